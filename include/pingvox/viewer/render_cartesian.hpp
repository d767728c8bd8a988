#pragma once

#include <optional>
#include <span>

#include "pingvox/result.hpp"
#include "pingvox/sonar/cartesian_image.hpp"
#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/polar_image.hpp"
#include "pingvox/sonar/sweep.hpp"
#include "pingvox/viewer/picture.hpp"
#include "pingvox/viewer/render_echoes.hpp"

namespace pingvox {

struct CartesianPictureOptions {
  EchoPictureOptions style;  ///< its target_px is the width and the height of the image
  BetweenBeams between = BetweenBeams::kInterpolate;
  double beam_width_rad = CartesianOptions{}.beam_width_rad;

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// One sweep seen from above (paper, figures 2 and 4): ahead (x) is up, left (y) is left, brighter is more intense,
/// with markers at the echoes, range rings, and bearings counter-clockwise from ahead.
/// @param image   the sweep's image, filtered or not
/// @param echoes  one for each beam, or empty
/// REQUIRES valid options, image.rows() == sweep.beams.size(), echoes.size() the same or 0
Picture render_cartesian(const Sweep& sweep, const PolarImage& image, std::span<const std::optional<Echo>> echoes,
                         const CartesianPictureOptions& options = {});

}  // namespace pingvox
