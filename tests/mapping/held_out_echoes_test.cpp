#include "mapping/internal/held_out_echoes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "mapping/internal/first_return.hpp"
#include "mapping/room.hpp"
#include "pingvox/geometry/degree.hpp"

namespace pingvox::test {
namespace {

using Eigen::Vector3d;

constexpr double kTolerance_m = 0.1;
constexpr LogOdds kWall(2.0F), kWater(-1.0F);

OccupancyMap unknown_space() {
  Result<OccupancyMap> map = OccupancyMap::make({.resolution_m = 0.05});
  EXPECT_TRUE(map);
  return *std::move(map);
}

/// Sets the cells of a box.
void fill(OccupancyMap& map, const Vector3d& from_m, const Vector3d& to_m, LogOdds belief) {
  const double step_m = map.lattice().resolution_m();
  Editor editor = map.edit();
  for (double x = from_m.x(); x < to_m.x(); x += step_m) {
    for (double y = from_m.y(); y < to_m.y(); y += step_m) {
      for (double z = from_m.z(); z < to_m.z(); z += step_m) {
        editor.set(*map.lattice().key_of(Vector3d(x, y, z)), map.lattice().depth(), belief);
      }
    }
  }
}

/// Free water around the origin, with a wall across x.
OccupancyMap wall_at(double x_m) {
  OccupancyMap map = unknown_space();
  fill(map, {-1.0, -2.0, -2.0}, {5.0, 2.0, 2.0}, kWater);
  fill(map, {x_m, -2.0, -2.0}, {x_m + 0.05, 2.0, 2.0}, kWall);
  return map;
}

/// A beam along x, as wide and high as a Micron hears objects.
BeamInMap beam_along_x() {
  return heard_part({}, Pose::Identity(), 0.0);
}

EchoOutcome outcome(const OccupancyMap& map, double echo_m) {
  const BeamInMap beam = beam_along_x();
  return outcome_of(first_return_m(map, beam, 0.75, echo_m + kTolerance_m), echo_m, kTolerance_m,
                    place_of_echo(map, beam, echo_m, kTolerance_m).what);
}

/// Beams that are read again and again.
class BeamsInMemory final : public BeamSource {
 public:
  explicit BeamsInMemory(std::vector<Beam> beams) : beams_(std::move(beams)) {}
  Result<std::optional<Beam>> next() override {
    if (next_ == beams_.size()) return std::nullopt;
    return beams_[next_++];
  }

