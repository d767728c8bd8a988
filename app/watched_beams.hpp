#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/slam/clock_offset.hpp"
#include "pingvox/sonar/beam_source_decorator.hpp"

namespace pingvox::app {

/// A log of beams that notes how the sonar's picture turns while it is read.
class WatchedBeams final : public BeamSourceDecorator {
 public:
  WatchedBeams(std::unique_ptr<BeamSource> source, const Pose& body_from_sensor)
      : BeamSourceDecorator(std::move(source)), turns_(body_from_sensor) {}

  Result<std::optional<Beam>> next() override {
    Result<std::optional<Beam>> beam = source().next();
    if (beam && *beam) turns_.add(**beam);
    return beam;
  }

  /// By how much the times of the poses are off, by the beams read so far. nullopt: it cannot be told.
  std::optional<ClockOffset> clock_error_of(const Trajectory& trajectory) {
    const std::vector<YawChange> changes = turns_.finish();
    return clock_error(changes, turns_.pauses(), trajectory);
  }

 private:
  PictureTurns turns_;
};

}  // namespace pingvox::app
