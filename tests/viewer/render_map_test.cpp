#include "pingvox/viewer/render_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "viewer/picture_text.hpp"

using namespace pingvox;

namespace {

const MapColours kColours{};
const Rgb kCrossColour{230, 120, 0}, kArrowColour{40, 44, 52};

/// What is in the frame: around what is known there is always something unknown.
struct Inside {
  std::size_t left, top, right, bottom;
};

Inside inside_of(const Picture& picture) {
  Inside in{0, 0, 0, 0};
  const auto is_unknown = [&](std::size_t x, std::size_t y) { return picture.at(x, y) == kColours.unknown; };
  for (std::size_t i = 0; i < picture.width() * picture.height(); ++i) {
    in.left = i % picture.width();
    in.top = i / picture.width();
    if (is_unknown(in.left, in.top)) break;
  }
  for (in.right = in.left; is_unknown(in.right, in.top);) ++in.right;
  for (in.bottom = in.top; is_unknown(in.left, in.bottom);) ++in.bottom;
  return in;
}

/// Pixels inside of the border that have this colour.
std::size_t count_of(const Picture& picture, Rgb colour) {
  const Inside in = inside_of(picture);
  std::size_t count = 0;
  for (std::size_t y = in.top; y < in.bottom; ++y) {
    for (std::size_t x = in.left; x < in.right; ++x) count += picture.at(x, y) == colour ? 1 : 0;
  }
  return count;
}

/// Upper left corner of the smallest box around all that is known.
std::pair<std::size_t, std::size_t> corner_of_known(const Picture& picture) {
  const Inside in = inside_of(picture);
  std::pair corner{in.right, in.bottom};
  for (std::size_t y = in.top; y < in.bottom; ++y) {
    for (std::size_t x = in.left; x < in.right; ++x) {
      if (picture.at(x, y) == kColours.unknown) continue;
      corner = {std::min(corner.first, x), std::min(corner.second, y)};
    }
  }
  return corner;
}

/// Pixels along the edge of a cell.
std::size_t edge_px(std::size_t target_px, std::size_t cells) {
  return target_px * 23 / 20 / cells;
}

Key cell(int x, int y, int z) {
  const auto word = [](int c) { return static_cast<std::uint16_t>(32768 + c); };
  return {word(x), word(y), word(z)};
}

const std::vector<std::pair<Rgb, char>> kMapLetters = {
    {kColours.unknown, ' '}, {kColours.surely_free, '.'}, {kColours.surely_occupied, '#'}};

TEST(RenderMap, PutsXUpAndYLeft) {
  OccupancyMap map({.resolution_m = 1.0});
  {
    Editor editor = map.edit();
    const LogOdds wall = Clamp{}.highest, water = Clamp{}.lowest;
    // Far from the origin, so that its cross is not in the picture.
    for (int y = 100; y < 105; ++y) editor.set(cell(203, y, 0), 16, wall);  // ahead: a wall
    for (int x = 200; x < 203; ++x) editor.set(cell(x, 104, 0), 16, wall);  // left: another
    for (int x = 200; x < 203; ++x) editor.set(cell(x, 101, 0), 16, water);
    editor.set(cell(201, 102, 5), 16, water);  // free above, but
    editor.set(cell(201, 102, -3), 16, wall);  // occupied below
  }
  const Picture picture = render_map(map, {.target_px = 80});
  const auto [left, top] = corner_of_known(picture);
  EXPECT_EQ(as_text(picture, left, top, 5, 4, edge_px(80, 5), kMapLetters),
            "#####\n"
            "#  . \n"
            "# #. \n"
            "#  . \n");
}

TEST(RenderMap, PutsNorthUpAndEastToTheRightWhereTheyAreKnown) {
  OccupancyMap map({.resolution_m = 1.0});
  {
    Editor editor = map.edit();
    const LogOdds wall = Clamp{}.highest, water = Clamp{}.lowest;
    for (int x = 200; x < 205; ++x) editor.set(cell(x, 103, 0), 16, wall);   // in the north
    for (int y = 100; y < 103; ++y) editor.set(cell(204, y, 0), 16, water);  // in the east
    editor.set(cell(200, 100, 0), 16, wall);                                 // in the south west
  }
  constexpr std::string_view kDrawn =
      "#####\n"
      "    .\n"
      "    .\n"
      "#   .\n";
  const Picture picture = render_map(map, {.axes = MapAxes::kRightAhead, .target_px = 80});
  const auto [left, top] = corner_of_known(picture);
  EXPECT_EQ(as_text(picture, left, top, 5, 4, edge_px(80, 5), kMapLetters), kDrawn);
  const Picture north = render_map(map, {.axes = MapAxes::kEastNorth, .target_px = 400});
  const Picture right_ahead = render_map(map, {.axes = MapAxes::kRightAhead, .target_px = 400});
  EXPECT_GT(count_of(north, kArrowColour), count_of(right_ahead, kArrowColour)) << "an arrow to the north";
  ASSERT_EQ(north.width(), right_ahead.width());
  ASSERT_EQ(north.height(), right_ahead.height());
  std::size_t different = 0;
  for (std::size_t y = 0; y < north.height(); ++y) {
    for (std::size_t x = 0; x < north.width(); ++x) different += north.at(x, y) != right_ahead.at(x, y) ? 1 : 0;
  }
  EXPECT_LT(different, north.width() * north.height() / 50) << "only by the arrow";
}

TEST(RenderMap, PutsZUpFromEachSide) {
  OccupancyMap map({.resolution_m = 1.0});
  {
    Editor editor = map.edit();
    const LogOdds wall = Clamp{}.highest, water = Clamp{}.lowest;
    for (int x = 200; x < 204; ++x) editor.set(cell(x, 100, 50), 16, water);  // a bottom of water, and on it
    editor.set(cell(203, 100, 51), 16, wall);                                 // a step ahead,
    editor.set(cell(203, 100, 52), 16, wall);
    editor.set(cell(200, 102, 51), 16, wall);  // and one to the left
  }
  const auto seen = [&](MapView view, std::size_t across) {
    const Picture picture = render_map(map, {.view = view, .target_px = 64});
    const auto [left, top] = corner_of_known(picture);
    const std::size_t cell_px = edge_px(64, std::max<std::size_t>(across, 3));
    return as_text(picture, left, top, across, 3, cell_px, kMapLetters);
  };
  EXPECT_EQ(seen(MapView::kRight, 4),
            "   #\n"
            "#  #\n"
            "....\n");
  EXPECT_EQ(seen(MapView::kLeft, 4),
            "#   \n"
            "#  #\n"
            "....\n");
  EXPECT_EQ(seen(MapView::kFront, 3),
            "#  \n"
            "# #\n"
            ".  \n");
  EXPECT_EQ(seen(MapView::kBehind, 3),
            "  #\n"
            "# #\n"
            "  .\n");
}

TEST(RenderMap, DrawsPathsWhereTheyWentAndNotAcrossGaps) {
  OccupancyMap map({.resolution_m = 1.0});
  {
    Editor editor = map.edit();
    for (int x = 100; x < 120; ++x) {
      for (int y = 100; y < 120; ++y) editor.set(cell(x, y, 0), 16, Clamp{}.lowest);
    }
  }
  std::vector<StampedPose> poses;
  for (const auto& [time, x, y] :
       {std::array{0.0, 102.5, 102.5}, {1.0, 117.5, 102.5}, {20.0, 117.5, 117.5}, {21.0, 102.5, 117.5}}) {
    poses.push_back({time, Pose(Eigen::Translation3d(x, y, 0.5))});
  }
  MapPictureOptions options{.target_px = 400};
  const Picture plain = render_map(map, options);
  options.paths = {{"dive.tum", *Trajectory::make(poses, 5.0)}};
  const Picture drawn = render_map(map, options);
  EXPECT_EQ(drawn.width(), plain.width());
  EXPECT_GT(drawn.height(), plain.height()) << "a row of the legend";
  const auto [left, top] = corner_of_known(plain);
  const std::size_t px = edge_px(400, 20);
  // x is up, y is left.
  const auto at = [&](double x, double y) {
    const auto from_left = static_cast<std::size_t>((120.0 - y) * static_cast<double>(px));
    const auto from_top = static_cast<std::size_t>((120.0 - x) * static_cast<double>(px));
    return drawn.at(left + from_left, top + from_top);
  };
  const Rgb line = at(110.0, 102.5);
  EXPECT_NE(line, kColours.surely_free);
  EXPECT_EQ(at(106.0, 117.5), line);
  EXPECT_EQ(at(117.5, 110.0), kColours.surely_free) << "a gap";
  EXPECT_EQ(at(110.0, 110.0), kColours.surely_free);

  // The start is a ring, the end a disc.
  EXPECT_EQ(at(102.5, 102.5), (Rgb{255, 255, 255}));
  const Rgb beside_end = at(102.5 + 5.0 / static_cast<double>(px), 117.5);
  EXPECT_EQ(beside_end, line);

  // One that leads out of the map makes the picture wider.
  poses.back().map_from_body.translation().x() = 160.0;
  options.paths.front().map_from_body = *Trajectory::make(poses);
  const auto part = shown_part(map, options);
  ASSERT_TRUE(part);
  EXPECT_EQ(part->max.x(), 161.0);
  options.paths.assign(6, options.paths.front());
  EXPECT_FALSE(options.validate());
}

// Kills agreement of free cells, of cells that are not shown, and that of one cell taken for that of its column.
TEST(RenderMap, ColoursOccupiedColumnsByHowEchoesAgree) {
  OccupancyMap map({.resolution_m = 1.0});
  {
    Editor editor = map.edit();
    for (int x = 200; x < 205; ++x) editor.set(cell(x, 100, 0), 16, Clamp{}.highest);
    editor.set(cell(200, 100, 3), 16, Clamp{}.highest);  // two in one column
    for (int x = 200; x < 205; ++x) editor.set(cell(x, 101, 0), 16, Clamp{}.lowest);
  }
  const auto at = [](int x, int y, int z, std::uint32_t judged, std::uint32_t agreed) {
    return CellAgreement{cell(x, y, z).as<WideWord>(), judged, agreed};
  };
  const std::vector<CellAgreement> agreement = {at(200, 100, 0, 3, 0), at(200, 100, 3, 1, 1), at(201, 100, 0, 9, 9),
                                                at(202, 100, 0, 9, 0), at(204, 101, 0, 5, 0), at(300, 100, 0, 5, 0)};
  const MapPictureOptions options{.target_px = 80, .agreement = agreement};
  const auto mixed = [](Rgb a, Rgb b, double share) {
    const auto part = [&](int from, int to) {
      return static_cast<std::uint8_t>(std::lround(from + (to - from) * share));
    };
    return Rgb{part(a.red, b.red), part(a.green, b.green), part(a.blue, b.blue)};
  };
  const std::vector<std::pair<Rgb, char>> letters = {
      {kColours.unknown, ' '},    {kColours.surely_free, '.'},
      {kColours.none_agree, '0'}, {mixed(kColours.none_agree, kColours.all_agree, 0.25), '1'},
      {kColours.all_agree, '4'},  {kColours.not_judged, '?'}};
  const Picture picture = render_map(map, options);
  const auto [left, top] = corner_of_known(picture);
  EXPECT_EQ(as_text(picture, left, top, 2, 5, edge_px(80, 5), letters),
            ".?\n"
            ".?\n"
            ".0\n"
            ".4\n"
            ".1\n");
  MapPictureOptions layer = options;
  layer.layer_z_m = 3.5;
  EXPECT_GT(count_of(render_map(map, layer), kColours.all_agree), 0U) << "of the upper cell alone";
}

// Kills heights that are drawn where they tell nothing, or not at all.
TEST(RenderMap, ColoursAPathByItsHeightWhereThatChanges) {
  OccupancyMap map({.resolution_m = 0.5});
  {
    Editor editor = map.edit();
    for (int x = 0; x < 20; ++x) editor.set(cell(x, 0, 0), 16, Clamp{}.lowest);
  }
  const auto path = [](double climb_m) {
    std::vector<StampedPose> poses;
    for (int i = 0; i <= 10; ++i) {
      poses.push_back({i * 1.0, pose_from_rpy({i * 1.0, 0.2, 0.1 * climb_m * i}, 0.0, 0.0, 0.0)});
    }
    return MapPath{"dive", *Trajectory::make(poses)};
  };
  const Rgb style{206, 24, 60};
  const auto height_of = [&](const MapPictureOptions& options) { return render_map(map, options).height(); };
  const Picture level = render_map(map, {.target_px = 400, .paths = {path(1.0)}});
  const Picture steep = render_map(map, {.target_px = 400, .paths = {path(8.0)}});
  EXPECT_GT(steep.height(), level.height()) << "a row of the legend";
  EXPECT_LT(count_of(steep, style), count_of(level, style) / 2);
  // Seen from a side, or beside another one.
  EXPECT_EQ(height_of({.target_px = 400, .paths = {path(8.0), path(1.0)}}),
            height_of({.target_px = 400, .paths = {path(1.0), path(1.0)}}));
  const Picture side = render_map(map, {.view = MapView::kRight, .target_px = 400, .paths = {path(8.0)}});
  EXPECT_GT(count_of(side, style), 0U);
}

TEST(RenderMap, ShowsOneLayerOfCells) {
  OccupancyMap map({.resolution_m = 0.05});
  {
    Editor editor = map.edit();
    for (int z = -3; z <= 3; ++z) editor.set(cell(100, 100 + z, z), 16, Clamp{}.highest);
  }
  const auto cells_at = [&](double z_m) {
    const Picture picture = render_map(map, {.target_px = 16, .layer_z_m = z_m});
    return count_of(picture, kColours.surely_occupied) / 256;
  };
  // A height between two layers belongs to the upper one.
  for (const double z_m : {0.0, 0.02, 0.05, -0.05, -0.15, 0.1, 0.15, 0.199}) EXPECT_EQ(cells_at(z_m), 1U) << z_m;
  for (const double z_m : {0.21, -0.16, 1e6, -1e300}) {
    EXPECT_GT(render_map(map, {.layer_z_m = z_m}).width(), 0U) << z_m;
  }
  // All of them from above, so that the layer is one of several.
  EXPECT_EQ(count_of(render_map(map, {.target_px = 16}), kColours.surely_occupied), 7U * 4U);
}

TEST(RenderMap, ShowsMoreThanIsKnownToBeCompared) {
  OccupancyMap small({.resolution_m = 1.0}), large({.resolution_m = 1.0});
  small.edit().set(cell(100, 100, 0), 16, Clamp{}.highest);
  large.edit().set(cell(98, 101, 0), 16, Clamp{}.highest);
  large.edit().set(cell(102, 99, 7), 16, Clamp{}.highest);
  const auto part = shown_part(large, {});
  ASSERT_TRUE(part);
  EXPECT_EQ(part->min, Eigen::Vector3d(98, 99, 0));
  EXPECT_EQ(part->max, Eigen::Vector3d(103, 102, 8));
  EXPECT_FALSE(shown_part(OccupancyMap{}, {}));
  EXPECT_EQ(shown_part(large, {.layer_z_m = 7.5})->min, Eigen::Vector3d(102, 99, 7));

  const Picture a = render_map(large, {.target_px = 100});
  const Picture b = render_map(small, {.target_px = 100, .at_least = part});
  EXPECT_EQ(a.width(), b.width());
  EXPECT_EQ(a.height(), b.height());
  // The cell in the middle of five by three.
  const auto [left, top] = corner_of_known(b);
  const auto [all_left, all_top] = corner_of_known(a);
  EXPECT_EQ(left, all_left + edge_px(100, 5));
  EXPECT_EQ(top, all_top + 2 * edge_px(100, 5));
}

TEST(RenderMap, ShowsOnlyTheSlab) {
  OccupancyMap map({.resolution_m = 1.0});
  {
    Editor editor = map.edit();
    editor.set(cell(100, 100, 0), 16, Clamp{}.lowest);
    editor.set(cell(100, 100, 3), 16, Clamp{}.highest);
    editor.set(cell(101, 100, 0), 16, Clamp{}.lowest);
  }
  const Picture all = render_map(map, {.target_px = 16});
  EXPECT_EQ(count_of(all, kColours.surely_occupied), edge_px(16, 2) * edge_px(16, 2));
  const Picture slab = render_map(map, {.target_px = 16, .min_z_m = 0.0, .max_z_m = 3.0});
  EXPECT_EQ(count_of(slab, kColours.surely_occupied), 0U);
  EXPECT_EQ(count_of(slab, kColours.surely_free), 2 * edge_px(16, 2) * edge_px(16, 2));
  // A slab may be open to one side.
  const Picture open = render_map(map, {.target_px = 16, .max_z_m = 3.0});
  EXPECT_TRUE(std::ranges::equal(open.rgb(), slab.rgb()));
  const Picture above = render_map(map, {.target_px = 16, .min_z_m = 3.0});
  EXPECT_GT(count_of(above, kColours.surely_occupied), 0U);
  EXPECT_EQ(count_of(above, kColours.surely_free), 0U);
}

// Below the map: from the colour of what is hardly occupied to that of what surely is.
TEST(RenderMap, TheLegendHasBothEndsOfEachColour) {
  OccupancyMap map({.resolution_m = 1.0});
  map.edit().set(cell(100, 100, 0), 16, LogOdds(0.0F));
  const Picture picture = render_map(map, {.target_px = 160});
  for (const Rgb colour :
       {kColours.barely_occupied, kColours.surely_occupied, kColours.barely_free, kColours.surely_free}) {
    std::size_t pixels = 0;
    for (std::size_t y = inside_of(picture).bottom; y < picture.height(); ++y) {
      for (std::size_t x = 0; x < picture.width(); ++x) pixels += picture.at(x, y) == colour ? 1 : 0;
    }
    EXPECT_GE(pixels, 18U) << "a column that no label covers";
  }
}

TEST(RenderMap, MarksTheOriginAndWhatIsUndecided) {
  OccupancyMap map({.resolution_m = 1.0, .thresholds = {LogOdds(-0.5F), LogOdds(0.5F)}});
  map.edit().set(cell(0, 0, 0), 13, LogOdds(0.0F));
  map.edit().set(cell(-8, -8, 0), 13, LogOdds(0.0F));
  const Picture picture = render_map(map, {.target_px = 160});
  EXPECT_GT(count_of(picture, kColours.undecided), 10'000U);
  // Where the two squares meet, in the middle.
  const auto [left, top] = corner_of_known(picture);
  const std::size_t x = left + 8 * edge_px(160, 16), y = top + 8 * edge_px(160, 16);
  EXPECT_EQ(picture.at(x, y), kCrossColour);
  EXPECT_EQ(picture.at(x + 10, y), kCrossColour);
  EXPECT_NE(picture.at(x + 13, y), kCrossColour);
}

TEST(RenderMap, AgreesWithEachColumnsHighestCell) {
  std::size_t checked = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    OccupancyMap map({.resolution_m = 0.1});
    {
      Editor editor = map.edit();
      for (int i = 0; i < 300; ++i) {
        const int size = 1 << (random() % 4);
        const auto place = [&] { return static_cast<int>(random() % 64) / size * size; };
        const int x = place(), y = place(), z = place();
        const LogOdds belief = random() % 3 == 0 ? Clamp{}.highest : Clamp{}.lowest;
        editor.set(cell(1024 + x, 1024 + y, z), 16 - std::countr_zero(static_cast<unsigned>(size)), belief);
      }
    }
    const auto box = map.bounds();
    ASSERT_TRUE(box);
    const auto cells = [](double m) { return static_cast<int>(std::lround(m / 0.1)); };
    const int low_x = cells(box->min.x()), high_x = cells(box->max.x());
    const int low_y = cells(box->min.y()), high_y = cells(box->max.y());
    const Picture picture = render_map(map, {.target_px = 64 * 4});
    const auto [left, top] = corner_of_known(picture);
    const auto nx = static_cast<std::size_t>(high_x - low_x), ny = static_cast<std::size_t>(high_y - low_y);
    std::string expected;
    for (int x = high_x - 1; x >= low_x; --x) {
      for (int y = high_y - 1; y >= low_y; --y) {
        char letter = ' ';
        for (int z = 0; z < 64; ++z) {
          const auto belief = map.at(cell(x, y, z));
          if (belief && letter != '#') letter = *belief > LogOdds(0.0F) ? '#' : '.';
        }
        expected += letter;
        ++checked;
      }
      expected += '\n';
    }
    EXPECT_EQ(as_text(picture, left, top, ny, nx, edge_px(256, std::max(nx, ny)), kMapLetters), expected);
  }
  EXPECT_GT(checked, 30'000U);
}

TEST(RenderMap, LosesNoThinWallWhereAPixelIsManyCells) {
  OccupancyMap map({.resolution_m = 0.01});
  {
    Editor editor = map.edit();
    editor.set(cell(0, 0, 0), 4, Clamp{}.lowest);                                      // 4096 cells a side
    for (int x = 0; x < 4096; ++x) editor.set(cell(x, 1234, 0), 16, Clamp{}.highest);  // one cell thick
  }
  const Picture picture = render_map(map, {.target_px = 500});
  EXPECT_LE(picture.width(), 700U);
  EXPECT_EQ(count_of(picture, kColours.surely_occupied), 4096U / 16U * edge_px(500, 256) * edge_px(500, 256));
}

TEST(RenderMap, DrawsMapsOfAnyDepthAndSize) {
  for (const int depth : {1, 2, 3, 16, 17, 64, 128}) {
    for (const double resolution_m : {1e-300, 0.05, 1e269}) {
      SCOPED_TRACE(::testing::Message() << depth << " levels, " << resolution_m << " m");
      OccupancyMap map({.resolution_m = resolution_m, .depth = depth});
      const Picture empty = render_map(map);
      EXPECT_GT(empty.width(), 0U);
      const WideWord last = depth == 128 ? ~WideWord{0} : (WideWord{1} << depth) - 1;
      map.edit().set(WideKey{}, depth, Clamp{}.highest);
      map.edit().set(WideKey{last, last, last}, depth, Clamp{}.lowest);
      const Picture corners = render_map(map);
      EXPECT_GT(count_of(corners, kColours.surely_occupied), 0U);
      EXPECT_GT(count_of(corners, kColours.surely_free), 0U);
      for (const MapView view : {MapView::kRight, MapView::kLeft, MapView::kFront, MapView::kBehind}) {
        const Picture side = render_map(map, {.view = view, .at_least = shown_part(map, {})});
        EXPECT_GT(count_of(side, kColours.surely_occupied), 0U);
      }
      const Picture layer = render_map(map, {.layer_z_m = 0.0, .at_least = Box{{-1e308, -1, 0}, {1e308, 1, 1e-320}}});
      EXPECT_LE(layer.width(), Picture::kMaxSide);
      map.edit().set(WideKey{}, 0, Clamp{}.highest);
      EXPECT_GT(count_of(render_map(map), kColours.surely_occupied), 0U);
    }
  }
}

TEST(MapPictureOptions, RefuseSenselessValues) {
  EXPECT_TRUE(MapPictureOptions{}.validate());
  EXPECT_FALSE(MapPictureOptions{.target_px = 0}.validate());
  EXPECT_FALSE(MapPictureOptions{.target_px = 4000}.validate());
  EXPECT_FALSE((MapPictureOptions{.min_z_m = 1.0, .max_z_m = 1.0}).validate());
  EXPECT_FALSE((MapPictureOptions{.min_z_m = 1.0, .layer_z_m = 1.0}).validate());
}

}  // namespace
