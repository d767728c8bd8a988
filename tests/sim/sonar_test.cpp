#include "pingvox/sim/sonar.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "bench/tank_range.hpp"
#include "pingvox/sim/scene.hpp"
#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/filters.hpp"
#include "pingvox/sonar/sweep.hpp"

namespace pingvox {
namespace {

using bench::true_range_m;
using testing::AllOf;
using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;

struct BeamWithEcho {
  Beam beam;
  SonarSimulator::Ping ping;
};

std::vector<BeamWithEcho> heard_in(const World& world, const Trajectory& way, const SonarOptions& options,
                                   std::size_t turns) {
  EXPECT_TRUE(options.validate());
  SonarSimulator simulator(world, way, options, turns);
  std::vector<BeamWithEcho> heard;
  for (;;) {
    auto beam = simulator.next();
    if (!beam || !*beam) return heard;
    heard.push_back({std::move(**beam), simulator.ping()});
  }
}

std::vector<BeamWithEcho> heard_in(const World& world, const SonarOptions& options, std::size_t turns = 1) {
  return heard_in(world, Trajectory::still(Pose::Identity()), options, turns);
}

/// FNV-1a.
std::uint64_t checksum(const std::vector<BeamWithEcho>& all) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const BeamWithEcho& heard : all) {
    for (const std::uint8_t byte : heard.beam.intensities) hash = (hash ^ byte) * 0x100000001b3U;
  }
  return hash;
}

SonarOptions noiseless() {
  SonarOptions options;
  options.noise = options.speckle = options.silent = 0.0;
  options.compression = 1.0;
  return options;
}

std::size_t strongest_in(const Beam& beam, double from_m, double to_m) {
  std::size_t best = 0;
  for (std::size_t i = 0; i < beam.intensities.size(); ++i) {
    const double middle = (static_cast<double>(i) + 0.5) * beam.bin_length_m;
    if (middle < from_m || middle > to_m) continue;
    if (best == 0 || beam.intensities[i] > beam.intensities[best]) best = i;
  }
  return best;
}

TEST(SonarSimulator, SendsValidBeamsOfTheOrderedShape) {
  const SonarOptions options;
  const auto all = heard_in(tank_scene({}).world, options, 2);
  ASSERT_EQ(all.size(), 400U);
  for (std::size_t n = 0; n < all.size(); ++n) {
    SCOPED_TRACE(n);
    ASSERT_TRUE(validate(all[n].beam));
    EXPECT_EQ(all[n].beam.intensities.size(), 399U);
    EXPECT_DOUBLE_EQ(all[n].beam.time_s, static_cast<double>(n) / 23.0);
  }
  EXPECT_NEAR(all[1].beam.bearing_rad, 2 * kPi - 1.8 * kPi / 180, 1e-12) << "clockwise, as these heads turn";
  EXPECT_EQ(all[0].beam.bearing_rad, all[200].beam.bearing_rad);
  EXPECT_NE(all[0].beam.intensities, all[200].beam.intensities) << "noise repeats itself";
}

TEST(SonarSimulator, IsSilentWithoutNoiseBetweenTheHeadAndTheFirstWall) {
  const TankOptions tank{.floater_radius_m = 0.0};
  SonarOptions options = noiseless();
  options.side_lobes = 0.0;
  for (const auto& [beam, ping] : heard_in(tank_scene(tank).world, options)) {
    SCOPED_TRACE(beam.bearing_rad);
    EXPECT_GT(beam.intensities[10], 40) << "self-reflection";
    for (std::size_t i = 50; i < 110; ++i) EXPECT_EQ(beam.intensities[i], 0) << i;
    const auto wall = static_cast<std::size_t>(true_range_m(tank, beam.bearing_rad) / options.bin_length_m);
    EXPECT_GT(beam.intensities[wall], 30);
  }
}

