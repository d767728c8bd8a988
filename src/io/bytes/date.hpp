#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace pingvox {

/// Seconds since 1970 of "2017.11.02 08.58.46.723", taken as UTC; nullopt: invalid.
std::optional<double> date_time_s(std::string_view text);

/// The text of which date_time_s gives these milliseconds since 1970, in UTC.
std::string date_time_text(std::uint64_t since_1970_ms);

/// Seconds since midnight of "13:26:49.178"; nullopt: invalid.
std::optional<double> time_of_day_s(std::string_view text);

}  // namespace pingvox
