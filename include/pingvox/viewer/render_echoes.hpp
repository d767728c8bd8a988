#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"
#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/viewer/picture.hpp"

namespace pingvox {

struct EchoPictureOptions {
  std::size_t target_px = 1000;  ///< approximate width of the image without its axes, 16..3072
  double gamma = 0.5;            ///< lightness is (intensity / 255)^gamma: less amplifies faint echoes; > 0
  Rgb echo{255, 128, 0};         ///< of the markers
  Rgb nothing{176, 182, 190};    ///< where no beam reaches

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// Beams in polar coordinates (paper, figure 3): a row for each beam, the first on top, range to the right, brighter is
/// more intense, with a marker at each echo. With few beams, rows are several pixels high; with many, several beams
/// share a row, which shows the maximum and all echoes. Beam numbers at the left, bearings at the right.
/// @param beams   a log or one sweep
/// @param echoes  one for each beam, or empty
/// REQUIRES valid options, beams that validate, echoes.size() == beams.size() or 0
Picture render_echoes(std::span<const Beam> beams, std::span<const std::optional<Echo>> echoes,
                      const EchoPictureOptions& options = {});

}  // namespace pingvox
