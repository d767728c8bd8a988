#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pingvox/sonar/polar_image.hpp"
#include "sonar/bin_window.hpp"

namespace pingvox {

/// Contrast of each beam: the rise of intensity that makes an echo at the beam's gain. Half of the upper quartile of
/// the largest rises of the beams around, about 70 in the paper's recording. If that quartile is below 9.7 times the
/// noise (median difference of bins six apart), or the median rise below 8.5 times, most beams hold only noise, and the
/// contrast is 15 times the noise. At least 14.
class Contrasts {
 public:
  /// Keeps a reference to the image.
  Contrasts(const PolarImage& image, const std::vector<BinWindow>& windows);

  int of(std::size_t beam) const;

 private:
  /// Signal and noise of one beam.
  struct Loudness {
    int rise;      ///< the largest
    double noise;  ///< of the noisy part of the beam
  };

  const PolarImage& image_;
  std::vector<std::optional<Loudness>> heard_;  ///< nullopt: its window is empty
};

}  // namespace pingvox
