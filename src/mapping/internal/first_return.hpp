#pragma once

#include <optional>
#include <vector>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/mapping/beam_model.hpp"

namespace pingvox {

/// A beam through a map.
struct BeamInMap {
  Pose map_from_sensor = Pose::Identity();
  double bearing_rad = 0.0;
  // The part of the beam within which objects are heard, full angles: 0 for what has none (rays, the height of fans).
  double width_rad = 0.0, height_rad = 0.0;
};

/// The part of a beam whose silence frees cells: `free_share` of its width and height.
BeamInMap heard_part(const BeamModelOptions& model, const Pose& map_from_sensor, double bearing_rad);

/// Range [m] from the head to the centre of the first occupied cell on the axis of a beam, between two ranges; nullopt:
/// there is none. REQUIRES 0 <= min_range_m < max_range_m
std::optional<double> first_return_m(const OccupancyMap& map, const BeamInMap& beam, double min_range_m,
                                     double max_range_m);

/// What a map says of where an echo came from.
struct EchoPlace {
  /// kOccupied: anywhere on the arc of the echo, within the tolerance in range; kFree: at least half of the arc; else
  /// kUnknown.
  Occupancy what = Occupancy::kUnknown;
  double error_m = 0.0;  ///< of kOccupied: range of the cell nearest in range, less that of the echo
};
EchoPlace place_of_echo(const OccupancyMap& map, const BeamInMap& beam, double echo_m, double tolerance_m);

/// Occupied cells on the arc of an echo, within the tolerance in range: those that it may have come from. A cell may be
/// there more than once.
std::vector<WideKey> occupied_on_arc(const OccupancyMap& map, const BeamInMap& beam, double echo_m, double tolerance_m);
/// The cells on the arc at the range of the echo, whatever they are.
std::vector<WideKey> cells_on_arc(const OccupancyMap& map, const BeamInMap& beam, double echo_m);

}  // namespace pingvox
