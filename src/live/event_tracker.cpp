#include "live/event_tracker.hpp"

#include <algorithm>

namespace pingvox {

EventTracker::EventTracker(std::string head, const HeadStatus& status, const LiveNavigation* nav) {
  head_ = {.name = std::move(head), .is_connected = status.is_connected, .problem = status.problem};
  if (nav == nullptr) return;
  for (const NavDevice& device : nav->devices()) {
    nav_.push_back({.name = device.name(), .is_connected = device.status().is_connected, .problem = {}});
  }
}

void EventTracker::add(LiveEvent event) {
  constexpr std::size_t kMaxEvents = 1000;  // bounds the memory if a caller takes none
  if (events_.size() < kMaxEvents) events_.push_back(std::move(event));
}

void EventTracker::update_head(const HeadStatus& status) {
  update_recording(status.recording_error, head_);
  if (status.unexpected > 0 && !std::exchange(has_unexpected_, true)) {
    add(live_event::UnexpectedBeam{head_.name, status.first_unexpected});
  }
  update_publishers(status, head_);
  update_connection(status, head_);
}

void EventTracker::update_nav(const LiveNavigation& nav) {
  const std::string& position = nav.poses().position();
  for (std::size_t i = 0; i < nav_.size(); ++i) {
    const NavDevice& device = nav.devices()[i];
    const LiveNavStatus status = device.status();
    Device& known = nav_[i];
    update_recording(status.recording_error, known);
    update_senders(status, known);
    if (device.has_other_origin(position) && !std::exchange(known.has_other_origin, true)) {
      add(live_event::SenderRestarted{known.name, position});
    }
    update_publishers(status, known);
    update_connection(status, known);
  }
}

void EventTracker::update_obstacles(const std::string& problem) {
  if (problem == obstacle_problem_) return;
  obstacle_problem_ = problem;
  if (problem.empty()) {
    add(live_event::ObstaclesSent{});
  } else {
    add(live_event::ObstaclesNotSent{problem});
  }
}

void EventTracker::update_publishing(const std::string& problem) {
  if (problem == publish_problem_) return;
  publish_problem_ = problem;
  if (!problem.empty()) add(live_event::NotPublished{problem});
}

void EventTracker::update_recording(const std::optional<Error>& error, Device& known) {
  if (!error) known.has_failed_recording = false;
  if (error && !std::exchange(known.has_failed_recording, true)) add(live_event::RecordingFailed{*error});
}

/// Of a head or of navigation.
template <class Status>
void EventTracker::update_connection(const Status& status, Device& known) {
  if (status.is_connected == known.is_connected && status.problem == known.problem) return;
  if (status.is_connected) {
    add(live_event::Connected{known.name});
  } else if (!status.refused.empty()) {
    add(live_event::MessagesRefused{known.name, status.refused});
  } else if (!status.problem.empty()) {
    add(live_event::NotConnected{known.name, status.problem});
  }
  known.is_connected = status.is_connected;
  known.problem = status.problem;
}

template <class Status>
void EventTracker::update_publishers(const Status& status, Device& known) {
  if (status.publishers < 2 || std::exchange(known.has_several_publishers, true)) return;
  add(live_event::SeveralPublishers{known.name, status.publishers});
}

/// Why a device has no attitude, where no other one has any.
void EventTracker::update_attitudes(const LiveNavigation& nav) {
  if (nav.poses().has(NavQuantity::kAttitude)) return;
  for (std::size_t i = 0; i < nav_.size(); ++i) {
    const std::string reason = nav.devices()[i].status().no_attitude;
    if (reason.empty() || std::exchange(nav_[i].has_missed_attitude, true)) continue;
    add(live_event::MessagesRefused{nav_[i].name, "no attitude: " + reason});
  }
}

void EventTracker::update_senders(const LiveNavStatus& status, Device& known) {
  if (status.vehicles > known.vehicles && known.vehicles > 0) {
    add(live_event::VehicleChanged{known.name, status.vehicle});
  }
  known.vehicles = status.vehicles;
  known.others = std::min(known.others, status.others.size());
  for (; known.others < status.others.size(); ++known.others) {
    add(live_event::SenderIgnored{known.name, status.others[known.others], status.vehicle});
  }
}

void EventTracker::update_poses(LiveNavigation& nav, const Beams& beams) {
  update_sources(nav, beams);
  update_attitudes(nav);
  for (const LivePoses::NewFrame& frame : nav.take_new_frames()) {
    ++new_frames_;
    add(live_event::NewFrame{frame.source, frame.quantity, frame.step});
  }
}

void EventTracker::update_sources(LiveNavigation& nav, const Beams& beams) {
  constexpr double kLong_s = 5.0;
  const LivePoses& poses = nav.poses();
  const std::optional<double> until_s = poses.known_until_s();
  if (!until_s || !nav.pose_came_s()) {
    if (nav.now_s() > kLong_s && !std::exchange(has_missed_sources_, true)) {
      add(live_event::NoSourceYet{poses.has(NavQuantity::kAttitude), poses.has(NavQuantity::kPosition),
                                  nav.messages()});
    }
    return;
  }
  const PoseWatch::Seen seen{
      nav.now_s(), {*until_s, *nav.pose_came_s()}, beams.latest, beams.asked.beams, beams.asked.without_pose};
  // Beams that came before have no pose, and that is no news.
  bool restarts = false;
  if (!std::exchange(has_sources_, true)) {
    add(live_event::SourcesChosen{poses.attitude(), poses.position()});
    restarts = true;
  }
  const bool has_no_pose = nav.now_s() - *nav.pose_came_s() > kLong_s;
  if (std::exchange(has_no_pose_, has_no_pose) != has_no_pose) {
    restarts = true;
    if (has_no_pose) {
      add(live_event::PosesEnded{});
    } else {
      add(live_event::PosesResumed{});
    }
  }
  if (restarts || has_no_pose) {
    pose_watch_.restart(seen);
    nav.restart_clocks();
  } else if (std::optional<LiveEvent> told = pose_watch_.update(seen)) {
    add(*std::move(told));
  }
}

void EventTracker::update_clocks(LiveNavigation& nav) {
  // BeamsWithoutPose has the reason as well.
  if (pose_watch_.is_reported()) return nav.restart_clocks();
  for (const ClockWatch::Difference& difference : nav.take_clock_differences()) {
    add(live_event::ClocksDiffer{nav_[difference.device].name, head_.name, difference.ahead_s});
  }
}

}  // namespace pingvox
