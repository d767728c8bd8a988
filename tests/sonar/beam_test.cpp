#include "pingvox/sonar/beam.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

namespace pingvox {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

TEST(WrapBearing, NeverReturnsAWholeTurn) {
  for (const double angle :
       {-1e-300, -1e-17, -1e-9, kTurn, -kTurn, 1e15, -1e15, std::nextafter(kTurn, 0.0), 3 * kTurn}) {
    SCOPED_TRACE(angle);
    EXPECT_GE(wrap_bearing(angle), 0.0);
    EXPECT_LT(wrap_bearing(angle), kTurn);
  }
  EXPECT_DOUBLE_EQ(wrap_bearing(-std::numbers::pi / 2), 1.5 * std::numbers::pi);
}

TEST(ValidateBeam, RefusesWhatItsCommentsRuleOut) {
  const Beam good{.time_s = 1.0, .bearing_rad = 1.0, .bin_length_m = 0.1, .intensities = {1, 2}};
  EXPECT_TRUE(validate(good));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinity, -infinity}) {
    Beam beam = good;
    beam.time_s = bad;
    EXPECT_FALSE(validate(beam)) << bad;
  }
  for (const double bad : {nan, -0.1, kTurn, infinity}) {
    Beam beam = good;
    beam.bearing_rad = bad;
    EXPECT_FALSE(validate(beam)) << bad;
  }
  for (const double bad : {nan, 0.0, -0.1, infinity, 1e9}) {
    Beam beam = good;
    beam.bin_length_m = bad;
    EXPECT_FALSE(validate(beam)) << bad;
  }
}

// Kills a longest range that is compared with the length of a bin.
TEST(ValidateBeam, RefusesMoreBinsThanTheLongestRangeHolds) {
  Beam beam{.time_s = 1.0, .bearing_rad = 1.0, .bin_length_m = 1.0, .intensities = {}};
  beam.intensities.resize(static_cast<std::size_t>(kMaxBeamRange_m));
  EXPECT_TRUE(validate(beam));
  beam.intensities.push_back(0);
  EXPECT_FALSE(validate(beam));
}

/// Three beams, then the end or an error.
class ThreeBeams : public BeamSource {
 public:
  explicit ThreeBeams(Result<void> end) : end_(std::move(end)) {}
  Result<std::optional<Beam>> next() override {
    if (given_ < 3) return Beam{.time_s = ++given_, .bearing_rad = 0.0, .bin_length_m = 0.1, .intensities = {}};
    if (!end_) return tl::unexpected(end_.error());
    return std::nullopt;
  }

 private:
  double given_ = 0.0;
  Result<void> end_;
};

TEST(ReadAll, GivesTheBeamsInTheirOrder) {
  ThreeBeams source{{}};
  const Result<std::vector<Beam>> beams = read_all(source);
  ASSERT_TRUE(beams);
  ASSERT_EQ(beams->size(), 3U);
  for (std::size_t n = 0; n < 3; ++n) EXPECT_EQ((*beams)[n].time_s, static_cast<double>(n + 1));
}

TEST(ReadAll, DoesNotTakeAnErrorForTheEnd) {
  ThreeBeams source{fail(Error::Code::kIo, "the disk is gone")};
  const Result<std::vector<Beam>> beams = read_all(source);
  ASSERT_FALSE(beams);
  EXPECT_EQ(beams.error().message, "the disk is gone");
}

}  // namespace
}  // namespace pingvox
