#include "placed_sweep.hpp"

#include <cmath>

#include "pingvox/sonar/filters.hpp"
#include "pingvox/sonar/sweep.hpp"

namespace pingvox::bench {

Eigen::Vector3d PlacedBeam::at(double range_m) const {
  return map_from_sonar * (Eigen::Vector3d(std::cos(beam.bearing_rad), std::sin(beam.bearing_rad), 0.0) * range_m);
}

std::vector<PlacedSweep> place_sweeps(std::span<const Beam> beams, const Trajectory& map_from_sonar) {
  std::vector<PlacedSweep> placed;
  for (const Sweep& sweep : sweeps_of(beams)) {
    const auto echoes = detect_echoes(apply_filter(PolarImage(sweep), {}), sweep, {});
    PlacedSweep& to = placed.emplace_back();
    for (std::size_t n = 0; n < sweep.beams.size(); ++n) {
      if (const auto pose = map_from_sonar.at(sweep.beams[n].time_s)) to.push_back({sweep.beams[n], echoes[n], *pose});
    }
  }
  return placed;
}

std::vector<std::vector<Eigen::Vector2d>> echoes_in_plane(std::span<const PlacedSweep> sweeps) {
  std::vector<std::vector<Eigen::Vector2d>> points;
  for (const PlacedSweep& sweep : sweeps) {
    std::vector<Eigen::Vector2d>& of_sweep = points.emplace_back();
    for (const PlacedBeam& beam : sweep) {
      if (beam.echo) of_sweep.emplace_back(beam.at(beam.echo->range_m).head<2>());
    }
  }
  return points;
}

}  // namespace pingvox::bench
