#include "pingvox/web/scene_bytes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "page_columns.hpp"
#include "pingvox/map/for_each_leaf.hpp"
#include "web/point_collector.hpp"

// Bytes for the page, read by readers of their own and compared with the map cell by cell.
namespace pingvox::web {
namespace {

MapOptions options_of(int depth, double resolution_m = 0.1) {
  MapOptions options;
  options.resolution_m = resolution_m;
  options.depth = depth;
  return options;
}

/// Cells at random around the origin, some of them many times, and blocks that the tree joins.
OccupancyMap random_map(int depth, std::uint64_t seed, Thresholds thresholds = {}) {
  MapOptions options = options_of(depth);
  options.thresholds = thresholds;
  OccupancyMap map(options);
  std::mt19937_64 random(seed);
  const std::int64_t half = std::int64_t{1} << (depth - 1), reach = std::min<std::int64_t>(half, 20);
  const auto word = [&](std::int64_t from_centre) { return static_cast<std::uint16_t>(from_centre + half); };
  const auto any = [&] { return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(2 * reach)) - reach; };
  Editor editor = map.edit();
  for (int i = 0; i < 3000; ++i) {
    const double p = 0.2 + 0.05 * static_cast<double>(random() % 13);
    editor.update(Key{word(any()), word(any()), word(any())}, LogOdds::from_probability(p));
  }
  for (const int levels : {1, 2, 3}) {
    if (depth <= levels) continue;
    const Key key{word(any()), word(any()), word(any())};
    editor.set(key, depth - levels, LogOdds::from_probability(levels == 2 ? 0.2 : 0.9));
  }
  editor.synchronize();
  return map;
}

/// What each cell of a map should be on the page: probabilities as bytes, by cell counted from the origin.
std::map<test::CellIndex, int> expected_cells(const OccupancyMap& map, double lowest, std::int64_t reach) {
  std::map<test::CellIndex, int> cells;
  const std::int64_t half = std::int64_t{1} << (map.lattice().depth() - 1);
  for (std::int64_t x = -reach; x < reach; ++x) {
    for (std::int64_t y = -reach; y < reach; ++y) {
      for (std::int64_t z = -reach; z < reach; ++z) {
        const auto word = [half](std::int64_t from_centre) { return static_cast<std::uint16_t>(from_centre + half); };
        const auto belief = map.at(Key{word(x), word(y), word(z)});
        // A cell at the limit is in or out by rounding of its log-odds, as the map's own comparison is.
        if (!belief || *belief < LogOdds::from_probability(lowest)) continue;
        cells[{x, y, z}] = static_cast<int>(std::lround(belief->probability() * 255.0));
      }
    }
  }
  return cells;
}

TEST(SceneBytes, haveTheCellsOfAMapOfAnyDepth) {
  std::size_t cells = 0;
  for (const int depth : {1, 2, 3, 4, 5, 8, 16}) {
    const OccupancyMap map = random_map(depth, static_cast<std::uint64_t>(depth));
    const Result<Bytes> bytes = cells_bytes(map);
    ASSERT_TRUE(bytes) << bytes.error().message;
    const test::ReadCells read = test::read_cells(*bytes);
    const std::int64_t reach = std::min<std::int64_t>(std::int64_t{1} << (depth - 1), 32);
    EXPECT_EQ(read.probability, expected_cells(map, 0.4, reach)) << depth;
    EXPECT_EQ(read.lowest, 0.4F);
    EXPECT_EQ(read.resolution_m, 0.1F);
    cells += read.probability.size();
  }
  EXPECT_GT(cells, 5000U);
}

// Kills agreements in another order than the cells, and those of cells that are not sent.
TEST(SceneBytes, haveTheAgreementOfEachCell) {
  for (const int depth : {2, 5, 16}) {
    SceneMap shown{"map", "log", random_map(depth, 40U + static_cast<std::uint64_t>(depth))};
    const std::int64_t half = std::int64_t{1} << (depth - 1), reach = std::min<std::int64_t>(half, 32);
    std::mt19937_64 random(7);
    std::map<test::CellIndex, int> expected;
    for (const auto& [cell, probability] : expected_cells(shown.map, 0.01, reach)) {
      if (random() % 3 == 0) continue;
      const auto& [x, y, z] = cell;
      const auto word = [half](std::int64_t from_centre) { return static_cast<WideWord>(from_centre + half); };
      const auto judged = static_cast<std::uint32_t>(1 + random() % 9);
      const auto agreed = static_cast<std::uint32_t>(random() % (judged + 1));
      shown.agreement.push_back({{word(x), word(y), word(z)}, judged, agreed});
      expected[cell] = static_cast<int>(std::lround(1.0 + 254.0 * agreed / judged));
    }
    std::ranges::shuffle(shown.agreement, random);
    const Result<Bytes> cells = cells_bytes(shown.map), agreement = agreement_bytes(shown);
    ASSERT_TRUE(cells && agreement);
    // As the page reads it: the column of probabilities replaced.
    Bytes replaced = *cells;
    const test::ReadCells places = test::read_cells(*cells);
    ASSERT_EQ(agreement->size(), places.probability.size());
    const std::size_t columns = 32 + std::size_t{20} * places.bricks;
    std::ranges::copy(*agreement, replaced.begin() + static_cast<std::ptrdiff_t>(columns));
    for (const auto& [cell, level] : test::read_cells(replaced).probability) {
      EXPECT_EQ(level, expected.contains(cell) ? expected[cell] : 0);
    }
    Scene scene;
    scene.maps.push_back(shown);
    EXPECT_NE(scene_json(scene).find("\"map/0/agreement\""), std::string::npos);
  }
}

TEST(SceneBytes, putACellWhereItsCornerIs) {
  OccupancyMap map(options_of(16, 0.25));
  const Eigen::Vector3d point_m(-3.1, 7.6, -0.1);
  map.edit().update(*map.lattice().key_of(point_m), LogOdds::from_probability(0.8));
  const test::ReadCells read = test::read_cells(*cells_bytes(map));
  ASSERT_EQ(read.probability.size(), 1U);
  const auto& [x, y, z] = read.probability.begin()->first;
  const Eigen::Vector3d corner_m =
      0.25 * Eigen::Vector3d(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
  EXPECT_EQ(corner_m, Eigen::Vector3d(-3.25, 7.5, -0.25));
  EXPECT_EQ(read.probability.begin()->second, 204);
}

TEST(SceneBytes, goDownToALowThresholdOfTheMap) {
  const Thresholds low{LogOdds::from_probability(0.3), LogOdds::from_probability(0.3)};
  const OccupancyMap map = random_map(16, 7, low);
  const test::ReadCells read = test::read_cells(*cells_bytes(map));
  EXPECT_NEAR(read.lowest, 0.3F, 1e-6);
  EXPECT_EQ(read.probability, expected_cells(map, map.options().thresholds.upper.probability(), 32));
}

TEST(SceneBytes, haveTheFreeCellsAsCubes) {
  for (const int depth : {1, 2, 3, 6, 16}) {
    const OccupancyMap map = random_map(depth, 100 + static_cast<std::uint64_t>(depth));
    const Result<Bytes> bytes = free_bytes(map);
    ASSERT_TRUE(bytes) << bytes.error().message;
    std::map<test::CellIndex, int> read;
    for (const test::ReadCube& cube : test::read_cubes(*bytes)) {
      for (std::int64_t x = cube.x; x < cube.x + cube.edge; ++x) {
        for (std::int64_t y = cube.y; y < cube.y + cube.edge; ++y) {
          for (std::int64_t z = cube.z; z < cube.z + cube.edge; ++z) {
            EXPECT_TRUE(read.emplace(test::CellIndex{x, y, z}, 0).second) << "a cell twice";
          }
        }
      }
    }
    std::size_t free = 0;
    const std::int64_t half = std::int64_t{1} << (depth - 1), reach = std::min<std::int64_t>(half, 32);
    for (std::int64_t x = -reach; x < reach; ++x) {
      for (std::int64_t y = -reach; y < reach; ++y) {
        for (std::int64_t z = -reach; z < reach; ++z) {
          const auto word = [half](std::int64_t from_centre) { return static_cast<std::uint16_t>(from_centre + half); };
          const bool is_free = map.classify(Key{word(x), word(y), word(z)}) == Occupancy::kFree;
          EXPECT_EQ(is_free, read.contains({x, y, z})) << depth << ": " << x << " " << y << " " << z;
          free += is_free ? 1 : 0;
        }
      }
    }
    EXPECT_EQ(free, read.size());
  }
}

TEST(SceneBytes, ofAnEmptyMapAreAHeader) {
  const OccupancyMap map;
  EXPECT_TRUE(test::read_cells(*cells_bytes(map)).probability.empty());
  EXPECT_TRUE(test::read_cubes(*free_bytes(map)).empty());
}

TEST(SceneBytes, refuseMapsThatNoBrowserHolds) {
  OccupancyMap vast(options_of(16));
  vast.edit().set(Key{}, 4, LogOdds::from_probability(0.9));
  EXPECT_EQ(cells_bytes(vast).error().code, Error::Code::kLimit);
  EXPECT_TRUE(free_bytes(vast));
  OccupancyMap far(options_of(64));
  far.edit().update(WideKey{}, LogOdds::from_probability(0.9));
  EXPECT_EQ(cells_bytes(far).error().code, Error::Code::kLimit);
  OccupancyMap far_and_free(options_of(64));
  far_and_free.edit().update(WideKey{}, LogOdds::from_probability(0.1));
  EXPECT_EQ(free_bytes(far_and_free).error().code, Error::Code::kLimit);
  EXPECT_TRUE(test::read_cells(*cells_bytes(far_and_free)).probability.empty());
  // A large free leaf is one cube.
  OccupancyMap open(options_of(16));
  open.edit().set(Key{}, 0, LogOdds::from_probability(0.1));
  const auto cubes = test::read_cubes(*free_bytes(open));
  ASSERT_EQ(cubes.size(), 1U);
  EXPECT_EQ(cubes[0].edge, 65536);
  EXPECT_EQ(cubes[0].x, -32768);
}

TEST(SceneBytes, keepMillimetresFarFromTheOrigin) {
  Scene scene;
  const Eigen::Vector3d far_m(412345.678, 4567890.123, -12.5);
  std::vector<StampedPose> poses;
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 50; ++i) {
    Pose pose = pose_from_rpy(far_m + 20.0 * Eigen::Vector3d(normal(random), normal(random), normal(random)),
                              normal(random), 0.3 * normal(random), normal(random));
    poses.push_back({1.7e9 + i * 0.125, pose});
  }
  add_path("path.tum", *Trajectory::make(poses), scene);
  const Eigen::Vector3d origin_m = scene.origin_m();
  EXPECT_LT((origin_m - far_m).norm(), 100.0);
  EXPECT_EQ(origin_m, Eigen::Vector3d(origin_m.array().round()));
  const Bytes bytes = path_bytes(scene.paths[0], origin_m);
  test::NumberReader in(bytes);
  EXPECT_EQ(in.take<std::uint32_t>(), 0x50585650U);
  EXPECT_EQ(in.take<std::uint32_t>(), 50U);
  in.take<std::uint64_t>();
  const auto times = in.take<double>(50);
  std::vector<std::vector<float>> columns;
  for (int i = 0; i < 7; ++i) columns.push_back(in.take<float>(50));
  EXPECT_EQ(in.left(), 0U);
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_EQ(times[i], poses[i].time_s);
    const Pose& pose = poses[i].map_from_body;
    const Eigen::Vector3d read_m = origin_m + Eigen::Vector3d(columns[0][i], columns[1][i], columns[2][i]);
    EXPECT_LT((read_m - pose.translation()).norm(), 1e-4);
    const Eigen::Quaterniond turn(columns[6][i], columns[3][i], columns[4][i], columns[5][i]);
    EXPECT_LT((turn.toRotationMatrix() - pose.linear()).norm(), 1e-5);
  }
  EXPECT_NE(scene_json(scene).find("\"clock\": \"unix\""), std::string::npos);
}

