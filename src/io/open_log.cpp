#include "pingvox/io/open_log.hpp"

#include <fmt/core.h>

#include <cstdint>
#include <span>
#include <utility>
#include <variant>

#include "io/internal/unknown_file.hpp"

namespace pingvox {
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

Result<Format> identify_log(ByteStream& stream) {
  Result<Format> format = identify_format(stream);
  if (!format || is_bag(*format)) return format;
  const FormatKind kind = kind_of(*format);
  if (kind == FormatKind::kBeams || kind == FormatKind::kScans || kind == FormatKind::kCloud) return format;
  return fail(Error::Code::kUnsupported,
              fmt::format("{}: is {}, not a log of a sonar", stream.name(), description_of(*format)));
}

Result<Log> open_log(ByteStream stream, Damage damage, const std::optional<Eigen::Vector3d>& cloud_origin_m,
                     const BeamTopic& topic) {
  const Result<Format> format = identify_log(stream);
  if (!format) return tl::unexpected(format.error());
  if (!topic.name.empty() && !topic.fields && !is_bag(*format)) {
    return fail(Error::Code::kBadOption, fmt::format("{}: topic: has no effect on {}, only on ROS bags", stream.name(),
                                                     description_of(*format)));
  }
  if (is_bag(*format)) return open_bag_log(std::move(stream), damage, topic);
  if (kind_of(*format) == FormatKind::kBeams) {
    return open_beams(std::move(stream), damage, topic).map([](auto source) { return Log(std::move(source)); });
  }
  return ByteStream::whole(std::move(stream))
      .and_then([&](FileBytes file) { return open_scans(std::move(file), damage, cloud_origin_m); })
      .map([](auto source) { return Log(std::move(source)); });
}

Result<std::unique_ptr<BeamSource>> only_beams(Log log, const std::string& name) {
  if (auto* beams = std::get_if<std::unique_ptr<BeamSource>>(&log)) return std::move(*beams);
  return fail(Error::Code::kUnsupported, fmt::format("{}: holds scans of points, not beams of a sonar", name));
}

}  // namespace pingvox
