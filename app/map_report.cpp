#include "map_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "console.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/sonar/device_profile.hpp"

namespace pingvox::app {

JsonObject bounds_json(const std::optional<Box>& bounds) {
  JsonObject json;
  if (!bounds) return json.add_null("min").add_null("max");
  return json.add("min", bounds->min).add("max", bounds->max);
}

JsonObject map_json(const OccupancyMap& map, const MapCounts& counts) {
  JsonObject json;
  return json.add("resolution", map.lattice().resolution_m())
      .add("depth", map.lattice().depth())
      .add("leaves", counts.leaves)
      .add("inner", counts.inner)
      .add("memory_bytes", map.memory_bytes())
      .add("occupied_cells", counts.occupied_cells)
      .add("free_cells", counts.free_cells)
      .add("bounds", bounds_json(map.bounds()));
}

std::string bounds_text(const std::optional<Box>& bounds) {
  if (!bounds) return "nothing is known";
  const auto& [min, max] = *bounds;
  return fmt::format("x {:.9g}..{:.9g}, y {:.9g}..{:.9g}, z {:.9g}..{:.9g} m", min.x(), max.x(), min.y(), max.y(),
                     min.z(), max.z());
}

std::string bytes_text(std::size_t bytes) {
  constexpr double kKilo = 1000.0;
  const auto size = static_cast<double>(bytes);
  if (size < kKilo) return fmt::format("{} B", bytes);
  if (size < kKilo * kKilo) return fmt::format("{:.1f} kB", size / kKilo);
  if (size < kKilo * kKilo * kKilo) return fmt::format("{:.1f} MB", size / (kKilo * kKilo));
  return fmt::format("{:.1f} GB", size / (kKilo * kKilo * kKilo));
}

double rounded_degrees(double angle_rad) {
  return std::round(angle_rad / kDegree_rad * 1e6) / 1e6;
}

std::string beams_text(std::size_t beams, std::size_t sweeps, std::size_t echoes) {
  return fmt::format("{}, {}, {}", counted(beams, "beam"), counted(sweeps, "complete sweep"), counted(echoes, "echo"));
}

std::string damage_text(std::size_t records, std::string_view first) {
  return fmt::format("{}, the first: {}", counted(records, "damaged record"), on_one_line(first));
}

std::string empty_map_text(const std::string& output) {
  return fmt::format(
      "{}: the map is empty: no echoes and no free space in range (see --min-range, --max-range, "
      "--threshold and --silent)",
      output);
}

std::string duration_text(double from_s, double to_s) {
  const std::string date = date_text(from_s);
  return fmt::format("{:.3f} s, from {:.3f} s{}", to_s - from_s, from_s, date.empty() ? "" : ", " + date);
}

std::string report_line(std::string_view label, std::string_view value) {
  return fmt::format("  {:<12}{}\n", label, value);
}

std::string sound_line(double sound_speed_m_s) {
  if (sound_speed_m_s == kAssumedSoundSpeed_m_s) return "";
  return report_line("sound", fmt::format("{:.1f} m/s", sound_speed_m_s));
}

std::string map_text(const OccupancyMap& map, const MapCounts& counts, std::string_view resolution) {
  const Lattice& lattice = map.lattice();
  const std::string cells = resolution.empty() ? fmt::format("{} m", lattice.resolution_m()) : std::string(resolution);
  std::string out = report_line("cells", fmt::format("{}, {} levels", cells, lattice.depth())) +
                    report_line("occupied", fmt::format("{}", counts.occupied_cells)) +
                    report_line("free", fmt::format("{}", counts.free_cells));
  if (counts.undecided_cells > 0) out += report_line("undecided", fmt::format("{}", counts.undecided_cells));
  return out +
         report_line("nodes", fmt::format("{} = {} leaves + {} inner", counts.nodes(), counts.leaves, counts.inner)) +
         report_line("bounds", bounds_text(map.bounds())) + report_line("memory", bytes_text(map.memory_bytes()));
}

}  // namespace pingvox::app
