#pragma once

#include <optional>
#include <string>

namespace pingvox {

/// The fields by which a message is a beam. They are named by their paths, as in "echo.angle".
struct BeamFields {
  enum class Length { kBeam, kBin };

  std::string angle;        ///< where the head looked
  std::string length;       ///< length [m] of what `length_of` says
  std::string intensities;  ///< numbers 0..255, the nearest first
  Length length_of = Length::kBeam;
  double angle_unit_rad = 1.0;  ///< negative: angles are clockwise
  double ahead = 0.0;           ///< the angle of the sensor's x axis, in its unit
};

/// The messages of a ROS bag that are beams.
struct BeamTopic {
  std::string name = {};  ///< empty: the only topic with beams
  /// nullopt: messages of types that we know. REQUIRES a name
  std::optional<BeamFields> fields = std::nullopt;
};

}  // namespace pingvox
