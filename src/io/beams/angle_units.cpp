#include "io/beams/angle_units.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/median.hpp"
#include "pingvox/geometry/degree.hpp"

namespace pingvox {
namespace {

constexpr std::array kUnits = {AngleUnit::kRadian, AngleUnit::kDegree, AngleUnit::kGradian};

double turn_of(AngleUnit unit) {
  return unit == AngleUnit::kRadian ? 2.0 * std::numbers::pi : unit == AngleUnit::kDegree ? 360.0 : 400.0;
}

/// The unit in which something is a whole turn, give or take a part of it.
std::optional<AngleUnit> unit_of_turn(double angle, double tolerance_turns) {
  for (const AngleUnit unit : kUnits) {
    if (std::fabs(angle / turn_of(unit) - 1.0) <= tolerance_turns) return unit;
  }
  return std::nullopt;
}

/// Angles up to a turn either way, with the noise of the head.
constexpr double kMaxTurns = 1.05;

/// No head turns by less than this many degrees or gradians from beam to beam; in radians it is 2.9 degrees.
constexpr double kFinestStep = 0.05;

/// Nor by more than this many degrees.
constexpr double kCoarsestStep = 10.0;

}  // namespace

double radians_of(AngleUnit unit) {
  return 2.0 * std::numbers::pi / turn_of(unit);
}

std::string_view name_of(AngleUnit unit) {
  return unit == AngleUnit::kRadian ? "radians" : unit == AngleUnit::kDegree ? "degrees" : "gradians";
}

/// Damaged numbers, up to a fiftieth, are left out.
struct AngleUnits::Shape {
  double min = 0.0, max = 0.0;
  double step = 0.0;  ///< median of those that turn the head; 0: it does not turn
  bool has_jumps = false;
  std::optional<AngleUnit> by_jump;  ///< where the angles wrap after a turn

  double largest() const { return std::max(std::fabs(min), std::fabs(max)); }
};

AngleUnits::Shape AngleUnits::shape() const {
  constexpr std::size_t kShareOfDamaged = 50;
  constexpr double kShareOfJump = 0.5, kTolerance_turns = 0.03;
  Shape shape;
  if (angles_.empty()) return shape;
  std::vector<double> sorted = angles_;
  std::ranges::sort(sorted);
  const std::size_t damaged = sorted.size() / kShareOfDamaged;
  shape.min = sorted[damaged];
  shape.max = sorted[sorted.size() - 1 - damaged];
  const double extent = shape.max - shape.min;
  const auto is_in = [&](double angle) { return angle >= shape.min - extent && angle <= shape.max + extent; };
  std::vector<double> steps, jumps;
  for (std::size_t i = 1; i < angles_.size(); ++i) {
    const double step = std::fabs(angles_[i] - angles_[i - 1]);
    if (!is_in(angles_[i]) || !is_in(angles_[i - 1]) || !(step > 0.0)) continue;
    (step > kShareOfJump * extent ? jumps : steps).push_back(step);
  }
  if (!steps.empty()) shape.step = median(std::move(steps));
  shape.has_jumps = !jumps.empty();
  if (!jumps.empty()) shape.by_jump = unit_of_turn(median(std::move(jumps)) + shape.step, kTolerance_turns);
  return shape;
}

std::optional<AngleUnit> AngleUnits::unit() const {
  const Shape is = shape();
  if (is.step > 0.0 && is.step < kFinestStep) return AngleUnit::kRadian;
  if (is.by_jump) return is.by_jump;
  if (is.largest() > kMaxTurns * turn_of(AngleUnit::kGradian)) {
    // Turns are counted, by steps that heads make; otherwise it is another unit, as 6400 a turn.
    const bool counts = stated_ != AngleUnit::kRadian && !is.has_jumps && is.step <= kCoarsestStep;
    return counts ? std::optional(stated_) : std::nullopt;
  }
  if (is.max - is.min > turn_of(AngleUnit::kDegree) + is.step + 1.0) return AngleUnit::kGradian;
  if (is.largest() <= kMaxTurns * turn_of(stated_)) return stated_;
  // A single turn, which ends one step before it would wrap.
  return unit_of_turn(is.max - is.min + is.step, 0.5 * is.step / turn_of(AngleUnit::kDegree) + 1e-3);
}

bool AngleUnits::are_enough() const {
  constexpr std::size_t kFirst = 64;
  if (angles_.size() >= kMaxAngles) return true;
  // Looked at now and then, for each look goes through all.
  if (angles_.size() < kFirst || angles_.size() % kFirst != 0) return false;
  const Shape is = shape();
  if (is.by_jump) return true;
  // Degrees that begin at 0 are small for some time.
  return is.step < kFinestStep && stated_ == AngleUnit::kRadian &&
         is.largest() <= kMaxTurns * turn_of(AngleUnit::kRadian);
}

bool AngleUnits::count_turns() const {
  const std::optional<AngleUnit> known = unit();
  return known && shape().largest() > kMaxTurns * turn_of(*known);
}

std::string AngleUnits::problem_text() const {
  const std::optional<AngleUnit> known = unit();
  if (known == stated_) return {};
  return fmt::format("holds {}, it seems: its numbers go {}", known ? name_of(*known) : "something else", range_text());
}

std::string AngleUnits::range_text() const {
  const auto [min, max] = std::ranges::minmax(angles_);
  return fmt::format("from {:.6g} to {:.6g}", min, max);
}

}  // namespace pingvox
