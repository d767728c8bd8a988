#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/words.hpp"
#include "io/internal/clock.hpp"
#include "io/internal/json.hpp"
#include "pingvox/map/occupancy_map.hpp"

namespace pingvox::app {

/// {"min": [x, y, z], "max": [x, y, z]}, with null for both corners when there is no box.
JsonObject bounds_json(const std::optional<Box>& bounds);

/// {"resolution": 0.05, "depth": 16, "occupied_cells": ...}
JsonObject map_json(const OccupancyMap& map, const MapCounts& counts);

/// "-1.2 -3.4 0 .. 1.2 3.4 0.5 m", or "nothing is known".
std::string bounds_text(const std::optional<Box>& bounds);

/// A number of bytes as text: "12.3 MB".
std::string bytes_text(std::size_t bytes);

/// Degrees, rounded to a millionth: 90 is not 90.00000000000001.
double rounded_degrees(double angle_rad);

/// "4000 beams, 10 complete sweeps, 3900 echoes"
std::string beams_text(std::size_t beams, std::size_t sweeps, std::size_t echoes);

/// "2 damaged records, the first: line 43: range 20000 m is longer than 10000 m"
std::string damage_text(std::size_t records, std::string_view first);

/// The warning for an empty map.
std::string empty_map_text(const std::string& output);
/// "12.500 s, from 3.000 s", with the date where the time has one.
std::string duration_text(double from_s, double to_s);
/// A line of a report, with the values aligned.
std::string report_line(std::string_view label, std::string_view value);

/// A line with the speed of sound; empty where it is the one that devices assume.
std::string sound_line(double sound_speed_m_s);

/// Summary of a map as text.
/// @param resolution  how it was chosen; empty: only what it is
std::string map_text(const OccupancyMap& map, const MapCounts& counts, std::string_view resolution = {});

}  // namespace pingvox::app
