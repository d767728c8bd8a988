#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pingvox/sonar/polar_image.hpp"
#include "sonar/bin_window.hpp"

namespace pingvox {

/// How many beams to either side decide about the edges of one: the link, the thinning and the gradient.
std::size_t canny_reach_beams(const CannyOptions& options);

/// The nearest rising edge of each beam.
/// @param strong  of each beam: the gradient that a strong edge exceeds
std::vector<std::optional<std::size_t>> first_edges(const PolarImage& image, const std::vector<BinWindow>& windows,
                                                    const std::vector<int>& strong, const CannyOptions& options);

}  // namespace pingvox
