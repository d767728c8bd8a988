#include "pingvox/mapping/beam_mapper.hpp"

#include <map>
#include <utility>
#include <vector>

#include "base/without_exceptions.hpp"
#include "mapping/echo_mapper.hpp"
#include "mapping/stopwatch.hpp"
#include "sonar/internal/echo_stream.hpp"

namespace pingvox {

/// Passes beams to echo detection, and then with their poses to the map.
class BeamMapper::Stages {
 public:
  Stages(const BuildOptions& options, OccupancyMap& map, CountSweeps count)
      : sound_speed_ratio_(options.sound_speed_ratio),
        empty_stream_(detail::echo_stream(options)),
        stream_(empty_stream_),
        mapper_(options, map, count) {}

  Result<void> add(Beam beam, const std::optional<Pose>& map_from_body) {
    watch_.skip();
    beam.bin_length_m *= sound_speed_ratio_;
    poses_[beams_++] = map_from_body;
    return take(stream_.add(std::move(beam)));
  }

  Result<void> finish() {
    watch_.skip();
    Result<void> taken = take(stream_.finish());
    mapper_.end_sweep();
    return taken;
  }

  /// After an error, when the waiting beams are incomplete.
  void restart() {
    stream_ = empty_stream_;
    sweeps_ = 0;
    mapper_.restart(report_);
    poses_.clear();
    beams_ = 0;
  }

  void track(ChangedPages* changes) { mapper_.track(changes); }
  const BuildReport& report() const { return report_; }
  SweepCoverage coverage() const { return mapper_.coverage(); }
  std::optional<std::size_t> delay_beams() const { return stream_.delay_beams(); }

 private:
  /// Maps the beams whose echoes are final.
  Result<void> take(const std::vector<EchoStream::BeamWithEcho>& final_echoes) {
    const std::size_t sweeps_before = std::exchange(sweeps_, stream_.complete_sweeps());
    const detail::EchoBeams heard = detail::echo_beams(final_echoes, 0, sweeps_ - sweeps_before);
    watch_.lap(report_.seconds.detect);
    std::vector<std::optional<Pose>> map_from_body;
    map_from_body.reserve(heard.beams.size());
    for (const std::uint64_t number : heard.numbers) map_from_body.push_back(poses_.extract(number).mapped());
    return mapper_.add(heard, map_from_body, report_);
  }

  double sound_speed_ratio_;
  EchoStream empty_stream_;  ///< to restart without an allocation
  EchoStream stream_;
  std::size_t sweeps_ = 0;  ///< complete ones of the stream, so far
  detail::EchoMapper mapper_;
  std::map<std::uint64_t, std::optional<Pose>> poses_;  ///< map_from_body of the beams that wait, by their numbers
  std::uint64_t beams_ = 0;                             ///< passed to the stream so far
  BuildReport report_;
  detail::Stopwatch watch_;
};

Result<BeamMapper> BeamMapper::make(const BuildOptions& options, OccupancyMap& map, CountSweeps count) {
  return detail::without_exceptions([&]() -> Result<BeamMapper> {
    if (const auto valid = options.validate(); !valid) return tl::unexpected(valid.error());
    return BeamMapper(std::make_unique<Stages>(options, map, count));
  });
}

BeamMapper::BeamMapper(std::unique_ptr<Stages> stages) : stages_(std::move(stages)) {}
BeamMapper::BeamMapper(BeamMapper&&) noexcept = default;
BeamMapper& BeamMapper::operator=(BeamMapper&&) noexcept = default;
BeamMapper::~BeamMapper() = default;

Result<void> BeamMapper::add(Beam beam, const std::optional<Pose>& map_from_body) {
  Result<void> added = detail::without_exceptions([&] { return stages_->add(std::move(beam), map_from_body); });
  if (!added) stages_->restart();
  return added;
}

Result<void> BeamMapper::finish() {
  Result<void> finished = detail::without_exceptions([&] { return stages_->finish(); });
  if (!finished) stages_->restart();
  return finished;
}

void BeamMapper::track(ChangedPages* changes) {
  stages_->track(changes);
}

const BuildReport& BeamMapper::report() const {
  return stages_->report();
}

SweepCoverage BeamMapper::coverage() const {
  return stages_->coverage();
}

std::optional<std::size_t> BeamMapper::delay_beams() const {
  return stages_->delay_beams();
}

}  // namespace pingvox
