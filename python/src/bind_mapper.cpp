#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "arrays.hpp"
#include "errors.hpp"
#include "keywords.hpp"
#include "module.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/mapping/beam_mapper.hpp"
#include "recorded_beams.hpp"
#include "report.hpp"
#include "shared_map.hpp"

namespace pingvox::python {
namespace {

/// A mapper with the map that it fills. It is used only while the map is changed, so by one thread at a time.
class Mapper {
 public:
  Mapper(std::shared_ptr<SharedMap> shared, const BuildOptions& options)
      : shared_(std::move(shared)),
        mapper_(value_of(shared_->change([&](OccupancyMap& map) { return BeamMapper::make(options, map); }))) {}

  void add(const RecordedBeams& recorded, const std::optional<Trajectory>& trajectory) {
    shared_->change([&](OccupancyMap&) {
      Interpreter interpreter;
      for (const Beam& beam : *recorded.beams) {
        value_of(mapper_.add(beam, trajectory ? trajectory->at(beam.time_s) : Pose::Identity()));
        if (interpreter.is_due()) interpreter.tell(0);
      }
    });
  }
  void add_one(double time, double bearing, double bin_length, const py::object& values, const py::object& pose) {
    const ByteArray intensities = byte_array(values, "intensities", "(bins,)");
    if (intensities.ndim() != 1) raise_usage("intensities: must be an array of shape (bins,)");
    Beam beam{time,
              std::isfinite(bearing) ? wrap_bearing(bearing) : bearing,
              bin_length,
              {intensities.data(), intensities.data() + intensities.size()}};
    value_of(validate(beam));
    std::optional<Pose> map_from_body;
    if (!pose.is_none()) map_from_body = pose_from(pose, "pose");
    value_of(shared_->change([&](OccupancyMap&) { return mapper_.add(std::move(beam), map_from_body); }));
  }
  void finish() {
    value_of(shared_->change([&](OccupancyMap&) { return mapper_.finish(); }));
  }
  py::dict report() const {
    return report_of(shared_->read([&](const OccupancyMap&) { return mapper_.report(); }));
  }
  const std::shared_ptr<SharedMap>& map() const { return shared_; }

 private:
  std::shared_ptr<SharedMap> shared_;
  BeamMapper mapper_;
};

}  // namespace

py::dict report_of(const BuildReport& report, std::size_t damaged) {
  py::dict all, skipped_for, seconds, threshold;
  skipped_for["damage"] = damaged;
  skipped_for["no_pose"] = report.no_pose.count;
  skipped_for["blocked"] = report.blocked.count;
  skipped_for["too_long"] = report.too_long.count;
  skipped_for["outside_map"] = report.outside.count;
  seconds["read"] = report.seconds.read;
  seconds["detect"] = report.seconds.detect;
  seconds["trace"] = report.seconds.trace;
  seconds["apply"] = report.seconds.apply;
  threshold["min"] = report.min_threshold;
  threshold["max"] = report.max_threshold;
  all["beams"] = report.beams;
  all["sweeps"] = report.sweeps;
  all["echoes"] = report.echoes;
  all["skipped"] = report.skipped;
  all["skipped_for"] = skipped_for;
  all["threshold"] = threshold;
  all["cells_freed"] = report.cells_freed;
  all["cells_hit"] = report.cells_hit;
  all["seconds"] = seconds;
  return all;
}

void bind_mapper(py::module_& module) {
  const std::string doc = docstring(
      "Maps beams as they arrive. A beam is mapped with its sweep, when the next one begins, or with vote='beam' as\n"
      "soon as its neighbours are there. The map may be read in between, also by other threads.",
      "BeamMapper");
  py::class_<Mapper>(module, "BeamMapper", doc.c_str())
      .def(py::init([](std::shared_ptr<SharedMap> map, const py::kwargs& keywords) {
             return std::make_unique<Mapper>(std::move(map), mapper_options(keywords));
           }),
           py::arg("map").none(false))
      .def("add_beams", &Mapper::add, py::arg("beams"), py::arg("trajectory") = py::none(),
           "Maps beams along a trajectory (map_from_body); None: the vehicle stands at the origin. Beams outside of\n"
           "its time are left out and counted.")
      .def("add", &Mapper::add_one, py::arg("time"), py::arg("bearing"), py::arg("bin_length"), py::arg("intensities"),
           py::arg("pose"),
           "Takes one beam. time: seconds; bearing: radians, counter-clockwise from ahead; bin_length: metres;\n"
           "intensities: (bins,) whole numbers in 0..255; pose: map_from_body, (4, 4), None: not known, the beam is "
           "left out.")
      .def("finish", &Mapper::finish, "Maps the beams that still wait. The next one begins a new sweep.")
      .def_property_readonly("map", &Mapper::map, "The map that it fills.")
      .def_property_readonly("report", &Mapper::report, "Counts so far, named as in the program's JSON.");
}

}  // namespace pingvox::python
