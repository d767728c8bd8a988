#include "draw/chart.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/option_errors.hpp"
#include "viewer/axis.hpp"
#include "viewer/colours.hpp"
#include "viewer/label.hpp"

namespace pingvox::bench {
namespace {

constexpr std::ptrdiff_t kEdge = 24, kLegendRow = 24, kSwatch = 34;

struct Style {
  Rgb colour;
  Marker marker;
};

/// Neighbours differ in lightness (L* 11, 57, 34, 78, 46, 67), readable without colour.
constexpr std::array<Style, Chart::kMaxSeries> kStyles = {{{{16, 24, 72}, Marker::kDisc},
                                                           {{222, 100, 0}, Marker::kSquare},
                                                           {{110, 50, 130}, Marker::kTriangle},
                                                           {{235, 184, 60}, Marker::kDiamond},
                                                           {{0, 116, 128}, Marker::kCross},
                                                           {{90, 172, 220}, Marker::kRing}}};

bool is_shown(double value, Spacing spacing) {
  return std::isfinite(value) && (spacing == Spacing::kLinear || value > 0.0);
}

struct Extent {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();

  void add(double value, Spacing spacing) {
    if (!is_shown(value, spacing)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  bool empty() const { return low > high; }
};

/// An axis around numbers, with round ends.
AxisScale scale_around(Extent extent, Spacing spacing) {
  if (extent.empty()) extent = {spacing == Spacing::kLinear ? 0.0 : 1.0, spacing == Spacing::kLinear ? 1.0 : 10.0};
  if (spacing == Spacing::kLogarithmic) {
    const double low = round_length(extent.low), high = round_length_above(extent.high);
    return {low, std::isfinite(high) && high > low ? high : low * 10.0, spacing};
  }
  double span = extent.high - extent.low;
  if (!(span > 1e-12 * std::max(std::abs(extent.low), std::abs(extent.high)))) {
    const double around = extent.low == 0.0 ? 1.0 : std::abs(extent.low) * 0.5;
    extent = {extent.low - around, extent.high + around};
    span = 2.0 * around;
  }
  if (!std::isfinite(span)) return {extent.low, extent.high, spacing};
  const double step = round_length(span / 4.0);
  return {std::floor(extent.low / step + 1e-9) * step, std::ceil(extent.high / step - 1e-9) * step, spacing};
}

/// Positions of the axes and the mapping of numbers to pixels.
struct Layout {
  AxisScale x, y;
  std::vector<Tick> x_ticks, y_ticks;
  Area area;

  Spot spot_of(double at_x, double at_y) const {
    return {static_cast<double>(area.x) + x.share_of(at_x) * static_cast<double>(area.width), y_of(at_y)};
  }
  double y_of(double at_y) const {
    return static_cast<double>(area.bottom()) - y.share_of(at_y) * static_cast<double>(area.height);
  }
};

std::ptrdiff_t legend_width(const Series& series) {
  return kSwatch + kGap + label_width(series.name, kTextScale) + 4 * kGap;
}

/// Legend rows as wide as the chart: first and past-the-end series of each.
std::vector<std::pair<std::size_t, std::size_t>> legend_rows(const Chart& chart) {
  std::vector<std::pair<std::size_t, std::size_t>> rows;
  std::ptrdiff_t used = 0;
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    const std::ptrdiff_t width = legend_width(chart.series[i]);
    if (rows.empty() || used + width > static_cast<std::ptrdiff_t>(chart.width) - 2 * kEdge) {
      rows.emplace_back(i, i);
      used = 0;
    }
    used += width;
    rows.back().second = i + 1;
  }
  return rows;
}

Layout layout_of(const Chart& chart) {
  Layout layout;
  Extent x, y;
  for (const Series& series : chart.series) {
    for (std::size_t i = 0; i < series.y.size(); ++i) {
      if (chart.kind == Chart::Kind::kLines) {
        if (!is_shown(series.x[i], chart.x_spacing) || !is_shown(series.y[i], chart.y_spacing)) continue;
        x.add(series.x[i], chart.x_spacing);
      }
      y.add(series.y[i], chart.y_spacing);
    }
  }
  if (chart.y_mark) y.add(*chart.y_mark, chart.y_spacing);
  if (chart.kind == Chart::Kind::kBars) y.add(0.0, chart.y_spacing);
  layout.x = scale_around(x, chart.x_spacing);
  layout.y = scale_around(y, chart.y_spacing);

  // Room for the labels of the bars.
  if (chart.kind == Chart::Kind::kBars && !y.empty()) {
    const double room = 0.06;
    if (chart.y_spacing == Spacing::kLogarithmic) {
      layout.y.at_end *= std::pow(layout.y.at_end / layout.y.at_start, room);
    } else {
      const double span = layout.y.at_end - layout.y.at_start;
      if (y.high > 0.0) layout.y.at_end += room * span;
      if (y.low < 0.0) layout.y.at_start -= room * span;
    }
  }
  // Bars that begin at the lower end of a logarithmic axis must have a length.
  if (chart.kind == Chart::Kind::kBars && chart.y_spacing == Spacing::kLogarithmic && layout.y.at_start == y.low) {
    layout.y.at_start *= 0.5;
  }
  layout.y_ticks = ticks_of(layout.y, 8);
  const std::ptrdiff_t left = kEdge + left_axis_width(layout.y_ticks);
  std::ptrdiff_t top = kEdge;
  if (!chart.title.empty()) top += kLegendRow + kGap;
  top += static_cast<std::ptrdiff_t>(legend_rows(chart).size()) * kLegendRow + 2 * kGap;
  layout.area = {left, top, static_cast<std::ptrdiff_t>(chart.width) - left - 2 * kEdge,
                 static_cast<std::ptrdiff_t>(chart.height) - top - kBottomAxis - kGap};
  if (chart.kind == Chart::Kind::kLines) {
    layout.x_ticks = ticks_of(layout.x, static_cast<std::size_t>(std::max<std::ptrdiff_t>(layout.area.width / 110, 2)));
  } else {
    const auto count = static_cast<double>(chart.categories.size());
    for (std::size_t i = 0; i < chart.categories.size(); ++i) {
      layout.x_ticks.push_back({(static_cast<double>(i) + 0.5) / count, chart.categories[i]});
    }
  }
  return layout;
}

/// A rectangle in the pattern of a series: plain or striped in one of four directions.
void fill_bar(Picture& picture, const Area& bar, std::size_t series) {
  const Rgb colour = kStyles[series].colour, pale = mix(colour, kPaper, 0.55);
  constexpr std::ptrdiff_t kPeriod = 10, kStripe = 3;
  for (std::ptrdiff_t y = bar.y; y < bar.bottom(); ++y) {
    for (std::ptrdiff_t x = bar.x; x < bar.right(); ++x) {
      // Relative to the corner, so that bars of one series look alike.
      const std::ptrdiff_t dx = x - bar.x, dy = bar.bottom() - y;
      const std::array<std::ptrdiff_t, Chart::kMaxSeries> along = {kStripe, dx + dy, dx + kPeriod * 1000 - dy,
                                                                   kStripe, dy,      dx};
      picture.set(x, y, along[series] % kPeriod < kStripe ? pale : colour);
    }
  }
  draw_frame(
      picture,
      {bar.x + 1, bar.y + 1, std::max<std::ptrdiff_t>(bar.width - 2, 0), std::max<std::ptrdiff_t>(bar.height - 2, 0)},
      1, kStyles[series].colour);
}

void draw_legend(Picture& picture, const Chart& chart, std::ptrdiff_t y) {
  for (const auto& [first, last] : legend_rows(chart)) {
    std::ptrdiff_t x = kEdge;
    for (std::size_t i = first; i < last; ++i) {
      const Style& style = kStyles[i];
      if (chart.kind == Chart::Kind::kBars) {
        fill_bar(picture, {x, y, kSwatch, 16}, i);
      } else {
        const double middle = static_cast<double>(y) + 8.0, left = static_cast<double>(x);
        draw_line(picture, {left, middle}, {left + static_cast<double>(kSwatch), middle}, 2.5, style.colour,
                  {x, y, kSwatch, 20});
        draw_marker(picture, style.marker, {left + 0.5 * static_cast<double>(kSwatch), middle}, 7.0, style.colour);
      }
      draw_label(picture, x + kSwatch + kGap, y + 1, chart.series[i].name, kTextScale, kInk);
      x += legend_width(chart.series[i]);
    }
    y += kLegendRow;
  }
}

void draw_lines(Picture& picture, const Chart& chart, const Layout& layout) {
  const Area& area = layout.area;
  const Area around{area.x - 8, area.y - 8, area.width + 16, area.height + 16};
  for (std::size_t s = 0; s < chart.series.size(); ++s) {
    const Series& series = chart.series[s];
    std::optional<Spot> before;
    std::vector<Spot> spots;
    for (std::size_t i = 0; i < series.y.size(); ++i) {
      if (!is_shown(series.x[i], chart.x_spacing) || !is_shown(series.y[i], chart.y_spacing)) {
        before.reset();
        continue;
      }
      const Spot spot = layout.spot_of(series.x[i], series.y[i]);
      if (before) draw_line(picture, *before, spot, 2.5, kStyles[s].colour, around);
      before = spot;
      spots.push_back(spot);
    }
    // As many markers as fit beside each other.
    const std::size_t every = spots.size() / 40 + 1;
    for (std::size_t i = 0; i < spots.size(); i += every) {
      draw_marker(picture, kStyles[s].marker, spots[i], 7.0, kStyles[s].colour);
    }
  }
}

void draw_bars(Picture& picture, const Chart& chart, const Layout& layout) {
  const auto groups = static_cast<std::ptrdiff_t>(chart.categories.size());
  const auto series = static_cast<std::ptrdiff_t>(chart.series.size());
  if (groups == 0 || series == 0) return;
  const std::ptrdiff_t group_px = layout.area.width / groups;
  const std::ptrdiff_t bar_px = std::clamp<std::ptrdiff_t>(group_px * 9 / 10 / series, 1, 90);
  const double ground =
      chart.y_spacing == Spacing::kLinear ? layout.y_of(0.0) : static_cast<double>(layout.area.bottom());
  for (std::ptrdiff_t g = 0; g < groups; ++g) {
    const std::ptrdiff_t middle =
        layout.area.x +
        static_cast<std::ptrdiff_t>(std::lround((static_cast<double>(g) + 0.5) *
                                                static_cast<double>(layout.area.width) / static_cast<double>(groups)));
    for (std::ptrdiff_t s = 0; s < series; ++s) {
      const double value = chart.series[static_cast<std::size_t>(s)].y[static_cast<std::size_t>(g)];
      if (!is_shown(value, chart.y_spacing)) continue;
      const std::ptrdiff_t x = middle - series * bar_px / 2 + s * bar_px;
      const double tip = layout.y_of(value);
      const auto top = static_cast<std::ptrdiff_t>(std::lround(std::min(tip, ground)));
      const auto bottom = static_cast<std::ptrdiff_t>(std::lround(std::max(tip, ground)));
      fill_bar(picture,
               {x + 1, top, std::max<std::ptrdiff_t>(bar_px - 2, 1), std::max<std::ptrdiff_t>(bottom - top, 2)},
               static_cast<std::size_t>(s));
      const std::string text = fmt::format("{:.3g}", value);
      if (label_width(text, kTextScale) + kGap <= bar_px) {
        draw_centred(picture, x + bar_px / 2, value < 0.0 ? bottom + 4 : top - 18, text, kInk);
      } else if (label_width(text, 1) <= bar_px) {
        draw_label(picture, x + (bar_px - label_width(text, 1)) / 2 + 1, value < 0.0 ? bottom + 3 : top - 10, text, 1,
                   kInk);
      }
    }
  }
}

}  // namespace

Result<void> Chart::validate() const {
  OptionErrors errors;
  errors.require_within("width", width, 320, Picture::kMaxSide);
  errors.require_within("height", height, 240, Picture::kMaxSide);
  if (series.empty() || series.size() > kMaxSeries) {
    errors.add(fmt::format("there must be 1..{} series, not {}", kMaxSeries, series.size()));
  }
  for (const Series& one : series) {
    if (kind == Kind::kLines && one.x.size() != one.y.size()) {
      errors.add(fmt::format("series '{}' has {} x for {} y", one.name, one.x.size(), one.y.size()));
    }
    if (kind == Kind::kBars && one.y.size() != categories.size()) {
      errors.add(fmt::format("series '{}' has {} values for {} categories", one.name, one.y.size(), categories.size()));
    }
  }
  return errors.result("chart");
}

Picture render_chart(const Chart& chart) {
  assert(chart.validate());
  const Layout layout = layout_of(chart);
  const Area& area = layout.area;
  Picture picture(chart.width, chart.height, kPaper);
  for (const Tick& tick : layout.y_ticks) {
    const auto y =
        area.bottom() - static_cast<std::ptrdiff_t>(std::lround(tick.share * static_cast<double>(area.height)));
    picture.fill(area.x, y - 1, area.width, 1, kPaleInk);
  }
  if (chart.kind == Chart::Kind::kLines) {
    for (const Tick& tick : layout.x_ticks) {
      const auto x = area.x + static_cast<std::ptrdiff_t>(std::lround(tick.share * static_cast<double>(area.width)));
      picture.fill(x, area.y, 1, area.height, kPaleInk);
    }
  }
  draw_frame(picture, area, 2, kInk);
  draw_bottom_axis(picture, area, layout.x_ticks, chart.x_label);
  draw_left_axis(picture, area, layout.y_ticks, chart.y_label);
  if (chart.kind == Chart::Kind::kBars) draw_bars(picture, chart, layout);
  if (chart.y_mark && is_shown(*chart.y_mark, chart.y_spacing)) {
    const auto y = static_cast<std::ptrdiff_t>(std::lround(layout.y_of(*chart.y_mark)));
    for (std::ptrdiff_t x = area.x; x < area.right(); x += 16) picture.fill(x, y - 1, 9, 2, kInk);
  }
  if (chart.kind == Chart::Kind::kLines) draw_lines(picture, chart, layout);

  std::ptrdiff_t y = kEdge;
  if (!chart.title.empty()) {
    draw_label(picture, kEdge, y, chart.title, kTextScale, kInk);
    y += kLegendRow + kGap;
  }
  draw_legend(picture, chart, y);
  return picture;
}

}  // namespace pingvox::bench
