#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>

#include "web/page_columns.hpp"

namespace pingvox::test {

/// Knows the cells of a map that grows by what is told of its changes (docs/view.md).
class FollowingClient {
 public:
  /// Takes `map/0/cells` or `map/0/changes`.
  void take(std::span<const std::uint8_t> bytes) {
    NumberReader in(bytes);
    EXPECT_EQ(in.take<std::uint32_t>(), 0x43585650U);
    const auto bricks = in.take<std::uint32_t>(), cells = in.take<std::uint32_t>();
    version_ = in.take<std::uint32_t>();
    in.take<std::uint64_t>();
    const bool is_part = in.take<std::uint32_t>() == 1;
    in.take<std::uint32_t>();
    if (!is_part) cells_.clear();
    const auto x = in.take<std::int32_t>(bricks), y = in.take<std::int32_t>(bricks), z = in.take<std::int32_t>(bricks);
    const auto low = in.take<std::uint32_t>(bricks), high = in.take<std::uint32_t>(bricks);
    const auto probability = in.take<std::uint8_t>(cells);
    std::size_t next = 0;
    for (std::size_t b = 0; b < bricks; ++b) {
      EXPECT_TRUE(is_part || low[b] != 0 || high[b] != 0) << "an empty brick";
      for (std::int64_t bit = 0; bit < 64; ++bit) {
        const CellIndex cell{4 * std::int64_t{x[b]} + bit % 4, 4 * std::int64_t{y[b]} + bit / 4 % 4,
                             4 * std::int64_t{z[b]} + bit / 16};
        cells_.erase(cell);
        const std::uint32_t word = bit < 32 ? low[b] : high[b];
        if ((word >> (bit % 32) & 1) != 0) cells_[cell] = probability.at(next++);
      }
    }
    EXPECT_EQ(next, cells);
    bricks_taken_ = bricks;
  }

  std::uint32_t version() const { return version_; }
  std::size_t bricks_taken() const { return bricks_taken_; }  ///< last time
  const std::map<CellIndex, int>& cells() const { return cells_; }

 private:
  std::uint32_t version_ = 0;
  std::size_t bricks_taken_ = 0;
  std::map<CellIndex, int> cells_;
};

}  // namespace pingvox::test