TEST(SceneBytes, ofPointsAreTheirCoordinates) {
  const ScenePoints cloud{"cloud.ply", {{1.0, 2.0, 3.0}, {-4.0, 5.5, 0.25}}};
  const Bytes bytes = points_bytes(cloud, Eigen::Vector3d(1.0, 0.0, 0.0));
  test::NumberReader in(bytes);
  EXPECT_EQ(in.take<std::uint32_t>(), 0x58585650U);
  EXPECT_EQ(in.take<std::uint32_t>(), 2U);
  EXPECT_EQ(in.take<std::uint32_t>(), 0U);
  in.take<std::uint32_t>();
  EXPECT_EQ(in.take<float>(2), (std::vector<float>{0.0F, -5.0F}));
  EXPECT_EQ(in.take<float>(2), (std::vector<float>{2.0F, 5.5F}));
  EXPECT_EQ(in.take<float>(2), (std::vector<float>{3.0F, 0.25F}));
  EXPECT_EQ(in.take<float>(2).size(), 2U);
  EXPECT_EQ(in.left(), 0U);
}

TEST(SceneBytes, ofALogAreItsBeams) {
  SceneLog log;
  log.bins = 4;
  log.beams = {{.time_s = 1.5,
                .bearing_rad = 0.25,
                .bin_length_m = 0.1,
                .echo_m = 3.5,
                .echo_probability = 0.625,
                .threshold = 80.0,
                .sweep = 0},
               {.time_s = 2.5, .bearing_rad = 0.5, .bin_length_m = 0.2, .sweep = 1}};
  const Bytes bytes = beams_bytes(log);
  test::NumberReader in(bytes);
  EXPECT_EQ(in.take<std::uint32_t>(), 0x4c585650U);
  EXPECT_EQ(in.take<std::uint32_t>(), 2U);
  EXPECT_EQ(in.take<std::uint32_t>(), 4U);
  in.take<std::uint32_t>();
  EXPECT_EQ(in.take<double>(2), (std::vector<double>{1.5, 2.5}));
  EXPECT_EQ(in.take<float>(2), (std::vector<float>{0.25F, 0.5F}));
  EXPECT_EQ(in.take<float>(2), (std::vector<float>{0.0F, 0.0F}));
  EXPECT_EQ(in.take<float>(2), (std::vector<float>{0.1F, 0.2F}));
  const auto echoes = in.take<float>(2);
  EXPECT_EQ(echoes[0], 3.5F);
  EXPECT_TRUE(std::isnan(echoes[1]));
  EXPECT_EQ(in.take<float>(2)[0], 0.625F);
  const auto thresholds = in.take<float>(2);
  EXPECT_EQ(thresholds[0], 80.0F);
  EXPECT_TRUE(std::isnan(thresholds[1]));
  EXPECT_EQ(in.take<std::uint32_t>(2), (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(in.left(), 0U);
}

TEST(SceneBytes, cloudsOfMoreThanTheMostPointsAreThinnedEvenly) {
  PointCollector points;
  const std::size_t count = 2 * kMaxPoints + 3;
  for (std::size_t i = 0; i < count; ++i) points.add({static_cast<double>(i), 0.0, 0.0});
  Scene scene;
  points.finish("cloud.ply", scene);
  ASSERT_EQ(scene.points.size(), 1U);
  const auto& kept = scene.points[0].points_m;
  ASSERT_GT(kept.size(), kMaxPoints / 3);
  ASSERT_LE(kept.size(), kMaxPoints);
  const double step = kept[1].x() - kept[0].x();
  for (std::size_t i = 1; i < kept.size(); ++i) ASSERT_EQ(kept[i].x() - kept[i - 1].x(), step) << i;
  ASSERT_EQ(scene.notes.size(), 1U);
  EXPECT_NE(scene.notes[0].find("cloud.ply: one of 4 of its 4000003 points is shown"), std::string::npos)
      << scene.notes[0];
}

}  // namespace
}  // namespace pingvox::web
