#pragma once

#include <memory>
#include <ostream>

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

/// Any log that holds beams, told by content. kUnsupported when it holds none, kCorrupt when its frame is broken.
Result<std::unique_ptr<BeamSource>> open_beams(FileBytes file, Damage damage = Damage::kSkip);

/// Any log that holds point scans, told by content.
Result<std::unique_ptr<ScanSource>> open_scans(FileBytes file, Damage damage = Damage::kSkip);

/// Writes all beams of a source as CSV (docs/formats.md). Numbers are written so that reading gives the same beams to
/// the last bit.
/// @return how many there were; the source's error; kIo when `out` fails
Result<std::size_t> write_csv(BeamSource& beams, std::ostream& out);

}  // namespace pingvox
