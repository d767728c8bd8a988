#include "beam_sweeps.hpp"

#include <algorithm>

namespace pingvox::bench {

std::vector<BeamSweep> beam_sweeps(const TankEchoes& tank, std::size_t most) {
  std::vector<BeamSweep> sweeps;
  for (const auto& sweep : std::span(tank.sweeps).first(std::min(most, tank.sweeps.size()))) {
    BeamSweep& beams = sweeps.emplace_back();
    for (const BeamEcho& echo : sweep) {
      PlacedBeam& beam = beams.emplace_back();
      beam.bearing_rad = echo.bearing_rad;
      beam.bin_length_m = echo.range_m;
      beam.echo.emplace();
      beam.echo->first = 1;
      beam.echo->range_m = echo.range_m;
      beam.echo->intensity = echo.intensity;
    }
  }
  return sweeps;
}

void insert(OccupancyMap& map, ScanUpdate& scan, std::span<const BeamSweep> sweeps, const BeamModelOptions& model) {
  BeamTracer tracer(model);
  for (const BeamSweep& sweep : sweeps) {
    tracer.trace(sweep, scan);
    (void)map.apply(scan);
    scan.clear();
  }
}

}  // namespace pingvox::bench
