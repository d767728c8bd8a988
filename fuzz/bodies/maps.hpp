#pragma once

#include <zlib.h>

#include <bit>
#include <cstdint>
#include <span>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "fuzz/bodies/require.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/map/for_each_leaf.hpp"

namespace pingvox::fuzz {

/// All that a map holds, bit for bit.
inline std::vector<std::tuple<WideKey, int, std::uint32_t>> leaves_in(const OccupancyMap& map) {
  std::vector<std::tuple<WideKey, int, std::uint32_t>> leaves;
  for_each_leaf(map, [&](const Leaf& leaf) {
    leaves.emplace_back(leaf.key, leaf.depth, std::bit_cast<std::uint32_t>(leaf.belief.value()));
  });
  return leaves;
}

/// Any bytes as a map: what is read takes memory in proportion, and is written and read back equal.
/// @return how many maps were read
inline std::size_t maps(std::span<const std::uint8_t> bytes) {
  const auto read = read_map({"fuzzed", {bytes.begin(), bytes.end()}});
  if (!read) {
    const std::string& message = read.error().message;
    require(message.starts_with("fuzzed") && message.find('\n') == std::string::npos,
            "an error is one line and names the file");
    return 0;
  }
  // A brick for each inner node of two bytes is the most that there can be.
  require(read->map.memory_bytes() <= 4096 + bytes.size() / 2 * sizeof(detail::Brick), "memory is in proportion");

  std::ostringstream out;
  require(write_map(read->map, read->format, read->made_by, out).has_value(), "what is read is written");
  const std::string written = out.str();
  const auto back = read_map({"written", {written.begin(), written.end()}});
  require(back.has_value(), "what is written is read");
  require(back->format == read->format && back->made_by == read->made_by, "what the file says comes back");
  const MapOptions &a = read->map.options(), &b = back->map.options();
  require(a.resolution_m == b.resolution_m && a.depth == b.depth && a.parents == b.parents, "the lattice comes back");
  require(a.clamp.lowest == b.clamp.lowest && a.clamp.highest == b.clamp.highest &&
              a.thresholds.lower == b.thresholds.lower && a.thresholds.upper == b.thresholds.upper,
          "the options come back");
  require(leaves_in(read->map) == leaves_in(back->map), "each leaf comes back");
  return 1;
}

/// The same, and again with a valid checksum, to reach the code behind its check.
inline std::size_t pvx(std::span<const std::uint8_t> bytes) {
  const std::size_t as_is = maps(bytes);
  if (bytes.size() < 4) return as_is;
  std::vector<std::uint8_t> fixed(bytes.begin(), bytes.end());
  const std::size_t end = fixed.size() - 4;
  const auto crc = static_cast<std::uint32_t>(crc32_z(crc32_z(0, nullptr, 0), fixed.data(), end));
  for (std::size_t i = 0; i < 4; ++i) fixed[end + i] = static_cast<std::uint8_t>(crc >> (8 * i));
  return as_is + maps(fixed);
}

}  // namespace pingvox::fuzz
