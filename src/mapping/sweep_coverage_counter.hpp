#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "mapping/internal/beam_tracer.hpp"
#include "pingvox/mapping/sweep_coverage.hpp"
#include "pingvox/sonar/beam_pauses.hpp"

namespace pingvox::detail {

/// Some of the values that were added, evenly spread over all of them, to take a median of: all of the first ten
/// thousand and more, then each second one, then each fourth, so that memory stays bounded.
template <class Value>
class ThinnedSample {
 public:
  void add(const Value& value) {
    if (count_++ % stride_ != 0) return;
    if (values_.size() == kMaxValues) {
      for (std::size_t i = 0; i < kMaxValues / 2; ++i) values_[i] = values_[2 * i];
      values_.resize(kMaxValues / 2);
      stride_ *= 2;
    }
    values_.push_back(value);
  }
  std::size_t count() const { return count_; }  ///< of the values that were added
  const std::vector<Value>& values() const { return values_; }

 private:
  static constexpr std::size_t kMaxValues = 16'384;  // even, so that the next value to keep follows the kept ones
  std::size_t count_ = 0, stride_ = 1;
  std::vector<Value> values_;
};

/// Counts what SweepCoverage says, beam by beam. Memory is bounded, as a vehicle maps for days: medians are of samples,
/// and of a vehicle that comes to more than a million places (250,000 square metres of walls) the first million count.
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
  };
  struct Place {
    std::uint32_t last_sweep, sweeps;
  };
  /// Of all sweeps that have ended.
  std::size_t sweeps() const { return complete_.count() + incomplete_.count(); }
  void mark(const PlacedBeam& beam, double width_rad);

  double place_m_;
  std::size_t beams_ = 0;
  ThinnedSample<Sweep> complete_, incomplete_;
  std::optional<Sweep> pending_;
  Pose first_ = Pose::Identity(), last_ = Pose::Identity();  ///< map_from_sensor in the pending sweep
  BeamPauseCounter pauses_;
  ThinnedSample<double> widths_m_;  ///< of the beam at each echo
  std::unordered_map<std::uint64_t, Place> places_;
};

}  // namespace pingvox::detail
