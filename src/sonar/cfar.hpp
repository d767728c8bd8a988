#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "pingvox/sonar/detect_echo.hpp"

namespace pingvox {

/// How many times the noise (as a root mean square, or the ordered bin) a bin must be so that the wanted share of bins
/// of Rayleigh noise passes. REQUIRES valid options.
double cfar_scale(const CfarOptions& options);

/// The first rising bin that is `scale` times the noise of its training bins, and stands `least` above it.
/// @param bins  those that are evidence; they alone are trained on
std::optional<std::size_t> first_above_noise(std::span<const std::uint8_t> bins, double scale, double least,
                                             const CfarOptions& options);

}  // namespace pingvox
