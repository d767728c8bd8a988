#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "live/beam_queue.hpp"
#include "live/live_navigation.hpp"
#include "live/pose_watch.hpp"
#include "pingvox/device/head_status.hpp"
#include "pingvox/live/live_event.hpp"
#include "pingvox/live/live_mapping.hpp"

namespace pingvox {

/// Compares the state of the devices with that of before, and keeps what has changed as events.
class EventTracker {
 public:
  /// @param nav  nullptr: the vehicle does not move
  EventTracker(std::string head, const HeadStatus& status, const LiveNavigation* nav);

  void add(LiveEvent event);
  void update_head(const HeadStatus& status);
  void update_nav(const LiveNavigation& nav);
  /// The fate of the beams so far.
  struct Beams {
    PoseWatch::Latest latest;
    BeamQueue::Asked asked;
  };
  void update_poses(LiveNavigation& nav, const Beams& beams);
  void update_clocks(LiveNavigation& nav);
  /// @param problem  why obstacles are not sent; empty: they are
  void update_obstacles(const std::string& problem);
  /// @param problem  why something is not published; empty: it is
  void update_publishing(const std::string& problem);

  std::vector<LiveEvent> take() { return std::exchange(events_, {}); }
  /// How often a source continued in another frame.
  std::size_t new_frames() const { return new_frames_; }

 private:
  /// What is known of a device.
  struct Device {
    std::string name;
    bool is_connected = false;
    std::string problem;
    bool has_failed_recording = false, has_other_origin = false;
    bool has_several_publishers = false, has_missed_attitude = false;
    std::size_t vehicles = 0, others = 0;
  };

  void update_recording(const std::optional<Error>& error, Device& known);
  template <class Status>
  void update_connection(const Status& status, Device& known);
  template <class Status>
  void update_publishers(const Status& status, Device& known);
  void update_attitudes(const LiveNavigation& nav);
  void update_senders(const LiveNavStatus& status, Device& known);
  void update_sources(LiveNavigation& nav, const Beams& beams);

  Device head_;
  std::vector<Device> nav_;
  PoseWatch pose_watch_;
  bool has_unexpected_ = false;
  bool has_sources_ = false, has_missed_sources_ = false, has_no_pose_ = false;
  std::string obstacle_problem_, publish_problem_;
  std::size_t new_frames_ = 0;
  std::vector<LiveEvent> events_;
};

}  // namespace pingvox
