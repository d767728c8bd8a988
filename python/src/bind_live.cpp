#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "errors.hpp"
#include "keywords.hpp"
#include "live_event.hpp"
#include "live_thread.hpp"
#include "module.hpp"
#include "pingvox/live/live_mapping.hpp"
#include "recorded_beams.hpp"
#include "report.hpp"
#include "shared_map.hpp"

namespace pingvox::python {
namespace {

constexpr std::chrono::milliseconds kNone(0), kPause(50);  ///< kPause: from one look for signals to the next

/// pingvox.LiveMapping.
class Live {
 public:
  Live(const std::string& head, const py::kwargs& keywords) {
    LiveOptions options = live_options(head, keywords);
    options.changes = KeepChanges::kYes;  // for take_beams
    name_ = options.head.name();
    for (const Keyword& one : keywords_of("LiveMapping.drive")) {
      if (keywords.contains(one.name)) driven_by_[one.name.c_str()] = keywords[one.name.c_str()];
    }
    thread_ = without_lock([&] { return value_of(LiveThread::open(options)); });
  }
  ~Live() {
    const py::gil_scoped_release release;
    thread_.reset();
  }
  Live(const Live&) = delete;
  Live& operator=(const Live&) = delete;

  const std::string& name() const { return name_; }

  /// The result of f(live), which is called in the thread of the run and must own what it uses. A signal ends the wait.
  template <class F>
  auto ask(F f) const {
    auto result = without_lock([&] {
      auto asked = thread_->call(std::move(f));
      Interpreter interpreter;
      while (asked.wait_for(kPause) != std::future_status::ready) interpreter.tell(0);
      return asked;
    });
    return result.get();
  }

  /// Waits for the end of the run.
  /// @param seconds  at most
  /// @return nullopt: the run goes on. Else what it ended by
  std::optional<Result<void>> wait(double seconds) const {
    return without_lock([&] {
      const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(std::max(0.0, seconds));
      Interpreter interpreter;
      for (;;) {
        const std::chrono::duration<double> left = until - std::chrono::steady_clock::now();
        const std::chrono::duration<double> longest = std::clamp<std::chrono::duration<double>>(left, kNone, kPause);
        std::optional<Result<void>> ended = thread_->ended(std::chrono::ceil<std::chrono::milliseconds>(longest));
        if (ended || left <= kNone) return ended;
        interpreter.tell(0);
      }
    });
  }
  /// Ends the run, and waits for its end.
  Result<void> end() const {
    thread_->end();
    for (;;) {
      if (std::optional<Result<void>> ended = wait(1.0)) return *std::move(ended);
    }
  }

  /// Waits for the next event. nullopt: the run has ended.
  std::optional<ReportedEvent> next_event() const {
    return without_lock([&] {
      Interpreter interpreter;
      for (;;) {
        const bool has_ended = thread_->ended().has_value();
        std::optional<ReportedEvent> event = thread_->take_event(kPause);
        if (event || has_ended) return event;
        interpreter.tell(0);
      }
    });
  }
  py::list take_events() const {
    py::list all;
    for (const ReportedEvent& event : thread_->take_events()) all.append(event_object(event));
    return all;
  }

  void drive(const py::kwargs& keywords) {
    py::dict all;
    for (const auto& [name, value] : driven_by_) all[name] = value;
    for (const auto& [name, value] : keywords) all[name] = value;
    const LiveHead driven = head_options(ask([](LiveMapping& live) { return live.head(); }), py::kwargs(all));
    value_of(ask([driven](LiveMapping& live) { return live.drive(driven); }));
    driven_by_ = std::move(all);
  }

 private:
  std::unique_ptr<LiveThread> thread_;
  std::string name_;
  py::dict driven_by_;  ///< keywords of the head that were given last
};

/// Iterates over the events of a run until it ends.
struct LiveEvents {
  std::shared_ptr<const Live> live;

