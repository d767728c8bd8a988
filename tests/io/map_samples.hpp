#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "pingvox/io/maps.hpp"
#include "pingvox/map/for_each_leaf.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "support/logs.hpp"

// Maps, and their bytes, for the tests of the readers and writers of maps.
namespace pingvox::samples {

using Bytes = std::vector<std::uint8_t>;

/// From hex digits; anything else between them is left out.
inline Bytes bytes_of_hex(std::string_view hex) {
  Bytes bytes;
  int high = -1;
  for (const char c : hex) {
    const int digit = c >= '0' && c <= '9' ? c - '0' : (c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1);
    if (digit < 0) continue;
    if (high >= 0) bytes.push_back(static_cast<std::uint8_t>(high * 16 + digit));
    high = high >= 0 ? -1 : digit;
  }
  return bytes;
}

inline Bytes to_bytes(const OccupancyMap& map, Format format, std::string_view made_by = {}) {
  std::ostringstream out;
  const auto done = write_map(map, format, made_by, out);
  EXPECT_TRUE(done) << done.error().message;
  return bytes_of(out.str());
}

inline Result<MapFile> read(Bytes bytes, std::size_t memory_limit_bytes = 0) {
  return read_map(FileBytes{"test file", std::move(bytes)}, memory_limit_bytes);
}

/// One line for each leaf: two maps hold the same, bit for bit, when these are equal.
inline std::vector<std::tuple<WideKey, int, std::uint32_t>> leaves_of(const OccupancyMap& map) {
  std::vector<std::tuple<WideKey, int, std::uint32_t>> leaves;
  for_each_leaf(map, [&](const Leaf& leaf) {
    leaves.emplace_back(leaf.key, leaf.depth, std::bit_cast<std::uint32_t>(leaf.belief.value()));
  });
  return leaves;
}

/// A random update of one cell.
struct Update {
  WideKey key;
  float log_odds = 0.0F;
};

/// Updates around the middle of a lattice: single cells, and cubes of equal ones, so that there is something to join.
inline std::vector<Update> random_updates(std::mt19937_64& random, int depth, std::size_t count) {
  const WideWord middle = WideWord{1} << (depth - 1);
  const WideWord reach = std::min<WideWord>(middle, 20);
  std::vector<Update> updates;
  while (updates.size() < count) {
    const auto word = [&] { return middle - reach + static_cast<WideWord>(random()) % (2 * reach); };
    const WideKey key{word(), word(), word()};
    const float log_odds = random() % 2 == 0 ? 0.85F : -0.4F;
    if (random() % 8 != 0 || depth < 3) {
      updates.push_back({key, log_odds});
      continue;
    }
    const int edge = random() % 4 == 0 ? 4 : 2;
    const WideWord mask = ~static_cast<WideWord>(edge - 1);
    for (int i = 0; i < edge * edge * edge; ++i) {
      const WideKey cell{(key.x & mask) + static_cast<WideWord>(i % edge),
                         (key.y & mask) + static_cast<WideWord>(i / edge % edge),
                         (key.z & mask) + static_cast<WideWord>(i / edge / edge)};
      updates.push_back({cell, log_odds});
    }
  }
  return updates;
}

inline OccupancyMap map_of(const std::vector<Update>& updates, const MapOptions& options) {
  OccupancyMap map(options);
  Editor editor = map.edit();
  for (const Update& update : updates) editor.update(update.key, LogOdds(update.log_odds));
  editor.synchronize();
  return map;
}

}  // namespace pingvox::samples
