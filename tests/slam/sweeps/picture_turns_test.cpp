#include "slam/internal/picture_turns.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pingvox/io/beams.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/nav.hpp"
#include "tests/support/room.hpp"
#include "tests/support/turning_vehicle.hpp"

namespace pingvox {
namespace {

using test::log_of;
using test::Room;
using test::wander;
using test::Yaw;
using testing::HasSubstr;

/// The turns that a sonar sees in the room, from the beam `first` on: ten in a second.
std::vector<YawChange> seen(const Yaw& yaw, int first, int end) {
  PictureTurns turns;
  for (int i = first; i < end; ++i) turns.add(Room{}.beam(i, {0.4, -0.3, yaw(0.1 * i)}));
  return turns.finish();
}

std::string why_not(const Yaw& yaw) {
  const auto offset = clock_offset(seen(yaw, 0, 900), log_of(yaw, 0.0, 90.0, 0.05, 0.0));
  EXPECT_FALSE(offset) << offset->offset_s;
  return offset ? "" : offset.error().message;
}

TEST(ClockOffset, ThePictureTurnsAgainstTheVehicle) {
  const auto changes = seen(wander, 0, 900);
  ASSERT_GT(changes.size(), 50U);
  std::size_t near = 0;
  for (const YawChange& change : changes) {
    near += std::abs(change.by_rad - wander(change.to_s) + wander(change.from_s)) < 0.05 ? 1 : 0;
  }
  EXPECT_GT(near, changes.size() * 8 / 10) << "of " << changes.size();
}

TEST(ClockOffset, MovesWithTheClockOfTheNavigation) {
  const auto changes = seen(wander, 0, 900);
  const auto zero = clock_offset(changes, log_of(wander, 0.0, 90.0, 0.05, 0.0));
  ASSERT_TRUE(zero) << zero.error().message;
  EXPECT_LT(zero->deviation_s, 0.4);
  EXPECT_NEAR(zero->offset_s, 0.0, 0.1);
  for (const double clock_s : {37.3, -1234.56, 1.7e9}) {
    const auto moved = clock_offset(changes, log_of(wander, 0.0, 90.0, 0.05, clock_s));
    ASSERT_TRUE(moved) << clock_s << ": " << moved.error().message;
    EXPECT_NEAR(moved->offset_s, zero->offset_s - clock_s, 0.005);
  }
}

TEST(ClockOffset, NeedsNoMoreThanAPartOfBothRecordings) {
  const auto changes = seen(wander, 0, 900);
  const auto offset = clock_offset(changes, log_of(wander, 30.0, 400.0, 0.05, 1000.0));
  ASSERT_TRUE(offset) << offset.error().message;
  EXPECT_NEAR(offset->offset_s, -1000.0, 0.2);
}

TEST(ClockOffset, IsRefusedWhereItCannotBeTold) {
  EXPECT_THAT(why_not([](double) { return 0.7; }), HasSubstr("turns too little"));
  EXPECT_THAT(why_not([](double time_s) { return 0.03 * time_s; }), HasSubstr("equally well"));
  EXPECT_THAT(why_not([](double time_s) { return 0.4 * std::sin(time_s * 2.0 * std::numbers::pi / 15.0); }),
              HasSubstr("equally well"));
  const auto blind = clock_offset({}, log_of(wander, 0.0, 90.0, 0.05, 0.0));
  ASSERT_FALSE(blind);
  EXPECT_THAT(blind.error().message, HasSubstr("too few sweeps"));
  EXPECT_FALSE(clock_offset(seen(wander, 0, 300), *NavLog::make({}, NavClock::kUnknown)));
  // Another dive.
  const Yaw other = [](double time_s) { return 0.5 * std::sin(0.083 * time_s) + 0.3 * std::sin(0.059 * time_s + 2.0); };
  EXPECT_FALSE(clock_offset(seen(wander, 0, 900), log_of(other, 0.0, 90.0, 0.05, 0.0)));
  // Its yaw counts the other way round.
  const auto opposite = clock_offset(seen(wander, 0, 900), log_of([](double t) { return -wander(t); }, 0, 90, 0.05, 0));
  ASSERT_FALSE(opposite);
  EXPECT_THAT(opposite.error().message, HasSubstr("does not turn as the picture does"));
}

TEST(ClockOffset, AHeadThatTurnsAboutALevelAxisShowsNoTurns) {
  PictureTurns turns(pose_from_rpy(Eigen::Vector3d::Zero(), std::numbers::pi / 2.0, 0.0, 0.0));
  for (int i = 0; i < 900; ++i) turns.add(Room{}.beam(i, {0.4, -0.3, wander(0.1 * i)}));
  EXPECT_TRUE(turns.finish().empty());
}

std::filesystem::path shared(const std::string& name) {
  return std::filesystem::path(PINGVOX_SHARED_DATA) / name;
}

// The sonar's times are about 0.6 s before those of both compasses (docs/slam-figures.md). The first quarter of an
// hour.
TEST(ClockOffset, OfTheMarinasSonarAndCompass) {
  const auto hits = shared("marina-ribas-stpere/is_hits.txt"),
             compass = shared("marina-ribas-stpere/_040825_1735_DVL.log");
  if (!std::filesystem::exists(hits) || !std::filesystem::exists(compass)) GTEST_SKIP() << "no recording";
  auto beams = open_beams(*ByteStream::open(hits.string()));
  ASSERT_TRUE(beams) << beams.error().message;
  const auto nav = read_nav(*read_file(compass.string()));
  ASSERT_TRUE(nav) << nav.error().message;
  PictureTurns turns;
  std::optional<double> end_s;
  while (auto beam = *(*beams)->next()) {
    if (!end_s) end_s = beam->time_s + 900.0;
    if (beam->time_s > *end_s) break;
    turns.add(*std::move(beam));
  }
  const auto offset = clock_offset(turns.finish(), nav->log);
  ASSERT_TRUE(offset) << offset.error().message;
  EXPECT_NEAR(offset->offset_s, -0.6, 0.4);
  EXPECT_LT(offset->deviation_s, 0.5);
}

}  // namespace
}  // namespace pingvox
