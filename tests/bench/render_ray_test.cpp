#include "bench/draw/render_ray.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "viewer/picture_text.hpp"

namespace pingvox::bench {
namespace {

const std::vector<std::pair<Rgb, char>> kLetters = {
    {Rgb{255, 255, 255}, '.'}, {Rgb{120, 168, 214}, '#'}, {Rgb{34, 52, 110}, 'X'}};

TEST(RayFigure, HoldsWhatTheTraversalsMark) {
  const auto dda = ray_figure({0.5, 0.5}, {3.4, 1.5}, RayAlgorithm::kDda);
  EXPECT_EQ(dda.marked, (std::vector<GridCell>{{0, 0}, {1, 0}, {1, 1}, {2, 1}, {3, 1}}));
  const auto back = ray_figure({-0.5, -2.5}, {-0.5, 0.5}, RayAlgorithm::kBresenham);
  EXPECT_EQ(back.marked, (std::vector<GridCell>{{-1, -3}, {-1, -2}, {-1, -1}, {-1, 0}}));
  const auto diagonal = ray_figure({0.5, 0.5}, {2.5, 2.5}, RayAlgorithm::kBresenham);
  EXPECT_EQ(diagonal.marked.size(), 3U);
}

TEST(RenderRay, ShowsWhichCellsAreMissedAndWhichAreBeyond) {
  // From (0, 0) to (2, 0), but marked are (0, 0), (1, 1) and (2, 0).
  RayFigure figure{{0.2, 0.5}, {2.8, 0.5}, {{0, 0}, {1, 1}, {2, 0}}};
  ASSERT_TRUE(figure.validate());
  // Cells of 64 pixels: a grid of 5 x 4, y upwards, looked at near their upper right corners.
  const Picture picture = render_ray(figure, 320);
  std::string cells;
  for (std::size_t row = 0; row < 4; ++row) cells += as_text(picture, 24 + 59, 24 + row * 64 + 5, 5, 1, 64, kLetters);
  // The missed one is hatched: either its colour or paper.
  EXPECT_EQ(cells.substr(0, 12), ".....\n..X..\n");
  EXPECT_EQ(cells.substr(12, 2), ".#");
  EXPECT_EQ(cells.substr(15), "#.\n.....\n");
  std::size_t hatched = 0;
  for (std::size_t x = 24 + 2 * 64; x < 24 + 3 * 64; ++x) {
    hatched += picture.at(x, 24 + 2 * 64 + 5) == Rgb{222, 100, 0} ? 1 : 0;
  }
  EXPECT_EQ(hatched, 24U);
}

TEST(RenderRay, DrawsLongRaysAndSinglePoints) {
  for (const double end : {0.5, 0.7, 300.5, -300.5}) {
    const RayFigure figure = ray_figure({0.5, 0.5}, {end, 0.3 * end}, RayAlgorithm::kDda);
    ASSERT_TRUE(figure.validate());
    EXPECT_LE(render_ray(figure).width(), 1700U);
  }
  EXPECT_FALSE((RayFigure{{0.0, 0.0}, {500.0, 0.0}, {}}).validate());
  EXPECT_FALSE((RayFigure{{0.0, 0.0}, {std::numeric_limits<double>::quiet_NaN(), 0.0}, {}}).validate());
  EXPECT_FALSE((RayFigure{{0.0, 0.0}, {1.0, 0.0}, {{std::numeric_limits<std::int64_t>::max(), 0}}}).validate());
}

}  // namespace
}  // namespace pingvox::bench
