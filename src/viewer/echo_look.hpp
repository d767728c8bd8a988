#pragma once

#include <array>

#include "pingvox/viewer/picture.hpp"
#include "pingvox/viewer/render_echoes.hpp"
#include "viewer/strokes.hpp"

namespace pingvox {

/// The grey of each intensity.
std::array<Rgb, 256> greys_of(const EchoPictureOptions& options);

/// Pixels that the legend of pictures of echoes is wide and high.
inline constexpr std::ptrdiff_t kEchoLegendWidth = 520, kEchoLegendHeight = 24;

enum class Marked { kEchoes, kNothing };

/// The legend at (x, y): which grey is which intensity and, where echoes are marked, how.
void draw_echo_legend(Picture& picture, std::ptrdiff_t x, std::ptrdiff_t y, const EchoPictureOptions& options,
                      Marked marked);

}  // namespace pingvox
