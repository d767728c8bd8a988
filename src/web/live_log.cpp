#include "web/live_log.hpp"

#include <algorithm>
#include <utility>

#include "web/echo_display.hpp"
#include "web/scene_objects.hpp"

namespace pingvox::web {

LiveLog::LiveLog(const BuildOptions& build, double of_first_s)
    : build_(build), of_first_s_(of_first_s), stream_(build.filter, build.echo) {}

void LiveLog::add(Beam beam) {
  beam.bin_length_m *= build_.sound_speed_ratio;
  const std::size_t bins = beam.intensities.size();
  const std::size_t group = std::max<std::size_t>((bins + SceneLog::kMaxBins - 1) / SceneLog::kMaxBins, 1);
  Kept kept{.beam = {.time_s = of_first_s_ + beam.time_s,
                     .bearing_rad = beam.bearing_rad,
                     .bin_length_m = beam.bin_length_m * static_cast<double>(group)},
            .bins = join_bins(beam.intensities, group)};
  bins_ = std::max(bins_, kept.bins.size());
  beams_.push_back(std::move(kept));
  for (const EchoStream::BeamWithEcho& heard : stream_.add(std::move(beam))) settle(heard);
  beams_.back().beam.sweep = static_cast<std::uint32_t>(stream_.complete_sweeps());
  for (; beams_.size() > kMaxBeams; beams_.pop_front()) ++first_;
  settled_ = std::max(settled_, first_);
  while (settled_ < end() && beams_[settled_ - first_].is_settled) ++settled_;
}

void LiveLog::settle(const EchoStream::BeamWithEcho& heard) {
  if (heard.number < first_) return;
  Kept& kept = beams_[static_cast<std::size_t>(heard.number) - first_];
  kept.is_settled = true;
  kept.beam.threshold = level_of(build_.echo, heard.echo);
  if (heard.echo) show_echo(*heard.echo, build_.model, kept.beam);
}

SceneLog LiveLog::description(std::size_t beams) const {
  SceneLog log;
  log.beam_width_rad = build_.model.width_rad;
  log.beam_height_rad = build_.model.height_rad;
  log.body_from_sonar = build_.body_from_sensor;
  log.bins = bins_;
  log.beams.resize(beams);
  return log;
}

Bytes LiveLog::beams_from(std::size_t number) const {
  const std::size_t from = std::clamp(number, first_, end());
  SceneLog log;
  log.bins = bins_;
  for (std::size_t i = from; i < end(); ++i) log.beams.push_back(beams_[i - first_].beam);
  return beams_bytes(log, static_cast<std::uint32_t>(from));
}

std::optional<Bytes> LiveLog::bins_of(std::size_t from, std::size_t to) const {
  if (from < first_ || from > to || to > end()) return std::nullopt;
  Bytes bytes;
  bytes.reserve((to - from) * bins_);
  for (std::size_t i = from; i < to; ++i) {
    const std::vector<std::uint8_t>& bins = beams_[i - first_].bins;
    bytes.insert(bytes.end(), bins.begin(), bins.end());
    bytes.resize(bytes.size() + bins_ - bins.size());
  }
  return bytes;
}

}  // namespace pingvox::web