TEST(SonarSimulator, HearsAWallWhereItIs) {
  for (const double range_m : {1.0, 1.7, 3.3, 4.6}) {
    World world;
    world.add(Rectangle{{range_m, 0.0, 0.0}, {0.0, 50.0, 0.0}, {0.0, 0.0, 50.0}});
    const Beam beam = heard_in(world, noiseless()).front().beam;
    const double middle_m = (static_cast<double>(strongest_in(beam, 0.6, 5.0)) + 0.5) * beam.bin_length_m;
    // Sound that leaves a little upwards comes back a little later: the crest lies behind the wall, never before it.
    EXPECT_NEAR(middle_m, range_m + 0.01, 0.02) << range_m;
  }
}

TEST(SonarSimulator, HearsTheWallAgainInItsMirrorImage) {
  const TankOptions tank{
      .side_m = 2.0, .sensor_x_m = 0.0, .sensor_y_m = 0.0, .sensor_yaw_rad = 0.0, .floater_radius_m = 0.0};
  SonarOptions options = noiseless();
  options.bins = 800;
  // Ahead, 1 m; from there back to the wall behind, 3 m; and ahead again, 5 m.
  const World world = tank_scene(tank).world;
  const Beam beam = heard_in(world, options).front().beam;
  EXPECT_NEAR(static_cast<double>(strongest_in(beam, 2.6, 3.4)), 241.0, 4.0);
  EXPECT_NEAR(static_cast<double>(strongest_in(beam, 4.6, 5.4)), 402.0, 6.0);
  options.multipath = 0.0;
  const Beam single = heard_in(world, options).front().beam;
  EXPECT_LT(single.intensities[240], beam.intensities[240] / 2);
}

TEST(SonarSimulator, HearsAPileBesideTheBeamThroughItsSideLobe) {
  World world;
  world.add(Cylinder{{3.0, 0.0, -1.0}, {0.0, 0.0, 2.0}, 0.1}, {.scatter = 30.0, .glint = 0.0});
  SonarOptions options = noiseless();
  // The first side lobe of a face of 3 degrees lies between 3.4 and 6.8 degrees.
  const auto at_degrees = [&](double degrees) {
    const auto all = heard_in(world, options);
    const auto& beam = all[static_cast<std::size_t>(std::lround((360.0 - degrees) / 1.8))].beam;
    return static_cast<int>(beam.intensities[strongest_in(beam, 2.5, 3.5)]);
  };
  const int main_lobe = at_degrees(1.8);
  const int side_lobe = at_degrees(5.4);
  EXPECT_GT(main_lobe, 100);
  EXPECT_GT(side_lobe, 2);
  EXPECT_LT(side_lobe, main_lobe / 8);
  options.side_lobes = 0.0;
  EXPECT_LT(at_degrees(7.2), 2);
}

TEST(SonarSimulator, HearsLessOfAWallThatSlants) {
  const auto peak = [](double slant_rad) {
    World world;
    world.add(
        Rectangle{{3.0, 0.0, 0.0}, {50.0 * std::sin(slant_rad), 50.0 * std::cos(slant_rad), 0.0}, {0.0, 0.0, 50.0}});
    const Beam beam = heard_in(world, noiseless()).front().beam;
    return static_cast<int>(beam.intensities[strongest_in(beam, 2.0, 4.5)]);
  };
  int before = 256;
  for (const double slant : {0.0, 0.3, 0.6, 0.9, 1.2}) {
    const int now = peak(slant);
    EXPECT_LT(now, before) << slant;
    EXPECT_GT(now, 0) << slant;
    before = now;
  }
}

TEST(SonarSimulator, LosesWithRangeWhatItsGainDoesNotMakeUpFor) {
  for (const double range_m : {1.0, 2.0, 4.0}) {
    World world;
    world.add(Rectangle{{range_m, 0.0, 0.0}, {0.0, 50.0, 0.0}, {0.0, 0.0, 50.0}});
    const auto peak = [&](double gain) {
      SonarOptions options = noiseless();
      options.gain = gain;
      const Beam beam = heard_in(world, options).front().beam;
      return static_cast<double>(beam.intensities[strongest_in(beam, 0.7, 4.9)]);
    };
    // Spreading, and 0.2 dB a metre out and back, both counted from 1 m.
    EXPECT_NEAR(peak(0.0) / peak(1.0), std::pow(10.0, -2.0 * 0.2 * (range_m - 1.0) / 20.0) / range_m, 0.03) << range_m;
    EXPECT_NEAR(peak(0.5) / peak(1.0), std::sqrt(peak(0.0) / peak(1.0)), 0.03) << range_m;
  }
}

