#include "pingvox/viewer/render_echoes.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "base/option_errors.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose2.hpp"
#include "viewer/axis.hpp"
#include "viewer/colours.hpp"
#include "viewer/echo_legend.hpp"
#include "viewer/label.hpp"

namespace pingvox {
namespace {

constexpr std::ptrdiff_t kLeft = 110, kRight = 182, kTop = 44, kBottom = 96;
constexpr std::size_t kMaxRows = 2000, kMinHeight = 800;
constexpr std::size_t kMinEchoWidth = static_cast<std::size_t>(kEchoLegendWidth);
constexpr std::ptrdiff_t kMarkWidth = 3;

/// Mapping of beams and ranges to pixels.
struct Scale {
  std::size_t beams = 0;
  double range_m = 0.0;     ///< of the longest beam
  std::size_t columns = 0;  ///< pixels
  std::size_t rows = 0;     ///< of one or more beams each
  std::size_t row_px = 1;

  std::size_t row_of(std::size_t beam) const { return beam * rows / beams; }
  std::size_t column_of(double range) const {
    const double column = range / range_m * static_cast<double>(columns);
    return static_cast<std::size_t>(std::clamp(column, 0.0, static_cast<double>(columns - 1)));
  }
};

Scale scale_of(std::span<const Beam> beams, std::size_t target_px) {
  Scale scale;
  scale.beams = beams.size();
  std::size_t bins = 0;
  for (const Beam& beam : beams) {
    scale.range_m = std::max(scale.range_m, static_cast<double>(beam.intensities.size()) * beam.bin_length_m);
    bins = std::max(bins, beam.intensities.size());
  }
  if (bins == 0) return scale;
  // A whole number of pixels a bin, if all beams have the same bins.
  scale.columns = bins <= target_px ? target_px / bins * bins : target_px;
  scale.rows = std::min(beams.size(), kMaxRows);
  if (beams.size() > kMaxRows) {
    const std::size_t shared = (beams.size() + kMaxRows - 1) / kMaxRows;
    scale.rows = (beams.size() + shared - 1) / shared;
  }
  scale.row_px = std::clamp<std::size_t>(kMinHeight / scale.rows, 1, 16);
  return scale;
}

constexpr int kNothing = -1;

/// Maximum intensity of each pixel, kNothing where no beam reaches.
std::vector<int> loudest(std::span<const Beam> beams, const Scale& scale) {
  std::vector<int> pixels(scale.columns * scale.rows, kNothing);
  for (std::size_t b = 0; b < beams.size(); ++b) {
    int* const row = pixels.data() + scale.row_of(b) * scale.columns;
    const Beam& beam = beams[b];
    for (std::size_t i = 0; i < beam.intensities.size(); ++i) {
      const auto edge = [&](std::size_t bin) {
        return static_cast<double>(bin) * beam.bin_length_m / scale.range_m * static_cast<double>(scale.columns);
      };
      // Rounding must not put a bin's edge on the other side of a pixel's.
      const double from = edge(i), to = edge(i + 1);
      const auto first = static_cast<std::size_t>(from + 1e-6);
      const auto last = std::max(first, static_cast<std::size_t>(std::max(to - 1e-6, 0.0)));
      for (std::size_t x = first; x <= last && x < scale.columns; ++x) {
        row[x] = std::max(row[x], static_cast<int>(beam.intensities[i]));
      }
    }
  }
  return pixels;
}

void draw_axes(Picture& picture, const Scale& scale) {
  const auto width = static_cast<std::ptrdiff_t>(scale.columns);
  const auto height = static_cast<std::ptrdiff_t>(scale.rows * scale.row_px);
  picture.fill(kLeft - 2, kTop - 2, width + 4, 2, kInk);
  picture.fill(kLeft - 2, kTop + height, width + 4, 2, kInk);
  picture.fill(kLeft - 2, kTop, 2, height, kInk);
  picture.fill(kLeft + width, kTop, 2, height, kInk);

  const double step_m = round_length(scale.range_m / 3.0);
  const std::ptrdiff_t below = kTop + height + 2;
  for (int n = 0; n < 10 && n * step_m <= scale.range_m * (1.0 + 1e-9); ++n) {
    const double range_m = n * step_m;
    const auto x =
        kLeft + static_cast<std::ptrdiff_t>(std::lround(range_m / scale.range_m * static_cast<double>(width)));
    picture.fill(x - 1, below, 2, kTick, kInk);
    const std::string text = length_text(range_m);
    draw_label(picture, x - label_width(text, kTextScale) / 2 + 1, below + kTick + kGap, text, kTextScale, kInk);
  }
  draw_centred(picture, kLeft + width / 2, below + kTick + 2 * kGap + kTextScale * kLetterHeight, "range in m", kInk);

  const auto step = static_cast<std::size_t>(std::max(1.0, round_length(static_cast<double>(scale.beams) / 3.0)));
  for (std::size_t beam = 0; beam < scale.beams; beam += step) {
    const auto y = kTop + static_cast<std::ptrdiff_t>(scale.row_of(beam) * scale.row_px);
    picture.fill(kLeft - 2 - kTick, y, kTick, 2, kInk);
    const std::string text = std::to_string(beam);
    draw_label(picture, kLeft - 2 - kTick - kGap - label_width(text, kTextScale), y - 6, text, kTextScale, kInk);
  }
  constexpr std::string_view kBeam = "beam";
  draw_label(picture, kLeft - kGap - label_width(kBeam, kTextScale), kGap, kBeam, kTextScale, kInk);
}

/// A bearing [degrees, counter-clockwise, 0..359] with its side, port or starboard.
std::string side_text(long degrees) {
  if (degrees == 0) return "ahead";
  if (degrees == 180) return "astern";
  return degrees < 180 ? fmt::format("{} port", degrees) : fmt::format("{} stbd", 360 - degrees);
}

/// Round bearings at the right, at the beams where the head passes them.
void draw_bearings(Picture& picture, std::span<const Beam> beams, const Scale& scale) {
  double turned_rad = 0.0;
  for (std::size_t b = 1; b < beams.size(); ++b)
    turned_rad += std::abs(wrap_angle(beams[b].bearing_rad - beams[b - 1].bearing_rad));
  // A step that gives about ten labels.
  constexpr std::array kSteps = {10.0, 15.0, 30.0, 45.0, 90.0, 180.0, 360.0};
  double step_rad = kSteps.back() * kDegree_rad;
  for (const double step_deg : kSteps) {
    step_rad = step_deg * kDegree_rad;
    if (turned_rad <= 13.0 * step_rad) break;
  }
  const auto x = kLeft + static_cast<std::ptrdiff_t>(scale.columns) + 2;
  constexpr std::ptrdiff_t kRoom = kTextScale * kLetterHeight + 4;
  std::ptrdiff_t free_from = kTop - kRoom;
  const auto mark = [&](std::size_t beam, double passed) {
    const auto y = kTop + static_cast<std::ptrdiff_t>(scale.row_of(beam) * scale.row_px);
    if (y < free_from) return;
    const auto degrees = static_cast<long>(std::lround(passed * step_rad / kDegree_rad)) % 360;
    picture.fill(x, y, kTick, 2, kInk);
    draw_label(picture, x + kTick + kGap, y - 6, side_text(degrees < 0 ? degrees + 360 : degrees), kTextScale, kInk);
    free_from = y + kRoom;
  };
  // Unwrapped bearing, so that 0 is no special case.
  double bearing = beams.empty() ? 0.0 : beams[0].bearing_rad / step_rad;
  if (!beams.empty() && std::abs(bearing - std::round(bearing)) < 1e-6) mark(0, std::round(bearing));
  for (std::size_t b = 1; b < beams.size(); ++b) {
    const double before = bearing;
    bearing += wrap_angle(beams[b].bearing_rad - beams[b - 1].bearing_rad) / step_rad;
    // Tolerance for a beam exactly on a round bearing.
    constexpr double kNear = 1e-6;
    const bool is_rising = bearing >= before;
    const double passed = is_rising ? std::floor(bearing + kNear) : std::ceil(bearing - kNear);
    if (is_rising ? passed > before + kNear : passed < before - kNear) mark(b, passed);
  }
  draw_label(picture, x + kGap, kGap, "bearing in deg", kTextScale, kInk);
}

}  // namespace

Result<void> EchoPictureOptions::validate() const {
  OptionErrors errors;
  errors.require("target_px", target_px, kPictureSizes_px);
  errors.require(gamma > 0.0 && std::isfinite(gamma), "gamma", "> 0", gamma);
  return errors.result("echo picture");
}

Picture render_echoes(std::span<const Beam> beams, std::span<const std::optional<Echo>> echoes,
                      const EchoPictureOptions& options) {
  assert(options.validate());
  assert(echoes.empty() || echoes.size() == beams.size());
  const Scale scale = scale_of(beams, options.target_px);
  if (scale.columns == 0) {
    Picture picture(400, 80, kPaper);
    draw_label(picture, 24, 30, "no data", kTextScale, kInk);
    return picture;
  }
  const std::array<Rgb, 256> greys = greys_of(options);
  const std::size_t height = scale.rows * scale.row_px;
  Picture picture(std::max(kLeft + scale.columns + kRight, kMinEchoWidth), kTop + height + kBottom, kPaper);
  const auto row_px = static_cast<std::ptrdiff_t>(scale.row_px);
  const std::vector<int> pixels = loudest(beams, scale);
  for (std::size_t row = 0; row < scale.rows; ++row) {
    for (std::size_t column = 0; column < scale.columns; ++column) {
      const int intensity = pixels[row * scale.columns + column];
      picture.fill(kLeft + static_cast<std::ptrdiff_t>(column), kTop + static_cast<std::ptrdiff_t>(row) * row_px, 1,
                   row_px, intensity == kNothing ? options.nothing : greys[static_cast<std::size_t>(intensity)]);
    }
  }
  for (std::size_t b = 0; b < echoes.size(); ++b) {
    if (!echoes[b]) continue;
    const auto x = kLeft + static_cast<std::ptrdiff_t>(scale.column_of(echoes[b]->range_m));
    const auto y = kTop + static_cast<std::ptrdiff_t>(scale.row_of(b)) * row_px;
    picture.fill(std::max(x - kMarkWidth / 2, kLeft), y, kMarkWidth, row_px, options.echo);
  }
  draw_axes(picture, scale);
  draw_bearings(picture, beams, scale);
  draw_echo_legend(picture, kGap, kTop + static_cast<std::ptrdiff_t>(height) + kBottom - kEchoLegendHeight, options,
                   echoes.empty() ? Marked::kNothing : Marked::kEchoes,
                   std::ranges::find(pixels, kNothing) == pixels.end() ? Unrecorded::kHidden : Unrecorded::kShown);
  return picture;
}

}  // namespace pingvox
