#include "cloud/scan_window.hpp"

#include <gtest/gtest.h>

#include <map>

namespace pingvox::detail {
namespace {

std::map<std::uint64_t, bool> take_all(ScanWindow& window) {
  std::map<std::uint64_t, bool> pages;
  window.take_touched([&](std::uint64_t page, bool has_hits) { EXPECT_TRUE(pages.emplace(page, has_hits).second); });
  return pages;
}

// Kills a page that is passed by or told twice, one that is still told in the next scan, and hits of no page.
TEST(ScanWindow, TouchedPagesAreTakenOnce) {
  ScanWindow window;
  for (const int bits : {4, 6, 5}) {
    SCOPED_TRACE(bits);
    window.open(bits);
    const std::uint64_t last = (std::uint64_t{1} << (3 * bits)) - 1;
    EXPECT_TRUE(window.mark_hit(last));
    EXPECT_FALSE(window.mark_hit(last)) << "it was marked before";
    EXPECT_TRUE(window.mark_hit(last - 1));
    std::map<std::uint64_t, bool> expected{{last >> ScanWindow::kPageCellBits, true}};
    if (bits > 4) {
      window.touched()[3] = 1;
      expected.emplace(3, false);
    }
    EXPECT_EQ(take_all(window), expected);
    EXPECT_TRUE(take_all(window).empty());
    EXPECT_EQ(window.hit()[last / 64], std::uint64_t{3} << 62);
    window.hit()[last / 64] = 0;
  }
}

// Kills a hit that only told which cells were found, and then becomes one of the map.
TEST(ScanWindow, HitsAreForgotten) {
  ScanWindow window;
  window.open(5);
  const std::array<std::uint64_t, 3> places{0, 77, 32767};
  for (const std::uint64_t place : places) EXPECT_TRUE(window.mark_hit(place));
  window.clear_hits(places);
  EXPECT_TRUE(take_all(window).empty());
  for (const std::uint64_t place : places) EXPECT_TRUE(window.mark_hit(place));
}

// Kills marks of a scan that was given up in the next one.
TEST(ScanWindow, LeavesNothingWhenItIsDropped) {
  ScanWindow window;
  window.open(5);
  window.mark_hit(4097);
  window.missed()[5] = 1;
  window.drop();
  window.open(5);
  EXPECT_TRUE(take_all(window).empty());
  EXPECT_EQ(window.missed()[5], 0U);
  EXPECT_EQ(window.hit()[4097 / 64], 0U);
}

}  // namespace
}  // namespace pingvox::detail
