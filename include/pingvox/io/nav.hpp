#pragma once

#include <cstddef>
#include <ostream>
#include <string>
#include <vector>

#include "pingvox/io/beams.hpp"
#include "pingvox/io/byte_stream.hpp"
#include "pingvox/io/bytes.hpp"
#include "pingvox/nav/device_clock.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/nav/receiver_clock.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// Contents of a navigation log.
struct NavFile {
  NavLog log;
  std::size_t records = 0;              ///< frames, records or lines that were read, with or without navigation
  std::vector<DamageKind> damage;       ///< in the order in which the kinds were met
  std::vector<std::string> notes = {};  ///< what was left out although undamaged: messages of other vehicles
  /// Where the recorder's clock was set; times before and after are on one clock where it is known by how much.
  std::vector<ClockSetting> settings = {};
  /// The starts of the autopilot, where its messages have times of its own: its log counts from one of them.
  std::vector<DeviceRun> runs = {};
};

/// Reads any navigation log; the format is recognised by content. Units and frames are converted to those
/// of NavQuantity.
/// @return kUnsupported when the file is none; with Damage::kFail, kCorrupt naming the first damage
Result<NavFile> read_nav(const FileBytes& file, Damage damage = Damage::kSkip);
/// The same. ROS bags are read as streams, other logs as a whole.
Result<NavFile> read_nav(ByteStream stream, Damage damage = Damage::kSkip);

/// Writes all samples as CSV (docs/formats.md). Numbers are written so that reading gives the same to the last bit;
/// what cannot stand in a name there becomes `_`.
/// @return how many there were; kIo when `out` fails
Result<std::size_t> write_nav_csv(const NavLog& log, std::ostream& out);

}  // namespace pingvox
