#pragma once

#include <pybind11/pybind11.h>

#include "live_thread.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/live/live_mapping.hpp"
#include "pingvox/slam/localizer.hpp"

namespace pingvox::python {

/// An object of the class that the event has in Python.
pybind11::object event_object(const ReportedEvent& told);

/// The time, and map_from_body as a matrix of 4 x 4.
pybind11::tuple pose_of(const StampedPose& pose);
/// Metres and radians.
pybind11::dict hypothesis_of(const PoseHypothesis& hypothesis);

}  // namespace pingvox::python
