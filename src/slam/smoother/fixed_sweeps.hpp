#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "slam/smoother/echo_pairs.hpp"

namespace pingvox {

/// A sweep that left the problem: where its echoes were heard stays as it is.
struct FixedSweep {
  SweepPlace place;
  std::vector<PlacedEcho> echoes;  ///< each fixed
};

/// Sweeps that left the problem, by place. Of those in one square as wide as partners reach, 24 are kept, whichever
/// were the first: so neither a search nor the memory of a place grows with time.
class FixedSweeps {
 public:
  explicit FixedSweeps(std::uint64_t seed) : seed_(seed) {}

  /// REQUIRES a higher number than that of the sweep before.
  void add(FixedSweep sweep);

  /// Partners of the sweeps of a window, in the order of their numbers: those just before it, and for each at most
  /// kFarPartners that are near in place.
  std::vector<std::shared_ptr<const FixedSweep>> partners(std::span<const SweepPlace> window, double reach_m) const;
  /// All that were kept and are near a place, in the order of their numbers.
  std::vector<std::shared_ptr<const FixedSweep>> near(const Eigen::Vector2d& place_m, double reach_m) const;

 private:
  std::uint64_t seed_;
  std::deque<std::shared_ptr<const FixedSweep>> last_;
  std::map<std::pair<int, int>, std::vector<std::shared_ptr<const FixedSweep>>> squares_;
};

}  // namespace pingvox
