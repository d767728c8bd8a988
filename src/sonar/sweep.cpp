#include "pingvox/sonar/sweep.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "pingvox/geometry/degree.hpp"

namespace pingvox {
namespace {

constexpr double kFullTurn_rad = 2.0 * std::numbers::pi;
/// Below a third of the finest step of known heads (1/16 gradian): rounding, not movement.
constexpr double kSameBearing_rad = 3e-4;
constexpr double kJump_rad = 45.0 * kDegree_rad;
constexpr double kJump_steps = 4.0;
constexpr double kJitter_steps = 0.25;

/// The shorter way from one bearing to the other, in (-pi, pi].
double shortest_turn(double from_rad, double to_rad) {
  const double ahead = wrap_bearing(to_rad - from_rad);
  return ahead > std::numbers::pi ? ahead - kFullTurn_rad : ahead;
}

}  // namespace

double SweepAssembler::smaller_step_rad() const {
  return steps_rad_[1] > 0.0 ? std::min(steps_rad_[0], steps_rad_[1]) : steps_rad_[0];
}

double SweepAssembler::larger_step_rad() const {
  return std::max(steps_rad_[0], steps_rad_[1]);
}

bool SweepAssembler::is_jitter(double delta_rad) const {
  // One step across the first beam, after a much longer way around.
  const double turned = std::copysign(1.0, furthest_rad_) * (turned_rad_ + delta_rad);
  return furthest_rad_ != 0.0 && -turned > std::abs(furthest_rad_) / kJitter_steps;
}

std::optional<Sweep::Extent> SweepAssembler::end_by(const Beam& beam, double delta_rad) const {
  const Beam& first = pending_.beams.front();
  const std::size_t beams = pending_.beams.size() + 1;
  const std::size_t longest = std::max(longest_, beam.intensities.size());
  if (beams > kMaxBeams || longest > kMaxPixels / beams) return Sweep::Extent::kCut;
  if (std::abs(beam.bin_length_m - first.bin_length_m) > 0.01 * first.bin_length_m) return Sweep::Extent::kCut;

  const double larger = larger_step_rad();
  if (larger > 0.0 && std::abs(delta_rad) > std::max(kJump_rad, kJump_steps * larger)) {
    const bool flew_back = std::abs(shortest_turn(first.bearing_rad, beam.bearing_rad)) <= 0.5 * larger;
    return flew_back ? Sweep::Extent::kSector : Sweep::Extent::kCut;
  }
  if (furthest_rad_ == 0.0 || is_jitter(delta_rad)) return std::nullopt;
  const double furthest = std::abs(furthest_rad_);
  const double turned = std::copysign(1.0, furthest_rad_) * (turned_rad_ + delta_rad);
  if (furthest - turned > std::max(kSameBearing_rad, kJitter_steps * larger)) return Sweep::Extent::kSector;
  // A step across a gap must not widen the tolerance.
  const double tolerance = kJitter_steps * std::min(std::abs(delta_rad), smaller_step_rad());
  if (turned >= kFullTurn_rad - std::max(kSameBearing_rad, tolerance)) return Sweep::Extent::kTurn;
  return std::nullopt;
}

std::optional<Sweep> SweepAssembler::add(Beam beam) {
  std::optional<Sweep> finished;
  if (!pending_.beams.empty()) {
    const double delta = shortest_turn(pending_.beams.back().bearing_rad, beam.bearing_rad);
    const std::optional<Sweep::Extent> extent = end_by(beam, delta);
    if (extent) {
      finished = close(*extent);
    } else {
      if (is_jitter(delta)) {
        furthest_rad_ = 0.0;
        steps_rad_ = {};
      }
      turned_rad_ += delta;
      const double direction = std::copysign(1.0, furthest_rad_ == 0.0 ? turned_rad_ : furthest_rad_);
      const double advance = direction * (turned_rad_ - furthest_rad_);
      if (advance > kSameBearing_rad) {
        steps_rad_[1] = std::exchange(steps_rad_[0], advance);
        furthest_rad_ = turned_rad_;
      }
    }
  }
  longest_ = std::max(longest_, beam.intensities.size());
  pending_.beams.push_back(std::move(beam));
  return finished;
}

std::optional<Sweep> SweepAssembler::finish() {
  const double step = smaller_step_rad();
  const double tolerance = std::max(kSameBearing_rad, kJitter_steps * step);
  const bool around = furthest_rad_ != 0.0 && std::abs(furthest_rad_) + step >= kFullTurn_rad - tolerance;
  steps_rad_ = {};
  return close(around ? Sweep::Extent::kTurn : Sweep::Extent::kCut);
}

std::optional<Sweep> SweepAssembler::close(Sweep::Extent extent) {
  Sweep sweep = std::exchange(pending_, Sweep{});
  longest_ = 0;
  turned_rad_ = furthest_rad_ = 0.0;
  if (sweep.beams.empty()) return std::nullopt;
  sweep.extent = extent;
  return sweep;
}

std::vector<Sweep> sweeps_of(std::span<const Beam> beams) {
  SweepAssembler assembler;
  std::vector<Sweep> sweeps;
  for (const Beam& beam : beams) {
    if (auto sweep = assembler.add(beam)) sweeps.push_back(std::move(*sweep));
  }
  if (auto sweep = assembler.finish()) sweeps.push_back(std::move(*sweep));
  return sweeps;
}

}  // namespace pingvox
