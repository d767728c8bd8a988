#include "open_log.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "input_kinds.hpp"
#include "option_values.hpp"
#include "pingvox/recording/recording.hpp"

namespace pingvox::app {

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

Error advise_on_log(Error error, Format format) {
  if (error.code != Error::Code::kUnsupported) return error;
  switch (kind_of(format)) {
    case FormatKind::kMesh:
      error.message += ": 'pingvox convert' makes a map of its surface";
      break;
    case FormatKind::kNav:
      error.message += ": give it with --nav";
      break;
    case FormatKind::kTrajectory:
      error.message += ": 'map' and 'render' take it by --poses";
      break;
    default:
      break;
  }
  return error;
}

Result<Log> open_file_log(ByteStream stream, Damage damage, const BeamTopic& topic) {
  const Result<Format> format = identify_format(stream);
  if (!format) return tl::unexpected(format.error());
  return open_log(std::move(stream), damage, std::nullopt, topic).map_error([&](Error error) {
    return advise_on_log(std::move(error), *format);
  });
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

InputFile input_file(FileBytes file, const std::string& path) {
  const std::size_t size = std::min(file.bytes.size(), ByteStream::kBeginning);
  const std::optional<Format> format = streamed_format_of(file.view().first(size));
  std::error_code error;
  const bool is_file = path != "-" && !std::filesystem::is_other(path, error);
  return format && is_bag(*format) && is_file ? InputFile(path) : InputFile(std::move(file));
}

Result<Log> open_input(FileBytes file, const std::string& path, Damage damage, const BeamTopic& topic) {
  return input_file(std::move(file), path).open().and_then([&](ByteStream stream) {
    return open_file_log(std::move(stream), damage, topic);
  });
}

Result<std::unique_ptr<BeamSource>> subtract_own_background(std::unique_ptr<BeamSource> beams, const std::string& path,
                                                            std::optional<double> range_m, Damage damage,
                                                            const BeamTopic& topic) {
  if (!range_m) return beams;
  return Recording::open({path}, {.damage = damage, .topic = topic})
      .and_then([&](const Recording& recording) { return learn_background(recording, *range_m); })
      .map([&](Background background) { return subtract_background(std::move(beams), std::move(background)); });
}

}  // namespace pingvox::app
