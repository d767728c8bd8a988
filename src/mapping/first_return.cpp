#include "mapping/internal/first_return.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <vector>

#include "mapping/bundle_grid.hpp"
#include "pingvox/map/cast_ray.hpp"

namespace pingvox {
namespace {

/// Steps across an angle at a range, a cell apart.
int steps_across(double angle_rad, double range_m, double cell_m) {
  constexpr double kMaxSteps = 1000.0;
  return static_cast<int>(std::clamp(std::ceil(angle_rad * range_m / cell_m), 0.0, kMaxSteps));
}

/// An angle of `steps` + 1 that fill `angle_rad` about 0.
double angle_at(int step, int steps, double angle_rad) {
  return steps == 0 ? 0.0 : angle_rad * (static_cast<double>(step) / steps - 0.5);
}

Eigen::Vector3d direction_of(const BeamInMap& beam, double aside_rad, double up_rad) {
  const double bearing_rad = beam.bearing_rad + aside_rad;
  return beam.map_from_sensor.linear() * Eigen::Vector3d(std::cos(up_rad) * std::cos(bearing_rad),
                                                         std::cos(up_rad) * std::sin(bearing_rad), std::sin(up_rad));
}

std::optional<WideKey> first_occupied(const OccupancyMap& map, const Eigen::Vector3d& head_m,
                                      const Eigen::Vector3d& direction, double min_range_m, double max_range_m) {
  const RayEnd end = cast_ray(map, head_m + min_range_m * direction, direction, max_range_m - min_range_m);
  return end.what == Occupancy::kOccupied ? std::optional(end.key) : std::nullopt;
}

/// Directions over the arc at a range, a cell apart.
std::vector<Eigen::Vector3d> directions_over(const OccupancyMap& map, const BeamInMap& beam, double range_m) {
  const double cell_m = map.lattice().resolution_m();
  const int rows = steps_across(beam.height_rad, range_m, cell_m);
  const int columns = steps_across(beam.width_rad, range_m, cell_m);
  std::vector<Eigen::Vector3d> directions;
  directions.reserve(static_cast<std::size_t>(rows + 1) * static_cast<std::size_t>(columns + 1));
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column <= columns; ++column) {
      directions.push_back(
          direction_of(beam, angle_at(column, columns, beam.width_rad), angle_at(row, rows, beam.height_rad)));
    }
  }
  return directions;
}

/// Ranges within a tolerance of an echo.
struct Ranges {
  double from_m, to_m;
};
Ranges ranges_about(double echo_m, double tolerance_m) {
  return {std::max(0.0, echo_m - tolerance_m), echo_m + tolerance_m};
}

}  // namespace

BeamInMap heard_part(const BeamModelOptions& model, const Pose& map_from_sensor, double bearing_rad) {
  return {map_from_sensor, bearing_rad, model.free_share * detail::width_of(model),
          model.free_share * detail::height_of(model)};
}

std::optional<double> first_return_m(const OccupancyMap& map, const BeamInMap& beam, double min_range_m,
                                     double max_range_m) {
  assert(min_range_m >= 0.0 && max_range_m > min_range_m);
  const Eigen::Vector3d head_m = beam.map_from_sensor.translation();
  const auto cell = first_occupied(map, head_m, direction_of(beam, 0.0, 0.0), min_range_m, max_range_m);
  return cell ? std::optional((map.lattice().centre_of(*cell) - head_m).norm()) : std::nullopt;
}

EchoPlace place_of_echo(const OccupancyMap& map, const BeamInMap& beam, double echo_m, double tolerance_m) {
  const Eigen::Vector3d head_m = beam.map_from_sensor.translation();
  const auto [from_m, to_m] = ranges_about(echo_m, tolerance_m);
  EchoPlace place;
  std::size_t free = 0;
  const std::vector<Eigen::Vector3d> directions = directions_over(map, beam, echo_m);
  for (const Eigen::Vector3d& direction : directions) {
    if (const auto cell = first_occupied(map, head_m, direction, from_m, to_m)) {
      const double error_m = (map.lattice().centre_of(*cell) - head_m).norm() - echo_m;
      if (place.what != Occupancy::kOccupied || std::abs(error_m) < std::abs(place.error_m)) {
        place = {Occupancy::kOccupied, error_m};
      }
    } else if (map.classify(Eigen::Vector3d(head_m + echo_m * direction)) == Occupancy::kFree) {
      ++free;
    }
  }
  if (place.what != Occupancy::kOccupied && 2 * free >= directions.size()) place.what = Occupancy::kFree;
  return place;
}

std::vector<WideKey> occupied_on_arc(const OccupancyMap& map, const BeamInMap& beam, double echo_m,
                                     double tolerance_m) {
  const auto [from_m, to_m] = ranges_about(echo_m, tolerance_m);
  std::vector<WideKey> cells;
  for (const Eigen::Vector3d& direction : directions_over(map, beam, echo_m)) {
    const auto cell = first_occupied(map, beam.map_from_sensor.translation(), direction, from_m, to_m);
    if (cell) cells.push_back(*cell);
  }
  return cells;
}

std::vector<WideKey> cells_on_arc(const OccupancyMap& map, const BeamInMap& beam, double echo_m) {
  std::vector<WideKey> cells;
  for (const Eigen::Vector3d& direction : directions_over(map, beam, echo_m)) {
    const auto cell = map.lattice().key_of<WideWord>(beam.map_from_sensor.translation() + echo_m * direction);
    if (cell) cells.push_back(*cell);
  }
  return cells;
}

}  // namespace pingvox
