#include <gtest/gtest.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "pingvox/analysis/compare.hpp"
#include "pingvox/mapping/build_map.hpp"
#include "tests/mapping/room.hpp"

namespace pingvox {
namespace {

class Room : public BeamSource {
 public:
  Result<std::optional<Beam>> next() override {
    if (n_ == beams_.size()) return std::nullopt;
    return beams_[n_++];
  }

 private:
  std::vector<Beam> beams_ = test::room(500);
  std::size_t n_ = 0;
};

class Cloud : public ScanSource {
 public:
  Result<std::optional<PointScan>> next() override {
    if (++scans_ > 3) return std::nullopt;
    PointScan scan;
    scan.origin_m = {0.1 * scans_, 0.0, 0.0};
    const auto metre = [&] { return static_cast<double>(random_() % 8000) * 1e-3 - 4.0; };
    for (int i = 0; i < 3000; ++i) scan.points_m.emplace_back(metre(), metre(), metre());
    return scan;
  }

 private:
  std::mt19937_64 random_{3};
  int scans_ = 0;
};

void expect_same(const OccupancyMap& a, const OccupancyMap& b) {
  const auto compared = compare_maps(a, b, Sameness::kLogOdds);
  ASSERT_TRUE(compared);
  EXPECT_GT(compared->cells(), 10'000U);
  EXPECT_TRUE(compared->equal());
  EXPECT_EQ(a.counts().nodes(), b.counts().nodes());
}

// Kills parts that share a scan, a part that is left out or taken twice, evidence lost when parts go into one.
TEST(BuildMapThreads, TheMapDoesNotDependOnTheirNumber) {
  for (const BeamShape shape : {BeamShape::kRay, BeamShape::kCone}) {
    std::unique_ptr<OccupancyMap> first;
    for (const std::size_t threads : {1U, 2U, 3U, 7U}) {
      SCOPED_TRACE(threads);
      BuildOptions options;
      options.model.shape = shape;
      options.threads = threads;
      Room room;
      auto map = std::make_unique<OccupancyMap>(MapOptions{.resolution_m = 0.04});
      const auto report = build_map(room, Trajectory::still(Pose::Identity()), options, *map);
      ASSERT_TRUE(report) << report.error().message;
      EXPECT_EQ(report->beams, 500U);
      EXPECT_GT(report->echoes, 450U);
      if (first) expect_same(*first, *map);
      if (!first) first = std::move(map);
    }
  }
  std::unique_ptr<OccupancyMap> first;
  for (const std::size_t threads : {1U, 2U, 5U}) {
    SCOPED_TRACE(threads);
    BuildOptions options;
    options.threads = threads;
    Cloud cloud;
    auto map = std::make_unique<OccupancyMap>(MapOptions{.resolution_m = 0.05});
    ASSERT_TRUE(build_map(cloud, Trajectory::still(Pose::Identity()), options, *map));
    if (first) expect_same(*first, *map);
    if (!first) first = std::move(map);
  }
}

TEST(BuildMapThreads, AreLimited) {
  BuildOptions options;
  options.threads = 0;
  EXPECT_FALSE(options.validate());
  options.threads = 257;
  EXPECT_FALSE(options.validate());
}

}  // namespace
}  // namespace pingvox
