#include "live_event_text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string_view>
#include <variant>

#include "base/words.hpp"
#include "pingvox/geometry/degree.hpp"
#include "step_text.hpp"

namespace pingvox::app {
namespace {

/// Names of the navigation devices.
std::string nav_names(const LiveStatus& status) {
  std::string names;
  for (const LiveNavStatus& device : status.nav) names += (names.empty() ? "" : ", ") + device.name;
  return names;
}

/// Where a vehicle was located, and how surely.
std::string place_text(const PoseHypothesis& where) {
  return fmt::format("{:.2f} {:.2f} m +- {:.2f}, {:.1f} +- {:.1f} degrees", where.x_m, where.y_m, where.deviation_m,
                     where.yaw_rad / kDegree_rad, where.deviation_rad / kDegree_rad);
}

/// "3.0 s behind"; of a negative time "ahead of".
std::string apart_text(double behind_s) {
  return fmt::format("{:.1f} s {}", std::fabs(behind_s), behind_s < 0.0 ? "ahead of" : "behind");
}

/// Why beams have no pose although poses arrive.
std::string why_text(const live_event::BeamsWithoutPose& event) {
  if (event.behind_s) {
    return fmt::format("the poses are {} the beams: are the clocks right?", apart_text(*event.behind_s));
  }
  if (event.apart_s) return fmt::format("the poses are up to {:.1f} s apart", *event.apart_s);
  return "poses arrive, but none for their times";
}

/// The text of each kind of event.
class EventText {
 public:
  EventText(const LiveOptions& options, const LiveStatus& status) : options_(options), status_(status) {}

