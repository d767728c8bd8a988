#include "open_log.hpp"

#include <fmt/core.h>

#include <utility>

#include "mapping_options.hpp"
#include "option_values.hpp"
#include "unknown_file.hpp"

namespace pingvox::app {

Result<Format> identify_format(const FileBytes& file) {
  if (file.bytes.empty()) return fail(Error::Code::kUnsupported, fmt::format("{}: is empty", file.name));
  if (const auto format = format_of(file.view()); format && !is_true_ranges(file.view())) return *format;
  return fail(Error::Code::kUnsupported, fmt::format("{}: {}", file.name, describe_unknown_file(file.view())));
}

Result<Format> identify_format(ByteStream& stream) {
  if (const auto streamed = streamed_format_of(stream.beginning())) return *streamed;
  if (const Result<void> held = stream.load_all(); !held) return tl::unexpected(held.error());
  return identify_format(stream.held());
}

std::string describe(Format format) {
  const auto with = [&](std::string_view kind) { return fmt::format("{} (.{})", kind, name_of(format)); };
  // Formats without a suffix of their own.
  if (format == Format::kPingViewer) return "a log of beams (Ping Viewer)";
  if (format == Format::kSeanetCapture) return "a log of beams (SeaNet, serial line)";
  if (format == Format::kUdpCapture) return "a log of beams (SeaNet, UDP packets)";
  if (format == Format::kDumplog) return "a log of beams (SeanetDumpLog)";
  switch (kind_of(format)) {
    case FormatKind::kBeams:
      return with("a log of beams");
    case FormatKind::kScans:
      return with("a log of point scans");
    case FormatKind::kMap:
      return with("a map");
    case FormatKind::kTrajectory:
      return with("a trajectory");
    case FormatKind::kNav:
      return with("a navigation log");
    case FormatKind::kCloud:
      return with("a cloud of points");
    case FormatKind::kMesh:
      return with("a mesh");
    case FormatKind::kGrid:
      return with("a grid");
    case FormatKind::kPicture:
      break;
  }
  return with("a picture");
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

Result<Log> open_log(ByteStream stream, Damage damage, const std::optional<Eigen::Vector3d>& cloud_origin_m) {
  const Result<Format> format = identify_format(stream);
  if (!format) return tl::unexpected(format.error());
  const FormatKind kind = kind_of(*format);
  if (kind == FormatKind::kBeams) {
    return open_beams(std::move(stream), damage).map([](auto source) { return Log(std::move(source)); });
  }
  if (kind == FormatKind::kScans || kind == FormatKind::kCloud) {
    return ByteStream::whole(std::move(stream))
        .and_then([&](FileBytes file) { return open_scans(std::move(file), damage, cloud_origin_m); })
        .map([](auto source) { return Log(std::move(source)); });
  }
  return fail(Error::Code::kUnsupported,
              fmt::format("{}: is {}, not a log{}", stream.name(), describe(*format),
                          kind == FormatKind::kMesh ? ": 'pingvox convert' makes a map of its surface" : ""));
}

Result<Background> learn_background(const std::string& path, double range_m, Damage damage) {
  if (path == "-") return usage_error("--background: reads the log twice, and standard input can be read only once");
  return ByteStream::open(path)
      .and_then([&](ByteStream stream) { return open_beams(std::move(stream), damage); })
      .and_then([&](std::unique_ptr<BeamSource> source) { return Background::learn(*source, {.range_m = range_m}); });
}

Result<void> subtract_background(Log& log, const std::string& path, std::optional<double> range_m, Damage damage) {
  auto* beams = std::get_if<std::unique_ptr<BeamSource>>(&log);
  if (beams == nullptr || !range_m) return {};
  Result<Background> background = learn_background(path, *range_m, damage);
  if (!background) return tl::unexpected(background.error());
  *beams = subtract_background(std::move(*beams), *std::move(background));
  return {};
}

}  // namespace pingvox::app
