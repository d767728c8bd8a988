#include <array>

#include "accuracy/accuracy.hpp"
#include "bench.hpp"
#include "speed/cube.hpp"

namespace pingvox::bench {

std::span<const Bench> benches() {
  static constexpr std::array kBenches = {
      Bench{"cube-each", "the paper's cube, parents right and pruned after each update", Family::kSpeed, &cube_each},
      Bench{"cube-lazy", "the paper's cube as one batch, settled and pruned at its end", Family::kSpeed, &cube_lazy},
      Bench{"accuracy", "echoes and maps of simulated recordings, held against what is true", Family::kAccuracy,
            &accuracy},
  };
  return kBenches;
}

}  // namespace pingvox::bench
