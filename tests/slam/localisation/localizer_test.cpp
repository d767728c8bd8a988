// A vehicle in a room whose map is known.

#include "pingvox/slam/localizer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "pingvox/geometry/degree.hpp"
#include "support/room.hpp"

namespace pingvox::test {
namespace {

constexpr Room::State kPlace = {-1.0, 0.5, 0.7};

Localizer localizer_in(const Room& room, std::uint64_t seed = 1) {
  LocalizerOptions options;
  options.seed = seed;
  return Localizer(*DistanceField::make(room.map(), {}), options);
}

/// Beams [from, to) at a place.
void hear(Localizer& localizer, const Room& room, int from, int to, const Room::State& at) {
  for (int i = from; i < to; ++i) ASSERT_TRUE(localizer.add(room.beam(i, at)));
}

/// Distance [m] of where it thinks it is, and angle [rad] into `turn`.
double located_error_m(const Localizer& localizer, const Room::State& truth, double& turn) {
  const auto pose = localizer.pose();
  if (!pose) return 1e9;
  const Eigen::Vector3d at = pose->map_from_body.translation();
  const Eigen::Vector3d ahead = pose->map_from_body.rotation().col(0);
  turn = std::remainder(std::atan2(ahead.y(), ahead.x()) - truth.yaw, 2.0 * std::numbers::pi);
  return std::hypot(at.x() - truth.x, at.y() - truth.y);
}

TEST(Localizer, FindsItselfAnywhereAfterATurn) {
  const Room room;
  Localizer localizer = localizer_in(room);
  hear(localizer, room, 0, 90, kPlace);
  EXPECT_FALSE(localizer.pose());
  hear(localizer, room, 90, 300, kPlace);
  double turn = 0.0;
  EXPECT_LT(located_error_m(localizer, kPlace, turn), 0.12);
  EXPECT_NEAR(turn, 0.0, 2.5 * kDegree_rad);
  EXPECT_TRUE(localizer.is_sure());
  EXPECT_EQ(localizer.hypotheses().size(), 1U);
}

// Kills a filter that picks one of two places that nothing tells apart.
TEST(Localizer, ReportsBothPlacesInASymmetricRoomAndIsNotSure) {
  const Room room{.has_block = false};
  Localizer localizer = localizer_in(room);
  hear(localizer, room, 0, 110, kPlace);
  const auto found = localizer.hypotheses();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(found[0].x_m, -found[1].x_m, 0.1);
  EXPECT_NEAR(found[0].y_m, -found[1].y_m, 0.1);
  EXPECT_NEAR(std::abs(std::remainder(found[0].yaw_rad - found[1].yaw_rad, 2.0 * std::numbers::pi)), std::numbers::pi,
              0.05);
  EXPECT_GT(found[1].weight, 0.2);
  EXPECT_FALSE(localizer.is_sure());
}

TEST(Localizer, FollowsOdometryThatDrifts) {
  const Room room;
  Localizer localizer = localizer_in(room);
  localizer.start(kPlace.x, kPlace.y, kPlace.yaw, 0.2, 0.1);
  double turn = 0.0;
  Room::State truth = kPlace;
  for (int i = 0; i < 400; ++i) {
    const double share = i / 400.0;
    truth = {kPlace.x + 1.5 * share, kPlace.y - share, kPlace.yaw + 0.5 * share};
    // In a frame of its own, with 10 % more way and 0.1 rad of drift.
    const double cosine = std::cos(1.0), sine = std::sin(1.0), dx = 1.65 * share, dy = -1.1 * share;
    localizer.add(StampedPose{0.1 * i, pose_from_rpy({7.0 + cosine * dx - sine * dy, sine * dx + cosine * dy, -2.0},
                                                     0.0, 0.0, truth.yaw + 1.0 + 0.1 * share)});
    ASSERT_TRUE(localizer.add(room.beam(i, truth)));
  }
  EXPECT_LT(located_error_m(localizer, truth, turn), 0.15);
  EXPECT_NEAR(turn, 0.0, 0.06);
  EXPECT_EQ(localizer.pose()->map_from_body.translation().z(), -2.0);
}

// Kills a filter that stays where it was, or is sure before it has looked around.
TEST(Localizer, RecoversWithinThreeTurnsWhenItIsCarriedAway) {
  const Room room;
  Localizer localizer = localizer_in(room);
  hear(localizer, room, 0, 300, kPlace);
  ASSERT_TRUE(localizer.is_sure());
  const Room::State elsewhere{1.5, -1.2, -2.0};
  hear(localizer, room, 300, 600, elsewhere);
  double turn = 0.0;
  EXPECT_LT(located_error_m(localizer, elsewhere, turn), 0.15);
  EXPECT_NEAR(turn, 0.0, 0.05);
}

// Kills a filter that is sure of what one turn of the head says: in a harbour it may be a place that looks alike.
TEST(Localizer, IsNotSureOfAPlaceThatTheNextTurnDoesNotFind) {
  const Room room;
  Localizer localizer = localizer_in(room);
  hear(localizer, room, 0, 101, kPlace);
  ASSERT_TRUE(localizer.pose());
  EXPECT_FALSE(localizer.is_sure());
  const Room::State elsewhere{1.5, -1.2, -2.0};
  for (int i = 101; i < 200; ++i) {
    ASSERT_TRUE(localizer.add(room.beam(i, elsewhere)));
    EXPECT_FALSE(localizer.is_sure()) << i;
  }
}

// Kills a filter that goes on to be sure of where it was, or is sure of a place between.
TEST(Localizer, IsSureOfNoWrongPlaceAfterItWasCarriedAwayTwice) {
  const Room room;
  Localizer localizer = localizer_in(room);
  const std::vector<Room::State> places = {kPlace, {1.5, -1.2, -2.0}, {-2.0, -1.0, 1.0}};
  constexpr int kBeams = 400;
  for (std::size_t n = 0; n < places.size(); ++n) {
    const int first = kBeams * static_cast<int>(n);
    for (int i = first; i < first + kBeams; ++i) {
      ASSERT_TRUE(localizer.add(room.beam(i, places[n])));
      double turn = 0.0;
      if (i - first < 110 || !localizer.is_sure()) continue;
      EXPECT_LT(located_error_m(localizer, places[n], turn), 0.2) << i;
    }
    double turn = 0.0;
    EXPECT_LT(located_error_m(localizer, places[n], turn), 0.2) << n;
  }
}

TEST(Localizer, LeavesAWrongStart) {
  const Room room;
  Localizer localizer = localizer_in(room);
  localizer.start(0.5, -1.2, 2.3, 0.1, 0.05);
  hear(localizer, room, 0, 50, kPlace);
  EXPECT_FALSE(localizer.is_sure());
  hear(localizer, room, 50, 400, kPlace);
  double turn = 0.0;
  EXPECT_LT(located_error_m(localizer, kPlace, turn), 0.15);
}

TEST(Localizer, GivesTheSameBytesForTheSameSeed) {
  const Room room;
  Localizer a = localizer_in(room, 7), b = localizer_in(room, 7);
  hear(a, room, 0, 150, kPlace);
  hear(b, room, 0, 150, kPlace);
  EXPECT_EQ(a.pose()->map_from_body.matrix(), b.pose()->map_from_body.matrix());
  EXPECT_EQ(a.particles(), b.particles());
}

TEST(Localizer, SearchesWithLessThanATurnWhenTheRecordingEnds) {
  const Room room;
  Localizer localizer = localizer_in(room);
  hear(localizer, room, 0, 60, kPlace);
  ASSERT_FALSE(localizer.pose());
  localizer.finish();
  EXPECT_TRUE(localizer.pose());
  EXPECT_FALSE(localizer.is_sure());
}

TEST(Localizer, SaysNothingWithoutEchoesAndRefusesTimesThatFall) {
  const Room room;
  Localizer localizer = localizer_in(room);
  for (int i = 0; i < 250; ++i) {
    Beam silent = room.beam(i, kPlace);
    silent.intensities.assign(silent.intensities.size(), 0);
    ASSERT_TRUE(localizer.add(silent));
  }
  EXPECT_FALSE(localizer.pose());
  EXPECT_TRUE(localizer.hypotheses().empty());
  const auto back = localizer.add(room.beam(3, kPlace));
  ASSERT_FALSE(back);
  EXPECT_EQ(back.error().code, Error::Code::kCorrupt);
  localizer.finish();
  EXPECT_FALSE(localizer.pose());
}

TEST(LocalizerOptions, NamesWhatIsOutOfRange) {
  LocalizerOptions options;
  options.beam.stray = 0.0;
  EXPECT_FALSE(options.validate());
  options = {};
  options.min_particles = 5000;
  EXPECT_FALSE(options.validate());
  options = {};
  options.noise.yaw_rad_per_sqrt_s = -1.0;
  EXPECT_FALSE(options.validate());
}

}  // namespace
}  // namespace pingvox::test
