#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <future>
#include <iterator>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "arrays.hpp"
#include "errors.hpp"
#include "evaluation_text.hpp"
#include "input_kinds.hpp"
#include "keywords.hpp"
#include "live_event.hpp"
#include "module.hpp"
#include "open_log.hpp"
#include "open_recording.hpp"
#include "pingvox/analysis/cut_tree.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/recording/evaluate.hpp"
#include "pingvox/recording/recording.hpp"
#include "recorded_beams.hpp"
#include "recording_map.hpp"
#include "recording_report.hpp"
#include "recording_warnings.hpp"
#include "report.hpp"
#include "shared_map.hpp"

namespace pingvox::python {
namespace {

/// A recording, and the speed of sound that was given for it.
struct Dive {
  Recording recording;
  double sound_speed_ratio = 1.0;
};
using SharedDive = std::shared_ptr<const Dive>;

struct SlamResult {
  SharedDive dive;
  RecordingSlam slam;
};

using Path = std::variant<std::filesystem::path, std::vector<std::filesystem::path>>;

/// Calls f() in a thread of its own, as it takes no progress callback that could end it: where a signal does, as by
/// Ctrl-C, the thread goes on with what it has, and its result is dropped.
template <class F>
auto in_thread(F f) {
  std::packaged_task<decltype(f())()> task(std::move(f));
  auto result = task.get_future();
  std::thread(std::move(task)).detach();
  without_lock([&] {
    constexpr auto kPause = std::chrono::milliseconds(50);
    Interpreter interpreter;
    while (result.wait_for(kPause) != std::future_status::ready) interpreter.tell(0);
  });
  return result.get();
}

/// Refuses options that have no effect on any log of the recording, as the program does.
/// @param shape  of beams that are mapped; nullopt: they are not
void check_used(const Recording& recording, const std::vector<app::LimitedOption>& options,
                std::optional<BeamShape> shape, std::string_view function) {
  if (options.empty()) return;
  std::vector<std::string> kinds;
  for (std::size_t i = 0; i < recording.logs().size(); ++i) {
    if (recording.logs()[i].is_read_once()) return;
    const Result<OpenedLog> log = app::open_log_of(recording, i);
    if (!log) {
      const bool has_topic = std::ranges::find(options, "--topic", &app::LimitedOption::name) != options.end();
      if (has_topic && log.error().code == Error::Code::kBadOption) throw RaisedError(log.error());
      return;  // the error is that of what reads the log
    }
    const bool is_beams = log->beams() != nullptr;
    const bool is_bag_of_scans = is_bag(log->format) && !is_beams;
    kinds.push_back(app::kind_text(is_bag_of_scans ? FormatKind::kScans : kind_of(log->format)));
    if (is_bag_of_scans) kinds.emplace_back(app::kBagScans);
    if (is_beams && shape == BeamShape::kRay) kinds.emplace_back(app::kRayBeams);
  }
  if (const auto used = app::check_limited(options, kinds); !used) {
    raise_usage(fmt::format("{}: {}", function, used.error().message));
  }
}

std::shared_ptr<Dive> open_dive(const Path& logs, const py::kwargs& keywords) {
  std::vector<std::string> names;
  if (const auto* const one = std::get_if<std::filesystem::path>(&logs)) {
    names.push_back(one->string());
  } else {
    for (const auto& path : std::get<std::vector<std::filesystem::path>>(logs)) names.push_back(path.string());
  }
  if (names.empty()) raise_usage("open: needs a log");
  const OpenOptions options = open_options(names, keywords);
  return without_lock([&] {
    auto dive =
        std::make_shared<Dive>(Dive{value_of(app::open_recording(options.recording)), options.sound_speed_ratio});
    check_used(dive->recording, options.limited, std::nullopt, "open");
    return dive;
  });
}

/// With options named as keywords.
py::list texts_of(const std::vector<std::string>& warnings) {
  py::list texts;
  for (const std::string& warning : warnings) texts.append(with_keyword_names(warning));
  return texts;
}

/// What the program says of a map on standard error.
std::vector<std::string> warnings_of(const Recording& recording, const RecordingMap& made) {
  std::vector<std::string> warnings = app::warnings_of(recording, made.path);
  for (std::size_t i = 0; i < made.logs.size(); ++i) {
    std::ranges::move(app::warnings_of(recording, made.path, made.logs[i], made.map.lattice()),
                      std::back_inserter(warnings));
    // A path that was given though the recording has none: the vehicle did not stand still.
    if (made.path.trajectory.poses().size() > 1) continue;
    if (std::string still = app::still_vehicle_text(recording.logs()[i], recording.options()); !still.empty()) {
      warnings.push_back(std::move(still));
    }
  }
  return warnings;
}

py::dict report_of_map(const Recording& recording, const RecordingMap& made) {
  std::size_t damaged = 0;
  for (const MappedLog& log : made.logs) damaged += log.damaged;
  py::dict report = report_of(made.report, damaged);
  report["warnings"] = texts_of(warnings_of(recording, made));
  return report;
}

std::shared_ptr<RecordingMapView> map_along(const Dive& dive, VehiclePath path, const MapKeywords& options,
                                            const py::object& progress) {
  Interpreter interpreter(progress);
  RecordingMap made = without_lock([&] {
    check_used(dive.recording, options.limited, options.build.model.shape, "map");
    RecordingMap built =
        value_of(build_map(dive.recording, std::move(path), options.map, options.build, [&](const BuildReport& done) {
          if (interpreter.is_due()) interpreter.tell(done.beams);
        }));
    if (options.cut_depth) built.map = cut_tree(built.map, *options.cut_depth);
    return built;
  });
  return std::make_shared<RecordingMapView>(std::move(made.map), made.path.axes, report_of_map(dive.recording, made),
                                            std::move(made.path.trajectory));
}

std::shared_ptr<RecordingMapView> map(const SharedDive& dive, const std::optional<Trajectory>& trajectory,
                                      const py::object& progress, const py::kwargs& keywords) {
  MapKeywords options = map_options(keywords);
  options.build.sound_speed_ratio = dive->sound_speed_ratio;
  VehiclePath path = trajectory ? VehiclePath{.trajectory = *trajectory}
                                : without_lock([&] { return value_of(app::path_of(dive->recording)); });
  return map_along(*dive, std::move(path), options, progress);
}

SlamResult run_slam(const SharedDive& dive, const py::kwargs& keywords) {
  if (!dive) throw py::type_error("slam: needs a recording");
  SlamKeywords options = slam_options(keywords);
  options.slam.sound_speed_ratio = dive->sound_speed_ratio;
  return {dive,
          value_of(in_thread([dive, options] { return slam(dive->recording, options.slam, options.estimation); }))};
}

/// As the program's `slam --map`.
std::shared_ptr<RecordingMapView> map_of_slam(const SlamResult& result, const py::object& progress,
                                              const py::kwargs& keywords) {
  MapKeywords options = slam_map_options(keywords);
  options.build.filter = result.slam.options.filter;
  options.build.echo = result.slam.options.echo;
  options.build.sound_speed_ratio = result.slam.options.sound_speed_ratio;
  return map_along(*result.dive, result.slam.path(), options, progress);
}

RecordingLocation run_locate(const SharedDive& dive, const SharedMap& shared, const py::object& progress,
                             const py::kwargs& keywords) {
  RecordingLocateOptions options = locate_options(keywords);
  options.locate.localizer.sound_speed_ratio = dive->sound_speed_ratio;
  Interpreter interpreter(progress);
  return value_of(shared.read([&](const OccupancyMap& map) {
    return locate(dive->recording, map, options, [&](double share) {
      if (interpreter.is_due()) interpreter.tell(share);
    });
  }));
}

py::dict run_evaluate(const SharedDive& dive, const py::object& progress, const py::kwargs& keywords) {
  EvaluateOptions options = evaluate_options(keywords);
  options.build.sound_speed_ratio = dive->sound_speed_ratio;
  Interpreter interpreter(progress);
  const Evaluation found = value_of(without_lock([&] {
    return evaluate(dive->recording, options, [&](double share) {
      if (interpreter.is_due()) interpreter.tell(share);
    });
  }));
  py::dict all;
  all["beams"] = found.beams;
  all["folds"] = found.folds;
  all["resolution"] = found.resolution_m;
  all["tolerance"] = found.tolerance_m;
  all["echoes"] = found.all.echoes;
  all["judged"] = found.all.judged;
  all["predicted"] = found.all.predicted;
  all["within_cell"] = found.all.within_cell;
  all["within_10cm"] = found.all.within_10cm;
  all["too_early"] = found.all.too_early;
  all["from_free"] = found.all.from_free;
  all["coverage"] = found.all.coverage();
  all["is_judged"] = found.is_judged();
  all["verdict"] = app::verdict_text(found);
  return all;
}

RecordedBeams beams_of(const SharedDive& dive, std::size_t log) {
  if (log >= dive->recording.logs().size()) {
    throw py::index_error(fmt::format("there are {} logs", dive->recording.logs().size()));
  }
  return without_lock([&] {
    Interpreter interpreter;
    OpenedLog opened = value_of(app::open_log_of(dive->recording, log));
    std::optional<Background> background;
    value_of(subtract_background(dive->recording, opened, background));
    const std::string name = opened.name;
    const std::unique_ptr<BeamSource> source = value_of(only_beams(std::move(opened.log), name));
    std::vector<Beam> beams;
    while (std::optional<Beam> beam = value_of(source->next())) {
      beams.push_back(*std::move(beam));
      if (interpreter.is_due()) interpreter.tell(0);
    }
    RecordedBeams recorded(std::move(beams));
    recorded.note = source->note();
    recorded.skipped = source->skipped();
    return recorded;
  });
}

py::dict report_of_slam(const SlamResult& result) {
  const SlamReport& report = result.slam.solution.report;
  py::dict all, loops;
  loops["found"] = report.pairs.loops.found;
  loops["kept"] = report.pairs.loops.kept;
  all["poses"] = result.slam.solution.trajectory.poses().size();
  all["beams"] = report.beams;
  all["sweeps"] = report.sweeps;
  all["echoes"] = report.echoes;
  all["skipped"] = result.slam.skipped;
  all["pairs"] = report.pairs.count;
  all["loops"] = loops;
  all["velocity"] = report.velocity.source;
  all["heading"] = report.heading;
  all["not_observable"] = report.not_observable;
  all["implausible"] = report.implausible;
  std::vector<std::string> warnings = app::nav_warnings(result.dive->recording);
  if (std::string hint = app::mount_hint(result.dive->recording); !hint.empty()) warnings.push_back(std::move(hint));
  for (const auto& [file, note] : result.slam.notes) warnings.push_back(fmt::format("{}: {}", file, note));
  all["warnings"] = texts_of(warnings);
  return all;
}

py::tuple covariances_of(const SlamResult& result) {
  std::vector<double> times, matrices;
  for (const PoseCovariance& knot : result.slam.solution.covariances) {
    times.push_back(knot.time_s);
    // It is symmetric: columns and rows are the same.
    matrices.insert(matrices.end(), knot.covariance.data(), knot.covariance.data() + knot.covariance.size());
  }
  const auto knots = static_cast<py::ssize_t>(times.size());
  return py::make_tuple(array_of(std::move(times)), array_of(std::move(matrices), {knots, 3, 3}));
}

std::string calibration_text(const SlamResult& result) {
  return std::string(app::kCalibrationComment) +
         calibration_toml({result.slam.solution.calibration, result.slam.options.body_from_source});
}

void save_calibration(const SlamResult& result, const std::filesystem::path& path) {
  without_lock([&] {
    value_of(write_file(path.string(), [&](std::ostream& out) -> Result<void> {
      out << calibration_text(result);
      return {};
    }));
  });
}

py::array known_of(const RecordingLocation& location) {
  std::vector<std::uint8_t> known;
  for (const LocatedPose& pose : location.found.poses) known.push_back(pose.is_known ? 1 : 0);
  return array_of(std::move(known)).attr("astype")("bool");
}

py::list hypotheses_of(const RecordingLocation& location) {
  py::list all;
  for (const PoseHypothesis& one : location.found.hypotheses) all.append(hypothesis_of(one));
  return all;
}

std::vector<std::string> names_of(const Dive& dive) {
  std::vector<std::string> names;
  for (const InputFile& log : dive.recording.logs()) names.push_back(log.name());
  return names;
}

void bind_results(py::module_& module) {
  const std::string map_doc = docstring(
      "Maps the recording along the estimated trajectory, with its echoes and the estimated place of the sonar.\n\n"
      "progress: called with the number of beams so far.",
      "SlamResult.map");
  py::class_<SlamResult>(module, "SlamResult", "What SLAM found in a recording.")
      .def_property_readonly(
          "trajectory", [](const SlamResult& result) { return result.slam.solution.trajectory; },
          "Where the vehicle was, in a frame with x east and y north.")
      .def_property_readonly("covariances", &covariances_of,
                             "(N,) seconds and (N, 3, 3): covariances of x, y [m] and yaw [rad], some four a sweep;\n"
                             "none with causal.")
      .def_property_readonly("report", &report_of_slam, "Counts, sources, what is not observable, and warnings.")
      .def_property_readonly("calibration", &calibration_text,
                             "Of the sensors, as TOML: what open(use_calibration=FILE) takes.")
      .def("save_calibration", &save_calibration, py::arg("path"), "Writes it, the same bytes as the program.")
      .def("map", &map_of_slam, py::kw_only(), py::arg("progress") = py::none(), map_doc.c_str());
  py::class_<RecordingLocation>(module, "LocateResult", "Where the vehicle was in a known map.")
      .def_property_readonly(
          "trajectory", [](const RecordingLocation& location) { return value_of(location.found.trajectory()); },
          "All poses, since the vehicle was found first.")
      .def_property_readonly(
          "known_trajectory", [](const RecordingLocation& location) { return location.found.known_trajectory(); },
          "Those that are known to be right; None: none is.")
      .def_property_readonly("known", &known_of, "(N,) bool, for each pose: whether it is known to be right.")
      .def_property_readonly(
          "is_sure", [](const RecordingLocation& location) { return location.found.is_sure(); },
          "Whether one place alone fits at the end.")
      .def_property_readonly("hypotheses", &hypotheses_of,
                             "Where the vehicle may be at the end, the most likely first: metres and radians.");
}

}  // namespace

void bind_recording(py::module_& module) {
  bind_recording_map(module);
  bind_results(module);
  const std::string open_doc = docstring(
      "Opens what was recorded on one dive: a log of a sonar or several, and the navigation.\n\n"
      "logs: a path or several; formats are recognised by content. Angles of options are degrees, as in the program.",
      "open");
  module.def("open", &open_dive, py::arg("logs"), open_doc.c_str());
  const std::string map_text = docstring(
      "Maps all logs along the path of the vehicle, or along another trajectory.\n\n"
      "progress: called with the number of beams so far.",
      "Recording.map");
  const std::string slam_text =
      docstring("Estimates where the vehicle was, from the beams and the navigation, and how the sensors are mounted.",
                "Recording.slam");
  const std::string locate_text = docstring(
      "Finds the vehicle in a known map. open(poses=...) is taken as odometry in a frame that may drift.\n\n"
      "progress: called with the share that is done, in 0..1.",
      "Recording.locate");
  const std::string evaluate_text = docstring(
      "Says how well maps of this recording predict echoes that are kept out of them. Returns counts of echoes.\n\n"
      "progress: called with the share that is done, in 0..1.",
      "Recording.evaluate");
  py::class_<Dive, std::shared_ptr<Dive>>(module, "Recording", "What was recorded on one dive; see open().")
      .def_property_readonly("logs", &names_of, "Names of the logs.")
      .def_property_readonly(
          "nav_offset", [](const Dive& dive) { return value_of(dive.recording.nav_offset()).offset_s; },
          "Seconds that are added to the times of the navigation to get those of the first log.")
      .def(
          "path",
          [](const Dive& dive) {
            return without_lock([&] { return value_of(app::path_of(dive.recording)).trajectory; });
          },
          "Where the vehicle was by poses or navigation, else at the origin: a Trajectory.")
      .def(
          "beams", [](const std::shared_ptr<Dive>& dive, std::size_t log) { return beams_of(dive, log); },
          py::arg("log") = 0, "The beams of a log: Beams.")
      .def(
          "map",
          [](const std::shared_ptr<Dive>& dive, const std::optional<Trajectory>& trajectory, const py::object& progress,
             const py::kwargs& keywords) { return map(dive, trajectory, progress, keywords); },
          py::arg("trajectory") = py::none(), py::kw_only(), py::arg("progress") = py::none(), map_text.c_str())
      .def(
          "slam",
          [](const std::shared_ptr<Dive>& dive, const py::kwargs& keywords) { return run_slam(dive, keywords); },
          slam_text.c_str())
      .def(
          "locate",
          [](const std::shared_ptr<Dive>& dive, const SharedMap& shared, const py::object& progress,
             const py::kwargs& keywords) { return run_locate(dive, shared, progress, keywords); },
          py::arg("map"), py::kw_only(), py::arg("progress") = py::none(), locate_text.c_str())
      .def(
          "evaluate",
          [](const std::shared_ptr<Dive>& dive, const py::object& progress, const py::kwargs& keywords) {
            return run_evaluate(dive, progress, keywords);
          },
          py::kw_only(), py::arg("progress") = py::none(), evaluate_text.c_str())
      .def("__repr__",
           [](const Dive& dive) { return fmt::format("<pingvox.Recording of {}>", fmt::join(names_of(dive), ", ")); });
}

}  // namespace pingvox::python
