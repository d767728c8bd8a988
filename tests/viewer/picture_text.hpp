#pragma once

#include <string>
#include <utility>
#include <vector>

#include "pingvox/viewer/picture.hpp"

namespace pingvox {

/// A part of a picture as text: one letter for each step of `step` pixels, taken from the step's upper left pixel; '?'
/// for a colour that is not among the letters.
inline std::string as_text(const Picture& picture, std::size_t left, std::size_t top, std::size_t columns,
                           std::size_t rows, std::size_t step, const std::vector<std::pair<Rgb, char>>& letters) {
  std::string text;
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      const Rgb colour = picture.at(left + column * step, top + row * step);
      char letter = '?';
      for (const auto& [known, name] : letters) {
        if (known == colour) letter = name;
      }
      text += letter;
    }
    text += '\n';
  }
  return text;
}

}  // namespace pingvox
