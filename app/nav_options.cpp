#include "nav_options.hpp"

#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "geometry/internal/mount_text.hpp"
#include "pingvox/recording/recording.hpp"

namespace pingvox::app {

Take store_mount(Pose& target) {
  return [&target](const std::string& text) -> Result<void> {
    const Result<Pose> mount = mount_from(text);
    if (!mount) return tl::unexpected(mount.error());
    target = *mount;
    return {};
  };
}

Take store_pose_of(std::map<std::string, Pose>& target, std::string name) {
  return [&target, name = std::move(name)](const std::string& text) -> Result<void> {
    const std::size_t equals = text.rfind('=');
    if (equals == std::string::npos || equals == 0) {
      return usage_error(fmt::format("'{}': must be {}=X,Y,Z,R,P,Y", text, name));
    }
    Pose pose;
    if (auto taken = store_mount(pose)(text.substr(equals + 1)); !taken) return taken;
    if (!target.emplace(text.substr(0, equals), pose).second) {
      return usage_error(fmt::format("'{}' is given twice", text.substr(0, equals)));
    }
    return {};
  };
}

Option mount_option(Pose& target) {
  return {
      "--mount",
      0,
      "X,Y,Z,R,P,Y",
      "pose of the sonar head on the vehicle: metres ahead, to port and up; roll, pitch and yaw (to port) in degrees",
      "0,0,0,0,0,0",
      store_mount(target)};
}

Option mount_option(Pose& target, bool& is_given) {
  Option option = mount_option(target);
  option.take = [take = option.take, &is_given](const std::string& text) {
    is_given = true;
    return take(text);
  };
  return option;
}

Option nav_option(Args& targets, std::string help) {
  return {"--nav", 0, "FILE", std::move(help), "", store_each(targets), Repeats::kEachCounts};
}

Option source_option(std::vector<NamedSource>& targets) {
  const Take take = [&targets](const std::string& text) -> Result<void> {
    if (text.empty()) return usage_error("must be NAME or QUANTITY=NAME");
    const std::size_t equals = text.find('=');
    const auto quantity =
        equals == std::string::npos ? std::nullopt : nav_quantity_of(std::string_view(text).substr(0, equals));
    targets.push_back(quantity ? NamedSource{text.substr(equals + 1), quantity} : NamedSource{text});
    return {};
  };
  return {"--nav-source",
          0,
          "[QUANTITY=]NAME",
          "source of navigation to use instead of others, for all its quantities or for one (position, fix, attitude, "
          "heading, velocity, depth ...); 'pingvox info' lists the sources",
          "chosen by kind and by the times they cover",
          take,
          Repeats::kEachCounts};
}

Option nav_source_option(std::vector<NamedSource>& targets) {
  Option option = source_option(targets);
  option.only_with = {{"--nav"}};
  return option;
}

Option nav_offset_option(std::optional<double>& target_s) {
  Option option{"--nav-offset",
                0,
                "S",
                "seconds to add to the times of --nav to get those of the sonar log",
                "estimated",
                within(RecordingOptions::kNavOffsets_s, store_optional(target_s))};
  option.only_with = {{"--nav"}};
  return option;
}

Option nav_mount_option(std::map<std::string, Pose>& body_from_source) {
  Option option{"--nav-mount",
                0,
                "SOURCE=X,Y,Z,R,P,Y",
                "pose of a navigation source on the vehicle, in the form of --mount; 'pingvox info' lists the sources",
                "0,0,0,0,0,0",
                store_pose_of(body_from_source, "SOURCE"),
                Repeats::kEachCounts};
  option.only_with = {{"--nav"}};
  return option;
}

Option use_calibration_option(std::string& target, std::string help) {
  Option option{"--use-calibration", 0, "FILE", std::move(help), "", store(target)};
  option.only_with = {{"--nav"}};
  return option;
}

}  // namespace pingvox::app