TEST(SonarSimulator, CompressesWhatItShows) {
  World world;
  world.add(Rectangle{{3.0, 0.0, 0.0}, {0.0, 50.0, 0.0}, {0.0, 0.0, 50.0}});
  SonarOptions options = noiseless();
  const Beam linear = heard_in(world, options).front().beam;
  options.compression = 0.5;
  const Beam compressed = heard_in(world, options).front().beam;
  std::size_t faint = 0;
  for (std::size_t bin = 100; bin < 399; ++bin) {
    const double expected = 255.0 * std::sqrt(linear.intensities[bin] / 255.0);
    const double above = 255.0 * std::sqrt((linear.intensities[bin] + 1) / 255.0);
    EXPECT_GE(compressed.intensities[bin], std::floor(expected) - 1.0) << bin;
    EXPECT_LE(compressed.intensities[bin], above + 1.0) << bin;
    faint += linear.intensities[bin] > 0 && linear.intensities[bin] < 40 ? 1U : 0U;
  }
  EXPECT_GT(faint, 10U);
}

TEST(SonarSimulator, RoundsWhatItReportsOfItsBearingAndNotWhereItLooks) {
  SonarOptions options;
  options.beams_per_turn = 177;
  std::size_t rounded = 0;
  const auto all = heard_in(tank_scene({}).world, options);
  ASSERT_EQ(all.size(), 177U);
  for (const auto& [beam, ping] : all) {
    const double steps = beam.bearing_rad / options.bearing_step_rad;
    EXPECT_NEAR(steps, std::round(steps), 1e-9);
    const double error = std::remainder(beam.bearing_rad - ping.bearing_rad, 2.0 * kPi);
    EXPECT_LE(std::abs(error), 0.5 * options.bearing_step_rad + 1e-12);
    rounded += std::abs(error) > 1e-6 ? 1U : 0U;
  }
  EXPECT_GT(rounded, 150U);
  options.bearing_step_rad = 0.0;
  for (const auto& [beam, ping] : heard_in(tank_scene({}).world, options)) {
    EXPECT_EQ(beam.bearing_rad, ping.bearing_rad);
  }
}

TEST(SonarSimulator, LosesAndSilencesAsManyBeamsAsOrdered) {
  SonarOptions options;
  options.lost = 0.1;
  options.silent = 0.2;
  const World world = tank_scene({}).world;
  const auto all = heard_in(world, options, 20);
  // Of 4000 beams; four standard deviations.
  EXPECT_NEAR(static_cast<double>(all.size()), 3600.0, 76.0);
  std::size_t silent = 0;
  for (const auto& [beam, ping] : all) {
    EXPECT_GT(beam.intensities[10], 20) << "the head itself is always heard";
    const auto wall = static_cast<std::size_t>(true_range_m({}, ping.bearing_rad) / options.bin_length_m);
    int near_wall = 0;
    for (std::size_t i = wall; i < wall + 12; ++i) near_wall += beam.intensities[i];
    silent += near_wall < 12 * 50 ? 1U : 0U;
  }
  EXPECT_NEAR(static_cast<double>(silent) / static_cast<double>(all.size()), 0.2, 0.03);
  // Dropouts have a generator of their own: the beams that are not silenced sound as they would without.
  options.lost = 0.0;
  const auto some = heard_in(world, options, 2);
  options.silent = 0.0;
  const auto none = heard_in(world, options, 2);
  std::size_t same = 0;
  for (std::size_t n = 0; n < 400; ++n) same += some[n].beam.intensities == none[n].beam.intensities ? 1U : 0U;
  EXPECT_NEAR(static_cast<double>(same), 320.0, 32.0);
}

