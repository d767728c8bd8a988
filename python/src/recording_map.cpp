#include "recording_map.hpp"

#include <fmt/format.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <utility>

#include "errors.hpp"
#include "pingvox/io/maps.hpp"

namespace pingvox::python {
namespace {

std::shared_ptr<RecordingMapView> copy_of(const RecordingMapView& made) {
  const py::dict report = py::module_::import("copy").attr("deepcopy")(made.report());
  return std::make_shared<RecordingMapView>(made.read([](const OccupancyMap& map) { return map; }), made.axes(), report,
                                            made.trajectory());
}

/// For pickle.
py::tuple full_state_of(const RecordingMapView& made) {
  return py::make_tuple(state_of(made), made.report(), made.trajectory());
}

std::shared_ptr<RecordingMapView> map_of_full_state(const py::tuple& state) {
  if (state.size() != 3) raise_usage("the state of a map of a recording: must be the map, its report and trajectory");
  MapFile file = map_of_state(state[0]);
  return std::make_shared<RecordingMapView>(std::move(file.map), file.axes, state[1].cast<py::dict>(),
                                            state[2].cast<Trajectory>());
}

}  // namespace

void bind_recording_map(py::module_& module) {
  py::class_<RecordingMapView, SharedMap, std::shared_ptr<RecordingMapView>>(module, "RecordingMap",
                                                                             "A map of a recording.")
      .def(py::init([](const py::args&, const py::kwargs&) -> std::shared_ptr<RecordingMapView> {
        throw py::type_error("RecordingMap: is made by Recording.map() and SlamResult.map()");
      }))
      .def(py::pickle(&full_state_of, &map_of_full_state))
      .def("copy", &copy_of, "A map of its own with the same content, report and trajectory.")
      .def("__copy__", &copy_of)
      .def(
          "__deepcopy__", [](const RecordingMapView& made, const py::dict&) { return copy_of(made); }, py::arg("memo"))
      .def_property_readonly("report", &RecordingMapView::report,
                             "What was mapped and what was skipped, named as in the program's JSON, and warnings.")
      .def_property_readonly("trajectory", &RecordingMapView::trajectory, "Where the vehicle was.")
      .def("__repr__", [](const RecordingMapView& made) {
        return fmt::format("<pingvox.RecordingMap of {} m, {} leaves>",
                           made.read([](const OccupancyMap& map) { return map.lattice().resolution_m(); }),
                           made.read([](const OccupancyMap& map) { return map.counts().leaves; }));
      });
}

}  // namespace pingvox::python
