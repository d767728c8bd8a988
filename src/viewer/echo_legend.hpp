#pragma once

#include <array>

#include "pingvox/viewer/picture.hpp"
#include "pingvox/viewer/render_echoes.hpp"
#include "viewer/strokes.hpp"

namespace pingvox {

/// Grey of each intensity.
std::array<Rgb, 256> greys_of(const EchoPictureOptions& options);

/// Size of the echo legend [px].
inline constexpr std::ptrdiff_t kEchoLegendWidth = 520, kEchoLegendHeight = 24;

enum class Marked { kEchoes, kNothing };

/// The legend at (x, y): the grey scale and, if echoes are marked, their marker.
void draw_echo_legend(Picture& picture, std::ptrdiff_t x, std::ptrdiff_t y, const EchoPictureOptions& options,
                      Marked marked);

}  // namespace pingvox
