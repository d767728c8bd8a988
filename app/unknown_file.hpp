#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace pingvox::app {

/// The first line of the true ranges that `simulate --truth` writes: it begins as that of a log, and is none.
inline constexpr std::string_view kTrueRangesHeader = "time_s,bearing_rad,true_bearing_rad,axis_range_m,cone_range_m";

/// What a file is that none of our readers takes, as far as that can be summary, and what to do about it: "is
/// compressed: unpack it first".
std::string describe_unknown_file(std::span<const std::uint8_t> bytes);

/// Whether it begins with kTrueRangesHeader.
bool is_true_ranges(std::span<const std::uint8_t> bytes);

}  // namespace pingvox::app
