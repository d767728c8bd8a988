#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "errors.hpp"
#include "module.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/tum.hpp"
#include "pingvox/recording/vehicle_path.hpp"

namespace pingvox::python {
namespace {

constexpr std::size_t kMatrixSize = 16;

Trajectory trajectory_of(const py::object& time_values, const py::object& pose_values, double longest_step,
                         std::vector<std::size_t> cuts = {}) {
  if (!(longest_step >= 0.0)) raise_usage("longest_step: must be 0 or more");
  const DoubleArray times = double_array(time_values, "times", "(N,)");
  const DoubleArray poses = double_array(pose_values, "poses", "(N, 4, 4)");
  if (times.ndim() != 1 || poses.ndim() != 3 || poses.shape(0) != times.shape(0) || poses.shape(1) != 4 ||
      poses.shape(2) != 4) {
    raise_usage("Trajectory: times must have the shape (N,), poses (N, 4, 4)");
  }
  std::vector<StampedPose> stamped;
  for (std::size_t i = 0; i < size_of(times, 0); ++i) {
    const std::span matrix(poses.data() + kMatrixSize * i, kMatrixSize);
    stamped.push_back({times.data()[i], pose_from(matrix, fmt::format("poses[{}]", i))});
  }
  return value_of(Trajectory::make(std::move(stamped), longest_step, std::move(cuts)));
}

py::array times_of(const Trajectory& trajectory) {
  std::vector<double> times;
  for (const StampedPose& pose : trajectory.poses()) times.push_back(pose.time_s);
  return array_of(std::move(times));
}

py::array positions_of(const Trajectory& trajectory) {
  std::vector<double> positions;
  for (const StampedPose& pose : trajectory.poses()) append(pose.map_from_body.translation(), positions);
  return rows_of(std::move(positions));
}

py::array matrices_of(const Trajectory& trajectory) {
  std::vector<double> matrices;
  for (const StampedPose& pose : trajectory.poses()) append(pose.map_from_body, matrices);
  return array_of(std::move(matrices), {static_cast<py::ssize_t>(trajectory.poses().size()), 4, 4});
}

/// For pickle.
py::tuple state_of(const Trajectory& trajectory) {
  const StampedPose& first = trajectory.poses().front();
  const bool stands_still = trajectory.poses().size() == 1 && trajectory.at(first.time_s + 1.0).has_value();
  return py::make_tuple(times_of(trajectory), matrices_of(trajectory), trajectory.longest_step_s(), trajectory.cuts(),
                        stands_still);
}

Trajectory trajectory_of_state(const py::tuple& state) {
  constexpr std::size_t kParts = 5;
  if (state.size() != kParts) raise_usage("the state of a trajectory: has too many parts, or too few");
  Trajectory trajectory =
      trajectory_of(state[0], state[1], state[2].cast<double>(), state[3].cast<std::vector<std::size_t>>());
  if (!state[4].cast<bool>()) return trajectory;
  const StampedPose& only = trajectory.poses().front();
  return Trajectory::still(only.map_from_body, only.time_s);
}

py::array poses_at(const Trajectory& trajectory, const py::object& time_values) {
  const DoubleArray times = double_array(time_values, "times", "(N,)");
  if (times.ndim() != 1) raise_usage("times: must be an array of shape (N,)");
  std::vector<double> matrices;
  for (std::size_t i = 0; i < size_of(times, 0); ++i) {
    if (const auto pose = trajectory.at(times.data()[i])) {
      append(*pose, matrices);
    } else {
      matrices.insert(matrices.end(), kMatrixSize, std::numeric_limits<double>::quiet_NaN());
    }
  }
  return array_of(std::move(matrices), {times.shape(0), 4, 4});
}

}  // namespace

void bind_trajectory(py::module_& module) {
  py::class_<Trajectory>(module, "Trajectory",
                         "Where the vehicle was: poses in order of time, read between them by interpolation.\n\n"
                         "Poses are map_from_body, in metres, x ahead, y to port, z up.")
      .def(py::init([](const py::object& times, const py::object& poses, double longest_step) {
             return trajectory_of(times, poses, longest_step);
           }),
           py::arg("times"), py::arg("poses"), py::arg("longest_step") = std::numeric_limits<double>::infinity(),
           "times: (N,) seconds, rising; poses: (N, 4, 4) rigid transforms; longest_step: poses farther apart in\n"
           "time [s] have a gap between them.")
      .def(py::pickle(&state_of, &trajectory_of_state))
      .def("__copy__", [](const Trajectory& trajectory) { return trajectory; })
      .def(
          "__deepcopy__", [](const Trajectory& trajectory, const py::dict&) { return trajectory; }, py::arg("memo"))
      .def_static(
          "open",
          [](const std::filesystem::path& path) {
            return without_lock([&] { return value_of(read_trajectory(path)); });
          },
          py::arg("path"), "Reads TUM lines: 't x y z qx qy qz qw'.")
      .def(
          "save",
          [](const Trajectory& trajectory, const std::filesystem::path& path) {
            without_lock([&] {
              value_of(write_file(path.string(), [&](std::ostream& out) { return write_tum(trajectory, out); }));
            });
          },
          py::arg("path"), "Writes TUM lines, the same bytes as the program.")
      .def_property_readonly("times", &times_of, "(N,) float64, seconds.")
      .def_property_readonly("positions", &positions_of, "(N, 3) float64, metres in the map frame.")
      .def_property_readonly("matrices", &matrices_of, "(N, 4, 4) float64: map_from_body of each pose.")
      .def("at", &poses_at, py::arg("times"),
           "Poses at these times, (N,) seconds, as (N, 4, 4); NaN before the first pose, after the last and in gaps.")
      .def_property_readonly("gaps", &Trajectory::gaps, "How many gaps it has.")
      .def("__len__", [](const Trajectory& trajectory) { return trajectory.poses().size(); })
      .def("__repr__", [](const Trajectory& trajectory) {
        const auto& poses = trajectory.poses();
        return fmt::format("<pingvox.Trajectory of {} poses, {:.3f} s to {:.3f} s>", poses.size(), poses.front().time_s,
                           poses.back().time_s);
      });
}

}  // namespace pingvox::python
