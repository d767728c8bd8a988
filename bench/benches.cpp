#include <array>

#include "accuracy/accuracy.hpp"
#include "bench.hpp"
#include "speed/cube.hpp"
#include "speed/scans.hpp"

namespace pingvox::bench {

std::span<const Bench> benches() {
  static constexpr std::array kBenches = {
      Bench{"cube-each", "the paper's cube, parents right and pruned after each update", Family::kSpeed, &cube_each},
      Bench{"cube-lazy", "the paper's cube as one batch, settled and pruned at its end", Family::kSpeed, &cube_lazy},
      Bench{"tank-2d", "28 sweeps in a tank as scans of rays, cells of 1.25 cm", Family::kSpeed, &tank_2d},
      Bench{"tank-3d", "3 sweeps, each beam a bundle of 32 x 64 rays, cells of 5 cm", Family::kSpeed, &tank_3d},
      Bench{"tank-3d-cells", "the same, end points made cells first", Family::kSpeed, &tank_3d_cells},
      Bench{"tank-fine", "one sweep of bundles in cells of 1.25 cm", Family::kSpeed, &tank_fine},
      Bench{"accuracy", "echoes and maps of simulated recordings, held against what is true", Family::kAccuracy,
            &accuracy},
  };
  return kBenches;
}

}  // namespace pingvox::bench
