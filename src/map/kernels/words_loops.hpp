// The loop over words, included by words.cpp once for each kind of machine (see ray_lanes_loops.hpp).

#include "map/kernels/doubles_loops.hpp"

inline std::uint64_t words_in_use(const std::uint64_t* words) {
  Words bits{}, used{};
  for (std::size_t l = 0; l < kLanes; ++l) bits[l] = std::int64_t{1} << l;
  for (std::size_t first = 0; first < 64; first += kLanes) {
    Words some;
    std::memcpy(&some, words + first, sizeof some);
    used |= (some != 0) & bits;
    bits <<= kLanes;
  }
  std::int64_t all = 0;
  for (std::size_t l = 0; l < kLanes; ++l) all |= used[l];
  return static_cast<std::uint64_t>(all);
}
