#pragma once

#include <span>
#include <string>
#include <string_view>

#include "pingvox/result.hpp"
#include "pingvox/viewer/picture.hpp"

namespace pingvox {

/// One of several pictures in a picture.
struct Panel {
  Picture picture;
  std::string caption;  ///< stands below it, in as many lines as it takes; ASCII, may be empty
};

/// Panels in rows, as many beside each other as can be read on a screen, rows as equal as can be; a title on top unless
/// it is empty. @return kLimit when they do not fit into Picture::kMaxSide, kBadOption when there are none
Result<Picture> side_by_side(std::span<const Panel> panels, std::string_view title = {});

}  // namespace pingvox
