#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "pingvox/sonar/detect_echo.hpp"

namespace pingvox {

/// Ratio to the noise (root mean square, or the ordered bin) that the wanted fraction of bins of Rayleigh noise
/// exceeds. REQUIRES valid options.
double cfar_scale(const CfarOptions& options);

/// The first rising bin that is at least `scale` times the noise of its training bins, and `least` above it.
/// @param bins  the window of the beam; also the only training bins
std::optional<std::size_t> first_above_noise(std::span<const std::uint8_t> bins, double scale, double least,
                                             const CfarOptions& options);

}  // namespace pingvox
