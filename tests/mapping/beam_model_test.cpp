#include "pingvox/mapping/beam_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "mapping/internal/beam_tracer.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "support/rounds.hpp"
#include "support/uniform.hpp"

namespace pingvox {
namespace {

using test::uniform;

enum class Mark { kNone, kMissed, kHit };

Mark mark_of(ScanUpdate& scan, const Key& key) {
  const ScanUpdate::Page& page = scan.page(scan.page_of(key.as<WideWord>()));
  const std::size_t cell = ScanUpdate::cell_in_page(key);
  if ((page.hit[cell / 64] >> (cell % 64)) & 1) return Mark::kHit;
  return ((page.missed[cell / 64] >> (cell % 64)) & 1) ? Mark::kMissed : Mark::kNone;
}

/// A silent beam of `bins` bins of 1 cm.
Beam beam_of(double bearing_rad, std::size_t bins) {
  return {0.0, bearing_rad, 0.01, std::vector<std::uint8_t>(bins)};
}

Echo echo_at(double range_m, std::uint8_t intensity = 200) {
  Echo echo;
  echo.range_m = range_m;
  echo.first = echo.peak = echo.last = static_cast<std::size_t>(range_m / 0.01);
  echo.intensity = intensity;
  return echo;
}

/// A point of the sensor frame in the beam's own terms.
struct Polar {
  double range_m, off_bearing_rad, elevation_rad;
};

Polar polar_of(const Eigen::Vector3d& sensor_m, double bearing_rad) {
  const double bearing = std::atan2(sensor_m.y(), sensor_m.x());
  return {sensor_m.norm(), std::remainder(bearing - bearing_rad, 2.0 * std::numbers::pi),
          std::atan2(sensor_m.z(), std::hypot(sensor_m.x(), sensor_m.y()))};
}

/// Calls f(key, point in polar terms) for each cell of a box around the beam's reach.
template <class F>
void for_each_cell_near(const Lattice& lattice, const Pose& map_from_sensor, double bearing_rad, double range_m, F f) {
  const double edge = lattice.resolution_m();
  const Eigen::Vector3d origin = map_from_sensor.translation();
  const int reach = static_cast<int>(std::ceil(range_m / edge)) + 3;
  for (int x = -reach; x <= reach; ++x) {
    for (int y = -reach; y <= reach; ++y) {
      for (int z = -reach; z <= reach; ++z) {
        const auto key = lattice.key_of(origin + edge * Eigen::Vector3d(x, y, z));
        if (key) f(*key, polar_of(map_from_sensor.inverse() * lattice.centre_of(*key), bearing_rad));
      }
    }
  }
}

// Kills a cone with holes (a bundle too thin at its far end, a row that begins too late), one that is flat instead of
// on the sphere, and one that reaches beyond the beam.
class Cone : public testing::TestWithParam<Tracing> {};

TEST_P(Cone, TakesEachCellOfTheInsonifiedVolumeAndNoneFarFromIt) {
  std::size_t inside = 0, hits = 0;
  for (std::uint64_t seed = 1; seed <= test::rounds(12); ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const Lattice lattice(uniform(random, 0.03, 0.06));
    const Pose map_from_sensor =
        pose_from_rpy({uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)},
                      uniform(random, -0.6, 0.6), uniform(random, -0.6, 0.6), uniform(random, -3, 3));
    const double bearing = uniform(random, 0, 6), range = uniform(random, 0.7, 2.0);
    BeamModelOptions options;
    options.shape = BeamShape::kCone;
    options.tracing = GetParam();
    options.free_share = 1.0;
    options.width_rad = uniform(random, 1, 12) * kDegree_rad;
    options.height_rad = uniform(random, 10, 50) * kDegree_rad;
    ScanUpdate scan(lattice);
    ASSERT_EQ(trace_beam(map_from_sensor, beam_of(bearing, 400), echo_at(range), options, scan), 0U);

    const double half_diagonal = 0.5 * std::sqrt(3.0) * lattice.resolution_m();
    for_each_cell_near(lattice, map_from_sensor, bearing, range, [&](const Key& key, const Polar& cell) {
      const Mark mark = mark_of(scan, key);
      // Where the echo's first bin ends what was passed, a cell before the hit ones may be left out.
      if (cell.range_m <= range - lattice.resolution_m() && std::abs(cell.off_bearing_rad) <= options.width_rad / 2 &&
          std::abs(cell.elevation_rad) <= options.height_rad / 2) {
        EXPECT_NE(mark, Mark::kNone) << "a hole at range " << cell.range_m << " of " << range;
        ++inside;
      }
      if (mark == Mark::kNone) return;
      if (cell.range_m < 2.0 * half_diagonal) return;  // so near the head a cell spans all angles
      EXPECT_LE(cell.range_m, range + half_diagonal);
      const double slack = std::asin(half_diagonal / cell.range_m) + 1e-9;
      EXPECT_LE(std::abs(cell.elevation_rad), options.height_rad / 2 + slack);
      // Seen from above, an angle across the beam is 1 / cos(elevation) wider.
      EXPECT_LE(std::abs(cell.off_bearing_rad) * std::cos(cell.elevation_rad), options.width_rad / 2 + slack * 1.1);
      if (mark == Mark::kHit) {
        EXPECT_GE(cell.range_m, range - half_diagonal);
        ++hits;
      }
    });
  }
  EXPECT_GT(inside, test::rounds(2'000));
  EXPECT_GT(hits, test::rounds(500));
}

INSTANTIATE_TEST_SUITE_P(BeamModel, Cone, testing::Values(Tracing::kGeometry, Tracing::kBundle),
                         [](const auto& tracing) {
                           return tracing.param == Tracing::kGeometry ? "geometry" : "bundle";
                         });

// The two ways to trace a cone mark the same cells: a dense bundle of rays, and geometry.
TEST(BeamModel, GeometryMarksEachCellThatTheBundleMarks) {
  std::size_t alike = 0, grazed = 0, more = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const Lattice lattice(uniform(random, 0.02, 0.08));
    const Pose map_from_sensor =
        pose_from_rpy({uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)}, uniform(random, -3, 3),
                      uniform(random, -1.5, 1.5), uniform(random, -3, 3));
    BeamModelOptions options;
    options.shape = seed % 4 == 0 ? BeamShape::kFan : BeamShape::kCone;
    options.free_share = 1.0;
    options.width_rad = uniform(random, 1, 30) * kDegree_rad;
    options.height_rad = uniform(random, 5, 60) * kDegree_rad;
    const double bearing = uniform(random, 0, 6), range = uniform(random, 0.1, 1.5);
    ScanUpdate by_geometry(lattice), by_bundle(lattice);
    trace_beam(map_from_sensor, beam_of(bearing, 400), echo_at(range), options, by_geometry);
    options.tracing = Tracing::kBundle;
    trace_beam(map_from_sensor, beam_of(bearing, 400), echo_at(range), options, by_bundle);
    for_each_cell_near(lattice, map_from_sensor, bearing, range, [&](const Key& key, const Polar&) {
      const Mark geometry = mark_of(by_geometry, key), bundle = mark_of(by_bundle, key);
      if (geometry == Mark::kNone && bundle == Mark::kNone) return;
      // Geometry also knows the cells that the far end only clips, between two rays.
      const bool same = geometry == bundle;
      alike += same;
      more += !same && (bundle == Mark::kNone || geometry == Mark::kHit);
      grazed += !same && !(bundle == Mark::kNone || geometry == Mark::kHit);
    });
  }
  EXPECT_GT(alike, test::rounds(10'000));
  EXPECT_LE(grazed, alike / 10'000);
  EXPECT_LT(more, alike / 3);
  RecordProperty("alike", static_cast<int>(alike));
  RecordProperty("more", static_cast<int>(more));
  RecordProperty("grazed", static_cast<int>(grazed));
}

// Kills a fan with gaps between its rays, and one with a height.
TEST(BeamModel, FanStaysInThePlaneOfTheHeadWithoutGaps) {
  const Lattice lattice(0.05);
  BeamModelOptions options;
  options.shape = BeamShape::kFan;
  options.width_rad = 20.0 * kDegree_rad;
  options.free_share = 1.0;
  const Pose sensor = pose_from_rpy({0.025, 0.025, 0.025}, 0, 0, 0);
  ScanUpdate scan(lattice);
  trace_beam(sensor, beam_of(1.0, 400), echo_at(3.0), options, scan);
  std::size_t inside = 0;
  for_each_cell_near(lattice, sensor, 1.0, 3.0, [&](const Key& key, const Polar& cell) {
    const Mark mark = mark_of(scan, key);
    if (lattice.centre_of(key).z() != 0.025) {
      EXPECT_EQ(mark, Mark::kNone);
    } else if (cell.range_m <= 3.0 && std::abs(cell.off_bearing_rad) <= options.width_rad / 2) {
      EXPECT_NE(mark, Mark::kNone);
      ++inside;
    }
  });
  EXPECT_GT(inside, 500U);
}

// Kills a beam that frees what sound already came back from: the near edge of a slanting wall.
TEST(BeamModel, NothingIsFreedBetweenTheEchosFirstBinAndItsRange) {
  const Lattice lattice(0.05);
  Echo echo = echo_at(2.02);
  echo.first = 180;  // of 1 cm
  for (const BeamShape shape : {BeamShape::kRay, BeamShape::kFan, BeamShape::kCone}) {
    BeamModelOptions options;
    options.shape = shape;
    ScanUpdate scan(lattice);
    trace_beam(Pose::Identity(), beam_of(0.0, 400), echo, options, scan);
    const auto mark_at = [&](double x) { return mark_of(scan, *lattice.key_of(Eigen::Vector3d(x, 0.01, 0.01))); };
    EXPECT_EQ(mark_at(1.72), Mark::kMissed);
    EXPECT_EQ(mark_at(1.87), Mark::kNone);
    EXPECT_EQ(mark_at(1.97), Mark::kNone);
    EXPECT_EQ(mark_at(2.02), Mark::kHit);
  }
}

// Kills a beam that frees a bin too far, or one too little: bins as long as cells, so that each is seen.
TEST(BeamModel, FreesUpToWhereTheEchosFirstBinBegins) {
  const Lattice lattice(0.1);
  Beam beam = beam_of(0.0, 40);
  beam.bin_length_m = 0.1;
  Echo echo;
  echo.first = 20;
  echo.range_m = 2.45;
  for (const BeamShape shape : {BeamShape::kRay, BeamShape::kFan, BeamShape::kCone}) {
    BeamModelOptions options;
    options.shape = shape;
    ScanUpdate scan(lattice);
    const Pose sensor = pose_from_rpy({0.02, 0.05, 0.05}, 0, 0, 0);  // bin 20 begins at 2.02 m
    trace_beam(sensor, beam, echo, options, scan);
    const auto mark_at = [&](double x) { return mark_of(scan, *lattice.key_of(Eigen::Vector3d(x, 0.05, 0.05))); };
    EXPECT_EQ(mark_at(1.95), Mark::kMissed);
    EXPECT_EQ(mark_at(2.15), Mark::kNone);
    EXPECT_EQ(mark_at(2.45), Mark::kHit);
  }
}

// Kills `<` for `<=`: an echo at the range limit itself is within it.
TEST(BeamModel, AnEchoAtTheMaximumRangeIsHitAndOneBeyondIsNot) {
  const Lattice lattice(0.1);
  for (const double max_range_m : {2.0, std::nextafter(2.0, 0.0)}) {
    ScanUpdate scan(lattice);
    BeamTracer({.shape = BeamShape::kRay}, max_range_m).trace(Pose::Identity(), beam_of(0.0, 400), echo_at(2.0), scan);
    const Mark mark = mark_of(scan, *lattice.key_of(Eigen::Vector3d(2.0, 0.0, 0.0)));
    EXPECT_EQ(mark == Mark::kHit, max_range_m == 2.0);
  }
}

// Kills a cone that frees its edges, where an echo is too weak to be missed, or hits without them.
TEST(BeamModel, TheConesEdgeIsHitAndNotFreed) {
  const Lattice lattice(0.05);
  BeamModelOptions options;
  options.shape = BeamShape::kCone;
  ScanUpdate scan(lattice);
  trace_beam(Pose::Identity(), beam_of(0.0, 400), echo_at(3.02), options, scan);
  const auto mark_at = [&](double range_m, double elevation_deg) {
    const double elevation = elevation_deg * kDegree_rad;
    const Eigen::Vector3d at(range_m * std::cos(elevation), 0.01, range_m * std::sin(elevation));
    return mark_of(scan, *lattice.key_of(at));
  };
  EXPECT_EQ(mark_at(2.0, 11.0), Mark::kMissed);
  EXPECT_EQ(mark_at(2.0, 16.0), Mark::kNone);
  EXPECT_EQ(mark_at(3.02, 16.0), Mark::kHit);
}

// Kills a ray that frees its end cell, or hits another than the echo's.
TEST(BeamModel, RayFreesUpToItsEchoAndHitsThere) {
  const Lattice lattice(0.1);
  ScanUpdate scan(lattice);
  BeamModelOptions options;
  options.shape = BeamShape::kRay;
  options.hit_from = HitFrom::kFixed;
  const Pose sensor = pose_from_rpy({0.05, 0.05, 0.05}, 0, 0, 90.0 * kDegree_rad);
  trace_beam(sensor, beam_of(0.0, 400), echo_at(1.0), options, scan);
  OccupancyMap map({.resolution_m = 0.1});
  const auto report = map.apply(scan);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->cells_freed, 10U);
  EXPECT_EQ(report->cells_hit, 1U);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(map.at(Eigen::Vector3d(0.05, 0.05 + 0.1 * i, 0.05)), scan.miss());
  EXPECT_EQ(map.at(Eigen::Vector3d(0.05, 1.05, 0.05)), options.hit);
  EXPECT_EQ(map.counts().occupied_cells, 1U);
}

// Kills "no echo means a wall at maximum range", which the paper's program drew.
TEST(BeamModel, SilentBeamSaysNothingUnlessAsked) {
  const Lattice lattice(0.1);
  BeamModelOptions options;
  for (const BeamShape shape : {BeamShape::kRay, BeamShape::kFan, BeamShape::kCone}) {
    options.shape = shape;
    options.silent = Silent::kNothing;
    ScanUpdate scan(lattice);
    trace_beam(Pose::Identity(), beam_of(0.0, 200), std::nullopt, options, scan);
    EXPECT_TRUE(scan.empty());
    options.silent = Silent::kFree;
    trace_beam(Pose::Identity(), beam_of(0.0, 200), std::nullopt, options, scan);
    OccupancyMap map({.resolution_m = 0.1});
    ASSERT_TRUE(map.apply(scan));
    EXPECT_EQ(map.counts().occupied_cells, 0U);
    EXPECT_EQ(map.classify(Eigen::Vector3d(1.85, 0.01, 0.01)), Occupancy::kFree);
    EXPECT_EQ(map.classify(Eigen::Vector3d(2.15, 0.01, 0.01)), Occupancy::kUnknown);
  }
}

TEST(BeamModel, NothingIsTouchedBeyondTheMaximumRange) {
  const Lattice lattice(0.1);
  ScanUpdate scan(lattice);
  BeamTracer({.shape = BeamShape::kRay}, 1.0).trace(Pose::Identity(), beam_of(0.0, 400), echo_at(3.0), scan);
  OccupancyMap map({.resolution_m = 0.1});
  ASSERT_TRUE(map.apply(scan));
  EXPECT_EQ(map.counts().occupied_cells, 0U);
  EXPECT_EQ(map.counts().free_cells, 10U);
}

// Kills a cone that gives each cell of its arc the whole evidence of the echo.
TEST(BeamModel, OnePingNeverMakesAnArcCertain) {
  const Lattice lattice(0.05);
  BeamModelOptions options;
  options.shape = BeamShape::kCone;
  ScanUpdate scan(lattice);
  trace_beam(Pose::Identity(), beam_of(0.0, 400), echo_at(2.0, 255), options, scan);
  OccupancyMap map({.resolution_m = 0.05});
  ASSERT_TRUE(map.apply(scan));
  const MapCounts counts = map.counts();
  EXPECT_GT(counts.occupied_cells, 24U);
  EXPECT_LT(map.root()->belief(), LogOdds(options.hit.value() / 2.0F));
}

TEST(BeamModel, EvidenceGrowsWithTheEchoAndFallsOffTheAxis) {
  const LogOdds hit = LogOdds::from_probability(0.7);
  for (int i = 1; i < 256; ++i) {
    EXPECT_GT(evidence_of_intensity(static_cast<std::uint8_t>(i), hit),
              evidence_of_intensity(static_cast<std::uint8_t>(i - 1), hit));
  }
  EXPECT_EQ(evidence_of_intensity(255, hit), hit);
  EXPECT_GT(evidence_of_intensity(0, hit), LogOdds(0.0F));
  EXPECT_DOUBLE_EQ(share_on_arc(0.0, 0.6, 1.0), 1.0);
  EXPECT_DOUBLE_EQ(share_on_arc(0.3, 0.6, 1.0), 0.5);
  EXPECT_DOUBLE_EQ(share_on_arc(0.0, 0.6, 16.0), 0.5);
  EXPECT_DOUBLE_EQ(share_on_arc(0.0, 0.0, 0.1), 1.0);
}

TEST(BeamModel, BeamThatLeavesTheLatticeIsLeftOutAndCounted) {
  const Lattice lattice(0.1, 5);  // 3.2 m across
  ScanUpdate scan(lattice);
  EXPECT_EQ(trace_beam(Pose::Identity(), beam_of(0.0, 400), echo_at(3.0), {.shape = BeamShape::kRay}, scan), 1U);
  EXPECT_TRUE(scan.empty());
}

// Kills a Ping360 that is mapped with the Micron's cone, and a library whose beams are rays where the program's are
// cones.
TEST(BeamModel, IsTheConeOfTheHead) {
  const BeamModelOptions usual;
  EXPECT_EQ(usual.shape, BeamShape::kCone);
  EXPECT_DOUBLE_EQ(usual.width_rad, 3.0 * kDegree_rad);
  EXPECT_DOUBLE_EQ(usual.height_rad, 35.0 * kDegree_rad);
  const BeamModelOptions ping360 = beam_of_head(find_device("ping360"), {.shape = BeamShape::kFan, .free_share = 0.5});
  EXPECT_DOUBLE_EQ(ping360.width_rad, 2.0 * kDegree_rad);
  EXPECT_DOUBLE_EQ(ping360.height_rad, 25.0 * kDegree_rad);
  EXPECT_EQ(ping360.shape, BeamShape::kFan);
  EXPECT_DOUBLE_EQ(ping360.free_share, 0.5);
  EXPECT_DOUBLE_EQ(beam_of_head(nullptr, ping360).height_rad, 25.0 * kDegree_rad);
  EXPECT_EQ(beam_of_head(nullptr).shape, BeamShape::kCone);
}

TEST(BeamModel, OptionsNameEachBrokenField) {
  BeamModelOptions options;
  EXPECT_TRUE(options.validate());
  options.width_rad = -1.0;
  options.hit = LogOdds(-0.1F);
  const auto valid = options.validate();
  ASSERT_FALSE(valid);
  EXPECT_NE(valid.error().message.find("width"), std::string::npos);
  EXPECT_NE(valid.error().message.find("hit"), std::string::npos);
}

}  // namespace
}  // namespace pingvox
