#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pingvox/io/nav.hpp"

// The readers behind read_nav, and how format_of knows their formats.
namespace pingvox {

/// A log as far as it could be read.
struct NavReading {
  std::vector<NavSource> sources;
  NavClock clock = NavClock::kUnknown;
  std::size_t records = 0;
  std::vector<DamageKind> damage;  ///< in the order in which the kinds were met
  std::vector<std::string> notes;  ///< as those of NavFile
  std::vector<ClockSetting> settings;
  std::vector<DeviceRun> runs;
};

bool looks_like_tlog(std::span<const std::uint8_t> bytes);
NavReading read_tlog(std::span<const std::uint8_t> bytes);

bool looks_like_dataflash(std::span<const std::uint8_t> bytes);
NavReading read_dataflash(std::span<const std::uint8_t> bytes);

bool looks_like_ictineu(std::span<const std::uint8_t> bytes);
NavReading read_ictineu(std::span<const std::uint8_t> bytes);

bool looks_like_a50(std::span<const std::uint8_t> bytes);
NavReading read_a50(std::span<const std::uint8_t> bytes);

bool looks_like_nmea(std::span<const std::uint8_t> bytes);
NavReading read_nmea(std::span<const std::uint8_t> bytes);

bool looks_like_nav_csv(std::span<const std::uint8_t> bytes);
NavReading read_nav_csv(std::span<const std::uint8_t> bytes);

}  // namespace pingvox
