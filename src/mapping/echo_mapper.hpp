#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "mapping/internal/beam_tracer.hpp"
#include "mapping/scan_parts.hpp"
#include "mapping/stopwatch.hpp"
#include "mapping/sweep_coverage_counter.hpp"
#include "pingvox/map/changed_pages.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/map/scan_update.hpp"
#include "pingvox/mapping/build_options.hpp"
#include "sonar/internal/echo_stream.hpp"

namespace pingvox::detail {

/// What a map needs of a beam whose echo is known.
struct EchoBeam {
  double time_s, bearing_rad, bin_length_m;
  std::uint32_t bins;
  enum class Where : std::uint8_t { kInRange, kBeyond } where = Where::kInRange;  ///< is the echo
  std::optional<Echo> echo;                                                       ///< the first one
};

/// Beams whose echoes became final together.
struct EchoBeams {
  std::vector<EchoBeam> beams;
  std::vector<std::uint64_t> numbers;  ///< of the beams, in the order in which they came
  std::size_t ended_sweeps = 0;        ///< complete ones, since the beams before these
};

/// @param first  number of the stream's first beam
EchoBeams echo_beams(const std::vector<EchoStream::BeamWithEcho>& heard, std::uint64_t first, std::size_t ended_sweeps);

/// The stream that finds the echoes of beams for a map.
EchoStream echo_stream(const BuildOptions& options);

/// Brings beams whose echoes are known into a map. The same beams at the same poses make the same map.
class EchoMapper {
 public:
  /// REQUIRES valid options. `map` has to outlive this.
  EchoMapper(const BuildOptions& options, OccupancyMap& map, CountSweeps count = CountSweeps::kNo);

  /// @param map_from_body  of each beam; nullopt: not known, and the beam is left out and counted
  /// @return kLimit when the map would grow too large, or each of the first beams; the map keeps what it had got.
  /// Throws std::bad_alloc.
  Result<void> add(const EchoBeams& heard, std::span<const std::optional<Pose>> map_from_body, BuildReport& report);

  /// After an error: the next beam begins a sweep.
  /// @param report  of the beams so far
  void restart(const BuildReport& report);

  /// The next beam begins a sweep, and the one before is not complete.
  void end_sweep();

  /// Notes from now on what changes in the map. nullptr: not any more.
  void track(ChangedPages* changes) { changes_ = changes; }

  /// What the sweeps heard that have ended; empty without CountSweeps::kYes.
  SweepCoverage coverage() const { return coverage_ ? coverage_->coverage() : SweepCoverage{}; }

 private:
  /// Beams that are to be mapped.
  struct Placed {
    std::vector<PlacedBeam> beams;
    std::vector<const EchoBeam*> heard;
  };

  Result<Placed> place(const EchoBeams& heard, std::span<const std::optional<Pose>> map_from_body, BuildReport& report);
  double longest_range_m(std::span<const EchoBeam> beams);
  bool is_blocked(const PlacedBeam& beam) const;
  double length_of(const EchoBeam& beam) const;
  double cells_of(const EchoBeam& beam) const;
  tl::unexpected<Error> too_many_cells(const EchoBeam& beam) const;
  Result<void> map_as_one_scan(const Placed& placed, BuildReport& report);
  Result<void> map_one_by_one(const Placed& placed, BuildReport& report);
  Result<void> apply(BuildReport& report);

  BuildOptions options_;
  OccupancyMap* map_;
  std::vector<BeamTracer> tracers_;  ///< one for each thread
  ScanUpdate scan_;
  ScanParts parts_;
  std::size_t no_pose_before_ = 0;       ///< beams left out before this sweep
  std::vector<double> recent_ranges_m_;  ///< of beams before, without those that are too long
  std::size_t too_long_in_row_ = 0;
  std::optional<SweepCoverageCounter> coverage_;
  ChangedPages* changes_ = nullptr;
  Stopwatch watch_;
};

}  // namespace pingvox::detail
