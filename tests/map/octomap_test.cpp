// liboctomap as the second oracle: the same updates must give the same tree, bit for bit.
#include <gtest/gtest.h>
#include <octomap/octomap.h>

#include <cmath>
#include <limits>
#include <random>

#include "geometry/internal/ray_dda.hpp"
#include "pingvox/cloud/trace_points.hpp"
#include "pingvox/map/cast_ray.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/map/scan_update.hpp"
#include "support/differences.hpp"
#include "support/oracle_map.hpp"

using namespace pingvox;
using test::first_difference;
using test::Node;
using test::nodes_of;

namespace {

constexpr double kResolution = 0.1;

WideKey wide(const octomap::OcTreeKey& key) {
  return {key[0], key[1], key[2]};
}
Key narrow(const octomap::OcTreeKey& key) {
  return {key[0], key[1], key[2]};
}

std::vector<Node> octomap_nodes(octomap::OcTree& tree) {
  std::vector<Node> all;
  for (auto it = tree.begin_tree(), end = tree.end_tree(); it != end; ++it) {
    all.push_back({wide(it.getIndexKey()), static_cast<int>(it.getDepth()), it.isLeaf(),
                   std::bit_cast<std::uint32_t>(it->getLogOdds())});
  }
  return all;
}

double share(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}

/// Points in rooms of a few metres, so that rays cross and cells reach their clamps.
octomap::Pointcloud random_cloud(std::mt19937_64& random, std::size_t points) {
  octomap::Pointcloud cloud;
  const double half_m = 1.0 + 2.0 * share(random);
  for (std::size_t i = 0; i < points; ++i) {
    Eigen::Vector3d point(share(random) - 0.5, share(random) - 0.5, share(random) - 0.5);
    point *= half_m / point.cwiseAbs().maxCoeff();
    cloud.push_back(static_cast<float>(point.x()), static_cast<float>(point.y()), static_cast<float>(point.z()));
  }
  return cloud;
}

TEST(Octomap, SingleUpdatesGiveTheSameTree) {
  std::size_t compared = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    octomap::OcTree eager(kResolution), lazy(kResolution);
    OccupancyMap at_once({.resolution_m = kResolution}), lazily({.resolution_m = kResolution});
    constexpr std::array kEvidence{0.85F, -0.4F, 3.0F, -3.0F, 0.1F};
    for (int round = 0; round < 4; ++round) {
      {
        Editor at_once_editor = at_once.edit(Pruning::kEachUpdate);
        Editor lazily_editor = lazily.edit(Pruning::kLazy);
        const bool fills = random() % 2 == 0;
        for (int i = 0; i < 4'000; ++i) {
          // In a filling round each cell of a cube of 16 gets the same.
          const auto word = [&](int axis) {
            const int offset = fills ? (i >> (4 * axis)) & 15 : static_cast<int>(random() % 24);
            return static_cast<std::uint16_t>(32760 + offset);
          };
          const octomap::OcTreeKey key(word(0), word(1), word(2));
          const float evidence = fills ? kEvidence[static_cast<std::size_t>(round)] : kEvidence[random() % 5];
          eager.updateNode(key, evidence);
          lazy.updateNode(key, evidence, true);
          at_once_editor.update(narrow(key), LogOdds(evidence));
          lazily_editor.update(narrow(key), LogOdds(evidence));
        }
      }
      lazy.updateInnerOccupancy();
      lazy.prune();
      const std::vector<Node> expected = octomap_nodes(eager);
      ASSERT_EQ(first_difference(octomap_nodes(lazy), expected), "") << "OctoMap's two ways differ";
      ASSERT_EQ(first_difference(nodes_of(at_once), expected), "");
      ASSERT_EQ(first_difference(nodes_of(lazily), expected), "");
      compared += expected.size();
      for (int i = 0; i < 2'000; ++i) {
        const octomap::OcTreeKey key(static_cast<std::uint16_t>(32750 + random() % 40),
                                     static_cast<std::uint16_t>(32750 + random() % 40),
                                     static_cast<std::uint16_t>(32750 + random() % 40));
        const int depth = static_cast<int>(1 + random() % 16);
        const octomap::OcTreeNode* const theirs = eager.search(key, static_cast<unsigned>(depth));
        const auto ours = at_once.node_at(narrow(key), depth);
        ASSERT_EQ(theirs != nullptr, ours.has_value());
        if (theirs == nullptr) continue;
        ASSERT_EQ(theirs->getLogOdds(), ours->belief().value());
        ASSERT_EQ(theirs->getOccupancy(), ours->belief().probability());
        ASSERT_EQ(eager.isNodeOccupied(theirs), classify(ours->belief()) == Occupancy::kOccupied);
      }
    }
  }
  EXPECT_GT(compared, 100'000U);
}

TEST(Octomap, TheSameFreedAndHitCellsGiveTheSameTree) {
  std::size_t compared = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    octomap::OcTree tree(kResolution);
    OccupancyMap map({.resolution_m = kResolution});
    for (int i = 0; i < 12; ++i) {
      const octomap::point3d origin(static_cast<float>(share(random) - 0.5), static_cast<float>(share(random)), 0.0F);
      const octomap::Pointcloud cloud = random_cloud(random, 1'500);
      octomap::KeySet free_cells, occupied_cells;
      tree.computeUpdate(cloud, origin, free_cells, occupied_cells, -1.0);
      tree.insertPointCloud(cloud, origin, -1.0, i % 2 == 0);
      ScanUpdate scan(map.lattice());
      for (const auto& key : free_cells) scan.add_miss(narrow(key));
      for (const auto& key : occupied_cells) scan.add_hit(narrow(key), LogOdds::from_probability(0.7));
      const auto report = map.apply(scan);
      ASSERT_TRUE(report);
      ASSERT_EQ(report->cells_freed, free_cells.size());
      ASSERT_EQ(report->cells_hit, occupied_cells.size());
    }
    tree.updateInnerOccupancy();
    tree.prune();
    const std::vector<Node> expected = octomap_nodes(tree);
    ASSERT_EQ(first_difference(nodes_of(map), expected), "");
    const MapCounts counts = map.counts();
    EXPECT_EQ(counts.leaves, tree.getNumLeafNodes());
    EXPECT_EQ(counts.nodes(), tree.size());
    compared += expected.size();
  }
  EXPECT_GT(compared, 50'000U);
}

TEST(Octomap, TracedPointsFreeAndHitTheCellsOfInsertPointCloud) {
  std::size_t same = 0, different = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    octomap::OcTree tree(kResolution);
    OccupancyMap map({.resolution_m = kResolution});
    const octomap::point3d origin(0.03F, 0.04F, 0.06F);
    const octomap::Pointcloud cloud = random_cloud(random, 300);
    const double max_range_m = seed % 2 == 0 ? 2.0 : -1.0;
    octomap::KeySet free_cells, occupied_cells;
    tree.computeUpdate(cloud, origin, free_cells, occupied_cells, max_range_m);
    PointScan points;
    points.origin_m = {origin.x(), origin.y(), origin.z()};
    for (const auto& point : cloud) points.points_m.emplace_back(point.x(), point.y(), point.z());
    PointScanOptions options;
    if (max_range_m > 0.0) options.max_range_m = max_range_m;
    ScanUpdate scan(map.lattice());
    EXPECT_EQ(trace_points(points, options, scan), 0U);
    ASSERT_TRUE(map.apply(scan));
    std::size_t alike = 0;
    for (const auto& key : free_cells) alike += map.classify(narrow(key)) == Occupancy::kFree ? 1 : 0;
    for (const auto& key : occupied_cells) {
      ASSERT_EQ(map.classify(narrow(key)), Occupancy::kOccupied);
      ++alike;
    }
    const MapCounts counts = map.counts();
    same += alike;
    different += free_cells.size() + occupied_cells.size() - alike;
    different += counts.occupied_cells + counts.free_cells - alike;
  }
  EXPECT_GT(same, 100'000U);
  EXPECT_LT(different * 10'000, same);  // OctoMap computes rays in single precision
  RecordProperty("cells_alike", static_cast<int>(same));
  RecordProperty("cells_different", static_cast<int>(different));
}

TEST(Octomap, RaysCrossTheSameCells) {
  std::mt19937_64 random(5);
  octomap::OcTree tree(kResolution);
  const Lattice lattice(kResolution);
  int same = 0;
  constexpr int kRays = 20'000;
  for (int i = 0; i < kRays; ++i) {
    const auto metre = [&] { return static_cast<float>((share(random) - 0.5) * 20.0); };
    const octomap::point3d from(metre(), metre(), metre()), to(metre(), metre(), metre());
    octomap::KeyRay theirs;
    ASSERT_TRUE(tree.computeRayKeys(from, to, theirs));
    const auto ours = dda<std::uint16_t>(lattice, {from.x(), from.y(), from.z()}, {to.x(), to.y(), to.z()});
    ASSERT_TRUE(ours);
    std::vector<Key> cells, expected;
    for (const Key key : *ours) cells.push_back(key);
    for (const auto& key : theirs) expected.push_back(narrow(key));
    same += cells == expected ? 1 : 0;
  }
  EXPECT_GT(same, kRays - 100);
  RecordProperty("rays_alike", same);
}

TEST(Octomap, RaysSentThroughAMapHitTheSameCells) {
  std::mt19937_64 random(6);
  octomap::OcTree tree(kResolution);
  OccupancyMap map({.resolution_m = kResolution});
  {
    Editor editor = map.edit();
    for (int i = 0; i < 30'000; ++i) {
      const auto word = [&] { return static_cast<std::uint16_t>(32768 - 16 + random() % 32); };
      const octomap::OcTreeKey key(word(), word(), word());
      const float evidence = random() % 40 == 0 ? 0.85F : -0.4F;
      tree.updateNode(key, evidence);
      editor.update(narrow(key), LogOdds(evidence));
    }
  }
  int alike = 0, hits = 0, blocked = 0;
  constexpr int kRays = 10'000;
  for (int i = 0; i < kRays; ++i) {
    SCOPED_TRACE(i);
    const bool ignore_unknown = i % 2 == 0;
    const auto part = [&] { return static_cast<float>(share(random) - 0.5); };
    const octomap::point3d origin(part(), part(), part()), direction(part(), part(), part());
    octomap::point3d end;
    const bool is_hit = tree.castRay(origin, direction, end, ignore_unknown, 100.0);
    const RayEnd ours =
        cast_ray(map, {origin.x(), origin.y(), origin.z()}, {direction.x(), direction.y(), direction.z()}, 100.0,
                 ignore_unknown ? UnknownCells::kPass : UnknownCells::kBlock);
    octomap::OcTreeKey end_key;
    const bool both_gone = !is_hit && ignore_unknown && ours.what == Occupancy::kFree;
    const bool same_end =
        tree.coordToKeyChecked(end, end_key) && wide(end_key) == ours.key &&
        (is_hit ? ours.what == Occupancy::kOccupied : ours.what == Occupancy::kUnknown && !ignore_unknown);
    alike += both_gone || same_end ? 1 : 0;
    hits += is_hit ? 1 : 0;
    blocked += !is_hit && !ignore_unknown ? 1 : 0;
    if (ours.what == Occupancy::kFree) continue;
    // The range is where the ray enters the cell that it ends in.
    const Eigen::Vector3d way = Eigen::Vector3d(direction.x(), direction.y(), direction.z()).normalized();
    const Eigen::Vector3d entry = Eigen::Vector3d(origin.x(), origin.y(), origin.z()) + way * ours.range_m;
    const Eigen::Vector3d off = (entry - map.lattice().centre_of(ours.key)).cwiseAbs();
    EXPECT_LE(off.maxCoeff(), 0.5 * kResolution + 1e-9);
  }
  EXPECT_GT(hits, 2'000);
  EXPECT_GT(blocked, 500);
  EXPECT_GT(alike, kRays - 20);
  RecordProperty("alike", alike);
}

TEST(Octomap, KeysOfPointsAreTheSame) {
  std::mt19937_64 random(9);
  std::size_t inside = 0, outside = 0;
  for (const double resolution_m : {0.05, 0.1, 0.0125, 1.0, 0.3, 7.77}) {
    const octomap::OcTree tree(resolution_m);
    const Lattice lattice(resolution_m);
    const double border = std::ldexp(resolution_m, 15);
    const auto check = [&](double metre) {
      octomap::key_type theirs = 0;
      const bool is_inside = tree.coordToKeyChecked(metre, theirs);
      const auto ours = lattice.key_of({0.0, metre, 0.0});
      ASSERT_EQ(ours.has_value(), is_inside) << metre;
      ++(is_inside ? inside : outside);
      if (!is_inside) return;
      ASSERT_EQ(ours->y, theirs) << metre;
      ASSERT_EQ(lattice.centre_of(*ours).y(), tree.keyToCoord(theirs));
      for (unsigned depth = 0; depth <= 16; ++depth) {
        ASSERT_EQ(lattice.centre_of(*ours, static_cast<int>(depth)).y(), tree.keyToCoord(theirs, depth)) << depth;
      }
    };
    for (int i = 0; i < 20'000; ++i) {
      const double anywhere = (share(random) - 0.5) * 2.1 * border;
      const double on_a_face = std::floor(anywhere / resolution_m) * resolution_m;
      for (const double metre :
           {anywhere, on_a_face, std::nextafter(on_a_face, 1e9), std::nextafter(on_a_face, -1e9)}) {
        ASSERT_NO_FATAL_FAILURE(check(metre));
      }
    }
    const double inf = std::numeric_limits<double>::infinity();
    for (const double metre : {border, -border, std::nextafter(border, 0.0), std::nextafter(-border, -inf), 0.0, -0.0,
                               5e-324, -5e-324, 1e300, -1e300, inf, -inf}) {
      ASSERT_NO_FATAL_FAILURE(check(metre));
    }
    // liboctomap's answer depends on the processor: it makes NaN an integer.
    EXPECT_FALSE(lattice.key_of({0.0, std::nan(""), 0.0}));
  }
  EXPECT_GT(inside, 400'000U);
  EXPECT_GT(outside, 10'000U);
}

}  // namespace