  py::object next() const {
    const std::optional<ReportedEvent> event = live->next_event();
    if (!event) throw py::stop_iteration();
    return event_object(*event);
  }
};

std::shared_ptr<SharedMap> map_of(const Live& live) {
  return std::make_shared<SharedMap>(live.ask([](LiveMapping& run) { return OccupancyMap(run.map()); }));
}

py::dict coverage_of(const Live& live) {
  const SweepCoverage found = live.ask([](LiveMapping& run) { return run.coverage(); });
  py::dict all;
  all["beams"] = found.beams;
  all["echoes"] = found.echoes;
  all["sweeps"] = found.sweeps;
  all["places"] = found.places;
  all["places_heard_once"] = found.places_heard_once;
  all["sweeps_per_place"] = found.sweeps_per_place;
  all["sweep_time"] = found.sweep_s;
  all["moved"] = found.moved_m;
  all["turned"] = found.turned_rad;
  all["beam_width"] = found.beam_width_m;
  return all;
}

py::object pose_or_none(const Live& live) {
  const std::optional<StampedPose> pose = live.ask([](LiveMapping& run) { return run.pose(); });
  return pose ? py::object(pose_of(*pose)) : py::object(py::none());
}

}  // namespace

void bind_live(py::module_& module) {
  py::class_<LiveEvents>(module, "LiveEvents", "Iterates over the events of a run until it ends.")
      .def("__iter__", [](const LiveEvents& events) { return events; })
      .def("__next__", &LiveEvents::next);
  const std::string make_doc = docstring(
      "Maps with a sonar while it runs: drives the head, records its bytes, and maps each beam where the vehicle "
      "was.\n\n"
      "head: 'ping360:udp://HOST:PORT', 'replay:FILE@max' or another device of 'pingvox live'. It runs in a thread of\n"
      "its own until finish() or the end of `with`, whatever Python does meanwhile. A device that is missing or "
      "falls\n"
      "silent is retried as long as it runs; events report it.",
      "LiveMapping");
  const std::string drive_doc = docstring(
      "Changes the settings of the head from its next request on: what is not given stays, None is the default. The\n"
      "resolution of the map stays.",
      "LiveMapping.drive");
  py::class_<Live, std::shared_ptr<Live>>(module, "LiveMapping", make_doc.c_str())
      .def(py::init<const std::string&, const py::kwargs&>(), py::arg("head"))
      .def("__enter__", [](const std::shared_ptr<Live>& live) { return live; })
      .def(
          "__exit__",
          [](const Live& live, const py::object& kind, const py::object&, const py::object&) {
            // What was raised before says more.
            if (const Result<void> ended = live.end(); kind.is_none()) value_of(ended);
          },
          py::arg("kind"), py::arg("error"), py::arg("trace"))
      .def(
          "events", [](const std::shared_ptr<const Live>& live) { return LiveEvents{live}; },
          "Iterates over events as they come, until the run ends.")
      .def("take_events", &Live::take_events,
           "The events since the last call, in order; beyond the first thousand they are lost.")
      .def(
          "wait", [](const Live& live, double seconds) { return !live.wait(seconds); }, py::arg("seconds"),
          "Waits some seconds, less where the run ends. Returns whether the run goes on.")
      .def(
          "finish", [](const Live& live) { value_of(live.end()); },
          "Stops the head, ends the recordings and maps all beams that wait. Map, path and status stay. Raises what\n"
          "ended a replay early, or the limit of the map, which keeps the beams before.")
      .def_property_readonly("map", &map_of,
                             "The map as it is now, without the beams that wait: a copy, which stays as it is.")
      .def_property_readonly(
          "report", [](const Live& live) { return report_of(live.ask([](LiveMapping& run) { return run.report(); })); },
          "Of the map: counts, named as in the program's JSON.")
      .def_property_readonly("coverage", &coverage_of,
                             "What the sweeps that have ended heard, and how far the head moved meanwhile: metres,\n"
                             "radians and seconds. Zeros with slam, which moves them later.")
      .def_property_readonly(
          "status", [](const Live& live) { return live.ask([](LiveMapping& run) { return run.status(); }); },
          "Devices and counts: LiveStatus.")
      .def_property_readonly(
          "time", [](const Live& live) { return live.ask([](LiveMapping& run) { return run.time_s(); }); },
          "Seconds since the start; beams and poses count from there.")
      .def_property_readonly(
          "since_1970", [](const Live& live) { return live.ask([](LiveMapping& run) { return run.since_1970_s(); }); },
          "When it started, as recordings have it: seconds since 1970; 0 of a replay, which has its own times.")
      .def_property_readonly(
          "path", [](const Live& live) { return live.ask([](LiveMapping& run) { return run.path(); }); },
          "With slam the path of the vehicle as it is known now, a Trajectory; None: without slam, or not known yet.")
      .def_property_readonly(
          "pose", &pose_or_none,
          "Where the vehicle is, as far as it is known: the time and map_from_body, (4, 4); None: not\n"
          "known yet.")
      .def_property_readonly(
          "recordings", [](const Live& live) { return live.ask([](LiveMapping& run) { return run.recordings(); }); },
          "Files of the recordings.")
      .def_property_readonly(
          "is_recording",
          [](const Live& live) { return live.ask([](LiveMapping& run) { return run.is_recording(); }); },
          "Whether the head is being recorded.")
      .def(
          "begin_recording",
          [](const Live& live) { value_of(live.ask([](LiveMapping& run) { return run.begin_recording(); })); },
          "Ends the recording of all devices, if there is one, and begins another one: record has to be a folder.")
      .def(
          "end_recording", [](const Live& live) { live.ask([](LiveMapping& run) { run.end_recording(); }); },
          "Ends the recording of all devices; mapping goes on.")
      .def(
          "begin_new_map",
          [](const Live& live) {
            return std::make_shared<SharedMap>(
                value_of(live.ask([](LiveMapping& run) { return run.begin_new_map(); })));
          },
          "Begins a new map, with slam also a new path. Returns the map so far.")
      .def("drive", &Live::drive, drive_doc.c_str())
      .def(
          "take_beams",
          [](const Live& live) {
            return RecordedBeams(live.ask([](LiveMapping& run) { return run.take_changes(); }).beams);
          },
          "The beams that arrived since the last call, as Beams; of many the last 2000 at least.")
      .def(
          "take_latency",
          [](const Live& live) { return live.ask([](LiveMapping& run) { return run.take_latency_s(); }); },
          "Longest time from the arrival of a beam until the mapper was done with it, since the last call, "
          "seconds.")
      .def("__repr__", [](const Live& live) { return fmt::format("<pingvox.LiveMapping of {}>", live.name()); });
}

}  // namespace pingvox::python
