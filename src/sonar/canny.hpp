#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pingvox/sonar/polar_image.hpp"
#include "sonar/bin_window.hpp"

namespace pingvox {

/// Beams to either side that affect the edges of one beam: link, thinning and gradient.
std::size_t canny_reach_beams(const CannyOptions& options);

/// The nearest rising edge of each beam.
/// @param strong  for each beam: the gradient that a strong edge must exceed
std::vector<std::optional<std::size_t>> first_edges(const PolarImage& image, const std::vector<BinWindow>& windows,
                                                    const std::vector<int>& strong, const CannyOptions& options);

}  // namespace pingvox
