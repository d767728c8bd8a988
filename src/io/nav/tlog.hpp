#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "io/internal/mavlink.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// A frame and when it was received [us since 1970 by the computer's clock, which may not have been set].
struct TlogRecord {
  std::uint64_t time_us = 0;
  MavlinkFrame frame;
};

/// Walks through the records of a telemetry log, without frames with a wrong checksum and those with a time that is far
/// from those of both neighbours, which agree.
/// @return how many there were
std::size_t for_each_tlog_record(std::span<const std::uint8_t> bytes, std::vector<DamageKind>& damage,
                                 const std::function<void(const TlogRecord&)>& take);

}  // namespace pingvox
