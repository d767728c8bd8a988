// The text logs of the vehicle Ictineu: DVL, MTi, DGPS and the hits of its sonar.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/nav.hpp"
#include "pingvox/nav/nav_trajectory.hpp"
#include "support/folder.hpp"
#include "support/mutants.hpp"
#include "support/rounds.hpp"

namespace pingvox {
namespace {

FileBytes ictineu_file(const std::string& text) {
  return {"nav.log", {text.begin(), text.end()}};
}

const NavSource& source_of(const NavFile& file, NavQuantity quantity) {
  const NavSource* source = file.log.best(quantity);
  EXPECT_NE(source, nullptr) << name_of(quantity);
  static const NavSource kNone{"", quantity, {NavSample{}}};
  return source != nullptr ? *source : kNone;
}

/// 60 degrees right of a vehicle that heads north: the instrument heads 60 degrees. It moves 1 m/s that way.
constexpr const char* kDvl =
    "% time, [idSensor], year, waterVelX, bottomVelX, heading, pitch, roll, temperature, pressure\n\n"
    "100.5 2007 3 16 13 0 56 0 0 0 1 100 0 5 1 1.8 1.8 1.8 140 140 140 100 60 -0.5 1.6 14 1540 12.8 0.5 1.5 0 0\n"
    "101 2007 3 16 13 0 56 0 0 0 1 32767 32767 32767 0 1 1 1 140 140 140 100 60 -0.5 1.6 14 1540 12.8 0.5 1.5 0 0\n"
    "102 2007 3\n";

/// A line of the imaging sonar whose samples are those of `sample`.
std::string sonar_line(double time_s, double angle_rad, const std::function<int(int)>& sample) {
  std::string line = fmt::format("{:.3f}\t{:.0f} {:.7f}", time_s, std::fmod(time_s, 86400.0) * 1e3, angle_rad);
  for (int i = 0; i < 500; ++i) line += " " + std::to_string(sample(i));
  return line + " \r\n";
}

// Kills bearings in the other sense, samples that are shifted by a column, and lines that are read in part.
TEST(Ictineu, TheBeamsOfItsImagingSonarHave500Bins) {
  const auto ramp = [](int i) { return i % 256; };
  const std::string log =
      "% IS log: time, sensor time, angle, beam\n\n" + sonar_line(1093455224.578, 0.25 * std::numbers::pi, ramp) +
      "1093455224.646 63224646 0.7 1 2 3\n" + sonar_line(1093455224.718, 0.0, [](int i) { return i == 9 ? 256 : 0; }) +
      sonar_line(1093455224.786, 6.2517693, [](int) { return 0; });
  const FileBytes file{"_040825_1735_IS.log", {log.begin(), log.end()}};
  EXPECT_EQ(format_of(file.view()), Format::kIctineuBeams);
  auto source = open_beams(file);
  ASSERT_TRUE(source) << source.error().message;
  const auto beams = read_all(**source);
  ASSERT_TRUE(beams);
  ASSERT_EQ(beams->size(), 2U);
  EXPECT_EQ((*source)->skipped(), 2U);
  EXPECT_EQ((*source)->clock(), BeamClock::kOwn);
  ASSERT_NE((*source)->device(), nullptr);
  EXPECT_EQ((*source)->device()->name, "miniking");
  const Beam& first = beams->front();
  EXPECT_EQ(first.time_s, 1093455224.578);
  EXPECT_NEAR(first.bearing_rad, 1.75 * std::numbers::pi, 1e-6) << "45 degrees to the right";
  EXPECT_EQ(first.bin_length_m, 0.1);
  ASSERT_EQ(first.intensities.size(), 500U);
  for (int i = 0; i < 500; ++i) EXPECT_EQ(first.intensities[static_cast<std::size_t>(i)], ramp(i));
  const auto strict = open_beams(file, Damage::kFail);
  ASSERT_TRUE(strict);
  ASSERT_TRUE((*strict)->next());
  const auto damaged = (*strict)->next();
  ASSERT_FALSE(damaged);
  EXPECT_THAT(damaged.error().message, testing::EndsWith(": has 3 samples, not 500"));
}

TEST(Ictineu, TheDvlIsTurnedIntoTheVehicleAndSaysWhenItHasNoBottom) {
  EXPECT_EQ(format_of(ictineu_file(kDvl).view()), Format::kIctineu);
  const auto nav = read_nav(ictineu_file(kDvl));
  ASSERT_TRUE(nav) << nav.error().message;
  EXPECT_EQ(nav->records, 2U);
  ASSERT_EQ(nav->damage.size(), 1U);
  EXPECT_FALSE(read_nav(ictineu_file(kDvl), Damage::kFail));
  const NavSource& velocity = source_of(*nav, NavQuantity::kVelocity);
  ASSERT_EQ(velocity.samples.size(), 2U);
  // Half ahead, and to the right, which is negative.
  EXPECT_TRUE(velocity.samples[0].value.isApprox(Eigen::Vector3d(0.5, -std::sqrt(0.75), 0.05), 1e-12));
  EXPECT_TRUE(velocity.samples[0].valid);
  EXPECT_FALSE(velocity.samples[1].valid);
  EXPECT_NEAR(source_of(*nav, NavQuantity::kHeading).samples[0].value.x(), 90 * kDegree_rad, 1e-12) << "north";
  EXPECT_NEAR(source_of(*nav, NavQuantity::kDepth).samples[0].value.x(), 0.377225, 1e-12);
}

TEST(Ictineu, TheMtiIsTurnedIntoTheVehicle) {
  // The instrument heads 86 degrees, to the right of a vehicle that heads north, and is rolled by 10 degrees: right
  // side down, so the vehicle's stern is. It turns right, and rolls.
  const auto nav =
      read_nav(ictineu_file("% time, [idSensor], positionX, velocityX, accelerationX\n1 10 0 86 0.1 0 0.2 0 0 -9.8\n"));
  ASSERT_TRUE(nav) << nav.error().message;
  const Eigen::Vector3d attitude = source_of(*nav, NavQuantity::kAttitude).samples[0].value;
  // Nearly 90 degrees apart: the instrument's roll is the vehicle's pitch but for 4 degrees. REP-103: bow up is
  // negative.
  EXPECT_NEAR(attitude.y(), -std::asin(std::sin(10 * kDegree_rad) * std::sin(86 * kDegree_rad)), 1e-9);
  EXPECT_NEAR(attitude.x(), std::atan(std::tan(10 * kDegree_rad) * std::cos(86 * kDegree_rad)), 1e-3);
  EXPECT_NEAR(attitude.z(), 90 * kDegree_rad, 0.01);
  const Eigen::Vector3d rate = source_of(*nav, NavQuantity::kTurnRate).samples[0].value;
  EXPECT_NEAR(rate.z(), -0.2, 1e-12) << "to the right is clockwise";
  EXPECT_NEAR(rate.x(), 0.1 * std::cos(86 * kDegree_rad), 1e-12);
  EXPECT_NEAR(rate.y(), -0.1 * std::sin(86 * kDegree_rad), 1e-12);
}

TEST(Ictineu, FixesAreDegreesAndMinutesInOneNumber) {
  const auto nav = read_nav(
      ictineu_file("% UTM:  36\n% time, [idSensor], latitude, longitude, status, altitude(m)\n"
                   "1 4212.225 -306.2832 1 -2.1 51.8 23.6 24 0.1 0.1\n2 4212.225 306.2832 0 -2.1 51.8 23.6 24 0.1 0.1\n"
                   "3 9912.225 306.2832 1 -2.1 51.8 23.6 24 0.1 0.1\n"));
  ASSERT_TRUE(nav) << nav.error().message;
  const NavSource& fixes = source_of(*nav, NavQuantity::kFix);
  ASSERT_EQ(fixes.samples.size(), 2U);
  EXPECT_NEAR(fixes.samples[0].value.x(), (42 + 12.225 / 60) * kDegree_rad, 1e-12);
  EXPECT_NEAR(fixes.samples[0].value.y(), -(3 + 6.2832 / 60) * kDegree_rad, 1e-12);
  EXPECT_TRUE(fixes.samples[0].valid);
  EXPECT_FALSE(fixes.samples[1].valid);
  EXPECT_EQ(nav->damage.size(), 1U) << "99 degrees north";
}

class IctineuHits : public testing::Test {
 protected:
  /// Times of two turns: 0.1 s a beam, from 0 at the first beam of the first turn.
  void write_times() {
    std::ofstream out(folder_.path("a_IS_timestamps.log"));
    for (int i = -147; i < 400; ++i) out << 0.1 * i << " " << i << "\n";
  }
  Result<std::unique_ptr<BeamSource>> open(const std::string& lines, Damage damage = Damage::kSkip) {
    const std::string path = folder_.path("hits.txt");
    std::ofstream(path) << "# turn beam count bin...\n" << lines;
    return read_file(path).and_then([&](FileBytes file) { return open_beams(std::move(file), damage); });
  }

