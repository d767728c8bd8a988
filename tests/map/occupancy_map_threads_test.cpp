#include <gtest/gtest.h>

#include <atomic>
#include <random>
#include <thread>
#include <vector>

#include "pingvox/map/for_each_leaf.hpp"
#include "pingvox/map/occupancy_map.hpp"

using namespace pingvox;

namespace {

/// What a reader sees of a map, as numbers that are the same for each reader of an unchanged map.
struct Sight {
  double at_points = 0.0;
  double leaves = 0.0;
  MapCounts counts;
  std::size_t asked = 0;
};

Sight look_at(const OccupancyMap& map) {
  Sight sight;
  std::mt19937_64 random(7);
  for (int i = 0; i < 5'000; ++i) {
    const auto coordinate = [&] { return static_cast<double>(random() % 400) * 0.01 - 2.0; };
    const Eigen::Vector3d point(coordinate(), coordinate(), coordinate());
    const auto belief = map.at(point);
    sight.at_points += belief ? double{belief->value()} : 100.0;
    ++sight.asked;
  }
  for_each_leaf<WideWord>(map, {}, [&](const Leaf<WideWord>& leaf) { sight.leaves += double{leaf.belief.value()}; });
  sight.counts = map.counts();
  return sight;
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

// A const function that caches or settles something behind the caller's back would be a race.
TEST(OccupancyMapThreads, ManyReadersAtOnceSeeWhatOneSees) {
  const OccupancyMap map = random_map();
  const Sight alone = look_at(map);
  ASSERT_GT(alone.counts.leaves, 10'000U);
  std::atomic<int> alike = 0;
  std::vector<std::thread> readers;
  for (int i = 0; i < 4; ++i) {
    readers.emplace_back([&] {
      const Sight mine = look_at(map);
      if (mine.at_points == alone.at_points && mine.leaves == alone.leaves && mine.asked == alone.asked &&
          mine.counts.nodes() == alone.counts.nodes()) {
        ++alike;
      }
    });
  }
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(alike, 4);
}

// A static shared by all maps (liboctomap's users know them) would be a race between writers of different maps.
TEST(OccupancyMapThreads, MapsOfTheirOwnCanBeWrittenAtOnce) {
  const MapCounts alone = random_map().counts();
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