  std::string operator()(const live_event::Connected& event) const {
    return fmt::format("{}: connected", event.device);
  }
  std::string operator()(const live_event::NotConnected& event) const {
    return fmt::format("{}: not connected ({}); trying again", event.device, event.reason);
  }
  std::string operator()(const live_event::RecordingFailed& event) const {
    return fmt::format("{}; mapping goes on", event.error.message);
  }
  std::string operator()(const live_event::MappingFailed& event) const { return event.error.message; }
  std::string operator()(const live_event::NavFailed& event) const { return event.error.message; }
  std::string operator()(const live_event::UnexpectedBeam& event) const {
    return fmt::format("{}: unexpected beam: {}; such beams are recorded but not mapped", event.device, event.reason);
  }
  std::string operator()(const live_event::SourcesChosen& event) const {
    return fmt::format("{}: attitude of {}, position of {}", nav_names(status_), on_one_line(event.attitude),
                       on_one_line(event.position));
  }
  std::string operator()(const live_event::NoSourceYet& event) const {
    const std::string_view missing = event.has_attitude == event.has_position ? "attitude and position"
                                     : event.has_attitude                     ? "position"
                                                                              : "attitude";
    return fmt::format("{}: no {} yet, {} messages so far: beams are not mapped", nav_names(status_), missing,
                       event.messages);
  }
  std::string operator()(const live_event::PosesEnded&) const {
    return fmt::format("{}: no pose for 5 s: beams are not mapped", nav_names(status_));
  }
  std::string operator()(const live_event::PosesResumed&) const {
    return fmt::format("{}: poses again", nav_names(status_));
  }
  std::string operator()(const live_event::BeamsWithoutPose& event) const {
    const std::string what = event.without_pose == event.beams
                                 ? fmt::format("no beam was mapped for {:.0f} s", event.within_s)
                                 : fmt::format("{} of {} beams of the last {:.0f} s were not mapped",
                                               event.without_pose, event.beams, event.within_s);
    return fmt::format("{}: {}: {}", nav_names(status_), what, why_text(event));
  }
  std::string operator()(const live_event::BeamsWithPose&) const {
    return fmt::format("{}: beams are mapped again", nav_names(status_));
  }
  std::string operator()(const live_event::ClocksDiffer& event) const {
    return fmt::format("the stamps of {} are {} those of {}, judged by their arrival: are the clocks right?",
                       event.device, apart_text(-event.ahead_s), event.head);
  }
  std::string operator()(const live_event::VehicleChanged& event) const {
    return fmt::format(
        "{}: now follows {}, as the sender before fell silent; if it is another vehicle, start a new map", event.device,
        event.vehicle);
  }
  std::string operator()(const live_event::SenderIgnored& event) const {
    return fmt::format("{}: ignores {}, as it follows {}", event.device, event.sender, event.vehicle);
  }
  std::string operator()(const live_event::SenderRestarted& event) const {
    return fmt::format(
        "{}: the sender of {} restarted: its positions are relative to another origin now; start a new map",
        event.device, on_one_line(event.position));
  }
  std::string operator()(const live_event::NewFrame& event) const {
    return fmt::format("{}: {} of {} {}: it is in another frame now; start a new map", nav_names(status_),
                       name_of(event.quantity), on_one_line(event.source), step_text(event.step));
  }
  std::string operator()(const live_event::ObstaclesNotSent& event) const {
    return fmt::format("obstacles: not sent ({}); trying again", event.reason);
  }
  std::string operator()(const live_event::ObstaclesSent&) const {
    return fmt::format("obstacles: sent to {} from now on", *options_.obstacles);
  }
  std::string operator()(const live_event::NotPublished& event) const {
    return fmt::format("publish: {}; trying again", event.reason);
  }
  std::string operator()(const live_event::MotionChosen& event) const {
    const std::string heading =
        event.heading.empty() ? "the turn rates" : fmt::format("the heading of {}", on_one_line(event.heading));
    switch (event.motion) {
      case LiveMotion::kVelocity:
        return fmt::format("slam: motion from the velocity of {} and {}{}", on_one_line(event.velocity), heading,
                           event.deviation_m_sqrt_s
                               ? fmt::format(", standard deviation {:.3f} m after 1 s", *event.deviation_m_sqrt_s)
                               : "");
      case LiveMotion::kSonarAndHeading:
        return fmt::format("slam: no velocity: motion from the sonar and {}", heading);
      default:
        return "slam: no velocity and no heading: motion from the sonar alone";
    }
  }
  std::string operator()(const live_event::Located& event) const {
    return fmt::format("slam: located in {} at {}; beams are mapped from now on, earlier ones as well",
                       on_one_line(event.map), place_text(event.where));
  }
  std::string operator()(const live_event::NotLocated& event) const {
    const std::string what =
        event.hypotheses.empty()
            ? "its echoes match nowhere"
            : fmt::format("{}, the most likely at {} with weight {:.2f}", counted(event.hypotheses.size(), "place"),
                          place_text(event.hypotheses.front()), event.hypotheses.front().weight);
    return fmt::format("slam: not located in {} after {}: {}; beams are not mapped until it is", on_one_line(event.map),
                       counted(event.sweeps, "sweep"), what);
  }
  std::string operator()(const live_event::VelocityEnded& event) const {
    return fmt::format("slam: no velocity of {} for 1 s: poses are predicted from the last one and the heading",
                       on_one_line(event.velocity));
  }
  std::string operator()(const live_event::VelocityResumed& event) const {
    return fmt::format("slam: velocity of {} again, after {:.1f} s", on_one_line(event.velocity), event.missing_s);
  }
  std::string operator()(const live_event::PositionUncertain& event) const {
    return fmt::format("slam: position uncertain, standard deviation {:.0f} m: beams wait for the next solution",
                       event.deviation_m);
  }
  std::string operator()(const live_event::LoopClosed& event) const {
    return fmt::format("slam: loop closed: the path moves by up to {:.2f} m, and the map is corrected", event.moved_m);
  }
  std::string operator()(const live_event::SlamFailed& event) const {
    return fmt::format("slam: {}; such beams are not mapped", event.error.message);
  }
  std::string operator()(const live_event::MessagesRefused& event) const {
    return fmt::format("{}: its messages cannot be used: {}", event.device, on_one_line(event.reason));
  }
  std::string operator()(const live_event::SeveralPublishers& event) const {
    return fmt::format(
        "{}: has {} publishers at the same time, and all their messages are used: stop the others, or give each a "
        "topic of its own",
        event.device, event.publishers);
  }

 private:
  const LiveOptions& options_;
  const LiveStatus& status_;
};

}  // namespace

std::string live_event_text(const LiveEvent& event, const LiveOptions& options, const LiveStatus& status) {
  return std::visit(EventText(options, status), event);
}

}  // namespace pingvox::app
