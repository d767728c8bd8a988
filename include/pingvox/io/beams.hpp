#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <variant>

#include "pingvox/io/beam_topic.hpp"
#include "pingvox/io/byte_stream.hpp"
#include "pingvox/io/bytes.hpp"
#include "pingvox/map/point_scan.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// Handling of damage in a log.
enum class Damage {
  kSkip,  ///< skip the record and count it
  kFail,  ///< the first one is an error (--strict)
};

/// Opens a log of beams; the format is recognised by content. Device logs are read as streams in constant memory,
/// others as a whole.
/// @param topic  of a ROS bag. Without a name, a second topic with beams is an error (kBadOption) where it begins.
/// @return kUnsupported when it holds no beams, kCorrupt when its header is damaged
Result<std::unique_ptr<BeamSource>> open_beams(ByteStream stream, Damage damage = Damage::kSkip,
                                               const BeamTopic& topic = {});
/// The same for bytes in memory.
Result<std::unique_ptr<BeamSource>> open_beams(FileBytes file, Damage damage = Damage::kSkip,
                                               const BeamTopic& topic = {});

/// Opens a log of point scans, or a point cloud (PLY, PCD, XYZ) as one scan; the format is recognised by
/// content.
/// @param cloud_origin_m  origin of a cloud's rays (map frame); nullopt: a PCD's VIEWPOINT, else 0, 0, 0. Ignored for
///                        logs, which hold the origins of their scans
Result<std::unique_ptr<ScanSource>> open_scans(FileBytes file, Damage damage = Damage::kSkip,
                                               const std::optional<Eigen::Vector3d>& cloud_origin_m = std::nullopt);

/// What of a bag can be mapped.
using BagLog = std::variant<std::unique_ptr<BeamSource>, std::unique_ptr<ScanSource>>;

/// Opens a ROS bag: its beams, else scans of points (PointCloud2, PointCloud, LaserScan), which have times.
/// @param topic  of beams or scans, else as for open_beams; scans from a pipe need one
Result<BagLog> open_bag_log(ByteStream stream, Damage damage = Damage::kSkip, const BeamTopic& topic = {});

/// Writes all beams of a source as CSV (docs/formats.md). Reading them back gives exactly the same beams.
/// @return the number of beams; the source's error; kIo when `out` fails
Result<std::size_t> write_csv(BeamSource& beams, std::ostream& out);

}  // namespace pingvox