TEST(SonarSimulator, MakesTheSameBytesFromTheSameSeedOnEveryMachine) {
  const World world = tank_scene({}).world;
  const auto all = heard_in(world, {}, 2);
  EXPECT_EQ(all.size(), 400U);
  EXPECT_EQ(checksum(all), 5423343170556525543U);
  EXPECT_EQ(checksum(all), checksum(heard_in(world, {}, 2)));
  EXPECT_NE(checksum(all), checksum(heard_in(world, {.seed = 2}, 2)));
  EXPECT_EQ(checksum(heard_in(world, noiseless())), 8400011762310062285U);
}

TEST(SonarSimulator, TurnsOnWhileTheVehicleMoves) {
  // Straight ahead at half a metre a second, towards a wall: each turn hears it nearer, when the beam looks ahead.
  World world;
  world.add(Rectangle{{4.5, 0.0, 0.0}, {0.0, 20.0, 0.0}, {0.0, 0.0, 20.0}});
  const Route route{{{0.0, 0.0, 0.0}, {10.0, 0.0, 0.0}}, Route::End::kStays};
  SonarOptions options = noiseless();
  options.beams_per_turn = 50;
  options.beams_per_s = 50.0;
  const auto all = heard_in(world, follow_route(route, 5.0, {.speed_m_s = 0.5}), options, 5);
  ASSERT_EQ(all.size(), 250U);
  for (std::size_t turn = 0; turn < 5; ++turn) {
    const BeamWithEcho& ahead = all[turn * 50];
    const double range = 4.5 - 0.5 * static_cast<double>(turn);
    EXPECT_NEAR(ahead.ping.map_from_sensor.translation().x(), 0.5 * static_cast<double>(turn), 1e-9);
    EXPECT_NEAR((static_cast<double>(strongest_in(ahead.beam, 0.7, 5.0)) + 0.5) * 0.0125, range + 0.01, 0.02);
  }
}

TEST(SonarSimulator, StopsWhereTheTrajectoryEnds) {
  const Trajectory way = *Trajectory::make({{10.0, Pose::Identity()}, {12.0, Pose::Identity()}});
  const auto all = heard_in(tank_scene({}).world, way, {}, 100);
  ASSERT_EQ(all.size(), 47U) << "23 beams a second, both ends included";
  EXPECT_EQ(all.front().beam.time_s, 10.0);
}

TEST(TrueRangeOfAWorld, OfAPlaneIsTheFootOfThePerpendicularOrTheConesEdge) {
  SonarOptions options;
  options.bins = 2000;
  const double half_width = 0.5 * options.beam_width_rad;
  const double half_height = 0.5 * options.beam_height_rad;
  World wall;
  wall.add(Rectangle{{5.0, 0.0, 0.0}, {0.0, 100.0, 0.0}, {0.0, 0.0, 100.0}});
  for (const double bearing : {0.0, 0.4, 1.0}) {
    const TrueRange range = true_range(wall, Pose::Identity(), bearing, options);
    ASSERT_TRUE(range.axis_m && range.cone_m);
    EXPECT_NEAR(*range.axis_m, 5.0 / std::cos(bearing), 1e-9);
    EXPECT_NEAR(*range.cone_m, 5.0 / std::cos(std::max(0.0, bearing - half_width)), 2e-4) << bearing;
  }
  // Of a bottom 2 m below, which the middle of the beam never meets, the lower edge of the cone.
  World bottom;
  bottom.add(Rectangle{{0.0, 0.0, -2.0}, {100.0, 0.0, 0.0}, {0.0, 100.0, 0.0}});
  const TrueRange range = true_range(bottom, Pose::Identity(), 0.3, options);
  EXPECT_FALSE(range.axis_m);
  ASSERT_TRUE(range.cone_m);
  EXPECT_NEAR(*range.cone_m, 2.0 / std::sin(half_height), 1e-4);
  options.bins = 399;
  EXPECT_FALSE(true_range(bottom, Pose::Identity(), 0.3, options).cone_m) << "behind the last bin";
}

