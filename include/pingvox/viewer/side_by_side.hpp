#pragma once

#include <span>
#include <string>
#include <string_view>

#include "pingvox/result.hpp"
#include "pingvox/viewer/picture.hpp"

namespace pingvox {

/// One picture of several.
struct Panel {
  Picture picture;
  std::string caption;  ///< below the picture, wrapped; ASCII, may be empty
};

/// Arranges panels in balanced rows no wider than a screen, below a title unless it is empty. @return kLimit when they
/// do not fit into Picture::kMaxSide, kBadOption when there are none
Result<Picture> side_by_side(std::span<const Panel> panels, std::string_view title = {});

}  // namespace pingvox
