#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <octomap/ScanGraph.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <limits>
#include <numbers>
#include <random>
#include <sstream>

#include "pingvox/io/file.hpp"
#include "support/logs.hpp"

namespace pingvox {
namespace {

using testing::HasSubstr;

Eigen::Vector3d to_double(const octomap::point3d& p) {
  return Eigen::Vector3f(p.x(), p.y(), p.z()).cast<double>();
}

/// What graph2tree hands to insertPointCloud, computed by liboctomap in the order in which that tool does it.
std::vector<PointScan> scans_by_octomap(octomap::ScanGraph& graph) {
  std::vector<PointScan> scans;
  for (octomap::ScanNode* node : graph) {
    const octomap::pose6d pose = node->pose;
    const octomap::point3d sensor_origin = pose.inv().transform(node->pose.trans());
    node->scan->transform(pose);
    PointScan scan;
    scan.origin_m = to_double(pose.transform(sensor_origin));
    for (const octomap::point3d& point : *node->scan) scan.points_m.push_back(to_double(point));
    scans.push_back(std::move(scan));
  }
  return scans;
}

std::size_t expect_same(const std::vector<PointScan>& ours, const std::vector<PointScan>& octomaps) {
  std::size_t checked = 0;
  EXPECT_EQ(ours.size(), octomaps.size());
  for (std::size_t i = 0; i < std::min(ours.size(), octomaps.size()); ++i) {
    SCOPED_TRACE(i);
    EXPECT_EQ(ours[i].origin_m, octomaps[i].origin_m);
    EXPECT_EQ(ours[i].points_m, octomaps[i].points_m);
    checked += ours[i].points_m.size();
  }
  return checked;
}

float random_float(std::mt19937_64& random, double size) {
  return static_cast<float>((static_cast<double>(random() >> 11) * 0x1p-53 - 0.5) * 2.0 * size);
}

/// Scans from everywhere, some of them empty, joined by edges.
void fill(octomap::ScanGraph& graph, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const std::size_t nodes = 1 + random() % 6;
  for (std::size_t i = 0; i < nodes; ++i) {
    auto* const cloud = new octomap::Pointcloud;  // the graph takes it
    const std::size_t points = random() % 300;
    const double size = std::pow(10.0, static_cast<double>(random() % 5) - 2.0);
    for (std::size_t j = 0; j < points; ++j) {
      cloud->push_back(random_float(random, size), random_float(random, size), random_float(random, size));
    }
    const double pi = std::numbers::pi;
    graph.addNode(cloud, octomap::pose6d(random_float(random, size), random_float(random, size),
                                         random_float(random, size), static_cast<double>(random_float(random, pi)),
                                         static_cast<double>(random_float(random, pi)),
                                         static_cast<double>(random_float(random, pi))));
    graph.connectPrevious();
  }
}

std::vector<std::uint8_t> graph_bytes(const octomap::ScanGraph& graph) {
  std::stringstream out;
  graph.writeBinary(out);
  return bytes_of(out.str());
}

TEST(ScanGraph, GivesThePointsThatOctomapMapsToTheLastBit) {
  std::size_t checked = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    octomap::ScanGraph graph;
    fill(graph, seed);
    const auto all = all_scans({"a.graph", graph_bytes(graph)}, Damage::kFail);
    EXPECT_EQ(all.error, "");
    checked += expect_same(all.items, scans_by_octomap(graph));
  }
  EXPECT_GT(checked, 20'000U);
}

TEST(ScanGraph, ReadsTheSphericalScan) {
  const std::string path = PINGVOX_SHARED_DATA "/octomap-share/spherical_scan.graph";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const auto file = read_file(path);
  ASSERT_TRUE(file) << file.error().message;
  octomap::ScanGraph graph;
  ASSERT_TRUE(graph.readBinary(path));
  const auto all = all_scans(*file, Damage::kFail);
  EXPECT_EQ(all.error, "");
  EXPECT_EQ(expect_same(all.items, scans_by_octomap(graph)), 10'201U);
}

TEST(ScanGraph, ReadsAGraphOfNothing) {
  const auto all = all_scans({"a.graph", std::vector<std::uint8_t>(8)}, Damage::kFail);
  EXPECT_EQ(all.error, "");
  EXPECT_TRUE(all.items.empty());
}

TEST(ScanGraph, RefusesEachTruncation) {
  octomap::ScanGraph graph;
  fill(graph, 3);
  const std::vector<std::uint8_t> bytes = graph_bytes(graph);
  ASSERT_GT(graph.size(), 1U);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    SCOPED_TRACE(size);
    const auto all = all_scans({"a.graph", {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)}});
    EXPECT_TRUE(all.items.empty());
    EXPECT_THAT(all.error, HasSubstr("a.graph"));
  }
}

/// One scan of three points as bytes, to damage it at known places.
class DamagedGraph : public testing::Test {
 protected:
  DamagedGraph() {
    octomap::ScanGraph graph;
    for (int i = 0; i < 2; ++i) {
      auto* const cloud = new octomap::Pointcloud;
      for (int j = 0; j < 3; ++j) cloud->push_back(1.0F, 2.0F, static_cast<float>(j));
      graph.addNode(cloud, octomap::pose6d(1, 2, 3, 0, 0, 0));
    }
    bytes_ = graph_bytes(graph);
  }

