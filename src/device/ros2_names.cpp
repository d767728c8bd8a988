#include <fmt/core.h>

#include <algorithm>
#include <string_view>

#include "base/option_errors.hpp"
#include "device/internal/ros2_node.hpp"

namespace pingvox {

Result<void> Ros2Network::validate() const {
  OptionErrors errors;
  errors.require_within("domain", domain, 0, kLastDomain);
  const bool is_name = std::ranges::all_of(interface, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '-' ||
           c == '_' || c == '@';
  });
  errors.require(is_name, "interface", "the name of a network interface", interface);
  return errors.result("ros2");
}

std::string dds_topic(const std::string& topic) {
  return topic.starts_with('/') ? "rt" + topic : topic;
}

std::string dds_type(const std::string& type) {
  const std::size_t package = type.find('/'), name = type.rfind('/');
  if (package == std::string::npos || package == name) return type;
  return fmt::format("{}::{}::dds_::{}_", type.substr(0, package), type.substr(package + 1, name - package - 1),
                     type.substr(name + 1));
}

std::optional<std::string> ros_type(const std::string& dds_type) {
  constexpr std::string_view kMiddle = "::msg::dds_::";
  const std::size_t middle = dds_type.find(kMiddle);
  if (middle == std::string::npos || !dds_type.ends_with('_')) return std::nullopt;
  const std::size_t name = middle + kMiddle.size();
  return fmt::format("{}/msg/{}", dds_type.substr(0, middle), dds_type.substr(name, dds_type.size() - name - 1));
}

}  // namespace pingvox
