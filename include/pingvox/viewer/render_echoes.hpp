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
  std::size_t target_px = 1000;  ///< about as wide is the image without its axes, 16..3072
  double gamma = 0.5;            ///< lightness is (intensity / 255)^gamma: below 1 faint echoes show better; > 0
  Rgb echo{255, 128, 0};         ///< of the marks
  Rgb nothing{176, 182, 190};    ///< where no beam reaches

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// What was heard, in polar coordinates (paper, figure 3): a row for each beam, the first on top, range to the right,
/// brighter where it was louder, with a mark on each echo. Few beams become rows several pixels high; of many, a few
/// share a row, which shows the loudest of them, and each of their echoes. The beams are numbered at the left, their
/// bearings written at the right.
/// @param beams   a log or one sweep
/// @param echoes  one for each beam, or none at all: then nothing is marked
/// REQUIRES valid options, beams that validate, echoes.size() == beams.size() or 0
Picture render_echoes(std::span<const Beam> beams, std::span<const std::optional<Echo>> echoes,
                      const EchoPictureOptions& options = {});

}  // namespace pingvox
