#include "pingvox/sonar/sweep.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace pingvox {
namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi;
constexpr double kDegree_rad = std::numbers::pi / 180.0;
/// Below a third of the finest step of known heads (1/16 gradian): rounding, not movement.
constexpr double kSameBearing_rad = 3e-4;
constexpr double kJump_rad = 45.0 * kDegree_rad;
constexpr double kJump_steps = 4.0;

/// The shorter way from one bearing to the other, in (-pi, pi].
double shortest_turn(double from_rad, double to_rad) {
  const double ahead = wrapped_bearing(to_rad - from_rad);
  return ahead > std::numbers::pi ? ahead - kTurn_rad : ahead;
}

}  // namespace

double SweepAssembler::usual_step_rad() const {
  // The smaller of two: behind one lost beam a step looks twice as large.
  return steps_rad_[1] > 0.0 ? std::min(steps_rad_[0], steps_rad_[1]) : steps_rad_[0];
}

std::optional<Sweep::Extent> SweepAssembler::ended_by(const Beam& beam, double delta_rad) const {
  const Beam& first = gathered_.beams.front();
  const std::size_t beams = gathered_.beams.size() + 1;
  const std::size_t longest = std::max(longest_, beam.intensities.size());
  if (beams > kMaxBeams || longest > kMaxPixels / beams) return Sweep::Extent::kCut;
  if (std::abs(beam.bin_length_m - first.bin_length_m) > 0.01 * first.bin_length_m) return Sweep::Extent::kCut;

  const double step = usual_step_rad();
  if (step > 0.0 && std::abs(delta_rad) > std::max(kJump_rad, kJump_steps * step)) {
    const bool flew_back = std::abs(shortest_turn(first.bearing_rad, beam.bearing_rad)) <= 0.5 * step;
    return flew_back ? Sweep::Extent::kSector : Sweep::Extent::kCut;
  }
  const double direction = std::copysign(1.0, furthest_rad_);
  const double turned = direction * (turned_rad_ + delta_rad);
  const double furthest = std::abs(furthest_rad_);
  if (furthest > 0.0 && furthest - turned > std::max(kSameBearing_rad, step / 3.0)) return Sweep::Extent::kSector;
  // A step across a gap must not widen the tolerance, nor may a doubled beam's.
  const double tolerance = std::max(kSameBearing_rad, 0.5 * std::min(std::abs(delta_rad), step));
  if (furthest > 0.0 && turned >= kTurn_rad - tolerance) return Sweep::Extent::kTurn;
  return std::nullopt;
}

std::optional<Sweep> SweepAssembler::add(Beam beam) {
  std::optional<Sweep> finished;
  if (!gathered_.beams.empty()) {
    const double delta = shortest_turn(gathered_.beams.back().bearing_rad, beam.bearing_rad);
    const std::optional<Sweep::Extent> extent = ended_by(beam, delta);
    if (extent) {
      finished = close(*extent);
    } else {
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
  gathered_.beams.push_back(std::move(beam));
  return finished;
}

std::optional<Sweep> SweepAssembler::finish() {
  const double step = usual_step_rad();
  const bool around = furthest_rad_ != 0.0 && std::abs(furthest_rad_) + 1.5 * step >= kTurn_rad;
  steps_rad_[0] = steps_rad_[1] = 0.0;
  return close(around ? Sweep::Extent::kTurn : Sweep::Extent::kCut);
}

std::optional<Sweep> SweepAssembler::close(Sweep::Extent extent) {
  Sweep sweep = std::exchange(gathered_, Sweep{});
  longest_ = 0;
  turned_rad_ = furthest_rad_ = 0.0;
  if (sweep.beams.empty()) return std::nullopt;
  sweep.extent = extent;
  return sweep;
}

}  // namespace pingvox
