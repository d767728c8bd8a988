#include "pingvox/viewer/render_mosaic.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <sstream>

using namespace pingvox;

namespace {

using testing::ElementsAre;

constexpr float kNever = std::numeric_limits<float>::quiet_NaN();

/// Two columns, three rows; the row of the lowest y first.
const Raster<float> kMosaic{2, 3, 0.5, {10.0, 20.0}, {0.0F, 255.0F, 51.0F, kNever, 102.0F, 300.0F}};

TEST(MosaicPicture, HasNorthUpAndIsTransparentWhereNothingWasHeard) {
  const GreyPicture picture = render_mosaic(kMosaic, PictureUp::kY, 1.0);
  EXPECT_EQ(picture.width, 2U);
  EXPECT_EQ(picture.height, 3U);
  EXPECT_THAT(picture.grey_alpha, ElementsAre(102, 255, 255, 255, 51, 255, 0, 0, 0, 255, 255, 255));
  EXPECT_EQ(render_mosaic(kMosaic, PictureUp::kY, 0.5).grey_alpha[4], 114) << "255 * sqrt(51 / 255)";
}

TEST(MosaicPicture, HasAheadUpAndLeftAtTheLeft) {
  const GreyPicture picture = render_mosaic(kMosaic, PictureUp::kX, 1.0);
  EXPECT_EQ(picture.width, 3U);
  EXPECT_EQ(picture.height, 2U);
  // Above the greater x; at the left the greatest y.
  EXPECT_THAT(picture.grey_alpha, ElementsAre(255, 255, 0, 0, 255, 255, 102, 255, 51, 255, 0, 255));
}

/// Where the middle of a pixel is, as a GIS reckons it from a world file.
Eigen::Vector2d place_of(PictureUp up, double column, double row) {
  std::ostringstream out;
  EXPECT_TRUE(write_world_file(kMosaic, up, out));
  std::istringstream in(out.str());
  double a = 0, d = 0, b = 0, e = 0, c = 0, f = 0;
  in >> a >> d >> b >> e >> c >> f;
  EXPECT_TRUE(in);
  return {a * column + b * row + c, d * column + e * row + f};
}

TEST(MosaicPicture, IsPlacedByItsWorldFile) {
  EXPECT_EQ(place_of(PictureUp::kY, 0, 0), Eigen::Vector2d(10.25, 21.25));
  EXPECT_EQ(place_of(PictureUp::kY, 1, 2), Eigen::Vector2d(10.75, 20.25));
  EXPECT_EQ(place_of(PictureUp::kX, 0, 0), Eigen::Vector2d(10.75, 21.25));
  EXPECT_EQ(place_of(PictureUp::kX, 2, 1), Eigen::Vector2d(10.25, 20.25));
  std::ostringstream bad;
  bad.setstate(std::ios::badbit);
  EXPECT_FALSE(write_world_file(kMosaic, PictureUp::kY, bad));
}

}  // namespace
