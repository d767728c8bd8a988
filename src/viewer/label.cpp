#include "viewer/label.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace pingvox {
namespace {

struct Letter {
  char name;
  std::string_view rows;  ///< of five pixels, from the top; a blank between them. Two rows hang below the line.
};

constexpr std::array kLetters = {
    Letter{'0', ".###. #...# #..## #.#.# ##..# #...# .###. ..... ....."},
    Letter{'1', "..#.. .##.. ..#.. ..#.. ..#.. ..#.. .###. ..... ....."},
    Letter{'2', ".###. #...# ....# ...#. ..#.. .#... ##### ..... ....."},
    Letter{'3', "##### ...#. ..#.. ...#. ....# #...# .###. ..... ....."},
    Letter{'4', "...#. ..##. .#.#. #..#. ##### ...#. ...#. ..... ....."},
    Letter{'5', "##### #.... ####. ....# ....# #...# .###. ..... ....."},
    Letter{'6', "..##. .#... #.... ####. #...# #...# .###. ..... ....."},
    Letter{'7', "##### ....# ...#. ..#.. .#... .#... .#... ..... ....."},
    Letter{'8', ".###. #...# #...# .###. #...# #...# .###. ..... ....."},
    Letter{'9', ".###. #...# #...# .#### ....# ...#. .##.. ..... ....."},
    Letter{'.', "..... ..... ..... ..... ..... .##.. .##.. ..... ....."},
    Letter{'-', "..... ..... ..... ##### ..... ..... ..... ..... ....."},
    Letter{'+', "..... ..#.. ..#.. ##### ..#.. ..#.. ..... ..... ....."},
    Letter{',', "..... ..... ..... ..... ..... .##.. .##.. ..#.. .#..."},
    Letter{'/', "....# ....# ...#. ..#.. .#... #.... #.... ..... ....."},
    Letter{'a', "..... ..... .###. ....# .#### #...# .#### ..... ....."},
    Letter{'b', "#.... #.... #.##. ##..# #...# #...# ####. ..... ....."},
    Letter{'c', "..... ..... .###. #.... #.... #...# .###. ..... ....."},
    Letter{'d', "....# ....# .##.# #..## #...# #...# .#### ..... ....."},
    Letter{'e', "..... ..... .###. #...# ##### #.... .###. ..... ....."},
    Letter{'f', "..##. .#..# .#... ###.. .#... .#... .#... ..... ....."},
    Letter{'g', "..... ..... .#### #...# #...# #...# .#### ....# .###."},
    Letter{'h', "#.... #.... #.##. ##..# #...# #...# #...# ..... ....."},
    Letter{'i', "..#.. ..... .##.. ..#.. ..#.. ..#.. .###. ..... ....."},
    Letter{'j', "...#. ..... ..##. ...#. ...#. ...#. ...#. #..#. .##.."},
    Letter{'k', "#.... #.... #..#. #.#.. ##... #.#.. #..#. ..... ....."},
    Letter{'l', ".##.. ..#.. ..#.. ..#.. ..#.. ..#.. .###. ..... ....."},
    Letter{'m', "..... ..... ##.#. #.#.# #.#.# #.#.# #.#.# ..... ....."},
    Letter{'n', "..... ..... #.##. ##..# #...# #...# #...# ..... ....."},
    Letter{'o', "..... ..... .###. #...# #...# #...# .###. ..... ....."},
    Letter{'p', "..... ..... ####. #...# #...# #...# ####. #.... #...."},
    Letter{'q', "..... ..... .##.# #..## #...# #...# .#### ....# ....#"},
    Letter{'r', "..... ..... #.##. ##..# #.... #.... #.... ..... ....."},
    Letter{'s', "..... ..... .#### #.... .###. ....# ####. ..... ....."},
    Letter{'t', ".#... .#... ###.. .#... .#... .#..# ..##. ..... ....."},
    Letter{'u', "..... ..... #...# #...# #...# #..## .##.# ..... ....."},
    Letter{'v', "..... ..... #...# #...# #...# .#.#. ..#.. ..... ....."},
    Letter{'w', "..... ..... #...# #.#.# #.#.# #.#.# .#.#. ..... ....."},
    Letter{'x', "..... ..... #...# .#.#. ..#.. .#.#. #...# ..... ....."},
    Letter{'y', "..... ..... #...# #...# #...# #...# .#### ....# .###."},
    Letter{'z', "..... ..... ##### ...#. ..#.. .#... ##### ..... ....."},
};

}  // namespace

void draw_label(Picture& picture, std::ptrdiff_t x, std::ptrdiff_t y, std::string_view text, std::ptrdiff_t scale,
                Rgb colour) {
  for (const char name : text) {
    const auto* const letter =
        std::find_if(kLetters.begin(), kLetters.end(), [&](const Letter& l) { return l.name == name; });
    if (letter != kLetters.end()) {
      for (std::size_t i = 0; i < letter->rows.size(); ++i) {
        const auto row = static_cast<std::ptrdiff_t>(i) / kLetterWidth,
                   column = static_cast<std::ptrdiff_t>(i) % kLetterWidth;
        if (letter->rows[i] == '#') picture.fill(x + column * scale, y + row * scale, scale, scale, colour);
      }
    }
    x += kLetterWidth * scale;
  }
}

double round_length(double most) {
  const double power = std::pow(10.0, std::floor(std::log10(most)));
  // log10 may round up to the next power.
  for (const double factor : {5.0, 2.0, 1.0}) {
    if (factor * power <= most) return factor * power;
  }
  return 0.5 * power;
}

std::string length_text(double metres) {
  return fmt::format("{:.6g}", metres);
}

}  // namespace pingvox
