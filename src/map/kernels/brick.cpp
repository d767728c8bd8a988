#include "map/kernels/brick.hpp"

#include <array>
#include <cstddef>
#include <cstring>
#include <limits>

namespace pingvox::detail {
namespace {

// 16 bytes at a time, which each x86-64 and ARM64 machine has.
namespace plain {
constexpr std::size_t kValues = 4;
#include "map/kernels/brick_loops.hpp"
}  // namespace plain

#ifdef PINGVOX_X86_LANES
#pragma GCC push_options
#pragma GCC target("avx2")
namespace avx2 {
constexpr std::size_t kValues = 8;
#include "map/kernels/brick_loops.hpp"
}  // namespace avx2
#pragma GCC pop_options
#pragma GCC push_options
#pragma GCC target("avx512f,avx512dq,avx512vl")
namespace avx512 {
constexpr std::size_t kValues = 16;
#include "map/kernels/brick_loops.hpp"
}  // namespace avx512
#pragma GCC pop_options
#endif

}  // namespace

bool add_alike(Brick& brick, std::uint64_t cells, float evidence, const Clamp& clamp, Lanes lanes) {
  PINGVOX_BY_LANES(lanes, add_alike(brick, cells, evidence, clamp), plain::add_alike(brick, cells, evidence, clamp));
}
float highest_of(const Brick& brick, Lanes lanes) {
  PINGVOX_BY_LANES(lanes, highest_of(brick), plain::highest_of(brick));
}
bool are_equal(const Brick& brick, Lanes lanes) {
  PINGVOX_BY_LANES(lanes, are_equal(brick), plain::are_equal(brick));
}

}  // namespace pingvox::detail
