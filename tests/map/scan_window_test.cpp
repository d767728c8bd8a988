#include "pingvox/map/scan_window.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <set>
#include <vector>

#include "map/kernels/words.hpp"
#include "map/tree_order.hpp"
#include "pingvox/map/log_odds.hpp"
#include "pingvox/map/scan_update.hpp"
#include "support/lanes.hpp"

namespace pingvox::detail {
namespace {

// Kills a bit of z that is taken along, and levels that change places or are cut off.
TEST(ScanWindow, PlacesInALayerHaveNoZ) {
  std::mt19937_64 random(1);
  for (int n = 0; n < 1'000; ++n) {
    const auto x = static_cast<std::uint16_t>(random()), y = static_cast<std::uint16_t>(random());
    const std::uint64_t flat = without_z(code_of(Key{x, y, static_cast<std::uint16_t>(random())}));
    for (unsigned level = 0; level < 16; ++level) {
      ASSERT_EQ(flat >> (2 * level) & 1U, x >> level & 1U);
      ASSERT_EQ(flat >> (2 * level + 1) & 1U, y >> level & 1U);
    }
    ASSERT_EQ(flat >> 32, 0U);
  }
}

// Kills cells at another height, or of another quarter of the page; marks of before that are lost; a brick that is not
// told; words that are not emptied.
TEST(ScanWindow, CellsOfALayerGetTheirPlacesInThePage) {
  for (std::uint64_t seed = 1; seed <= 1'000; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    std::array<std::uint64_t, 4> layer{};
    std::array<std::uint64_t, 64> before{}, expected{};
    for (std::uint64_t& word : layer) word = seed % 3 == 0 ? random() : random() & random() & random();
    if (seed % 4 == 0) layer[random() % 4] = 0;
    for (std::uint64_t& word : before) word = random() % 4 == 0 ? random() : 0;
    expected = before;
    const std::uint64_t z = spread_bits(seed % 16) << 2;
    std::uint64_t used = 0;
    for (std::uint64_t y = 0; y < 16; ++y) {
      for (std::uint64_t x = 0; x < 16; ++x) {
        const std::uint64_t cell = spread_bits(x) | spread_bits(y) << 1 | z, flat = without_z(cell);
        if ((layer[flat / 64] >> (flat % 64) & 1U) == 0) continue;
        expected[cell / 64] |= std::uint64_t{1} << (cell % 64);
        used |= std::uint64_t{1} << (cell / 64);
      }
    }
    // Bits of z above the page's, of which there are some in a window, mean nothing here.
    const std::uint64_t in_window = z | spread_bits(random() % 128) << 14;
    for (const Lanes lanes : lanes_here()) {
      std::array<std::uint64_t, 4> from = layer;
      std::array<std::uint64_t, 64> to = before;
      ASSERT_EQ(take_layer(from.data(), in_window, to.data(), lanes), used);
      ASSERT_EQ(to, expected);
      ASSERT_EQ(from, (std::array<std::uint64_t, 4>{}));
    }
  }
}

// Kills pages of a layer that are passed by, in corners of the window most of all, and pages at another height; a byte
// that forgets its other bits.
TEST(ScanWindow, PagesWithMarksInTheLayerAreTouched) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const int bits = 4 + static_cast<int>(seed % 4);
    ScanWindow window;
    window.open(bits);
    const std::uint64_t edge = std::uint64_t{1} << bits;
    const std::uint64_t z = spread_bits(seed % 3 == 0 ? edge - 1 : random() % edge) << 2;
    std::set<std::uint64_t> expected;
    for (auto n = random() % 20; n > 0; --n) {
      const std::uint64_t x = n % 5 == 0 ? edge - 1 : random() % edge, y = n % 7 == 0 ? edge - 1 : random() % edge;
      const std::uint64_t place = spread_bits(x) | spread_bits(y) << 1 | z;
      window.layer()[without_z(place) / 64] |= std::uint64_t{1} << (without_z(place) % 64);
      if (random() % 2 == 0) mark_place(place, window.missed(), window.touched());
      expected.insert(place >> ScanWindow::kPageCellBits);
    }
    const std::vector<std::uint8_t> before(window.touched(), window.touched() + window.pages());
    window.touch_layer();  // there is none yet
    ASSERT_TRUE(std::equal(before.begin(), before.end(), window.touched()));
    window.layer_z() = z;
    window.touch_layer();
    for (std::uint64_t page = 0; page < window.pages(); ++page) {
      ASSERT_EQ(window.touched()[page], before[page] | (expected.count(page) != 0 ? ScanWindow::kInLayer : 0));
    }
  }
}

// Kills marks of a scan that was given up in the next one.
TEST(ScanWindow, LeavesNothingWhenItIsDropped) {
  ScanUpdate scan;
  ScanWindow& window = scan.window(5);
  mark_place(77, window.missed(), window.touched());
  mark_hit(4097, window);
  window.layer()[2] = 1;
  window.layer_z() = 0;
  scan.drop_window();
  EXPECT_FALSE(scan.window(5).layer_z());
  scan.take_window({}, LogOdds(0.85F));
  EXPECT_TRUE(scan.empty());
}

}  // namespace
}  // namespace pingvox::detail
