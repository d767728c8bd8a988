#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "arrays.hpp"
#include "errors.hpp"
#include "fields.hpp"
#include "live/internal/motion_name.hpp"
#include "live_event.hpp"
#include "module.hpp"

namespace pingvox::python {
namespace {

/// What all events have.
struct EventText {
  std::string text;
};

/// An event as an object of Python.
template <class Event>
struct TextOf final : EventText {
  Event event;

  TextOf(std::string said, Event one) : EventText{std::move(said)}, event(std::move(one)) {}
};

std::string_view word_of(LiveNav::Kind kind) {
  switch (kind) {
    case LiveNav::Kind::kMavlink:
      return "mavlink";
    case LiveNav::Kind::kA50:
      return "a50";
    case LiveNav::Kind::kRos2:
      return "ros2";
  }
  return "";
}

py::dict step_of(const SourceStep& step) {
  py::dict all;
  all["from_time"] = step.from_s;
  all["to_time"] = step.to_s;
  all["moved"] = step.moved_m;
  all["turned"] = step.turned_rad;
  all["is_new_start"] = step.is_new_start;
  return all;
}

// The value of a field in Python.
template <class T>
T python_value(const T& value) {
  return value;
}
py::object python_value(const Error& error) {
  return error_object(error);
}
std::string_view python_value(LiveMotion motion) {
  return name_of(motion);
}
std::string_view python_value(NavQuantity quantity) {
  return name_of(quantity);
}
std::string_view python_value(LiveNav::Kind kind) {
  return word_of(kind);
}
py::dict python_value(const SourceStep& step) {
  return step_of(step);
}
py::dict python_value(const PoseHypothesis& hypothesis) {
  return hypothesis_of(hypothesis);
}
py::tuple python_value(const StampedPose& pose) {
  return pose_of(pose);
}
py::list python_value(const std::vector<PoseHypothesis>& hypotheses) {
  py::list all;
  for (const PoseHypothesis& one : hypotheses) all.append(hypothesis_of(one));
  return all;
}
template <class T>
py::object python_value(const std::optional<T>& value) {
  if (!value) return py::none();
  if constexpr (std::is_base_of_v<py::handle, decltype(python_value(*value))>) {
    return python_value(*value);
  } else {
    return py::cast(python_value(*value));
  }
}

/// Reads a field of an event.
template <class Event, class T>
auto in_event(T Event::* field) {
  return [field](const TextOf<Event>& text) { return python_value(text.event.*field); };
}
/// Reads a field of a status.
template <class Status, class T>
auto in_status(T Status::* field) {
  return [field](const Status& status) { return python_value(status.*field); };
}

template <class Event>
using EventFields = Fields<TextOf<Event>, EventText>;

void bind_device_events(py::module_& module) {
  using namespace live_event;
  EventFields<Connected>(module, "Connected", "A device answers.")
      .add("device", in_event(&Connected::device), "Its name.")
      .show_fields();
  EventFields<NotConnected>(module, "NotConnected", "A device does not answer, or not any more; retried.")
      .add("device", in_event(&NotConnected::device), "Its name.")
      .add("reason", in_event(&NotConnected::reason), "Why.")
      .show_fields();
  EventFields<RecordingFailed>(module, "RecordingFailed",
                               "A recording has failed; mapping goes on. Reported once for each recording.")
      .add("error", in_event(&RecordingFailed::error), "Why, a pingvox.Error.")
      .show_fields();
  EventFields<MappingFailed>(
      module, "MappingFailed",
      "The map cannot grow any more: the recording goes on, and beams are counted as not mapped.")
      .add("error", in_event(&MappingFailed::error), "Why, a pingvox.Error: 'limit' or 'no_memory'.")
      .show_fields();
  EventFields<NavFailed>(
      module, "NavFailed",
      "A navigation device can no longer be read; the recording of the sonar goes on. Reported once.")
      .add("error", in_event(&NavFailed::error), "Why, a pingvox.Error.")
      .show_fields();
  EventFields<UnexpectedBeam>(
      module, "UnexpectedBeam",
      "A beam that does not fit its request: such beams are recorded and not mapped. Reported once.")
      .add("device", in_event(&UnexpectedBeam::device), "Its name.")
      .add("reason", in_event(&UnexpectedBeam::reason), "What does not fit.")
      .show_fields();
  EventFields<MessagesRefused>(module, "MessagesRefused",
                               "Messages arrive, and cannot be used: all of them, or their attitudes.")
      .add("device", in_event(&MessagesRefused::device), "Its name.")
      .add("reason", in_event(&MessagesRefused::reason), "Why.")
      .show_fields();
  EventFields<SeveralPublishers>(module, "SeveralPublishers",
                                 "Several nodes publish one topic at the same time, and all their messages are used. "
                                 "Reported once for each device.")
      .add("device", in_event(&SeveralPublishers::device), "Its name.")
      .add("publishers", in_event(&SeveralPublishers::publishers), "How many, at least.")
      .show_fields();
  EventFields<ObstaclesNotSent>(module, "ObstaclesNotSent", "Obstacles cannot be sent; retried.")
      .add("reason", in_event(&ObstaclesNotSent::reason), "Why.")
      .show_fields();
  EventFields<ObstaclesSent>(module, "ObstaclesSent", "Obstacles are sent again.").show_fields();
  EventFields<NotPublished>(module, "NotPublished", "A message of ROS 2 was not published; later ones are tried.")
      .add("reason", in_event(&NotPublished::reason), "Why.")
      .show_fields();
}

void bind_nav_events(py::module_& module) {
  using namespace live_event;
  EventFields<SourcesChosen>(module, "SourcesChosen", "The sources of the poses are known, and kept from now on.")
      .add("attitude", in_event(&SourcesChosen::attitude), "Name of the source.")
      .add("position", in_event(&SourcesChosen::position), "Name of the source.")
      .show_fields();
  EventFields<NoSourceYet>(
      module, "NoSourceYet",
      "Five seconds have passed, and no source of poses is known: beams are not mapped. Reported once.")
      .add("has_attitude", in_event(&NoSourceYet::has_attitude), "Whether any attitude came.")
      .add("has_position", in_event(&NoSourceYet::has_position), "Whether any position came.")
      .add("messages", in_event(&NoSourceYet::messages), "How many messages came.")
      .show_fields();
  EventFields<PosesEnded>(module, "PosesEnded", "No pose has come for five seconds: beams are not mapped.")
      .show_fields();
  EventFields<PosesResumed>(module, "PosesResumed", "Poses come again.").show_fields();
  EventFields<BeamsWithoutPose>(module, "BeamsWithoutPose",
                                "Poses arrive, but no beam got one for five seconds, or most did not for ten: they are "
                                "not mapped. Reported once,\n"
                                "until BeamsWithPose.")
      .add("beams", in_event(&BeamsWithoutPose::beams), "How many beams these seconds had.")
      .add("without_pose", in_event(&BeamsWithoutPose::without_pose), "How many of them have no pose.")
      .add("within", in_event(&BeamsWithoutPose::within_s), "How many seconds these are.")
      .add("behind", in_event(&BeamsWithoutPose::behind_s),
           "How many seconds the poses are behind the beams when they come; negative: ahead. None: this is not why.")
      .add("apart", in_event(&BeamsWithoutPose::apart_s),
           "Longest time from one pose that came to the next, seconds. None: this is not why.")
      .show_fields();
  EventFields<BeamsWithPose>(module, "BeamsWithPose", "Nearly all beams get poses again.").show_fields();
  EventFields<ClocksDiffer>(
      module, "ClocksDiffer",
      "By their arrival, the stamps of a navigation device differ steadily from those of the sonar: beams are\n"
      "mapped where the vehicle was at another time, unless messages of one of them are that late. Reported\n"
      "once, until they agree.")
      .add("device", in_event(&ClocksDiffer::device), "Name of the navigation device.")
      .add("head", in_event(&ClocksDiffer::head), "Name of the sonar.")
      .add("ahead", in_event(&ClocksDiffer::ahead_s),
           "How many seconds the stamps of the device are ahead; negative: behind.")
      .show_fields();
  EventFields<VehicleChanged>(module, "VehicleChanged",
                              "The vehicle that was followed fell silent, and another sender is followed in its place.")
      .add("device", in_event(&VehicleChanged::device), "Name of the navigation device.")
      .add("vehicle", in_event(&VehicleChanged::vehicle), "Who is followed now.")
      .show_fields();
  EventFields<SenderIgnored>(module, "SenderIgnored", "A sender is ignored, because another one is followed.")
      .add("device", in_event(&SenderIgnored::device), "Name of the navigation device.")
      .add("sender", in_event(&SenderIgnored::sender), "Who is ignored.")
      .add("vehicle", in_event(&SenderIgnored::vehicle), "Who is followed.")
      .show_fields();
  EventFields<SenderRestarted>(
      module, "SenderRestarted",
      "The sender of the positions has restarted: they are relative to another origin since then, and the map does not "
      "fit. Reported once for each device.")
      .add("device", in_event(&SenderRestarted::device), "Name of the navigation device.")
      .add("position", in_event(&SenderRestarted::position), "Name of the source.")
      .show_fields();
  EventFields<NewFrame>(
      module, "NewFrame",
      "A source is in another frame since a step that no vehicle makes: the map does not fit any more.")
      .add("source", in_event(&NewFrame::source), "Its name.")
      .add("quantity", in_event(&NewFrame::quantity), "'position', 'heading', ...")
      .add("step", in_event(&NewFrame::step),
           "from_time, to_time [s]: of the samples before and after it; moved [m], turned [rad], is_new_start: its\n"
           "device restarted.")
      .show_fields();
}

void bind_slam_events(py::module_& module) {
  using namespace live_event;
  EventFields<MotionChosen>(module, "MotionChosen", "What SLAM estimates the motion of the vehicle from, from now on.")
      .add("motion", in_event(&MotionChosen::motion), "'velocity', 'sonar and heading' or 'sonar'.")
      .add("velocity", in_event(&MotionChosen::velocity), "Name of the source; empty: none.")
      .add("heading", in_event(&MotionChosen::heading), "Name of the source; empty: none.")
      .add(
          "deviation", in_event(&MotionChosen::deviation_m_sqrt_s),
          "Standard deviation of the displacement after one second, m / sqrt(s); None: estimated later from the sonar.")
      .show_fields();
  EventFields<Located>(module, "Located",
                       "The vehicle is located in the known map: poses are in its frame from now on, and earlier beams "
                       "are mapped as well.")
      .add("map", in_event(&Located::map), "File of the map.")
      .add("where", in_event(&Located::where), "x, y [m], yaw [rad], deviations and weight, as of LocateResult.")
      .show_fields();
  EventFields<NotLocated>(
      module, "NotLocated",
      "The vehicle is not located in the known map yet: beams are not mapped, and the search goes on. Reported once.")
      .add("map", in_event(&NotLocated::map), "File of the map.")
      .add("sweeps", in_event(&NotLocated::sweeps), "How many were tried.")
      .add("hypotheses", in_event(&NotLocated::hypotheses),
           "The most likely first, as of LocateResult; empty: echoes match nowhere.")
      .show_fields();
  EventFields<VelocityEnded>(module, "VelocityEnded",
                             "The velocity in use was not measured for a second. Poses are predicted from the last "
                             "one and the heading for\n"
                             "some ten seconds, then from matches of sweeps, where there are any.")
      .add("velocity", in_event(&VelocityEnded::velocity), "Name of the source.")
      .show_fields();
  EventFields<VelocityResumed>(module, "VelocityResumed", "A velocity is measured again.")
      .add("velocity", in_event(&VelocityResumed::velocity), "Name of the source.")
      .add("missing", in_event(&VelocityResumed::missing_s), "How many seconds it was not, at least.")
      .show_fields();
  EventFields<PositionUncertain>(
      module, "PositionUncertain",
      "The position may be some metres off: beams wait for a solution, and no obstacles are sent until then.")
      .add("deviation", in_event(&PositionUncertain::deviation_m),
           "Standard deviation since the last solution, metres.")
      .show_fields();
  EventFields<LoopClosed>(module, "LoopClosed", "SLAM has closed loops: the path is corrected, and then the map.")
      .add("loops", in_event(&LoopClosed::loops), "How many are kept since the last time.")
      .add("moved", in_event(&LoopClosed::moved_m), "Largest correction of a beam that was mapped already, metres.")
      .show_fields();
  EventFields<SlamFailed>(
      module, "SlamFailed",
      "Poses cannot be estimated (any more): later beams are recorded, and mapped if a later solution has their\n"
      "poses. Reported once.")
      .add("error", in_event(&SlamFailed::error), "Why, a pingvox.Error.")
      .show_fields();
}

void bind_status(py::module_& module) {
  Fields<HeadStatus>(module, "HeadStatus", "State of the connection to a sonar head, and of its recording.")
      .add("is_connected", in_status(&HeadStatus::is_connected), "Whether it answers.")
      .add("connections", in_status(&HeadStatus::connections), "How often it was connected.")
      .add("problem", in_status(&HeadStatus::problem), "Why it is not connected, or not any more.")
      .add("unanswered", in_status(&HeadStatus::unanswered), "Requests without an answer.")
      .add("damaged", in_status(&HeadStatus::damaged), "Damaged frames, and runs of bytes between frames.")
      .add("unexpected", in_status(&HeadStatus::unexpected),
           "Beams that do not fit their request: they are recorded and left out.")
      .add("first_unexpected", in_status(&HeadStatus::first_unexpected), "Why the first one does not fit.")
      .add("recording_error", in_status(&HeadStatus::recording_error),
           "What is wrong with the recording, a pingvox.Error; the beams go on.")
      .add("refused", in_status(&HeadStatus::refused),
           "Why none of the messages of a topic of ROS 2 can be used; empty: they can.")
      .add("publishers", in_status(&HeadStatus::publishers),
           "Publishers of a topic of ROS 2 that send at the same time; 0: at most one.")
      .show_fields();
  Fields<LiveNavStatus>(module, "LiveNavStatus", "State of a navigation device.")
      .add("kind", in_status(&LiveNavStatus::kind), "'mavlink', 'a50' or 'ros2'.")
      .add("name", in_status(&LiveNavStatus::name), "As in nav, with the port that was chosen.")
      .add("is_connected", in_status(&LiveNavStatus::is_connected), "Of one that waits for others to send, always.")
      .add("connections", in_status(&LiveNavStatus::connections), "How often it was connected.")
      .add("problem", in_status(&LiveNavStatus::problem), "Why it is not connected.")
      .add("messages", in_status(&LiveNavStatus::messages), "That came.")
      .add("damaged", in_status(&LiveNavStatus::damaged), "Damaged messages.")
      .add("recording_error", in_status(&LiveNavStatus::recording_error),
           "What is wrong with the recording, a pingvox.Error.")
      .add("refused", in_status(&LiveNavStatus::refused),
           "Why none of the messages of a topic of ROS 2 can be used; empty: they can.")
      .add("no_attitude", in_status(&LiveNavStatus::no_attitude),
           "Why messages of the last five seconds had no attitude; empty: they had.")
      .add("publishers", in_status(&LiveNavStatus::publishers),
           "Publishers of a topic of ROS 2 that send at the same time; 0: at most one.")
      .add("vehicle", in_status(&LiveNavStatus::vehicle), "Who is followed; empty: nobody yet.")
      .add("vehicles", in_status(&LiveNavStatus::vehicles), "How many were followed, one after the other.")
      .add("ignored", in_status(&LiveNavStatus::ignored), "Frames of other senders.")
      .add("others", in_status(&LiveNavStatus::others), "The first ones of these.")
      .show_fields();
  const auto motion_by = [](auto field) {
    return [field](const LiveSlamStatus& status) {
      return status.by ? py::cast((*status.by).*field) : py::object(py::none());
    };
  };
  Fields<LiveSlamStatus>(module, "LiveSlamStatus", "What SLAM does.")
      .add("motion", in_status(&LiveSlamStatus::motion),
           "Source of the motion: 'velocity', 'sonar and heading', 'sonar', or 'undecided'.")
      .add("velocity", motion_by(&MotionReport::velocity), "Its source, by the last solution; None: there is none yet.")
      .add("heading", motion_by(&MotionReport::heading), "Its source, by the last solution; None: there is none yet.")
      .add("deviation_of_motion", motion_by(&MotionReport::deviation_m_sqrt_s),
           "Standard deviation of the displacement after one second, m / sqrt(s); None: not known yet.")
      .add("loops", in_status(&LiveSlamStatus::loops), "Loops that were closed.")
      .add("corrections", in_status(&LiveSlamStatus::corrections), "How often the map was corrected.")
      .add("is_correcting", in_status(&LiveSlamStatus::is_correcting), "Whether a corrected map is being made.")
      .add("located", in_status(&LiveSlamStatus::located),
           "Where the vehicle was located in the known map, at that time, as of LocateResult; None: not yet, or there\n"
           "is none.")
      .add("without_velocity", in_status(&LiveSlamStatus::without_velocity_s),
           "Seconds since the last velocity was measured.")
      .add("deviation", in_status(&LiveSlamStatus::deviation_m),
           "Standard deviation of the displacement since the last solution, metres.")
      .add("predicted", in_status(&LiveSlamStatus::predicted),
           "LiveMapping.pose, however uncertain its position is: depth and heading are measured.")
      .show_fields();
  Fields<LiveStatus>(module, "LiveStatus", "State of a run at one time.")
      .add("time", in_status(&LiveStatus::time_s), "Seconds since the start.")
      .add("head", in_status(&LiveStatus::head), "Of the sonar head: HeadStatus.")
      .add("beams", in_status(&LiveStatus::beams), "That came: mapped, not mapped and waiting.")
      .add("mapped", in_status(&LiveStatus::mapped), "Beams in the map.")
      .add("not_mapped", in_status(&LiveStatus::not_mapped), "Without a pose, dropped, blocked or too long.")
      .add("waiting", in_status(&LiveStatus::waiting), "For their poses, or for the end of their sweep.")
      .add("without_pose", in_status(&LiveStatus::without_pose), "Of those not mapped.")
      .add("nav", in_status(&LiveStatus::nav), "Of each navigation device: LiveNavStatus.")
      .add("attitude", in_status(&LiveStatus::attitude), "Source of the attitude; empty: not chosen yet.")
      .add("position", in_status(&LiveStatus::position), "Source of the position; empty: not chosen yet.")
      .add("outliers", in_status(&LiveStatus::outliers), "Samples of these sources that were left out.")
      .add("new_frames", in_status(&LiveStatus::new_frames), "How often one of them went on in another frame.")
      .add("slam", in_status(&LiveStatus::slam), "LiveSlamStatus; None: poses are not by SLAM.")
      .show_fields();
}

}  // namespace

py::object event_object(const ReportedEvent& told) {
  return std::visit([&]<class Event>(const Event& event) { return py::cast(TextOf<Event>(told.text, event)); },
                    told.event);
}

py::tuple pose_of(const StampedPose& pose) {
  std::vector<double> matrix;
  append(pose.map_from_body, matrix);
  return py::make_tuple(pose.time_s, array_of(std::move(matrix), {4, 4}));
}

py::dict hypothesis_of(const PoseHypothesis& hypothesis) {
  py::dict all;
  all["x"] = hypothesis.x_m;
  all["y"] = hypothesis.y_m;
  all["yaw"] = hypothesis.yaw_rad;
  all["deviation"] = hypothesis.deviation_m;
  all["yaw_deviation"] = hypothesis.deviation_rad;
  all["weight"] = hypothesis.weight;
  return all;
}

void bind_live_event(py::module_& module) {
  py::class_<EventText>(module, "LiveEvent",
                        "What happens while LiveMapping runs: one of the classes of pingvox.live_event. str() is the\n"
                        "message of the program.")
      .def_property_readonly(
          "error", [](const EventText&) -> py::object { return py::none(); },
          "What has failed, as a pingvox.Error: a recording, the map, the navigation or SLAM. None: nothing.")
      .def("__str__", [](const EventText& event) { return event.text; });
  bind_device_events(module);
  bind_nav_events(module);
  bind_slam_events(module);
  bind_status(module);
}

}  // namespace pingvox::python
