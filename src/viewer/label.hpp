#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "pingvox/viewer/picture.hpp"

namespace pingvox {

/// Size of a letter including the gap, at scale 1.
inline constexpr std::ptrdiff_t kLetterWidth = 6;
inline constexpr std::ptrdiff_t kLetterHeight = 9;

inline std::ptrdiff_t label_width(std::string_view text, std::ptrdiff_t scale) {
  return static_cast<std::ptrdiff_t>(text.size()) * kLetterWidth * scale;
}

enum class Reads {
  kRightwards,
  kUpwards,  ///< rotated, for a left axis
};

/// Writes ASCII text. (x, y) is the upper left corner of the text, upwards the lower left one. Characters without a
/// glyph ('`', '$', '{', '}', '\\', and all beyond ASCII) leave a gap.
void draw_label(Picture& picture, std::ptrdiff_t x, std::ptrdiff_t y, std::string_view text, std::ptrdiff_t scale,
                Rgb colour, Reads reads = Reads::kRightwards);

/// A round length (1, 2 or 5 times a power of ten) that is at most `most`. REQUIRES most > 0 and finite.
double round_length(double most);

/// The same that is at least `least`. REQUIRES least > 0 and finite.
double round_length_above(double least);

/// A round length as text, as in "0.5" or "20".
std::string length_text(double metres);

}  // namespace pingvox
