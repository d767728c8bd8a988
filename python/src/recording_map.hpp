#pragma once

#include <pybind11/pybind11.h>

#include <utility>

#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/map/map_axes.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "shared_map.hpp"

namespace pingvox::python {

/// A map of a recording, and how it was made.
class RecordingMapView final : public SharedMap {
 public:
  RecordingMapView(OccupancyMap map, MapAxes axes, py::dict report, Trajectory trajectory)
      : SharedMap(std::move(map), axes), report_(std::move(report)), trajectory_(std::move(trajectory)) {}

  const py::dict& report() const { return report_; }
  const Trajectory& trajectory() const { return trajectory_; }

 private:
  py::dict report_;
  Trajectory trajectory_;
};

/// The class RecordingMap of the module. REQUIRES bind_map and bind_trajectory before.
void bind_recording_map(py::module_& module);

}  // namespace pingvox::python
