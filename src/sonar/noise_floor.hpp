#pragma once

#include <algorithm>
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

  /// Before the window, the floor where it begins. REQUIRES a bin before the window's end.
  int at(std::size_t bin) const {
    return rises_[(std::max(bin, window_.begin) - window_.begin) * rises_.size() / (window_.end - window_.begin)];
  }

  /// Half as high, for means of beams.
  NoiseFloor half() const {
    NoiseFloor lower = *this;
    for (int& rise : lower.rises_) rise = (rise + 1) / 2;
    return lower;
  }

 private:
  BinWindow window_;
  std::vector<int> rises_;
};

/// What is heard in one part of a beam.
struct BeamPart {
  double noise = 0.0;
  int rise = 0;  ///< the largest that ends in it
};

/// That of each beam: 12 times the noise at that range, and none where a quarter of the beams around, at least, rise by
/// 11 times the noise at about that range: there is a wall.
class NoiseFloors {
 public:
  /// Keeps references to both.
  NoiseFloors(const PolarImage& image, const std::vector<BinWindow>& windows);

  NoiseFloor of(std::size_t beam) const;

 private:
  const PolarImage& image_;
  const std::vector<BinWindow>& windows_;
  std::vector<std::vector<BeamPart>> heard_;  ///< of each beam; empty: its window is
};

}  // namespace pingvox
