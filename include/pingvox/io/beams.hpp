#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <ostream>

#include "pingvox/io/byte_stream.hpp"
#include "pingvox/io/bytes.hpp"
#include "pingvox/map/point_scan.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// What to do about damage in a log.
enum class Damage {
  kSkip,  ///< leave the record out and count it
  kFail,  ///< the first one is an error (--strict)
};

/// Any log that holds beams, told by content. kUnsupported when it holds none, kCorrupt when its frame is broken. Logs
/// of devices are read as the beams are asked for, in memory that does not grow with them; the others as a whole.
Result<std::unique_ptr<BeamSource>> open_beams(ByteStream stream, Damage damage = Damage::kSkip);
/// The same of bytes in memory.
Result<std::unique_ptr<BeamSource>> open_beams(FileBytes file, Damage damage = Damage::kSkip);

/// Any log that holds point scans, told by content, or a cloud of points (PLY, PCD, XYZ), which is one scan.
/// @param cloud_origin_m  from where the points of a cloud were seen (map frame); nullopt: what a PCD's VIEWPOINT says,
///                        else 0, 0, 0. Logs know the places of their scans, and nothing happens to those
Result<std::unique_ptr<ScanSource>> open_scans(FileBytes file, Damage damage = Damage::kSkip,
                                               const std::optional<Eigen::Vector3d>& cloud_origin_m = std::nullopt);

/// Writes all beams of a source as CSV (docs/formats.md). Numbers are written so that reading gives the same beams to
/// the last bit.
/// @return how many there were; the source's error; kIo when `out` fails
Result<std::size_t> write_csv(BeamSource& beams, std::ostream& out);

}  // namespace pingvox
