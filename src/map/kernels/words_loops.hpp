// The loops over words, included by words.cpp once for each kind of machine (see ray_lanes_loops.hpp).

#include "map/kernels/doubles_loops.hpp"

/// Calls f(first) for kLanes words each, which gives them in its second argument. @return the bits of those in use
template <class F>
inline std::uint64_t used_of(F&& f) {
  Words bits{}, used{};
  for (std::size_t l = 0; l < kLanes; ++l) bits[l] = std::int64_t{1} << l;
  for (std::size_t first = 0; first < 64; first += kLanes) {
    Words some;
    f(first, some);
    used |= (some != 0) & bits;
    bits <<= kLanes;
  }
  std::int64_t all = 0;
  for (std::size_t l = 0; l < kLanes; ++l) all |= used[l];
  return static_cast<std::uint64_t>(all);
}

inline std::uint64_t words_in_use(const std::uint64_t* words) {
  return used_of([&](std::size_t first, Words& some) { std::memcpy(&some, words + first, sizeof some); });
}

inline std::uint64_t move_words(std::uint64_t* from, std::uint64_t* to) {
  return used_of([&](std::size_t first, Words& some) {
    Words together;
    std::memcpy(&some, from + first, sizeof some);
    std::memcpy(&together, to + first, sizeof together);
    together |= some;
    std::memcpy(to + first, &together, sizeof together);
    together = Words{};
    std::memcpy(from + first, &together, sizeof together);
  });
}

inline std::uint64_t take_layer(std::uint64_t* from, std::uint64_t z, std::uint64_t* to) {
  using Bricks = std::uint64_t __attribute__((vector_size(32)));  // those of a word, 4 by 4 cells each
  constexpr std::uint64_t kBrickZ = 0b100100;                     // of a cell in its brick, and of a brick in its page
  const auto cell_z = static_cast<int>(z & kBrickZ);
  std::uint64_t* const bricks = to + (z >> 6 & kBrickZ);
  Bricks used{};
  for (std::size_t w = 0; w < 4; ++w) {
    Bricks cells = ((Bricks{} + std::exchange(from[w], 0)) >> Bricks{0, 16, 32, 48}) & 0xFFFF, together;
    used |= (cells != 0) & (Bricks{1, 2, 4, 8} << static_cast<int>(8 * w));
    // Each four bits leave room for the four at another height.
    cells = (cells | cells << 8) & 0x00FF00FF;
    cells = (cells | cells << 4) & 0x0F0F0F0F;
    std::memcpy(&together, bricks + 8 * w, sizeof together);
    together |= cells << cell_z;
    std::memcpy(bricks + 8 * w, &together, sizeof together);
  }
  return (used[0] | used[1] | used[2] | used[3]) << (bricks - to);
}

inline std::uint64_t count_cells(const std::uint64_t* words) {
  UnsignedWords quarters{};  // sums of 16 bits: there are 4096 bits in all
  for (std::size_t first = 0; first < 64; first += kLanes) {
    UnsignedWords some;
    std::memcpy(&some, words + first, sizeof some);
    some -= some >> 1 & 0x5555555555555555;
    some = (some & 0x3333333333333333) + (some >> 2 & 0x3333333333333333);
    some = (some + (some >> 4)) & 0x0F0F0F0F0F0F0F0F;
    quarters += (some + (some >> 8)) & 0x00FF00FF00FF00FF;
  }
  std::uint64_t all = 0;
  for (std::size_t l = 0; l < kLanes; ++l) all += quarters[l];
  return all * 0x0001000100010001 >> 48;
}
