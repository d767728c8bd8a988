#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pingvox/viewer/chart.hpp"
#include "pingvox/viewer/picture.hpp"
#include "viewer/strokes.hpp"

namespace pingvox {

/// Numbers along one side of a picture.
struct AxisScale {
  double at_start = 0.0;  ///< left or bottom; may be more than at_end
  double at_end = 1.0;
  Spacing spacing = Spacing::kLinear;  ///< kLogarithmic REQUIRES ends above 0

  /// Where a value is: 0 at the start, 1 at the end.
  double share_of(double value) const;
};

struct Tick {
  double share = 0.0;  ///< along the axis
  std::string text;
};

/// Round numbers along the axis, at most about `most`; none when its ends are not finite, or too close together for
/// doubles to tell numbers between them.
std::vector<Tick> ticks_of(const AxisScale& scale, std::size_t most);

inline constexpr std::ptrdiff_t kTextScale = 2, kTick = 8, kGap = 6;
/// Height of what stands below an area: ticks, their texts (in two rows at most), a title.
inline constexpr std::ptrdiff_t kBottomAxis = 68;

/// Width of what stands left of an area.
std::ptrdiff_t left_axis_width(const std::vector<Tick>& ticks);

/// Ticks and their texts below the area, by turns in two rows where they would touch, and the title below them.
void draw_bottom_axis(Picture& picture, const Area& area, const std::vector<Tick>& ticks, std::string_view title);
/// The same left of the area, the title turned.
void draw_left_axis(Picture& picture, const Area& area, const std::vector<Tick>& ticks, std::string_view title);

/// Text with its middle at x.
void draw_centred(Picture& picture, std::ptrdiff_t x, std::ptrdiff_t y, std::string_view text, Rgb colour);

}  // namespace pingvox
