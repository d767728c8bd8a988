#pragma once

#include <cstddef>
#include <vector>

#include "pingvox/sonar/polar_image.hpp"
#include "sonar/bin_window.hpp"

namespace pingvox {

/// How far an echo of one beam must rise to stand out of the noise: noise grows with the range, as the gain does.
class NoiseFloor {
 public:
  /// @param rises  of equal parts of the window, at least one
  NoiseFloor(BinWindow window, std::vector<int> rises) : window_(window), rises_(std::move(rises)) {}

  /// REQUIRES a bin of the window.
  int at(std::size_t bin) const {
    return rises_[(bin - window_.begin) * rises_.size() / (window_.end - window_.begin)];
  }

 private:
  BinWindow window_;
  std::vector<int> rises_;
};

/// That of each beam: 12 times the noise at that range, and none where a quarter of the beams around, at least, rise by
/// 11 times the noise at about that range: there is a wall.
std::vector<NoiseFloor> noise_floors(const PolarImage& image, const std::vector<BinWindow>& windows);

}  // namespace pingvox