  void put(std::size_t at, double value) { std::memcpy(bytes_.data() + at, &value, sizeof value); }
  void put(std::size_t at, std::uint32_t value) { std::memcpy(bytes_.data() + at, &value, sizeof value); }

  static constexpr std::size_t kPoint = 8;
  static constexpr std::size_t kTranslation = kPoint + 3 * 28;
  static constexpr std::size_t kRotation = kTranslation + 28;

  std::vector<std::uint8_t> bytes_;
};

TEST_F(DamagedGraph, LeavesOutPointsThatAreNotFinite) {
  put(kPoint + 28 + 4, std::numeric_limits<double>::quiet_NaN());
  put(kPoint + 56 + 4, 1e300);  // no float
  const auto all = all_scans({"a.graph", bytes_});
  EXPECT_EQ(all.error, "");
  EXPECT_EQ(all.skipped, 2U);
  ASSERT_EQ(all.items.size(), 2U);
  EXPECT_EQ(all.items[0].points_m.size(), 1U);
  EXPECT_EQ(all.items[1].points_m.size(), 3U);
  EXPECT_EQ(all_scans({"a.graph", bytes_}, Damage::kFail).error, "a.graph: scan 0, point 1: is not finite");
}

TEST_F(DamagedGraph, LeavesOutScansWithoutAPose) {
  const auto expect_one_left = [this](const char* what) {
    SCOPED_TRACE(what);
    const auto all = all_scans({"a.graph", bytes_});
    EXPECT_EQ(all.error, "");
    EXPECT_EQ(all.skipped, 1U);
    ASSERT_EQ(all.items.size(), 1U);
    EXPECT_EQ(all.items[0].number, 1U);
    EXPECT_THAT(all_scans({"a.graph", bytes_}, Damage::kFail).error, HasSubstr("a.graph: scan 0: its pose"));
  };
  const std::vector<std::uint8_t> whole = bytes_;
  put(kTranslation + 4, std::numeric_limits<double>::infinity());
  expect_one_left("translation");
  bytes_ = whole;
  put(kRotation + 4, 0.0);
  expect_one_left("no rotation");
  bytes_ = whole;
  put(kRotation + 4, std::numeric_limits<double>::quiet_NaN());
  expect_one_left("NaN");
  bytes_ = whole;
  put(kRotation, std::uint32_t{3});
  expect_one_left("count");
}

TEST_F(DamagedGraph, RefusesCountsThatTheBytesDoNotHold) {
  const std::vector<std::uint8_t> whole = bytes_;
  put(0, std::uint32_t{0xffffffff});
  EXPECT_THAT(all_scans({"a.graph", bytes_}).error, HasSubstr("does not fit"));
  bytes_ = whole;
  put(4, std::uint32_t{0xffffffff});
  EXPECT_THAT(all_scans({"a.graph", bytes_}).error, HasSubstr("scan 0 of 2 does not fit"));
  bytes_ = whole;
  put(bytes_.size() - 4, std::uint32_t{1000000});
  EXPECT_THAT(all_scans({"a.graph", bytes_}).error, HasSubstr("1000000 edges need 80000000 bytes, 0 are left"));
}

/// As log2graph and then graph2tree read it.
std::vector<PointScan> log_by_octomap(const std::string& text) {
  std::stringstream in(text);
  octomap::ScanGraph graph;
  std::streambuf* const talk = std::cerr.rdbuf(nullptr);  // a line for each scan
  graph.readPlainASCII(in);
  std::cerr.rdbuf(talk);
  return scans_by_octomap(graph);
}

TEST(ScanLog, GivesThePointsThatOctomapMapsToTheLastBit) {
  std::size_t checked = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    std::stringstream text;
    text << "# a log\n\n";
    for (std::size_t scan = 0; scan < 1 + random() % 5; ++scan) {
      text.precision(static_cast<int>(3 + random() % 20));
      if (random() % 2 == 0) text << std::scientific;
      if (random() % 3 == 0) text << std::fixed;
      text << "NODE";
      for (int i = 0; i < 3; ++i) text << (random() % 2 == 0 ? " " : "\t ") << random_float(random, 100.0);
      // Also past a whole turn.
      for (int i = 0; i < 3; ++i) text << ' ' << static_cast<double>(random_float(random, 9.0)) * 1.1;
      text << '\n';
      for (std::size_t point = random() % 100; point > 0; --point) {
        const auto coordinate = [&random] { return static_cast<double>(random_float(random, 20.0)) / 3.0; };
        text << coordinate() << ' ' << coordinate() << ' ' << coordinate();
        text << (random() % 10 == 0 ? " 77\n" : random() % 10 == 0 ? "\r\n" : "\n");
        if (random() % 20 == 0) text << "# a comment\n\n";
      }
    }
    const auto all = all_scans({"a.log", bytes_of(text.str())}, Damage::kFail);
    EXPECT_EQ(all.error, "");
    checked += expect_same(all.items, log_by_octomap(text.str()));
  }
  EXPECT_GT(checked, 5'000U);
}

TEST(ScanLog, AgreesWithOctomapOnOddButWholeLines) {
  const std::string text =
      "NODES +1 2e0 .5 0 -0 3.\n"
      "1 2 3\n"
      "\t4\t5\t6\n"
      "1e-50 -1e-42 7\n"
      "NODE 1 2 3 0 0 0\n"
      "NODE\t1 2 3 1.5707963 0 0 extra\n"
      "1 2 3 extra\n";
  const auto all = all_scans({"a.log", bytes_of("NODE 0 0 0 0 0 0\n" + text)}, Damage::kFail);
  EXPECT_EQ(all.error, "");
  EXPECT_EQ(expect_same(all.items, log_by_octomap("NODE 0 0 0 0 0 0\n" + text)), 4U);
}

TEST(ScanLog, ReadsTheLastLineWithoutAnEnd) {
  const auto all = all_scans({"a.log", bytes_of("NODE 0 0 0 0 0 0\n1 2 3\n4 5 6")}, Damage::kFail);
  ASSERT_EQ(all.items.size(), 1U);
  EXPECT_EQ(all.items[0].points_m.size(), 2U);
}

TEST(ScanLog, CountsIndentedLinesThatOctomapTakesForComments) {
  const std::string text = "NODE 0 0 0 0 0 0\n 1 2 3\n4 5 6\n   \n";
  const auto all = all_scans({"a.log", bytes_of(text)});
  EXPECT_EQ(expect_same(all.items, log_by_octomap(text)), 1U);
  EXPECT_EQ(all.skipped, 1U);
}

TEST(ScanLog, TellsHowTheSensorWasTurned) {
  const auto all = all_scans({"a.log", bytes_of("NODE 1 2 3 0 0 1.5707963\n1 0 0\n")});
  ASSERT_EQ(all.items.size(), 1U);
  const PointScan& scan = all.items[0];
  EXPECT_LT((scan.rotation * Eigen::Vector3d::UnitX() + scan.origin_m - scan.points_m.at(0)).norm(), 1e-6);
  EXPECT_LT((scan.points_m.at(0) - Eigen::Vector3d(1, 3, 3)).norm(), 1e-6);
}

TEST(ScanLog, LeavesDamagedLinesOutAndNamesTheFirstWhenAsked) {
  const std::string text =
      "NODE 0 0 0 0 0 0\n"
      "1 2 3\n"
      "1 2\n"
      "1 nan 3\n"
      "1,2,3\n"
      "1 2 1e39\n"
      "3.4e38 3.4e38 3.4e38\n"  // the arithmetic of the rotation passes the end of float
      "NODE 1 2 3\n"
      "1 2 3\n"
      "NODE 1 2 inf 0 0 0\n"
      "NODE 1 0 0 0 0 0\n"
      "1 2 3\n";
  const auto all = all_scans({"a.log", bytes_of(text)});
  EXPECT_EQ(all.error, "");
  ASSERT_EQ(all.items.size(), 2U);
  EXPECT_EQ(all.items[1].points_m.size(), 1U);
  EXPECT_EQ(all.items[1].points_m[0], Eigen::Vector3d(2, 2, 3));
  EXPECT_EQ(all.items[1].number, 3U);
  EXPECT_EQ(all.skipped, 8U - all.items[0].points_m.size() + 1U);
  EXPECT_EQ(all_scans({"a.log", bytes_of(text)}, Damage::kFail).error,
            "a.log: line 3: is not a point of three finite numbers");
}

// Kills angles in degrees that turn each scan anywhere.
TEST(ScanLog, AnglesInDegreesAreRefused) {
  std::string text;
  for (int i = 0; i < 9; ++i) text += "NODE 0 0 0 0 0 " + std::to_string(10 * i) + "\n1 2 3\n";
  EXPECT_THAT(all_scans({"a.log", bytes_of(text)}).error,
              HasSubstr("an angle of 20 rad after NODE is beyond two turns: are they in degrees?"));
}

}  // namespace
}  // namespace pingvox
