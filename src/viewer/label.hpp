#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "pingvox/viewer/picture.hpp"

namespace pingvox {

/// A letter's box, the gap to the next one included, at scale 1.
inline constexpr std::ptrdiff_t kLetterWidth = 6;
inline constexpr std::ptrdiff_t kLetterHeight = 9;

inline std::ptrdiff_t label_width(std::string_view text, std::ptrdiff_t scale) {
  return static_cast<std::ptrdiff_t>(text.size()) * kLetterWidth * scale;
}

/// Writes digits, small letters, '.', '-', '+', ',' and '/' with their upper left corner at (x, y). Other characters
/// leave a gap.
void draw_label(Picture& picture, std::ptrdiff_t x, std::ptrdiff_t y, std::string_view text, std::ptrdiff_t scale,
                Rgb colour);

/// A round length (1, 2 or 5 times a power of ten) that is at most `most`. REQUIRES most > 0 and finite.
double round_length(double most);

/// A round length as text, as in "0.5" or "20".
std::string length_text(double metres);

}  // namespace pingvox