 private:
  std::vector<Beam> beams_;
  std::size_t next_ = 0;
};

HeldOutEchoes echoes_of(std::vector<Beam> beams, const BuildOptions& build = {}) {
  BeamsInMemory source(std::move(beams));
  HeldOutEchoes echoes;
  EXPECT_TRUE(echoes.add(source, build));
  return echoes;
}

std::vector<JudgedEcho> judge(const HeldOutEchoes& echoes, const Trajectory& trajectory,
                              const HeldOutOptions& options = {}) {
  Result<JudgedEchoes> judged = echoes.judge(trajectory, {.resolution_m = 0.05}, options);
  EXPECT_TRUE(judged);
  return judged ? std::move(judged->echoes) : std::vector<JudgedEcho>();
}

double share_of(const std::vector<JudgedEcho>& echoes, EchoOutcome outcome) {
  const auto count = std::ranges::count(echoes, outcome, &JudgedEcho::outcome);
  return static_cast<double>(count) / static_cast<double>(echoes.size());
}

/// Turns of a head in a room that stays as it is.
std::vector<Beam> turns_in_room(std::size_t turns) {
  const std::vector<Beam> turn = room(200);
  std::vector<Beam> beams;
  for (std::size_t n = 0; n < turns * turn.size(); ++n) {
    beams.push_back(turn[n % turn.size()]);
    beams.back().time_s = 0.04 * static_cast<double>(n);
  }
  return beams;
}

Trajectory still() {
  return Trajectory::still(Pose::Identity());
}

// Kills a wall that counts as met although it is moved by more than the tolerance, and the two ways of being wrong that
// change places.
TEST(HeldOutEchoes, AMovedWallIsMetTooEarlyOrLeavesTheEchoInFreeWater) {
  EXPECT_EQ(outcome(wall_at(3.0), 3.02), EchoOutcome::kPredicted);
  EXPECT_EQ(outcome(wall_at(3.0), 2.96), EchoOutcome::kPredicted);
  EXPECT_EQ(outcome(wall_at(2.7), 3.02), EchoOutcome::kTooEarly);
  EXPECT_EQ(outcome(wall_at(3.3), 3.02), EchoOutcome::kFromFree);
  EXPECT_EQ(outcome(unknown_space(), 3.02), EchoOutcome::kUnknown);
  // Something before the echo is wrong, whatever is known behind it.
  EXPECT_EQ(outcome_of(2.7, 3.0, kTolerance_m, Occupancy::kUnknown), EchoOutcome::kTooEarly);
  EXPECT_EQ(outcome_of(2.95, 3.0, kTolerance_m, Occupancy::kOccupied), EchoOutcome::kPredicted);
}

// Kills echoes of objects above the axis that are said to come from free water, and a beam that is taken to hear as
// far up as its edge.
TEST(HeldOutEchoes, AnEchoMayComeFromAboveTheAxisAsFarAsTheBeamHears) {
  for (const auto& [up_deg, expected] : {std::pair{10.0, EchoOutcome::kPredicted}, {16.0, EchoOutcome::kFromFree}}) {
    OccupancyMap map = wall_at(4.5);
    const Vector3d at_m(3.0 * std::cos(up_deg * kDegree_rad), 0.0, 3.0 * std::sin(up_deg * kDegree_rad));
    fill(map, at_m - Vector3d(0.0, 0.1, 0.0), at_m + Vector3d(0.01, 0.1, 0.01), kWall);
    EXPECT_EQ(outcome(map, 3.0), expected) << up_deg;
  }
}

// Kills a nearest error that is that of the first cell looked at.
TEST(HeldOutEchoes, TheErrorIsThatOfTheNearestCellInRange) {
  OccupancyMap map = wall_at(3.0);
  fill(map, {2.93, -0.05, 0.5}, {2.94, 0.05, 0.51}, kWall);
  const EchoPlace place = place_of_echo(map, beam_along_x(), 3.03, kTolerance_m);
  EXPECT_EQ(place.what, Occupancy::kOccupied);
  EXPECT_LT(std::abs(place.error_m), 0.03);
}

TEST(HeldOutEchoes, AStillHeadPredictsItsOtherSweeps) {
  const HeldOutEchoes echoes = echoes_of(turns_in_room(5));
  EXPECT_EQ(echoes.sweeps(), 5U);
  const std::vector<JudgedEcho> judged = judge(echoes, still());
  EXPECT_GT(judged.size(), 900U);
  EXPECT_GT(share_of(judged, EchoOutcome::kPredicted), 0.9);
  EXPECT_TRUE(std::ranges::is_sorted(judged, {}, &JudgedEcho::sweep));
  const SweepCoverage coverage = echoes.coverage(still(), 0.05);
  EXPECT_EQ(coverage.sweeps, 5U);
  EXPECT_EQ(coverage.sweeps_per_place, 5.0);
  EXPECT_EQ(coverage.moved_m, 0.0);
  EXPECT_NEAR(coverage.sweep_s, 8.0, 0.1);
}

// Kills a sweep that is in the map that it is compared with.
TEST(HeldOutEchoes, ASingleSweepIsComparedWithNothing) {
  const std::vector<JudgedEcho> judged = judge(echoes_of(turns_in_room(1)), still());
  EXPECT_GT(judged.size(), 180U);
  EXPECT_EQ(share_of(judged, EchoOutcome::kUnknown), 1.0);
}

// Kills scores that depend on when or in what frame a recording was made.
TEST(HeldOutEchoes, AnotherClockOrATurnedFrameChangesNothing) {
  std::vector<Beam> beams = turns_in_room(4);
  const std::vector<JudgedEcho> before = judge(echoes_of(beams), still());
  for (Beam& beam : beams) beam.time_s += 1e6;
  const HeldOutEchoes later = echoes_of(beams);
  const std::vector<JudgedEcho> after = judge(later, still());
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    ASSERT_EQ(before[i].outcome, after[i].outcome);
    ASSERT_EQ(before[i].error_m, after[i].error_m);
  }
  // Cells are in other places then, so not each echo is the same.
  const Pose turned = pose_from_rpy({7.3, -2.2, 1.7}, 0.0, 0.0, 1.1);
  const std::vector<JudgedEcho> elsewhere = judge(later, Trajectory::still(turned));
  for (const EchoOutcome one : {EchoOutcome::kPredicted, EchoOutcome::kTooEarly, EchoOutcome::kFromFree}) {
    EXPECT_NEAR(share_of(elsewhere, one), share_of(before, one), 0.05);
  }
}

// Kills a score that does not see poses that are wrong: here each other sweep is put 0.3 m aside.
TEST(HeldOutEchoes, WrongPosesLowerTheScore) {
  const HeldOutEchoes echoes = echoes_of(turns_in_room(8));
  std::vector<StampedPose> poses;
  for (int sweep = 0; sweep < 8; ++sweep) {
    Pose pose = Pose::Identity();
    pose.translation().x() = sweep % 2 == 0 ? 0.0 : 0.3;
    poses.push_back({8.0 * sweep, pose});
    poses.push_back({8.0 * sweep + 7.97, pose});
  }
  const Result<Trajectory> jumping = Trajectory::make(poses);
  ASSERT_TRUE(jumping);
  const HeldOutOptions two_folds{.folds = 2};
  const double right = share_of(judge(echoes, still(), two_folds), EchoOutcome::kPredicted);
  const std::vector<JudgedEcho> wrong = judge(echoes, *jumping, two_folds);
  EXPECT_LT(share_of(wrong, EchoOutcome::kPredicted), right - 0.25);
  EXPECT_GT(share_of(wrong, EchoOutcome::kTooEarly), 0.1);
}

std::vector<CellAgreement> agreement_of(const HeldOutEchoes& echoes, const Trajectory& trajectory,
                                        CountCells cells = CountCells::kYes) {
  Result<JudgedEchoes> judged = echoes.judge(trajectory, {.resolution_m = 0.05}, {.folds = 2, .cells = cells});
  EXPECT_TRUE(judged);
  return judged ? std::move(judged->cells) : std::vector<CellAgreement>();
}

double mean_share(const std::vector<CellAgreement>& cells) {
  double judged = 0.0, agreed = 0.0;
  for (const CellAgreement& cell : cells) {
    judged += cell.judged;
    agreed += cell.agreed;
  }
  return agreed / judged;
}

// Kills cells that are counted although no echo was compared with them, or that agree with echoes that they contradict.
TEST(HeldOutEchoes, CellsAgreeWhereEchoesArePredicted) {
  const HeldOutEchoes echoes = echoes_of(turns_in_room(4));
  EXPECT_TRUE(agreement_of(echoes, still(), CountCells::kNo).empty());
  const std::vector<CellAgreement> cells = agreement_of(echoes, still());
  EXPECT_GT(cells.size(), 500U);
  EXPECT_TRUE(std::ranges::is_sorted(cells, {}, &CellAgreement::cell));
  for (const CellAgreement& cell : cells) {
    ASSERT_GT(cell.judged, 0U);
    ASSERT_LE(cell.agreed, cell.judged);
  }
  EXPECT_GT(mean_share(cells), 0.9);
  // The last sweep is turned: its echoes come from elsewhere.
  std::vector<StampedPose> poses = {{0.0, Pose::Identity()}, {23.97, Pose::Identity()}};
  const Pose aside = pose_from_rpy({0.5, 0.5, 0.0}, 0.0, 0.0, 0.4);
  poses.push_back({24.0, aside});
  poses.push_back({32.0, aside});
  const Result<Trajectory> turned = Trajectory::make(poses);
  ASSERT_TRUE(turned);
  EXPECT_LT(mean_share(agreement_of(echoes, *turned)), mean_share(cells) - 0.15);
}

TEST(CellAgreement, IsOneByteFromNoneToAll) {
  EXPECT_EQ(CellAgreement{}.level(), 0);
  EXPECT_EQ((CellAgreement{{}, 7, 0}.level()), 1);
  EXPECT_EQ((CellAgreement{{}, 7, 7}.level()), 255);
  EXPECT_EQ((CellAgreement{{}, 2, 1}.level()), 128);
}

// Kills ranges and mounts that are changed for the map, but not for the echoes that are compared with it.
TEST(HeldOutEchoes, ScalingAllRangesOfAStillHeadChangesLittle) {
  const HeldOutEchoes echoes = echoes_of(turns_in_room(4));
  const double before = share_of(judge(echoes, still()), EchoOutcome::kPredicted);
  EXPECT_NEAR(share_of(judge(echoes, still(), {.range_factor = 1.2}), EchoOutcome::kPredicted), before, 0.1);
  EXPECT_NEAR(share_of(judge(echoes, still(), {.mount_x_m = 0.4, .mount_yaw_rad = 0.7}), EchoOutcome::kPredicted),
              before, 0.05);
}

}  // namespace
}  // namespace pingvox::test
