#include "slam_files.hpp"

#include <fmt/format.h>

#include <optional>
#include <ostream>
#include <utility>

#include "pingvox/io/file.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/io/tum.hpp"

namespace pingvox::app {

Result<void> write_slam_results(const Trajectory& trajectory, const OccupancyMap& map, MapAxes axes,
                                const SlamCommand& command) {
  auto written = write_file(command.output, [&](std::ostream& out) { return write_tum(trajectory, out); });
  if (!written || !command.map) return written;
  return write_map(map, command.map_format, command.made_by, *command.map, axes);
}

Result<void> write_covariances(const SlamSolution& solution, const std::string& path) {
  return write_file(path, [&](std::ostream& out) -> Result<void> {
    out << "time_s,x_x,x_y,y_y,x_yaw,y_yaw,yaw_yaw\n";
    for (const auto& [time_s, c] : solution.covariances) {
      out << fmt::format("{:.9f},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}\n", time_s, c(0, 0), c(0, 1), c(1, 1),
                         c(0, 2), c(1, 2), c(2, 2));
    }
    return {};
  });
}

}  // namespace pingvox::app
