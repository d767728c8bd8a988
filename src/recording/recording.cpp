#include "pingvox/recording/recording.hpp"

#include <fmt/format.h>

#include <cassert>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/median.hpp"
#include "base/option_errors.hpp"
#include "sonar/internal/option_limits.hpp"

namespace pingvox {
namespace {

/// ": that of /temperature is 59 degrees C, and only those above 0 up to 35 are taken"; empty: there is none.
std::string other_temperatures(const NavLog& nav) {
  std::string text;
  for (const NavSource& source : nav.sources()) {
    if (source.quantity != NavQuantity::kTemperature || !is_usable(source)) continue;
    std::vector<double> values_c;
    for (const NavSample& sample : source.samples) {
      if (sample.valid) values_c.push_back(sample.value.x());
    }
    text += fmt::format("{}{} is {:.3g} degrees C", text.empty() ? ": that of " : ", that of ", source.name,
                        median(std::move(values_c)));
  }
  return text.empty() ? text : text + ", and only those above 0 up to 35 are taken";
}

Result<std::optional<Water>> water_of(const RecordingOptions& options, const NavLog& nav) {
  if (!options.nav_salinity) return std::nullopt;
  const std::optional<WaterAround> around = water_around(nav);
  if (!around) {
    return fail(Error::Code::kUnsupported,
                "nav_salinity: the navigation has no temperature of the water" + other_temperatures(nav));
  }
  const Water water{around->temperature_c, *options.nav_salinity, around->depth_m};
  if (const auto valid = water.validate(); !valid) return tl::unexpected(valid.error());
  return water;
}

Result<NavOffset> offset_of(const RecordingOptions& options, const NavLog& nav, const InputFile& log) {
  if (options.nav_offset_s) return NavOffset{.offset_s = *options.nav_offset_s, .by = NavOffset::By::kGiven};
  return find_nav_offset(nav, {log, options.topic, options.body_from_sonar, options.damage});
}

/// Says what is wrong with the log before the navigation is read. Standard input is read once, and an empty file may be
/// one of several.
Result<void> check_is_log(const InputFile& file) {
  if (file.is_standard_input()) return {};
  Result<ByteStream> stream = file.open();
  if (!stream) return tl::unexpected(stream.error());
  if (stream->beginning().empty()) return {};
  const Result<Format> format = identify_log(*stream);
  return format ? Result<void>() : tl::unexpected(format.error());
}

}  // namespace

Result<void> RecordingOptions::validate() const {
  OptionErrors errors;
  const bool has_nav = !nav.empty();
  if (has_nav && poses) errors.add("poses and nav exclude each other");
  if (!has_nav && nav_offset_s) errors.add("nav_offset_s has no effect without nav");
  if (!has_nav && !nav_sources.empty()) errors.add("nav_sources have no effect without nav");
  if (!has_nav && nav_salinity) errors.add("nav_salinity needs nav");
  if (!has_nav && calibration) errors.add("calibration has no effect without nav");
  if (nav_offset_s) errors.require("nav_offset_s", *nav_offset_s, kNavOffsets_s);
  if (background_m) errors.require("background_m", *background_m, kBackgroundRanges_m);
  return errors.result("recording");
}

BeamSource* OpenedLog::beams() const {
  const auto* const source = std::get_if<std::unique_ptr<BeamSource>>(&log);
  return source == nullptr ? nullptr : source->get();
}

ScanSource* OpenedLog::scans() const {
  const auto* const source = std::get_if<std::unique_ptr<ScanSource>>(&log);
  return source == nullptr ? nullptr : source->get();
}

Result<Recording> Recording::open(std::vector<InputFile> logs, RecordingOptions options) {
  if (logs.empty()) return fail(Error::Code::kBadOption, "recording: no log given");
  if (const auto valid = options.validate(); !valid) return tl::unexpected(valid.error());
  const InputFile& first = logs.front();
  if (const auto is_log = check_is_log(first); !is_log) return tl::unexpected(is_log.error());
  Result<NavFiles> nav = read_navigation(options.nav, {.damage = options.damage,
                                                       .fields = options.nav_fields,
                                                       .log = first.name(),
                                                       .topic = options.topic.name,
                                                       .chosen = options.nav_sources});
  if (!nav) return tl::unexpected(nav.error());
  Recording recording(std::move(logs), std::move(options), *std::move(nav));
  if (recording.options_.nav.empty()) return recording;
  const Result<std::optional<Water>> water = water_of(recording.options_, recording.nav_.log);
  if (!water) return tl::unexpected(water.error());
  recording.water_ = *water;
  recording.nav_offset_ = offset_of(recording.options_, recording.nav_.log, recording.logs_.front());
  return recording;
}

std::string Recording::nav_names() const {
  std::string names;
  for (const InputFile& file : options_.nav) names += (names.empty() ? "" : ", ") + file.name();
  return names;
}

Result<OpenedLog> Recording::open_log(std::size_t number) const {
  assert(number < logs_.size());
  Result<ByteStream> stream = logs_[number].open();
  if (!stream) return tl::unexpected(stream.error());
  std::string name = stream->name();
  const Result<Format> format = identify_format(*stream);
  if (!format) return tl::unexpected(format.error());
  return pingvox::open_log(*std::move(stream), options_.damage, options_.cloud_origin_m, options_.topic)
      .map([&](Log log) { return OpenedLog{std::move(name), *format, std::move(log)}; });
}

Result<VehiclePath> Recording::path() const {
  if (options_.poses) return read_path(*options_.poses);
  if (options_.nav.empty()) return still_path();
  // Without a path the offset of the clocks does not matter.
  if (!nav_offset_ && has_path(nav_.log)) return tl::unexpected(nav_offset_.error());
  return path_of(nav_, nav_names(), nav_offset_ ? nav_offset_->offset_s : 0.0, options_.calibration);
}

}  // namespace pingvox
