#include "open_log.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <utility>

#include "mapping_options.hpp"
#include "nav_report.hpp"
#include "option_values.hpp"
#include "unknown_file.hpp"

namespace pingvox::app {

namespace {

tl::unexpected<Error> unknown_file(const std::string& name, std::span<const std::uint8_t> bytes) {
  return fail(Error::Code::kUnsupported, fmt::format("{}: {}", name, describe_unknown_file(bytes)));
}

}  // namespace

Result<Format> identify_format(const FileBytes& file) {
  if (file.bytes.empty()) return fail(Error::Code::kUnsupported, fmt::format("{}: is empty", file.name));
  if (const auto format = format_of(file.view()); format && !is_true_ranges(file.view())) return *format;
  return unknown_file(file.name, file.view());
}

Result<Format> identify_format(ByteStream& stream) {
  const std::span<const std::uint8_t> beginning = stream.beginning();
  if (const auto streamed = streamed_format_of(beginning)) return *streamed;
  // The rest may be large, and that of a pipe may never end.
  if (beginning.size() == ByteStream::kBeginning && !may_be_known(beginning)) {
    return unknown_file(stream.name(), beginning);
  }
  if (const Result<void> held = stream.load_all(); !held) return tl::unexpected(held.error());
  return identify_format(stream.held());
}

Result<BagContents> bag_contents(ByteStream& stream, Damage damage, std::span<const NavFields> fields) {
  if (const std::optional<std::string> path = stream.path()) {
    Result<ByteStream> again = ByteStream::open(*path);
    if (!again) return tl::unexpected(again.error());
    return read_nav_log(std::move(*again), damage, fields);
  }
  if (const Result<void> held = stream.load_all(); !held) return tl::unexpected(held.error());
  return read_nav_log(ByteStream(stream.held()), damage, fields);
}

bool has(const BagContents& bag, BagTopicSummary::Use use) {
  return std::ranges::any_of(bag.topics,
                             [use](const BagTopicSummary& topic) { return topic.use == use && topic.messages > 0; });
}

std::string kind_text(FormatKind kind) {
  switch (kind) {
    case FormatKind::kBeams:
      return std::string(kBeamLogs);
    case FormatKind::kScans:
      return std::string(kPointLogs);
    case FormatKind::kCloud:
      return std::string(kClouds);
    case FormatKind::kMap:
      return std::string(kMaps);
    case FormatKind::kMesh:
      return std::string(kMeshes);
    case FormatKind::kTrajectory:
      return "trajectories";
    case FormatKind::kNav:
      return std::string(kNavLogs);
    default:
      return "this file";
  }
}

Result<Log> open_log(ByteStream stream, Damage damage, const std::optional<Eigen::Vector3d>& cloud_origin_m,
                     const BeamTopic& topic) {
  const Result<Format> format = identify_format(stream);
  if (!format) return tl::unexpected(format.error());
  const FormatKind kind = kind_of(*format);
  if (!topic.name.empty() && !topic.fields && !is_bag(*format)) {
    return usage_error(
        fmt::format("{}: --topic: has no effect on {}, only on ROS bags", stream.name(), description_of(*format)));
  }
  if (is_bag(*format)) return open_bag_log(std::move(stream), damage, topic);
  if (kind == FormatKind::kBeams) {
    return open_beams(std::move(stream), damage, topic).map([](auto source) { return Log(std::move(source)); });
  }
  if (kind == FormatKind::kScans || kind == FormatKind::kCloud) {
    return ByteStream::whole(std::move(stream))
        .and_then([&](FileBytes file) { return open_scans(std::move(file), damage, cloud_origin_m); })
        .map([](auto source) { return Log(std::move(source)); });
  }
  return fail(Error::Code::kUnsupported,
              fmt::format("{}: is {}, not a log of a sonar{}", stream.name(), description_of(*format),
                          kind == FormatKind::kMesh         ? ": 'pingvox convert' makes a map of its surface"
                          : kind == FormatKind::kNav        ? ": give it with --nav"
                          : kind == FormatKind::kTrajectory ? ": 'map' and 'render' take it by --poses"
                                                            : ""));
}

Result<std::unique_ptr<BeamSource>> only_beams(Log log, const std::string& name) {
  if (auto* beams = std::get_if<std::unique_ptr<BeamSource>>(&log)) return std::move(*beams);
  return fail(Error::Code::kUnsupported, fmt::format("{}: holds scans of points, not beams of a sonar", name));
}

Result<Background> learn_background(const std::string& path, double range_m, Damage damage, const BeamTopic& topic) {
  if (path == "-") return usage_error("--background: reads the log twice, and standard input can be read only once");
  return ByteStream::open(path)
      .and_then([&](ByteStream stream) { return open_beams(std::move(stream), damage, topic); })
      .and_then([&](std::unique_ptr<BeamSource> source) { return Background::learn(*source, {.range_m = range_m}); });
}

Result<void> subtract_background(Log& log, const std::string& path, std::optional<double> range_m, Damage damage,
                                 const BeamTopic& topic) {
  auto* beams = std::get_if<std::unique_ptr<BeamSource>>(&log);
  if (beams == nullptr || !range_m) return {};
  Result<Background> background = learn_background(path, *range_m, damage, topic);
  if (!background) return tl::unexpected(background.error());
  *beams = subtract_background(std::move(*beams), *std::move(background));
  return {};
}

}  // namespace pingvox::app
