#include "map/kernels/brick.hpp"

#include <array>
#include <cstddef>
#include <cstring>
#include <limits>

namespace pingvox::detail {
namespace {

// 16 bytes at a time, which each x86-64 and ARM64 machine has.
#define PINGVOX_LOOPS "map/kernels/brick_loops.hpp"
#include "map/kernels/each_machine.hpp"

}  // namespace

bool add_alike(BrickRef brick, std::uint64_t cells, float evidence, const Clamp& clamp, Lanes lanes) {
  PINGVOX_BY_LANES(lanes, add_alike(brick, cells, evidence, clamp), plain::add_alike(brick, cells, evidence, clamp));
}
float highest_of(BrickView brick, Lanes lanes) {
  PINGVOX_BY_LANES(lanes, highest_of(brick), plain::highest_of(brick));
}
bool are_equal(BrickView brick, Lanes lanes) {
  PINGVOX_BY_LANES(lanes, are_equal(brick), plain::are_equal(brick));
}
std::uint64_t cells_from(BrickView brick, float threshold, Lanes lanes) {
  PINGVOX_BY_LANES(lanes, cells_from(brick, threshold), plain::cells_from(brick, threshold));
}

}  // namespace pingvox::detail
