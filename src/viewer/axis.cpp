#include "viewer/axis.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "viewer/colours.hpp"
#include "viewer/label.hpp"

namespace pingvox {
namespace {

std::vector<Tick> linear_ticks(const AxisScale& scale, std::size_t most) {
  const double low = std::min(scale.at_start, scale.at_end), high = std::max(scale.at_start, scale.at_end);
  const double span = high - low;
  if (!std::isfinite(span) || !(span > 0.0) || span < 1e-12 * std::max(std::abs(low), std::abs(high))) return {};
  const double step = round_length_above(span / static_cast<double>(most));
  if (!(step > 0.0) || !std::isfinite(step)) return {};
  // Enough digits to distinguish neighbours.
  const double places = std::log10(std::max(std::abs(low), std::abs(high)) / step);
  const int digits = std::clamp(static_cast<int>(std::ceil(places)) + 1, 6, 15);
  std::vector<Tick> ticks;
  const double first = std::ceil(low / step - 1e-9);
  for (double n = first; n * step <= high + 1e-9 * span && ticks.size() <= most + 1; ++n) {
    const double value = n == 0.0 ? 0.0 : n * step;  // no "-0"
    ticks.push_back({scale.share_of(value), fmt::format("{:.{}g}", value, digits)});
  }
  return ticks;
}

std::vector<Tick> logarithmic_ticks(const AxisScale& scale, std::size_t most) {
  const double low = std::log10(std::min(scale.at_start, scale.at_end));
  const double high = std::log10(std::max(scale.at_start, scale.at_end));
  std::vector<Tick> ticks;
  if (!std::isfinite(low) || !std::isfinite(high)) return ticks;
  const auto add = [&](double value) {
    const double exponent = std::log10(value);
    if (exponent >= low - 1e-9 && exponent <= high + 1e-9) ticks.push_back({scale.share_of(value), length_text(value)});
  };
  const auto powers = static_cast<std::size_t>(std::max(0.0, high - low)) + 1;
  const int skip = static_cast<int>(powers / std::max<std::size_t>(most, 1)) + 1;
  const int last = static_cast<int>(std::floor(high + 1e-9));
  for (int power = static_cast<int>(std::floor(low)); power <= last; power += skip) {
    add(std::pow(10.0, power));
    // Few powers leave room for ticks between them.
    if (2 * powers < most) add(2.0 * std::pow(10.0, power));
    if (2 * powers < most) add(5.0 * std::pow(10.0, power));
  }
  return ticks;
}

std::ptrdiff_t place_of(const Area& area, const Tick& tick) {
  return area.x + static_cast<std::ptrdiff_t>(std::lround(tick.share * static_cast<double>(area.width)));
}

/// Whether the labels of two neighbours overlap.
bool do_touch(const Area& area, const std::vector<Tick>& ticks) {
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    const std::ptrdiff_t wide =
        (label_width(ticks[i - 1].text, kTextScale) + label_width(ticks[i].text, kTextScale)) / 2;
    if (std::abs(place_of(area, ticks[i]) - place_of(area, ticks[i - 1])) < wide + kGap) return true;
  }
  return false;
}

}  // namespace

double AxisScale::share_of(double value) const {
  // Halves and differences of logarithms, so that the difference of very large numbers does not overflow.
  const auto place = [this](double number) { return spacing == Spacing::kLinear ? 0.5 * number : std::log(number); };
  const double share = (place(value) - place(at_start)) / (place(at_end) - place(at_start));
  return std::isfinite(share) ? share : 0.0;
}

std::vector<Tick> ticks_of(const AxisScale& scale, std::size_t most) {
  return scale.spacing == Spacing::kLinear ? linear_ticks(scale, most) : logarithmic_ticks(scale, most);
}

std::ptrdiff_t left_axis_width(const std::vector<Tick>& ticks) {
  std::ptrdiff_t widest = 0;
  for (const Tick& tick : ticks) widest = std::max(widest, label_width(tick.text, kTextScale));
  return kTick + kGap + widest + kGap + kTextScale * kLetterHeight + kGap;
}

void draw_centred(Picture& picture, std::ptrdiff_t x, std::ptrdiff_t y, std::string_view text, Rgb colour) {
  draw_label(picture, x - label_width(text, kTextScale) / 2 + 1, y, text, kTextScale, colour);
}

void draw_bottom_axis(Picture& picture, const Area& area, const std::vector<Tick>& ticks, std::string_view title) {
  constexpr std::ptrdiff_t kRow = kTextScale * kLetterHeight;
  const std::ptrdiff_t below = area.bottom() + 2;
  const std::ptrdiff_t rows = do_touch(area, ticks) ? 2 : 1;
  std::ptrdiff_t row = 0;
  for (const Tick& tick : ticks) {
    const std::ptrdiff_t x = place_of(area, tick);
    picture.fill(x - 1, below, 2, kTick, kInk);
    draw_centred(picture, x, below + kTick + kGap + row * kRow, tick.text, kInk);
    row = (row + 1) % rows;
  }
  draw_centred(picture, area.x + area.width / 2, below + kTick + kGap + (rows == 1 ? kRow + kGap : rows * kRow), title,
               kInk);
}

void draw_left_axis(Picture& picture, const Area& area, const std::vector<Tick>& ticks, std::string_view title) {
  for (const Tick& tick : ticks) {
    const auto y =
        area.bottom() - static_cast<std::ptrdiff_t>(std::lround(tick.share * static_cast<double>(area.height)));
    picture.fill(area.x - 2 - kTick, y - 1, kTick, 2, kInk);
    draw_label(picture, area.x - 2 - kTick - kGap - label_width(tick.text, kTextScale), y - 7, tick.text, kTextScale,
               kInk);
  }
  const std::ptrdiff_t y = area.y + (area.height + label_width(title, kTextScale)) / 2;
  draw_label(picture, area.x - left_axis_width(ticks), y, title, kTextScale, kInk, Reads::kUpwards);
}

void draw_scale_bar(Picture& picture, std::ptrdiff_t x, std::ptrdiff_t top, const BarScale& scale,
                    std::string_view note) {
  if (!std::isfinite(scale.metres_per_px * scale.most_px)) return;
  const double length_m = round_length(scale.metres_per_px * scale.most_px);
  const auto bar = static_cast<std::ptrdiff_t>(std::lround(length_m / scale.metres_per_px));
  picture.fill(x, top + 8, bar, 3, kInk);
  picture.fill(x, top + 2, 3, 15, kInk);
  picture.fill(x + bar - 3, top + 2, 3, 15, kInk);
  draw_label(picture, x + bar + kGap, top + 2, fmt::format("{} m{}", length_text(length_m), note), kTextScale, kInk);
}

}  // namespace pingvox