  const test::Folder folder_;
};

TEST_F(IctineuHits, BecomeBeamsOfATurnWithSilentBeamsBetween) {
  write_times();
  auto source = open("2 0 1 500\n2 199 2 1 30\n");
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ((*source)->device()->name, "miniking");
  const auto beams = read_all(**source);
  ASSERT_TRUE(beams);
  ASSERT_EQ(beams->size(), 200U) << "the turn that has hits";
  EXPECT_NEAR(beams->front().time_s, 20.0, 1e-9);
  EXPECT_NEAR(beams->front().bearing_rad, 2 * std::numbers::pi / 200, 1e-12) << "beam 199, clockwise";
  EXPECT_EQ(beams->front().intensities.size(), 500U);
  EXPECT_EQ(beams->front().intensities[0], 255);
  EXPECT_EQ(beams->front().intensities[29], 255);
  EXPECT_EQ(beams->front().intensities[30], 0);
  EXPECT_THAT((*beams)[1].intensities, testing::Each(0));
  EXPECT_NEAR(beams->back().time_s, 39.9, 1e-9);
  EXPECT_NEAR(beams->back().bearing_rad, 0.0, 1e-12);
  EXPECT_EQ(beams->back().intensities[499], 255);
}

TEST_F(IctineuHits, SkipDamagedLinesAndNeedTheirTimes) {
  EXPECT_FALSE(open("1 0 1 5\n")) << "no times";
  write_times();
  const char* damaged = "1 0 1 5\n3 0 1 5\n0 0 1 5\n1 200 1 5\n1 3 2 5\n1 4 1 501\n1 5 1 0\n1 6 1 x\n1\n1 0 1 9\n";
  auto source = open(damaged);
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ((*source)->skipped(), 8U);
  const auto beams = read_all(**source);
  ASSERT_TRUE(beams);
  EXPECT_EQ(beams->size(), 200U);
  EXPECT_EQ(beams->back().intensities[4], 255);
  EXPECT_FALSE(open(damaged, Damage::kFail));
  auto none = open("");
  ASSERT_TRUE(none) << none.error().message;
  EXPECT_TRUE(read_all(**none)->empty());
}

// Not among the readers of tests/io/mutation_test.cpp: its times are in another file.
TEST_F(IctineuHits, KeepTheirPromisesWhenDamaged) {
  write_times();
  const std::string whole = "# turn beam count bin...\n1 0 1 5\n1 7 3 10 20 30\n2 0 1 500\n2 199 2 1 30\n";
  const std::vector<std::uint8_t> seed(whole.begin(), whole.end());
  std::size_t readable = 0;
  constexpr std::size_t kMutants = test::rounds(10'000);
  for (std::size_t i = 0; i < kMutants; ++i) {
    SCOPED_TRACE(i);
    std::mt19937_64 random(i);
    const auto source = open_beams({folder_.path("hits.txt"), mutant(seed, seed, random)});
    if (!source) continue;
    const auto beams = read_all(**source);
    ASSERT_TRUE(beams);
    ASSERT_LE(beams->size(), 400U);
    for (const Beam& beam : *beams) ASSERT_TRUE(validate(beam));
    readable += beams->empty() ? 0 : 1;
  }
  EXPECT_GT(readable, kMutants / 20);
}

TEST(IctineuRecording, HoldsWhatItsDescriptionSays) {
  const std::filesystem::path folder = std::filesystem::path(PINGVOX_SHARED_DATA) / "marina-ribas-stpere";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "the recording is not here";
  const auto read = [&](const char* name) {
    return read_file((folder / name).string()).and_then([](const FileBytes& file) { return read_nav(file); });
  };
  const auto dvl = read("_040825_1735_DVL.log"), mti = read("_040825_1735_MTI.log"),
             dgps = read("_040825_1735_DGPS.log");
  ASSERT_TRUE(dvl && mti && dgps);
  EXPECT_EQ(dvl->records, 5045U);
  EXPECT_EQ(summary_of(source_of(*dvl, NavQuantity::kVelocity)).invalid, 84U);
  EXPECT_EQ(mti->records, 33457U);
  // Both compasses agree on the vehicle's heading to a degree at the start.
  EXPECT_NEAR(source_of(*dvl, NavQuantity::kHeading).samples[0].value.x(),
              source_of(*mti, NavQuantity::kAttitude).samples[1].value.z(), 1 * kDegree_rad);
  const auto path = nav_positions(dgps->log);
  ASSERT_TRUE(path) << path.error().message;
  double length_m = 0;
  const auto& poses = path->trajectory.poses();
  for (std::size_t i = 1; i < poses.size(); ++i) {
    length_m += (poses[i].map_from_body.translation() - poses[i - 1].map_from_body.translation()).head<2>().norm();
  }
  EXPECT_NEAR(length_m, 690.3, 1.5);

  auto hits =
      read_file((folder / "is_hits.txt").string()).and_then([](FileBytes file) { return open_beams(std::move(file)); });
  ASSERT_TRUE(hits) << hits.error().message;
  std::size_t beams = 0, bins = 0;
  while (const auto beam = (*hits)->next()) {
    if (!*beam) break;
    ++beams;
    bins += static_cast<std::size_t>(std::count((*beam)->intensities.begin(), (*beam)->intensities.end(), 255));
    if (beams == 1) {
      EXPECT_NEAR((*beam)->time_s, 1093455234.656, 0.08) << "the first key frame";
    }
  }
  EXPECT_EQ(beams, 46000U);
  EXPECT_EQ(bins, 1092294U);
  EXPECT_EQ((*hits)->skipped(), 0U);
}

}  // namespace
}  // namespace pingvox
