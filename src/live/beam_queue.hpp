#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <utility>
#include <variant>
#include <vector>

#include "live/live_navigation.hpp"
#include "live/live_slam.hpp"
#include "pingvox/mapping/beam_mapper.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// Beams that wait for their poses, and then go into the map.
class BeamQueue {
 public:
  /// Poses from the navigation, or by SLAM.
  using Mapper = std::variant<BeamMapper, LiveSlam>;
  explicit BeamQueue(Mapper mapper) : mapper_(std::move(mapper)) {}

  /// nullptr: poses are from the navigation.
  LiveSlam* slam() { return std::get_if<LiveSlam>(&mapper_); }
  const LiveSlam* slam() const { return std::get_if<LiveSlam>(&mapper_); }

  /// Takes beams that have arrived. The oldest ones are dropped when too many wait: the recording has them.
  void push(std::vector<Beam>& arrived, double now_s);

  bool empty() const { return waiting_.empty(); }
  /// Whether the pose of the oldest beam is known, or will not come any more.
  /// @param nav  nullptr: the vehicle does not move
  bool can_map_one(const LiveNavigation* nav, double now_s) const;
  /// Maps the oldest beam, without a pose if it is not known. After an error it is dropped. REQUIRES that one waits.
  /// @param clock  to take the latency by
  /// @return the error of the map, once
  Result<void> map_one(const LiveNavigation* nav, const std::function<double()>& clock);
  /// With SLAM: corrects the map where that is due. @return as map_one
  Result<void> update(double now_s);
  /// Maps the beams that the mapper still holds. @return as map_one
  Result<void> finish();

  /// As BeamMapper::track.
  void track(ChangedPages* changes) {
    std::visit([changes](auto& mapper) { mapper.track(changes); }, mapper_);
  }
  /// Maps the waiting and later beams by another mapper.
  /// @return how many beams the old one had taken, which are not counted any more
  std::size_t restart(Mapper mapper);

  bool has_failed() const { return has_failed_; }
  const BuildReport& report() const {
    return std::visit([](const auto& mapper) -> const BuildReport& { return mapper.report(); }, mapper_);
  }
  /// Nothing with SLAM, which moves sweeps later.
  SweepCoverage coverage() const {
    const BeamMapper* const mapper = std::get_if<BeamMapper>(&mapper_);
    return mapper != nullptr ? mapper->coverage() : SweepCoverage{};
  }
  std::size_t beams() const { return beams_; }  ///< that were pushed
  /// Beams of all maps so far whose pose was looked up, and those of them without one. None with SLAM.
  struct Asked {
    std::size_t beams = 0, without_pose = 0;
  };
  const Asked& asked() const { return asked_; }
  /// With SLAM they wait until the end, as a solution may give their pose.
  std::size_t without_pose() const {
    if (slam() == nullptr) return without_pose_;
    return is_finished_ ? report().no_pose.count : 0;
  }
  /// Beams without a pose are known before the mapper leaves them out, which is at the end of their sweep. Those that
  /// reach out of the map are mapped in part.
  std::size_t not_mapped() const;
  /// Beams that are not yet mapped.
  std::size_t waiting() const { return beams_ - report().beams - not_mapped(); }

  /// Longest time from a beam's arrival until the mapper was done with it, since the last call.
  double take_latency_s() { return std::exchange(latency_s_, 0.0); }

 private:
  struct Waiting {
    Beam beam;
    double arrived_s;
  };
  Result<void> give_up(const Error& error);

  Result<void> add(Beam beam, const LiveNavigation* nav, double now_s);

  Mapper mapper_;
  std::deque<Waiting> waiting_;
  std::size_t beams_ = 0, without_pose_ = 0;
  Asked asked_;
  std::size_t dropped_ = 0;  ///< under load, or after an error of the map
  double latency_s_ = 0.0;
  bool has_failed_ = false, is_finished_ = false;
};

}  // namespace pingvox