TEST(TrueRangeOfAWorld, OfASphereIsToItsNearestPointInTheCone) {
  SonarOptions options;
  options.bins = 1000;
  const double half_height = 0.5 * options.beam_height_rad;
  for (const double up_rad : {0.0, 0.2, 0.31}) {
    World world;
    world.add(Sphere{{6.0 * std::cos(up_rad), 0.0, 6.0 * std::sin(up_rad)}, 0.5});
    const TrueRange range = true_range(world, Pose::Identity(), 0.0, options);
    ASSERT_TRUE(range.cone_m) << up_rad;
    const double off = std::max(0.0, up_rad - half_height);
    const double across = 6.0 * std::sin(off);
    EXPECT_NEAR(*range.cone_m, 6.0 * std::cos(off) - std::sqrt(0.25 - across * across), 1e-3) << up_rad;
  }
}

TEST(SonarOptions, NameEveryBrokenField) {
  EXPECT_TRUE(SonarOptions{}.validate());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  SonarOptions broken{.beams_per_turn = 3, .bins = 0, .bin_length_m = 0.0, .beams_per_s = 0.0, .beam_width_rad = 0.0};
  broken.beam_height_rad = 3.0;
  broken.side_lobes = broken.gain = broken.speckle = broken.multipath = broken.silent = 1.1;
  broken.bearing_step_rad = broken.ringing_m = broken.absorption_db_per_m = -1.0;
  broken.noise = nan;
  broken.compression = 0.0;
  broken.lost = 1.0;
  const std::string message = broken.validate().error().message;
  for (const char* name : {"beams_per_turn", "bins", "bin_length_m", "beams_per_s", "beam_width_rad", "beam_height_rad",
                           "side_lobes", "bearing_step_rad", "ringing_m", "gain", "compression", "absorption_db_per_m",
                           "speckle", "noise", "multipath", "silent", "lost"}) {
    EXPECT_THAT(message, HasSubstr(name));
  }
}

TEST(SonarSimulator, SurvivesTheExtremesOfItsOptions) {
  std::size_t ran = 0;
  for (const double bin_m : {1e-6, 1.0}) {
    for (const double side_m : {0.01, 1000.0}) {
      const TankOptions tank{.side_m = side_m, .sensor_x_m = 0.0, .sensor_y_m = 0.0, .floater_radius_m = 0.0};
      SonarOptions options;
      options.beams_per_turn = 4;
      options.bin_length_m = bin_m;
      options.beam_width_rad = 1.0;
      options.beam_height_rad = 2.0;
      options.absorption_db_per_m = 10.0;
      options.speckle = 1.0;
      options.noise = 255.0;
      EXPECT_EQ(heard_in(tank_scene(tank).world, options).size(), 4U);
      options.gain = 0.0;
      EXPECT_EQ(heard_in(tank_scene(tank).world, options).size(), 4U);
      ++ran;
    }
  }
  EXPECT_EQ(ran, 4U);
}

TEST(SonarSimulator, GivesTheDefaultDetectorTheTruthOfATank) {
  const World world = tank_scene({}).world;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    SCOPED_TRACE(seed);
    std::size_t beams = 0;
    std::size_t good = 0;
    std::size_t wrong = 0;
    SonarSimulator simulator(world, Trajectory::still(Pose::Identity()), {.seed = seed}, 5);
    const Result<std::vector<Beam>> recording = read_all(simulator);
    ASSERT_TRUE(recording);
    for (const Sweep& sweep : sweeps_of(*recording)) {
      EXPECT_EQ(sweep.extent, Sweep::Extent::kTurn);
      const auto echoes = detect_echoes(apply_filter(PolarImage(sweep), {}), sweep, {});
      for (std::size_t n = 0; n < echoes.size(); ++n) {
        ++beams;
        if (!echoes[n]) continue;
        const double error = std::abs(echoes[n]->range_m - true_range_m({}, sweep.beams[n].bearing_rad));
        good += error <= 0.05 ? 1U : 0U;
        wrong += error > 0.10 ? 1U : 0U;
      }
    }
    ASSERT_EQ(beams, 1000U);
    EXPECT_GE(good, 920U);
    EXPECT_LT(wrong, 20U);
  }
}

}  // namespace
}  // namespace pingvox
