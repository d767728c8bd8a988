#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string_view>
#include <vector>

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

bool is_ros2_topic(std::string_view text) {
  if (!text.starts_with('/')) return false;
  char before = ' ';
  for (const char c : text) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    const bool is_digit = c >= '0' && c <= '9';
    const bool is_allowed = before == '/' ? is_letter : c == '/' || is_letter || is_digit;
    if (!is_allowed) return false;
    before = c;
  }
  return before != '/';
}

std::string why_not_published(const Ros2Node& node) {
  constexpr std::ptrdiff_t kMaxNamed = 5;
  const Ros2Network& network = node.network();
  const std::vector<std::string> all = node.topics_of_others();
  const std::string where =
      fmt::format("in domain {}{}", network.domain,
                  network.interface.empty() ? "" : fmt::format(" at the interface {}", network.interface));
  if (all.empty()) {
    return fmt::format("nobody publishes it, and nothing at all is seen {}: check the domain and the interface", where);
  }
  std::vector<std::string> topics;
  std::ranges::copy_if(all, std::back_inserter(topics), [](const std::string& topic) {
    return topic.starts_with('/') && topic != "/rosout" && topic != "/parameter_events";
  });
  if (topics.empty()) return fmt::format("nobody publishes it, though other nodes are seen {}", where);
  const auto shown = std::min(std::ssize(topics), kMaxNamed);
  return fmt::format("nobody publishes it; {} there are {}{}", where,
                     fmt::join(topics.begin(), topics.begin() + shown, ", "),
                     shown < std::ssize(topics) ? fmt::format(" and {} more", std::ssize(topics) - shown) : "");
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
