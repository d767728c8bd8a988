#include "viewer/echo_legend.hpp"

#include <cmath>

#include "viewer/axis.hpp"
#include "viewer/colours.hpp"
#include "viewer/label.hpp"

namespace pingvox {

std::array<Rgb, 256> greys_of(const EchoPictureOptions& options) {
  std::array<Rgb, 256> greys;
  for (std::size_t i = 0; i < greys.size(); ++i) {
    const auto grey =
        static_cast<std::uint8_t>(std::lround(255.0 * std::pow(static_cast<double>(i) / 255.0, options.gamma)));
    greys[i] = {grey, grey, grey};
  }
  return greys;
}

void draw_echo_legend(Picture& picture, std::ptrdiff_t x, std::ptrdiff_t y, const EchoPictureOptions& options,
                      Marked marked, Unrecorded unrecorded) {
  constexpr std::ptrdiff_t kHigh = 16, kRamp = 128, kSwatch = 18, kApart = 24;
  const auto write = [&](std::string_view text) {
    draw_label(picture, x, y + 1, text, kTextScale, kInk);
    x += label_width(text, kTextScale) + kGap;
  };
  write("intensity 0");
  const std::array<Rgb, 256> greys = greys_of(options);
  for (std::ptrdiff_t i = 0; i < kRamp; ++i) {
    picture.fill(x + i, y, 1, kHigh, greys[static_cast<std::size_t>(i * 255 / (kRamp - 1))]);
  }
  draw_frame(picture, {x, y, kRamp, kHigh}, 1, kInk);
  x += kRamp + kGap;
  write("255");
  if (marked == Marked::kEchoes) {
    x += kApart - kGap;
    picture.fill(x, y, kSwatch, kHigh, {30, 30, 30});
    picture.fill(x + kSwatch / 2 - 2, y, 4, kHigh, options.echo);
    x += kSwatch + kGap;
    write("echo");
  }
  if (unrecorded == Unrecorded::kShown) {
    x += kApart - kGap;
    picture.fill(x, y, kSwatch, kHigh, options.nothing);
    draw_frame(picture, {x, y, kSwatch, kHigh}, 1, kInk);
    x += kSwatch + kGap;
    write("not recorded");
  }
}

}  // namespace pingvox
