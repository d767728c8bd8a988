#include "pingvox/viewer/render_cartesian.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "pingvox/geometry/degree.hpp"
#include "viewer/axis.hpp"
#include "viewer/colours.hpp"
#include "viewer/echo_legend.hpp"
#include "viewer/label.hpp"
#include "viewer/strokes.hpp"

namespace pingvox {
namespace {

constexpr std::ptrdiff_t kRim = 44, kMinWidth = 400;
constexpr Rgb kRing{110, 170, 220};

/// Position of the head and the largest range in the picture.
struct Disc {
  Spot middle;
  double radius_px = 0.0, range_m = 0.0;

  Spot spot_at(double range, double bearing_rad) const {
    const double px = range / range_m * radius_px;
    return {middle.x - px * std::sin(bearing_rad), middle.y - px * std::cos(bearing_rad)};
  }
};

/// Range of the beams by direction, to distinguish silence from directions without a beam.
class Reach {
 public:
  Reach(const Sweep& sweep, double reach_rad) : range_m_(kDirections, 0.0) {
    const double half = reach_rad / kStep_rad;
    for (const Beam& beam : sweep.beams) {
      const double range_m = static_cast<double>(beam.intensities.size()) * beam.bin_length_m;
      const double middle = beam.bearing_rad / kStep_rad;
      for (double n = std::ceil(middle - half); n <= middle + half; ++n) {
        double& there = range_m_[direction(n)];
        there = std::max(there, range_m);
      }
    }
  }

  bool contains(double x_m, double y_m) const {
    return std::hypot(x_m, y_m) <= range_m_[direction(std::round(std::atan2(y_m, x_m) / kStep_rad))];
  }

 private:
  static constexpr std::size_t kDirections = 7200;
  static constexpr double kStep_rad = 2.0 * std::numbers::pi / kDirections;

  static std::size_t direction(double n) {
    const double turns = std::floor(n / kDirections);
    return std::min(static_cast<std::size_t>(n - turns * kDirections), kDirections - 1);
  }

