#include "pingvox/viewer/picture.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <sstream>
#include <string_view>

#include "viewer/label.hpp"
#include "viewer/picture_text.hpp"

using namespace pingvox;

namespace {

constexpr Rgb kWhite{255, 255, 255}, kBlack{0, 0, 0};

TEST(Picture, FillsOnlyWhatLiesInIt) {
  Picture picture(6, 4, kWhite);
  picture.fill(-2, -1, 4, 3, kBlack);
  picture.fill(5, 3, 100, 100, kBlack);
  picture.set(4, 0, kBlack);
  picture.set(6, 0, kBlack);
  picture.set(0, -1, kBlack);
  EXPECT_EQ(as_text(picture, 0, 0, 6, 4, 1, {{kWhite, '.'}, {kBlack, '#'}}),
            "##..#.\n"
            "##....\n"
            "......\n"
            ".....#\n");
}

TEST(Picture, IsTheSameAfterPng) {
  Picture picture(40, 30, Rgb{1, 2, 3});
  picture.fill(5, 6, 7, 8, Rgb{250, 128, 7});
  std::ostringstream out;
  ASSERT_TRUE(write_png(picture, out));
  const std::string bytes = out.str();
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()), 0);
  ASSERT_EQ(image.width, 40U);
  ASSERT_EQ(image.height, 30U);
  std::vector<std::uint8_t> rgb(picture.rgb().size());
  ASSERT_NE(png_image_finish_read(&image, nullptr, rgb.data(), 0, nullptr), 0);
  EXPECT_TRUE(std::equal(rgb.begin(), rgb.end(), picture.rgb().begin()));
}

TEST(Label, IsReadable) {
  Picture picture(30, 9, kWhite);
  draw_label(picture, 0, 0, "2.5 m", 1, kBlack);
  EXPECT_EQ(as_text(picture, 0, 0, 30, 9, 1, {{kWhite, '.'}, {kBlack, '#'}}),
            ".###........#####.............\n"
            "#...#.......#.................\n"
            "....#.......####........##.#..\n"
            "...#............#.......#.#.#.\n"
            "..#.............#.......#.#.#.\n"
            ".#.....##...#...#.......#.#.#.\n"
            "#####..##....###........#.#.#.\n"
            "..............................\n"
            "..............................\n");
}

TEST(Label, ReadsUpwardsAtTheLeftAxis) {
  Picture picture(9, 18, kWhite);
  draw_label(picture, 0, 18, "L7", 1, kBlack, Reads::kUpwards);
  // Turned to the right again, it is the same as rightwards.
  Picture expected(18, 9, kWhite);
  draw_label(expected, 0, 0, "L7", 1, kBlack);
  for (std::size_t x = 0; x < 18; ++x) {
    for (std::size_t y = 0; y < 9; ++y) EXPECT_EQ(picture.at(y, 17 - x), expected.at(x, y)) << x << " " << y;
  }
}

TEST(Label, EachLetterDiffersFromEachOther) {
  std::vector<std::string> shapes;
  for (const char letter :
       std::string_view("0123456789.-+,/abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ:;=_()[]%*<>!?#&'\"|~@^")) {
    Picture picture(6, 9, kWhite);
    draw_label(picture, 0, 0, std::string_view(&letter, 1), 1, kBlack);
    shapes.push_back(as_text(picture, 0, 0, 6, 9, 1, {{kWhite, '.'}, {kBlack, '#'}}));
    EXPECT_NE(shapes.back().find('#'), std::string::npos) << letter;
    // The gap to the next letter.
    for (std::size_t row = 0; row < 9; ++row) EXPECT_EQ(shapes.back()[row * 7 + 5], '.') << letter;
  }
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) EXPECT_NE(shapes[i], shapes[k]);
  }
}

TEST(RoundLength, IsTheLongestRoundOneThatFits) {
  for (const auto& [most, round] : {std::pair{0.7, 0.5}, std::pair{1.0, 1.0}, std::pair{1.99, 1.0}, std::pair{4.9, 2.0},
                                    std::pair{999.0, 500.0}, std::pair{1000.0, 1000.0}, std::pair{0.0021, 0.002}}) {
    EXPECT_DOUBLE_EQ(round_length(most), round) << most;
  }
  for (const auto& [least, round] : {std::pair{0.7, 1.0}, std::pair{1.0, 1.0}, std::pair{1.01, 2.0},
                                     std::pair{5.0, 5.0}, std::pair{0.0021, 0.005}}) {
    EXPECT_DOUBLE_EQ(round_length_above(least), round) << least;
  }
  EXPECT_EQ(length_text(0.05), "0.05");
  EXPECT_EQ(length_text(20.0), "20");
}

}  // namespace
