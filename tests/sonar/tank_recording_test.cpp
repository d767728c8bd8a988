// What the defaults make of the recording of the paper's authors. The walls were fitted to the strongest ridge of the
// mean of all sweeps, beside this library.
#include "support/tank_recording.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/filters.hpp"
#include "pingvox/sonar/sweep.hpp"

namespace pingvox {
namespace {

class OnTheTankRecording : public testing::Test {
 protected:
  void SetUp() override {
    const std::vector<Beam> beams = test::TankRecording::beams(PINGVOX_SHARED_DATA);
    if (beams.empty()) GTEST_SKIP() << "no tank recording in " << PINGVOX_SHARED_DATA;
    ASSERT_EQ(beams.size(), 5604U);
    sweeps_ = sweeps_of(beams);
  }

  std::vector<Sweep> sweeps_;
};

/// The nearest wall, and how far the bearing is off its normal [degrees].
struct Wall {
  double range_m;
  double off_deg;
};

Wall wall_at(double clockwise_rad) {
  constexpr std::array<double, 4> kDistances_m = {2.109, 1.820, 2.325, 2.766};  // ahead, right, behind, left
  Wall nearest{.range_m = 1e9, .off_deg = 0.0};
  for (std::size_t side = 0; side < 4; ++side) {
    const double off = clockwise_rad + 0.0253 - 0.5 * std::numbers::pi * static_cast<double>(side);
    const double range = kDistances_m[side] / std::cos(off);
    if (std::cos(off) > 0.1 && range < nearest.range_m) {
      nearest = {range, std::abs(std::remainder(off, 2.0 * std::numbers::pi)) / kDegree_rad};
    }
  }
  return nearest;
}

TEST_F(OnTheTankRecording, ThereAre28SweepsAndFourBeamsOver) {
  ASSERT_EQ(sweeps_.size(), 29U);
  for (std::size_t n = 0; n < 28; ++n) {
    SCOPED_TRACE(n);
    EXPECT_EQ(sweeps_[n].extent, Sweep::Extent::kTurn);
    EXPECT_EQ(sweeps_[n].beams.size(), 200U);
  }
  EXPECT_EQ(sweeps_[28].extent, Sweep::Extent::kCut);
  EXPECT_EQ(sweeps_[28].beams.size(), 4U);
  EXPECT_EQ(sweeps_[28].beams[3].intensities.size(), 186U);
}

TEST_F(OnTheTankRecording, TheDefaultsFindTheWallsAndTheFloater) {
  std::size_t beams = 0;
  std::size_t missed = 0;
  std::size_t facing = 0;
  std::size_t on_wall = 0;
  std::map<long, std::vector<double>> ranges_at;
  for (const Sweep& sweep : sweeps_) {
    const auto echoes = detect_echoes(apply_filter(PolarImage(sweep), {}), sweep, {});
    for (std::size_t n = 0; n < echoes.size(); ++n) {
      ++beams;
      const double clockwise = 2.0 * std::numbers::pi - sweep.beams[n].bearing_rad;
      const double degrees = clockwise / kDegree_rad;
      if (!echoes[n]) {
        ++missed;
        continue;
      }
      ranges_at[std::lround(degrees / 1.8) % 200].push_back(echoes[n]->range_m);
      // Beyond 33 degrees off a wall's normal the corners answer through the beam's side lobes; the floater hides the
      // wall to the left.
      const Wall wall = wall_at(clockwise);
      const bool floater = degrees > 255.0 && degrees < 285.0;
      if (wall.off_deg > 33.0 || floater) continue;
      ++facing;
      if (std::abs(echoes[n]->range_m - wall.range_m) <= 0.05) ++on_wall;
    }
  }
  ASSERT_EQ(beams, 5604U);
  EXPECT_LE(missed, 5U);
  ASSERT_GT(facing, 3500U);
  EXPECT_GE(static_cast<double>(on_wall) / static_cast<double>(facing), 0.80);

  // The scene is static: what the noise changes from sweep to sweep must be little.
  std::size_t repeated = 0;
  std::size_t all = 0;
  for (auto& [bearing, ranges] : ranges_at) {
    std::ranges::nth_element(ranges, ranges.begin() + static_cast<std::ptrdiff_t>(ranges.size() / 2));
    const double median = ranges[ranges.size() / 2];
    for (const double range : ranges) repeated += std::abs(range - median) <= 2 * 0.0126 ? 1U : 0U;
    all += ranges.size();
  }
  EXPECT_EQ(ranges_at.size(), 200U);
  EXPECT_GE(static_cast<double>(repeated) / static_cast<double>(all), 0.97);

  const std::vector<double>& floater = ranges_at[std::lround(270.0 / 1.8)];
  ASSERT_GE(floater.size(), 20U);
  EXPECT_LT(floater[floater.size() / 2], 2.1) << "the floater stands before the wall at 2.77 m";
}

}  // namespace
}  // namespace pingvox