  std::vector<double> range_m_;
};

void draw_image(Picture& picture, const Area& area, const CartesianImage& image, const Reach& reach,
                const EchoPictureOptions& style) {
  const std::array<Rgb, 256> greys = greys_of(style);
  const double range_m = 0.5 * static_cast<double>(image.size_px) * image.pixel_m;
  for (std::size_t row = 0; row < image.size_px; ++row) {
    for (std::size_t column = 0; column < image.size_px; ++column) {
      const double x_m = image.x_m(row), y_m = image.y_m(column);
      if (std::hypot(x_m, y_m) > range_m) continue;
      const std::uint8_t intensity = image.at(row, column);
      picture.set(area.x + static_cast<std::ptrdiff_t>(column), area.y + static_cast<std::ptrdiff_t>(row),
                  intensity > 0 || reach.contains(x_m, y_m) ? greys[intensity] : style.nothing);
    }
  }
}

/// Spacing of range rings [m]: at most five, with room for their labels.
double ring_step_m(const Disc& disc) {
  return round_length_above(disc.range_m * std::max(0.2, 40.0 / disc.radius_px));
}

/// Range rings, and spokes at the rim with their degrees.
void draw_polar_grid(Picture& picture, const Area& area, const Disc& disc) {
  const double step_m = ring_step_m(disc);
  for (int n = 1; n * step_m < disc.range_m * (1.0 + 1e-9); ++n) {
    draw_circle(picture, disc.middle, n * step_m / disc.range_m * disc.radius_px, 1.3, kRing, 0.8, area);
  }
  constexpr int kSpokes = 12;
  for (int n = 0; n < kSpokes; ++n) {
    const double bearing_rad = 2.0 * std::numbers::pi * n / kSpokes;
    const double long_m = (1.0 + 8.0 / disc.radius_px) * disc.range_m;
    draw_line(picture, disc.spot_at(disc.range_m, bearing_rad), disc.spot_at(long_m, bearing_rad), 2.0, kInk,
              {area.x - kRim, area.y - kRim, area.width + 2 * kRim, area.height + 2 * kRim});
    const int degrees = n * 360 / kSpokes;
    const std::string text = degrees == 0     ? "ahead"
                             : degrees == 90  ? "port"
                             : degrees == 180 ? "astern"
                             : degrees == 270 ? "stbd"
                                              : fmt::format("{}", std::min(degrees, 360 - degrees));
    const double text_m = (1.0 + 27.0 / disc.radius_px) * disc.range_m;
    const Spot at = disc.spot_at(text_m, bearing_rad);
    draw_centred(picture, std::lround(at.x), std::lround(at.y) - 7, text, kInk);
  }
}

/// Labels of the rings, on a dark patch to be readable on any grey.
void draw_ring_labels(Picture& picture, const Disc& disc) {
  const double step_m = ring_step_m(disc);
  // Between two spokes.
  const double bearing_rad = 345.0 * kDegree_rad;
  for (int n = 1; n * step_m < disc.range_m * (1.0 - 1e-9); ++n) {
    const std::string text = length_text(n * step_m) + " m";
    const Spot at = disc.spot_at(n * step_m, bearing_rad);
    const std::ptrdiff_t x = std::lround(at.x), y = std::lround(at.y), width = label_width(text, kTextScale);
    picture.fill(x - width / 2 - 3, y - 10, width + 4, 20, {30, 30, 30});
    draw_centred(picture, x, y - 7, text, kRing);
  }
}

}  // namespace

Result<void> CartesianPictureOptions::validate() const {
  std::string bad;
  if (const auto valid = style.validate(); !valid) bad = valid.error().message;
  if (const auto valid = CartesianOptions{between, style.target_px, beam_width_rad}.validate(); !valid) {
    bad += (bad.empty() ? "" : "; ") + valid.error().message;
  }
  if (bad.empty()) return {};
  return fail(Error::Code::kBadOption, bad);
}

Picture render_cartesian(const Sweep& sweep, const PolarImage& image, std::span<const std::optional<Echo>> echoes,
                         const CartesianPictureOptions& options) {
  assert(options.validate());
  assert(image.rows() == sweep.beams.size());
  assert(echoes.empty() || echoes.size() == sweep.beams.size());
  const CartesianImage drawn =
      cartesian_image(image, sweep, {options.between, options.style.target_px, options.beam_width_rad});
  const auto size = static_cast<std::ptrdiff_t>(drawn.size_px);
  const std::ptrdiff_t inner = std::max(size + 2 * kRim, kMinWidth);
  const Area area{kMargin + (inner - size) / 2, kMargin + kRim, size, size};
  Picture picture(static_cast<std::size_t>(inner + 2 * kMargin),
                  static_cast<std::size_t>(area.bottom() + kRim + 2 * kFooterRow + kMargin / 2), kPaper);
  const std::ptrdiff_t footer = area.bottom() + kRim;
  const double half = 0.5 * static_cast<double>(size);
  const Disc disc{{static_cast<double>(area.x) + half, static_cast<double>(area.y) + half}, half, half * drawn.pixel_m};
  if (!(drawn.pixel_m > 0.0)) {
    draw_label(picture, kMargin, footer, "no data", kTextScale, kInk);
    return picture;
  }
  draw_image(picture, area, drawn, Reach(sweep, drawn_reach_rad(sweep, options.beam_width_rad)), options.style);
  draw_polar_grid(picture, area, disc);
  draw_ring_labels(picture, disc);
  const double radius = std::clamp(half / 200.0, 1.6, 4.0);
  for (std::size_t i = 0; i < echoes.size(); ++i) {
    if (!echoes[i] || !(echoes[i]->range_m <= disc.range_m)) continue;
    draw_disc(picture, disc.spot_at(echoes[i]->range_m, sweep.beams[i].bearing_rad), radius, options.style.echo);
  }
  draw_marker(picture, Marker::kPlus, disc.middle, 7.0, kRing);
  draw_scale_bar(picture, kMargin, footer, {disc.range_m / disc.radius_px, 130.0}, "; bearings in deg");
  const std::ptrdiff_t head_x =
      static_cast<std::ptrdiff_t>(picture.width()) - kMargin - label_width("head", kTextScale);
  draw_label(picture, head_x, footer + 2, "head", kTextScale, kInk);
  draw_marker(picture, Marker::kPlus, {static_cast<double>(head_x) - 16.0, static_cast<double>(footer) + 9.0}, 7.0,
              kRing);
  draw_echo_legend(picture, kMargin, footer + kFooterRow, options.style,
                   echoes.empty() ? Marked::kNothing : Marked::kEchoes,
                   sweep.extent == Sweep::Extent::kTurn ? Unrecorded::kHidden : Unrecorded::kShown);
  return picture;
}

}  // namespace pingvox
