#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <random>
#include <sstream>

#include "pingvox/analysis/compare.hpp"
#include "pingvox/cloud/trace_points.hpp"
#include "pingvox/io/maps.hpp"
#include "support/logs.hpp"

namespace pingvox {
namespace {

using Eigen::Vector3d;

TEST(Cloud, BecomesTheMapThatOctomapMakesOfIt) {
  constexpr double kResolution_m = 0.125;
  std::uint64_t cells = 0, different = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const auto coordinate = [&] { return static_cast<float>(random() % 10'000) / 1000.0F - 5.0F; };
    octomap::Pointcloud cloud;
    std::ostringstream text;
    text.precision(9);
    text << "ply\nformat ascii 1.0\nelement vertex 500\nproperty float x\nproperty float y\nproperty float z\n"
            "end_header\n";
    for (int i = 0; i < 500; ++i) {
      const float x = coordinate(), y = coordinate(), z = coordinate();
      cloud.push_back(x, y, z);
      text << x << ' ' << y << ' ' << z << '\n';
    }
    const octomap::point3d origin(0.5F, -0.25F, 0.3F);
    octomap::OcTree tree(kResolution_m);
    tree.insertPointCloud(cloud, origin);

    const auto source =
        open_scans({"cloud", bytes_of(text.str())}, Damage::kFail, Vector3d(0.5, -0.25, static_cast<double>(0.3F)));
    ASSERT_TRUE(source) << source.error().message;
    const auto scan = (*source)->next();
    ASSERT_TRUE(scan && *scan);
    OccupancyMap map({.resolution_m = kResolution_m});
    ScanUpdate update(map.lattice(), LogOdds::from_probability(0.4));
    EXPECT_EQ(trace_points(**scan, {}, update), 0U);
    ASSERT_TRUE(map.apply(update));

    std::ostringstream bytes;
    ASSERT_TRUE(tree.write(bytes));
    const auto theirs = read_map({"OctoMap's", bytes_of(bytes.str())});
    ASSERT_TRUE(theirs) << theirs.error().message;
    const auto compared = compare_maps(map, theirs->map, Sameness::kLogOdds);
    ASSERT_TRUE(compared) << compared.error().message;
    cells += compared->cells();
    different += compared->cells() - compared->same;
  }
  EXPECT_GT(cells, 200'000U);
  EXPECT_LT(different * 5'000, cells);  // OctoMap computes rays in single precision
}

}  // namespace
}  // namespace pingvox
