#include "open_log.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <system_error>
#include <utility>
#include <variant>

#include "console.hpp"
#include "mapping_options.hpp"
#include "nav_report.hpp"
#include "option_values.hpp"
#include "unknown_file.hpp"

namespace pingvox::app {

namespace {

tl::unexpected<Error> unknown_file(const std::string& name, std::span<const std::uint8_t> bytes) {
  return fail(Error::Code::kUnsupported, fmt::format("{}: {}", name, describe_unknown_file(bytes)));
}

/// The beams of several logs, one after another; those of points have none.
class BeamsOfLogs final : public BeamSource {
 public:
  BeamsOfLogs(std::span<const std::string> paths, Damage damage, const BeamTopic& topic)
      : paths_(paths), damage_(damage), topic_(topic) {}

  Result<std::optional<Beam>> next() override {
    for (;;) {
      if (source_ != nullptr) {
        Result<std::optional<Beam>> beam = source_->next();
        if (!beam || *beam) return beam;
      }
      if (paths_.empty()) return std::nullopt;
      Result<std::unique_ptr<BeamSource>> source = open(paths_.front());
      if (!source) return tl::unexpected(source.error());
      source_ = *std::move(source);
      paths_ = paths_.subspan(1);
    }
  }

 private:
  /// nullptr: holds no beams.
  Result<std::unique_ptr<BeamSource>> open(const std::string& path) const {
    Result<ByteStream> stream = ByteStream::open(path);
    if (!stream) return tl::unexpected(stream.error());
    if (stream->beginning().empty()) return nullptr;
    return open_log(*std::move(stream), damage_, std::nullopt, topic_).map([](Log log) {
      auto* const beams = std::get_if<std::unique_ptr<BeamSource>>(&log);
      return beams == nullptr ? nullptr : std::move(*beams);
    });
  }

  std::span<const std::string> paths_;
  Damage damage_;
  const BeamTopic& topic_;
  std::unique_ptr<BeamSource> source_;
};

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

Result<FileBytes> read_input(const std::string& path) {
  Result<ByteStream> stream = ByteStream::open(path);
  if (!stream) return tl::unexpected(stream.error());
  const std::span<const std::uint8_t> beginning = stream->beginning();
  const std::optional<Format> format = streamed_format_of(beginning);
  if (format && is_bag(*format) && stream->path()) {
    return FileBytes{stream->name(), {beginning.begin(), beginning.end()}};
  }
  return ByteStream::whole(*std::move(stream));
}

Result<Log> open_input(FileBytes file, const std::string& path, Damage damage, const BeamTopic& topic) {
  const std::size_t size = std::min(file.bytes.size(), ByteStream::kBeginning);
  const std::optional<Format> format = streamed_format_of(file.view().first(size));
  std::error_code error;
  if (format && is_bag(*format) && path != "-" && !std::filesystem::is_other(path, error)) {
    return ByteStream::open(path).and_then(
        [&](ByteStream stream) { return open_log(std::move(stream), damage, std::nullopt, topic); });
  }
  return open_log(std::move(file), damage, std::nullopt, topic);
}

Result<std::unique_ptr<BeamSource>> only_beams(Log log, const std::string& name) {
  if (auto* beams = std::get_if<std::unique_ptr<BeamSource>>(&log)) return std::move(*beams);
  return fail(Error::Code::kUnsupported, fmt::format("{}: holds scans of points, not beams of a sonar", name));
}

Result<Background> learn_background(std::span<const std::string> paths, double range_m, Damage damage,
                                    const BeamTopic& topic) {
  if (std::ranges::find(paths, "-") != paths.end()) {
    return usage_error("--background: reads the log twice, and standard input can be read only once");
  }
  BeamsOfLogs beams(paths, damage, topic);
  Result<Background> background = Background::learn(beams, {.range_m = range_m});
  if (!background || !background->empty()) return background;
  return fail(Error::Code::kUnsupported,
              fmt::format("{}: --background: needs {} beams of one direction",
                          paths.size() == 1 ? name_of_input(paths.front()) : "the logs", Background::kMinBeams));
}

Result<std::unique_ptr<BeamSource>> subtract_own_background(std::unique_ptr<BeamSource> beams, const std::string& path,
                                                            std::optional<double> range_m, Damage damage,
                                                            const BeamTopic& topic) {
  if (!range_m) return beams;
  return learn_background({&path, 1}, *range_m, damage, topic).map([&](Background background) {
    return subtract_background(std::move(beams), std::move(background));
  });
}

}  // namespace pingvox::app
