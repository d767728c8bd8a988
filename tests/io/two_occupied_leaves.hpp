#pragma once

#include "io/map_samples.hpp"

/// A map whose cloud of points is known by heart.
namespace pingvox::samples {

inline OccupancyMap map_of_two_occupied_leaves() {
  OccupancyMap map({.resolution_m = 0.5, .depth = 16});
  {
    Editor editor = map.edit();
    editor.set(Key{32768, 32768, 32768}, 16, LogOdds(1.0F));   // middle 0.25, 0.25, 0.25
    editor.set(Key{32770, 32768, 32764}, 15, LogOdds(2.0F));   // edge 1, middle 1.5, 0.5, -1.5
    editor.set(Key{32780, 32768, 32768}, 16, LogOdds(-1.0F));  // free
  }
  return map;
}

/// The header, then the points of that map: x, y, z, log-odds and edge of each, as floats.
inline Bytes cloud_of_two_occupied_leaves(std::string_view header) {
  Bytes bytes = bytes_of(header);
  const Bytes points = bytes_of_hex(
      "0000c03f 0000003f 0000c0bf 00000040 0000803f"
      "0000803e 0000803e 0000803e 0000803f 0000003f");
  bytes.insert(bytes.end(), points.begin(), points.end());
  return bytes;
}

}  // namespace pingvox::samples
