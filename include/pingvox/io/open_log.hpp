#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>

#include "pingvox/io/beam_topic.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/io/byte_stream.hpp"
#include "pingvox/io/bytes.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// Format of a file by its content. kUnsupported when it is not readable; the message describes the file.
Result<Format> identify_format(const FileBytes& file);
/// The same. Loads formats that are not read as streams into memory.
Result<Format> identify_format(ByteStream& stream);

/// The same of a log or a cloud: kUnsupported also when it is another file that can be read, as a map.
Result<Format> identify_log(ByteStream& stream);

/// A log of beams, or of scans of points.
using Log = BagLog;

/// Opens a log or a cloud by its content. kUnsupported when it is neither; the message describes the file.
/// @param cloud_origin_m  as for open_scans
/// @param topic           as for open_beams; kBadOption for a name where the log is no ROS bag
Result<Log> open_log(ByteStream stream, Damage damage = Damage::kSkip,
                     const std::optional<Eigen::Vector3d>& cloud_origin_m = std::nullopt, const BeamTopic& topic = {});

/// The beams of a log. kUnsupported naming it when it holds scans.
Result<std::unique_ptr<BeamSource>> only_beams(Log log, const std::string& name);

}  // namespace pingvox
