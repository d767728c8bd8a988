#include <gtest/gtest.h>

#include <atomic>
#include <random>
#include <thread>
#include <vector>

#include "pingvox/cloud/trace_points.hpp"
#include "pingvox/map/cast_ray.hpp"
#include "pingvox/map/for_each_leaf.hpp"

using namespace pingvox;

namespace {

// Run under the thread sanitizer: a const function that caches something would be seen here.
TEST(Threads, ManyReadersOfOneMapAgree) {
  OccupancyMap map({.resolution_m = 0.1});
  std::mt19937_64 random(1);
  const auto metre = [](std::mt19937_64& from) { return static_cast<double>(from() % 4000) * 1e-3 - 2.0; };
  for (int i = 0; i < 4; ++i) {
    PointScan points;
    for (int k = 0; k < 300; ++k) points.points_m.emplace_back(metre(random), metre(random), metre(random));
    ScanUpdate scan(map.lattice());
    ASSERT_EQ(trace_points(points, {}, scan), 0U);
    ASSERT_TRUE(map.apply(scan));
  }
  const OccupancyMap& shared = map;
  const auto read = [&] {
    std::mt19937_64 own(7);
    std::uint64_t seen = 0;
    for (int i = 0; i < 500; ++i) {
      const Eigen::Vector3d point_m(metre(own), metre(own), metre(own));
      const Key key = *shared.lattice().key_of(point_m);
      const int depth = static_cast<int>(own() % 17);
      seen += shared.at(key) ? 1U : 0U;
      seen += shared.node_at(key, depth) ? 2U : 0U;
      seen += static_cast<std::uint64_t>(shared.classify(point_m)) * 3;
      seen += static_cast<std::uint64_t>(cast_ray(shared, {0.0, 0.0, 0.0}, point_m, 5.0).range_m * 1000.0);
    }
    for_each_leaf(shared, {.max_depth = 14, .box = {}}, [&](const Leaf&) { ++seen; });
    // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): copying while others read is part of the test
    const OccupancyMap copied(shared);
    return seen + copied.counts().nodes() + static_cast<std::uint64_t>(shared.bounds()->max.x() * 10.0);
  };
  const std::uint64_t expected = read();
  std::atomic<int> agree = 0;
  std::vector<std::thread> readers;
  for (int i = 0; i < 4; ++i) readers.emplace_back([&] { agree += read() == expected ? 1 : 0; });
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(agree, 4);
  EXPECT_GT(expected, 10'000U);
}

OccupancyMap random_map() {
  OccupancyMap map({.resolution_m = 0.05});
  std::mt19937_64 random(3);
  Editor editor = map.edit();
  for (int i = 0; i < 20'000; ++i) {
    const auto word = [&] { return static_cast<std::uint16_t>(32768 - 40 + random() % 80); };
    editor.update(Key{word(), word(), word()}, LogOdds::from_probability(random() % 2 == 0 ? 0.7 : 0.4));
  }
  editor.synchronize();
  return map;
}

// Something static that all maps share (liboctomap's users know such) would be seen here.
TEST(Threads, MapsOfTheirOwnCanBeWrittenAtOnce) {
  const MapCounts alone = random_map().counts();
  ASSERT_GT(alone.leaves, 10'000U);
  std::atomic<int> alike = 0;
  std::vector<std::thread> writers;
  for (int i = 0; i < 4; ++i) {
    writers.emplace_back([&] {
      const MapCounts mine = random_map().counts();
      if (mine.leaves == alone.leaves && mine.inner == alone.inner) ++alike;
    });
  }
  for (std::thread& writer : writers) writer.join();
  EXPECT_EQ(alike, 4);
}

}  // namespace
