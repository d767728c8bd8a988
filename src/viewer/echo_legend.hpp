#pragma once

#include <array>

#include "pingvox/viewer/picture.hpp"
#include "pingvox/viewer/render_echoes.hpp"
#include "viewer/strokes.hpp"

namespace pingvox {

/// Grey of each intensity.
std::array<Rgb, 256> greys_of(const EchoPictureOptions& options);

/// Size of the echo legend [px].
inline constexpr std::ptrdiff_t kEchoLegendWidth = 640, kEchoLegendHeight = 24;

enum class Marked { kEchoes, kNothing };
/// Whether the picture has places that no beam reaches.
enum class Unrecorded { kShown, kHidden };

/// The legend at (x, y): the grey scale and, if they are there, the
/// marker of echoes and the colour of what was not recorded.
void draw_echo_legend(Picture& picture, std::ptrdiff_t x, std::ptrdiff_t y, const EchoPictureOptions& options,
                      Marked marked, Unrecorded unrecorded);

}  // namespace pingvox
