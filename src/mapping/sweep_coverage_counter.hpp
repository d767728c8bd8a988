#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "mapping/internal/beam_tracer.hpp"
#include "pingvox/mapping/sweep_coverage.hpp"

namespace pingvox::detail {

/// Counts what SweepCoverage says, beam by beam.
class SweepCoverageCounter {
 public:
  /// @param cell_m  resolution of the map
  explicit SweepCoverageCounter(double cell_m);

  /// Takes the next beam of a sweep. An echo without a heard range counts as none.
  /// @param width_rad  of the beam
  /// @param has_echo   whether its echo is to count: within the range that is mapped
  void add(double time_s, const PlacedBeam& beam, double width_rad, bool has_echo);
  /// The next beam begins a sweep. @param is_complete  whether the one before is
  void end_sweep(bool is_complete);

  /// Of the sweeps that have ended.
  SweepCoverage coverage() const;

 private:
  struct Sweep {
    double first_s, last_s, moved_m, turned_rad;
    bool is_complete;
  };
  struct Place {
    std::size_t last_sweep, sweeps;
  };
  void mark(const PlacedBeam& beam, double width_rad);

  double place_m_;
  std::size_t beams_ = 0;
  std::vector<Sweep> sweeps_;
  std::optional<Sweep> pending_;
  Pose last_ = Pose::Identity();  ///< map_from_sensor of the pending sweep's last beam
  std::vector<double> widths_m_;  ///< of the beam at each echo
  std::unordered_map<std::uint64_t, Place> places_;
};

}  // namespace pingvox::detail
