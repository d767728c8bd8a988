#include "mapping/sweep_coverage_counter.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/median.hpp"

namespace pingvox::detail {
namespace {

constexpr double kPlace_m = 0.5, kPlaceCells = 4.0;
/// A beam is not as wide in places as to take long.
constexpr double kMaxPlacesOfBeam = 200.0;
/// Some 40 MB.
constexpr std::size_t kMaxPlaces = 1'000'000;

/// Angle of the turn from one direction of a head to another.
double turn_rad(const Pose& from, const Pose& to) {
  return Eigen::AngleAxisd(from.linear().transpose() * to.linear()).angle();
}

/// Median of a member of some values; 0 without any.
template <class Value, class Get>
double median_of(const std::vector<Value>& values, Get get) {
  std::vector<double> numbers;
  numbers.reserve(values.size());
  for (const Value& value : values) numbers.push_back(get(value));
  return numbers.empty() ? 0.0 : median(std::move(numbers));
}

}  // namespace

SweepCoverageCounter::SweepCoverageCounter(double cell_m) : place_m_(std::max(kPlace_m, kPlaceCells * cell_m)) {}

void SweepCoverageCounter::add(double time_s, const PlacedBeam& beam, double width_rad, bool has_echo) {
  ++beams_;
  pauses_.add(time_s);
  if (pending_) {
    pending_->last_s = time_s;
    pending_->moved_m += (beam.map_from_sensor.translation() - last_.translation()).norm();
    pending_->turned_rad = std::max(pending_->turned_rad, turn_rad(first_, beam.map_from_sensor));
  } else {
    pending_ = Sweep{time_s, time_s, 0.0, 0.0};
    first_ = beam.map_from_sensor;
  }
  last_ = beam.map_from_sensor;
  if (!has_echo || !beam.echo) return;
  widths_m_.add(beam.echo->range_m * width_rad);
  mark(beam, width_rad);
}

void SweepCoverageCounter::mark(const PlacedBeam& beam, double width_rad) {
  const double range_m = beam.echo->range_m;
  // Two steps a place, so that none between the edges is left out.
  const double steps = std::min(std::ceil(2.0 * range_m * width_rad / place_m_), kMaxPlacesOfBeam);
  for (double step = 0.0; step <= steps; step += 1.0) {
    const double bearing_rad = beam.bearing_rad + (steps > 0.0 ? width_rad * (step / steps - 0.5) : 0.0);
    const Eigen::Vector3d at_m =
        beam.map_from_sensor * (range_m * Eigen::Vector3d(std::cos(bearing_rad), std::sin(bearing_rad), 0.0));
    const auto word = [&](double m) {
      constexpr double kFar = 1e9;
      return static_cast<std::uint32_t>(static_cast<std::int64_t>(std::floor(std::clamp(m / place_m_, -kFar, kFar))));
    };
    const std::uint64_t key = static_cast<std::uint64_t>(word(at_m.x())) << 32U | word(at_m.y());
    if (places_.size() >= kMaxPlaces && !places_.contains(key)) continue;
    Place& place = places_.try_emplace(key, Place{0, 0}).first->second;
    const auto sweep = static_cast<std::uint32_t>(sweeps());
    if (place.sweeps > 0 && place.last_sweep == sweep) continue;
    place = {sweep, place.sweeps + 1};
  }
}

void SweepCoverageCounter::end_sweep(bool is_complete) {
  if (!pending_) return;
  (is_complete ? complete_ : incomplete_).add(*pending_);
  pending_.reset();
}

SweepCoverage SweepCoverageCounter::coverage() const {
  SweepCoverage all;
  all.beams = beams_;
  all.echoes = widths_m_.count();
  all.sweeps = sweeps();
  all.places = places_.size();
  std::vector<double> sweeps_of_places;
  sweeps_of_places.reserve(places_.size());
  for (const auto& [key, place] : places_) {
    all.places_heard_once += place.sweeps == 1 ? 1 : 0;
    sweeps_of_places.push_back(static_cast<double>(place.sweeps));
  }
  all.sweeps_per_place = median_of(sweeps_of_places, [](double sweeps) { return sweeps; });
  const std::vector<Sweep>& used = complete_.count() == 0 ? incomplete_.values() : complete_.values();
  all.sweep_s = median_of(used, [](const Sweep& sweep) { return sweep.last_s - sweep.first_s; });
  all.moved_m = median_of(used, [](const Sweep& sweep) { return sweep.moved_m; });
  all.turned_rad = median_of(used, [](const Sweep& sweep) { return sweep.turned_rad; });
  all.beam_width_m = median_of(widths_m_.values(), [](double width_m) { return width_m; });
  all.pauses = pauses_.pauses();
  return all;
}

}  // namespace pingvox::detail
