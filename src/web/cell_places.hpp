#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstdint>
#include <optional>

#include "pingvox/geometry/key.hpp"
#include "pingvox/geometry/lattice.hpp"
#include "pingvox/map/for_each_leaf.hpp"
#include "pingvox/map/occupancy_map.hpp"

namespace pingvox::web {

inline constexpr std::int64_t kBrickEdge = 4;

/// The lowest probability that is sent, unless the map's own threshold is lower.
inline double lowest_probability(const OccupancyMap& map) {
  constexpr double kLowest = 0.4;
  return std::min(kLowest, map.options().thresholds.upper.probability());
}

/// A cell of the finest resolution, counted from the origin.
struct CellPlace {
  std::int64_t x = 0, y = 0, z = 0;

  friend auto operator<=>(const CellPlace&, const CellPlace&) = default;
};

/// Where the lowest cell of a cube of 2^levels cells is. nullopt: it, or its edge, does not fit into 32 bits.
/// @param key  of the lowest cell
inline std::optional<CellPlace> place_of(const WideKey& key, int levels, const Lattice& lattice) {
  __extension__ typedef __int128 SignedWide;
  constexpr SignedWide kFarthest = std::int64_t{1} << 31;
  constexpr int kMaxLevels = 31;
  if (levels > kMaxLevels) return std::nullopt;
  const WideWord half = WideWord{1} << (lattice.depth() - 1);
  const auto from_centre = [&](WideWord word) { return static_cast<SignedWide>(word - half); };
  const SignedWide edge = SignedWide{1} << levels;
  const std::array<SignedWide, 3> lowest = {from_centre(key.x), from_centre(key.y), from_centre(key.z)};
  for (const SignedWide cell : lowest) {
    if (cell < -kFarthest || cell + edge > kFarthest) return std::nullopt;
  }
  return CellPlace{static_cast<std::int64_t>(lowest[0]), static_cast<std::int64_t>(lowest[1]),
                   static_cast<std::int64_t>(lowest[2])};
}

/// Of a leaf.
inline std::optional<CellPlace> place_of(const Leaf& leaf) {
  return place_of(leaf.key, leaf.lattice->depth() - leaf.depth, *leaf.lattice);
}

/// Probabilities as bytes. Neighbours often have the same.
class ProbabilityByte {
 public:
  std::uint8_t of(LogOdds belief) {
    if (!last_ || *last_ != belief) byte_ = static_cast<std::uint8_t>(std::lround(belief.probability() * kHighestByte));
    last_ = belief;
    return byte_;
  }

 private:
  static constexpr double kHighestByte = 255.0;

  std::optional<LogOdds> last_;
  std::uint8_t byte_ = 0;
};

}  // namespace pingvox::web
