#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "io/bags/bag_topics.hpp"
#include "io/beams/angle_units.hpp"
#include "pingvox/io/beam_topic.hpp"
#include "pingvox/sonar/beam.hpp"

// The messages of drivers of sonars, by their type and fields (docs/formats.md).
namespace pingvox {

/// Settings from a message, valid for the beams after it.
struct SonarSettings {
  std::optional<double> period_25ns;
};

/// The beams of a message, or why it is none.
using Beams = tl::expected<std::vector<Beam>, Unusable>;

/// How the first field of a message says where the head looked.
struct HeadAngle {
  AngleUnit unit = AngleUnit::kRadian;  ///< as it is documented
  double turn = 1.0;                    ///< -1: clockwise
  double ahead_rad = 0.0;               ///< the angle of the sensor's x axis
};

struct SonarType {
  RosType type;
  std::string_view device;  ///< empty: unknown
  Beams (*beams_in)(const RosFields& message, SonarSettings& settings);
  std::optional<HeadAngle> angle = std::nullopt;                            ///< nullopt: `beams_in` turns the beams
  enum class Holds { kBeams, kBeamsToo, kSettings } holds = Holds::kBeams;  ///< kBeamsToo: the driver's, once more
};

/// Those that we know.
std::span<const SonarType> sonar_types();

/// Whether messages of the topic are beams.
bool is_sonar(const BagTopic& topic);

/// A message of a driver that we do not know, not turned.
Beams beam_of_fields(const RosFields& message, const BeamFields& fields);
/// The unit that is stated of it; nullopt: another one.
std::optional<AngleUnit> unit_of(const BeamFields& fields);

}  // namespace pingvox
