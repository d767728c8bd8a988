#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "pingvox/viewer/picture.hpp"
#include "viewer/strokes.hpp"

namespace pingvox {

/// Scale of an axis.
enum class Spacing { kLinear, kLogarithmic };

/// Range of an axis.
struct AxisScale {
  double at_start = 0.0;  ///< left or bottom; may be more than at_end
  double at_end = 1.0;
  Spacing spacing = Spacing::kLinear;  ///< kLogarithmic REQUIRES ends above 0

  /// Position of a value: 0 at the start, 1 at the end.
  double share_of(double value) const;
};

struct Tick {
  double share = 0.0;  ///< along the axis
  std::string text;
};

/// Round numbers along the axis, at most about `most`; none if its ends are not finite or too close together for
/// doubles.
std::vector<Tick> ticks_of(const AxisScale& scale, std::size_t most);

inline constexpr std::ptrdiff_t kTextScale = 2, kTick = 8, kGap = 6;
/// Height of a bottom axis: ticks, labels (at most two rows), a title.
inline constexpr std::ptrdiff_t kBottomAxis = 68;
/// Around a picture, and of a line of its legend.
inline constexpr std::ptrdiff_t kMargin = 24, kFooterRow = 28;

/// Width of a left axis.
std::ptrdiff_t left_axis_width(const std::vector<Tick>& ticks);

/// Ticks and labels below the area, alternating between two rows where they would overlap, and the title.
void draw_bottom_axis(Picture& picture, const Area& area, const std::vector<Tick>& ticks, std::string_view title);
/// The same left of the area, the title rotated.
void draw_left_axis(Picture& picture, const Area& area, const std::vector<Tick>& ticks, std::string_view title);

struct BarScale {
  double metres_per_px;  ///< > 0
  double most_px;        ///< length of the bar
};
/// A bar of a round length and what it is, with a note behind; nothing where the length overflows a double, as that of
/// a deep lattice may.
void draw_scale_bar(Picture& picture, std::ptrdiff_t x, std::ptrdiff_t top, const BarScale& scale,
                    std::string_view note);

/// Text centred at x.
void draw_centred(Picture& picture, std::ptrdiff_t x, std::ptrdiff_t y, std::string_view text, Rgb colour);

}  // namespace pingvox
