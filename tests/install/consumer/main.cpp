// A project outside of the tree that uses an installed pingvox.
#include <cstdio>
#include <pingvox/map/occupancy_map.hpp>
#include <pingvox/sonar/beam.hpp>

int main() {
  pingvox::OccupancyMap map(pingvox::MapOptions{.resolution_m = 0.1});
  const auto key = map.lattice().key_of({1.0, 2.0, 3.0});
  if (!key) return 1;
  const auto evidence = pingvox::LogOdds::from_probability(0.7);
  map.edit().update(*key, evidence);
  const auto belief = map.at(*key);
  if (!belief || *belief != evidence) return 1;
  // Something of the layer that leans on OpenCV, so that its libraries are asked for.
  if (!pingvox::validate(pingvox::Beam{.bin_length_m = 0.05})) return 1;
  std::printf("%.2f\n", belief->probability());
  return 0;
}
