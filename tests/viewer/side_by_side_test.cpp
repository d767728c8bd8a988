#include "pingvox/viewer/side_by_side.hpp"

#include <gtest/gtest.h>

using namespace pingvox;

namespace {

constexpr Rgb kRed{200, 0, 0}, kBlue{0, 0, 200}, kPaper{255, 255, 255};

TEST(SideBySide, PutsPicturesIntoARow) {
  const std::vector<Panel> panels = {{Picture(100, 50, kRed), "a"}, {Picture(60, 80, kBlue), ""}};
  const auto both = side_by_side(panels);
  ASSERT_TRUE(both);
  EXPECT_EQ(both->width(), 176U);
  EXPECT_GT(both->height(), 80U + 18U);
  EXPECT_EQ(both->at(99, 49), kRed);
  EXPECT_EQ(both->at(100, 49), kPaper);
  EXPECT_EQ(both->at(116, 0), kBlue);
  EXPECT_EQ(both->at(175, 79), kBlue);
  // The caption, below the higher of the two.
  std::size_t inked = 0;
  for (std::size_t y = 80; y < both->height(); ++y) {
    for (std::size_t x = 0; x < both->width(); ++x) inked += both->at(x, y) == kPaper ? 0 : 1;
  }
  EXPECT_GT(inked, 20U);
}

TEST(SideBySide, BreaksRowsThatWouldBeTooWide) {
  const std::vector<Panel> four(4, Panel{Picture(1200, 100, kRed), ""});
  const auto picture = side_by_side(four);
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->width(), 2416U);
  EXPECT_EQ(picture->height(), 200U);
  EXPECT_EQ(picture->at(1216, 100), kRed);
  const auto titled = side_by_side(four, "all of them");
  ASSERT_TRUE(titled);
  EXPECT_GT(titled->height(), 230U);
}

TEST(SideBySide, BreaksLongCaptions) {
  const std::vector<Panel> narrow = {{Picture(100, 50, kRed), "one two threefourfivesix seven"}};
  const auto picture = side_by_side(narrow);
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->width(), 100U);
  EXPECT_GT(picture->height(), 50U + 7U * 18U);
}

TEST(SideBySide, SaysWhenItDoesNotFit) {
  const auto none = side_by_side({});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, Error::Code::kBadOption);
  const std::vector<Panel> panels(10, Panel{Picture(3000, 3000, kRed), ""});
  const auto many = side_by_side(panels);
  ASSERT_FALSE(many);
  EXPECT_EQ(many.error().code, Error::Code::kLimit);
}

}  // namespace
