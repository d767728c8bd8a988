#include "pingvox/sonar/polar_image.hpp"

#include <gmock/gmock.h>

namespace pingvox {
namespace {

using testing::ElementsAre;

TEST(PolarImage, FillsShorterBeamsUpAndRemembersTheirLength) {
  Sweep sweep{.extent = Sweep::Extent::kTurn, .beams = std::vector<Beam>(3)};
  sweep.beams[0].intensities = {1, 2, 3};
  sweep.beams[2].intensities = {4};
  const PolarImage image(sweep);
  EXPECT_EQ(image.rows(), 3U);
  EXPECT_EQ(image.columns(), 3U);
  EXPECT_THAT(image.row(0), ElementsAre(1, 2, 3));
  EXPECT_THAT(image.row(1), ElementsAre(0, 0, 0));
  EXPECT_THAT(image.row(2), ElementsAre(4, 0, 0));
  EXPECT_EQ(image.bins_in(1), 0U);
  EXPECT_EQ(image.bins_in(2), 1U);
}

TEST(PolarImage, WrapsOnlyAroundAWholeTurn) {
  EXPECT_EQ(PolarImage(Sweep{Sweep::Extent::kTurn, {}}).wrap(), PolarImage::Wrap::kAround);
  EXPECT_EQ(PolarImage(Sweep{Sweep::Extent::kSector, {}}).wrap(), PolarImage::Wrap::kNone);
  EXPECT_EQ(PolarImage(Sweep{Sweep::Extent::kCut, {}}).wrap(), PolarImage::Wrap::kNone);
}

}  // namespace
}  // namespace pingvox
