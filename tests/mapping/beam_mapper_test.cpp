#include "pingvox/mapping/beam_mapper.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "pingvox/analysis/compare.hpp"
#include "pingvox/map/scan_update.hpp"
#include "pingvox/mapping/build_map.hpp"
#include "pingvox/sonar/polar_image.hpp"
#include "pingvox/sonar/sweep.hpp"
#include "tests/mapping/room.hpp"
#include "tests/support/tank_recording.hpp"

namespace pingvox {
namespace {

using test::room;

BuildOptions options_of(BeamShape shape, Vote vote) {
  BuildOptions options;
  options.model.shape = shape;
  options.vote = vote;
  options.body_from_sensor = pose_from_rpy({0.013, 0.021, 0.0}, 0.02, 0.03, 0.1);
  return options;
}

/// Stage by stage, in plain words: the map that every way of mapping sweeps has to make.
OccupancyMap by_stages(const std::vector<Beam>& beams, const BuildOptions& options) {
  OccupancyMap map;
  for (const Sweep& sweep : sweeps_of(beams)) {
    const auto echoes = detect_echoes(apply_filter(PolarImage(sweep), options.filter), sweep, options.echo);
    ScanUpdate scan(map.lattice(), options.miss);
    for (std::size_t i = 0; i < echoes.size(); ++i) {
      trace_beam(options.body_from_sensor, sweep.beams[i], echoes[i], options.model, scan);
      if (options.vote == Vote::kPerSweep) continue;
      EXPECT_TRUE(map.apply(scan));
      scan.clear();
    }
    EXPECT_TRUE(map.apply(scan));
  }
  return map;
}

void expect_same(const OccupancyMap& a, const OccupancyMap& b) {
  const auto compared = compare_maps(a, b, Sameness::kLogOdds);
  ASSERT_TRUE(compared);
  EXPECT_GT(compared->cells(), 3'000U);
  EXPECT_TRUE(compared->equal());
  EXPECT_EQ(a.counts().nodes(), b.counts().nodes());
}

void add_all(BeamMapper& mapper, const std::vector<Beam>& beams) {
  for (const Beam& beam : beams) ASSERT_TRUE(mapper.add(beam, Pose::Identity()));
  ASSERT_TRUE(mapper.finish());
}

// Kills beams that are mapped in another order, twice, or not at all, and evidence of another beam.
TEST(BeamMapper, MakesTheMapOfTheStagesOneByOneAndOfBuildMap) {
  std::vector<std::vector<Beam>> inputs{room(530)};
  const std::vector<Beam> tank = test::TankRecording::beams(PINGVOX_SHARED_DATA);
  if (!tank.empty()) inputs.push_back(tank);
  for (const std::vector<Beam>& beams : inputs) {
    for (const BeamShape shape : {BeamShape::kRay, BeamShape::kCone}) {
      for (const Vote vote : {Vote::kPerSweep, Vote::kPerBeam}) {
        BuildOptions options = options_of(shape, vote);
        const OccupancyMap expected = by_stages(beams, options);
        for (const unsigned threads : {1U, 3U}) {
          SCOPED_TRACE(testing::Message() << beams.size() << " beams, shape " << static_cast<int>(shape) << ", vote "
                                          << static_cast<int>(vote) << ", threads " << threads);
          options.threads = threads;
          OccupancyMap pushed, pulled;
          auto mapper = BeamMapper::make(options, pushed);
          ASSERT_TRUE(mapper);
          add_all(*mapper, beams);
          expect_same(pushed, expected);
          EXPECT_EQ(mapper->report().beams, beams.size());
          EXPECT_EQ(mapper->report().sweeps, beams.size() == 530 ? 2U : 28U);
          BeamsInMemory source(beams);
          ASSERT_TRUE(build_map(source, Trajectory::still(Pose::Identity()), options, pulled));
          expect_same(pulled, expected);
        }
      }
    }
  }
}

// Kills a beam that comes later than it says, and a map that cannot be read in between.
TEST(BeamMapper, MapsABeamWhenItsNeighboursAreHeard) {
  BuildOptions options = options_of(BeamShape::kRay, Vote::kPerBeam);
  options.timing = Timing::kByBeam;
  options.body_from_sensor = Pose::Identity();
  OccupancyMap map;
  auto mapper = BeamMapper::make(options, map);
  ASSERT_TRUE(mapper);
  ASSERT_TRUE(mapper->delay_beams());
  const std::size_t delay = *mapper->delay_beams();
  ASSERT_LT(delay, 50U);
  const std::vector<Beam> beams = room(450);
  for (std::size_t n = 0; n < 200; ++n) {
    ASSERT_TRUE(mapper->add(beams[n], Pose::Identity()));
    ASSERT_EQ(mapper->report().beams, n < 2 * delay ? 0 : n + 1 - 2 * delay);
    if (n < 2 * delay) continue;
    const Beam& mapped = beams[n - delay];
    const Eigen::Vector3d way(std::cos(mapped.bearing_rad), std::sin(mapped.bearing_rad), 0.0);
    ASSERT_EQ(map.classify(Eigen::Vector3d(way * 1.0)), Occupancy::kFree) << n;
  }
  for (std::size_t n = 200; n < 450; ++n) ASSERT_TRUE(mapper->add(beams[n], Pose::Identity()));
  EXPECT_EQ(mapper->report().sweeps, 2U);
  ASSERT_TRUE(mapper->finish());
  EXPECT_EQ(mapper->report().beams, 450U);
  options.timing = Timing::kBySweep;
  OccupancyMap other;
  BeamsInMemory source(beams);
  const auto by_sweep = build_map(source, Trajectory::still(Pose::Identity()), options, other);
  ASSERT_TRUE(by_sweep);
  EXPECT_EQ(mapper->report().echoes, by_sweep->echoes);
  EXPECT_GT(by_sweep->echoes, 400U);
  const auto known = compare_maps(map, by_stages(beams, options), Sameness::kOccupancy);
  ASSERT_TRUE(known);
  EXPECT_EQ(known->only_a + known->only_b, 0U);
}

// Kills a pose that goes to another beam where beams come out in another order than they went in, as at a sweep's end.
TEST(BeamMapper, EachBeamKeepsItsPoseWhenBeamsAreMappedOneByOne) {
  BuildOptions options = options_of(BeamShape::kRay, Vote::kPerBeam);
  const std::vector<Beam> beams = room(430);
  OccupancyMap by_sweep, by_beam;
  for (auto [timing, map] : {std::pair(Timing::kBySweep, &by_sweep), std::pair(Timing::kByBeam, &by_beam)}) {
    options.timing = timing;
    auto mapper = BeamMapper::make(options, *map);
    ASSERT_TRUE(mapper);
    for (std::size_t n = 0; n < beams.size(); ++n) {
      // Each beam hundreds of cells from the next: its own cells, so that the order does not matter.
      const double x = 10.0 * static_cast<double>(n % 50), y = 10.0 * static_cast<double>(n / 50);
      ASSERT_TRUE(mapper->add(beams[n], pose_from_rpy({x, y, 0.0}, 0.0, 0.0, 0.0)));
    }
    ASSERT_TRUE(mapper->finish());
  }
  expect_same(by_sweep, by_beam);
}

// Kills a report of more sweeps than its beams can fill: those that the poses do not cover.
TEST(BeamMapper, CountsNoSweepWithBeamsLeftOut) {
  OccupancyMap map({.resolution_m = 0.05});
  auto mapper = BeamMapper::make(options_of(BeamShape::kRay, Vote::kPerSweep), map);
  ASSERT_TRUE(mapper);
  const std::vector<Beam> beams = room(630);  // three turns of 200 beams, and 30
  for (std::size_t n = 0; n < beams.size(); ++n) {
    ASSERT_TRUE(mapper->add(beams[n], n < 410 ? std::optional(Pose::Identity()) : std::nullopt));
  }
  ASSERT_TRUE(mapper->finish());
  EXPECT_EQ(mapper->report().beams, 410U);
  EXPECT_EQ(mapper->report().sweeps, 2U);
}

// Kills a beam that is counted for another reason, or whose place is not told.
TEST(BeamMapper, CountsWhatItLeavesOutByReasonWithTheFirst) {
  BuildOptions options = options_of(BeamShape::kRay, Vote::kPerSweep);
  options.body_from_sensor = Pose::Identity();
  OccupancyMap map({.resolution_m = 0.05, .depth = 8});  // 6.4 m to each side
  auto mapper = BeamMapper::make(options, map);
  ASSERT_TRUE(mapper);
  const std::vector<Beam> beams = room(200);
  for (std::size_t n = 0; n < beams.size(); ++n) {
    std::optional<Pose> pose = Pose::Identity();
    if (n >= 30 && n < 37) pose.reset();
    if (n >= 100 && n < 104) pose->translation().x() = 50.0;
    ASSERT_TRUE(mapper->add(beams[n], pose));
  }
  ASSERT_TRUE(mapper->finish());
  const BuildReport& report = mapper->report();
  EXPECT_EQ(report.beams, 193U);
  EXPECT_EQ(report.no_pose.count, 7U);
  EXPECT_EQ(report.no_pose.first_s, beams[30].time_s);
  EXPECT_EQ(report.outside.count, 4U);
  EXPECT_EQ(report.outside.first_s, beams[100].time_s);
  EXPECT_EQ(report.skipped, 11U);
}

TEST(BeamMapper, GoesOnAfterAnErrorWithANewSweep) {
  BuildOptions options = options_of(BeamShape::kRay, Vote::kPerSweep);
  OccupancyMap map({.memory_limit_bytes = 2'000});
  auto mapper = BeamMapper::make(options, map);
  ASSERT_TRUE(mapper);
  const std::vector<Beam> beams = room(450);
  std::size_t refused = 0;
  for (const Beam& beam : beams) {
    const auto added = mapper->add(beam, Pose::Identity());
    if (added) continue;
    ++refused;
    EXPECT_EQ(added.error().code, Error::Code::kLimit);
  }
  EXPECT_GE(refused, 1U);
  EXPECT_TRUE(map.empty());
  EXPECT_FALSE(mapper->finish());
  EXPECT_TRUE(mapper->finish()) << "nothing waits any more";
}

// One damaged number ended the run, or freed the world up to the horizon.
TEST(BeamMapper, ABeamOutOfAllProportionCostsThatBeam) {
  const BuildOptions options = options_of(BeamShape::kRay, Vote::kPerSweep);
  std::vector<Beam> beams = room(450);
  std::vector<std::optional<Pose>> poses(beams.size(), Pose::Identity());
  beams[260].bin_length_m *= 50.0;
  beams[300].bin_length_m *= 50.0;
  const auto mapped = [&](const auto& poses_of_beams) {
    OccupancyMap map;
    auto mapper = BeamMapper::make(options, map);
    EXPECT_TRUE(mapper);
    for (std::size_t i = 0; i < beams.size(); ++i) EXPECT_TRUE(mapper->add(beams[i], poses_of_beams[i]));
    EXPECT_TRUE(mapper->finish());
    return std::pair(std::move(map), mapper->report());
  };
  const auto [map, report] = mapped(poses);
  EXPECT_EQ(report.too_long.count, 2U);
  EXPECT_EQ(report.too_long.first_s, beams[260].time_s);
  EXPECT_EQ(report.beams + report.blocked.count, 448U);
  EXPECT_EQ(report.skipped, 2U + report.blocked.count + report.outside.count);
  poses[260].reset();
  poses[300].reset();
  expect_same(map, mapped(poses).first);
}

TEST(BeamMapper, ABeamOfTooManyCellsCostsThatBeamAlsoOneByOne) {
  BuildOptions options = options_of(BeamShape::kCone, Vote::kPerBeam);
  options.timing = Timing::kByBeam;
  std::vector<Beam> beams = room(450);
  for (const std::size_t i : {0U, 100U, 101U, 260U}) beams[i].bin_length_m *= 500.0;
  OccupancyMap map;
  auto mapper = BeamMapper::make(options, map);
  ASSERT_TRUE(mapper);
  add_all(*mapper, beams);
  EXPECT_EQ(mapper->report().too_long.count, 4U);
  EXPECT_EQ(mapper->report().beams + mapper->report().blocked.count, 446U);
}

// Kills a range that is changed and is taken for a fault.
TEST(BeamMapper, ALongerRangeFromNowOnIsNoFault) {
  const BuildOptions options = options_of(BeamShape::kRay, Vote::kPerSweep);
  std::vector<Beam> beams = room(1000);
  for (std::size_t i = 300; i < beams.size(); ++i) beams[i].bin_length_m *= 12.0;
  OccupancyMap map;
  auto mapper = BeamMapper::make(options, map);
  ASSERT_TRUE(mapper);
  add_all(*mapper, beams);
  EXPECT_EQ(mapper->report().too_long.count, 0U);
  EXPECT_EQ(mapper->report().beams + mapper->report().blocked.count, 1000U);
}

TEST(BeamMapper, RefusesOneUpdatePerSweepFromSingleBeams) {
  BuildOptions options;
  options.timing = Timing::kByBeam;
  OccupancyMap map;
  const auto mapper = BeamMapper::make(options, map);
  ASSERT_FALSE(mapper);
  EXPECT_EQ(mapper.error().code, Error::Code::kBadOption);
}

}  // namespace
}  // namespace pingvox
