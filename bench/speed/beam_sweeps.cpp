#include "beam_sweeps.hpp"

#include <algorithm>

#include "pingvox/mapping/beam_tracer.hpp"

namespace pingvox::bench {

std::vector<BeamSweep> beam_sweeps(const TankEchoes& tank, std::size_t most) {
  std::vector<BeamSweep> sweeps;
  for (const auto& sweep : std::span(tank.sweeps).first(std::min(most, tank.sweeps.size()))) {
    BeamSweep& beams = sweeps.emplace_back();
    for (const BeamEcho& echo : sweep) {
      HeardBeam& heard = beams.emplace_back();
      heard.beam.bearing_rad = echo.bearing_rad;
      heard.beam.bin_length_m = echo.range_m;
      heard.echo.first = 1;
      heard.echo.range_m = echo.range_m;
      heard.echo.intensity = echo.intensity;
    }
  }
  return sweeps;
}

void insert(OccupancyMap& map, ScanUpdate& scan, std::span<const BeamSweep> sweeps, const BeamModelOptions& model) {
  BeamTracer tracer(model);
  for (const BeamSweep& sweep : sweeps) {
    for (const HeardBeam& heard : sweep) tracer.trace(Pose::Identity(), heard.beam, heard.echo, scan);
    (void)map.apply(scan);
    scan.clear();
  }
}

}  // namespace pingvox::bench
