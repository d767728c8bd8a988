#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace pingvox {

/// The first line of the true ranges that `simulate --truth` writes: similar to that of a log.
inline constexpr std::string_view kTrueRangesHeader = "time_s,bearing_rad,true_bearing_rad,axis_range_m,cone_range_m";

/// Names a file of a common kind that pingvox does not read, and what to do about it. nullopt: it is none of these.
std::optional<std::string> describe_unread_file(std::span<const std::uint8_t> bytes);

/// Describes a file of unknown format and what to do about it: "is compressed: unpack it first".
std::string describe_unknown_file(std::span<const std::uint8_t> bytes);

/// Whether it begins with kTrueRangesHeader.
bool is_true_ranges(std::span<const std::uint8_t> bytes);

}  // namespace pingvox
