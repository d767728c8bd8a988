#include "pingvox/sonar/mosaic.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace pingvox {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;

double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1p-53;
}

Mosaic mosaic_of(const MosaicOptions& options) {
  Result<Mosaic> made = Mosaic::make(options);
  EXPECT_TRUE(made) << made.error().message;
  return *std::move(made);
}

Raster<float> picture_of(const Mosaic& mosaic) {
  Result<Raster<float>> picture = mosaic.picture();
  EXPECT_TRUE(picture) << picture.error().message;
  return *std::move(picture);
}

/// The middle of the pixels of the greatest intensity.
Eigen::Vector2d brightest_place(const Raster<float>& picture) {
  float greatest = -1.0F;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double count = 0.0;
  for (std::size_t row = 0; row < picture.rows; ++row) {
    for (std::size_t column = 0; column < picture.columns; ++column) {
      const float intensity = picture.at(column, row);
      constexpr float kRounding = 0.01F;
      if (!(intensity >= greatest - kRounding)) continue;
      if (intensity > greatest + kRounding) {
        greatest = intensity;
        sum.setZero();
        count = 0.0;
      }
      sum += picture.corner_m +
             picture.cell_m * Eigen::Vector2d(static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5);
      count += 1.0;
    }
  }
  return sum / count;
}

/// A turn of beams whose intensities are random.
std::vector<Beam> random_turn(std::mt19937_64& random, std::size_t beams, std::size_t bins, double bin_m) {
  std::vector<Beam> turn(beams);
  for (std::size_t n = 0; n < beams; ++n) {
    turn[n].bearing_rad = 2.0 * kPi * static_cast<double>(n) / static_cast<double>(beams);
    turn[n].bin_length_m = bin_m;
    for (std::size_t i = 0; i < bins; ++i) turn[n].intensities.push_back(static_cast<std::uint8_t>(random() % 256));
  }
  return turn;
}

// The target is put into the frame of the head, where the sonar would hear it; only the picture goes the other way.
TEST(Mosaic, ShowsATargetAtTheHeightOfTheHeadWhereItIs) {
  std::size_t checked = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const Eigen::Vector3d at(uniform(random, -50, 50), uniform(random, -50, 50), uniform(random, -9, 0));
    const bool is_upside_down = random() % 2 == 0;
    const Pose map_from_head = pose_from_rpy(at, uniform(random, -0.2, 0.2) + (is_upside_down ? kPi : 0.0),
                                             uniform(random, -0.15, 0.15), uniform(random, -kPi, kPi));
    const double heading_rad = uniform(random, -kPi, kPi), range_m = uniform(random, 2.0, 20.0);
    const Eigen::Vector3d target = at + range_m * Eigen::Vector3d(std::cos(heading_rad), std::sin(heading_rad), 0.0);
    const Eigen::Vector3d heard = map_from_head.inverse() * target;
    Beam beam{0.0, wrap_bearing(std::atan2(heard.y(), heard.x())), 0.05, std::vector<std::uint8_t>(420, 10)};
    beam.intensities[static_cast<std::size_t>(heard.norm() / beam.bin_length_m)] = 200;
    const double pixel_m = uniform(random, 0.03, 0.2);
    const Blend blend = random() % 2 == 0 ? Blend::kMean : Blend::kMaximum;
    Mosaic mosaic = mosaic_of({.resolution_m = pixel_m, .blend = blend});
    ASSERT_TRUE(mosaic.add(map_from_head, beam, {.width_rad = 0.05, .height_rad = 0.6}));
    EXPECT_LT((brightest_place(picture_of(mosaic)) - target.head<2>()).norm(), 0.05 + 1.5 * pixel_m);
    ++checked;
  }
  EXPECT_EQ(checked, 300U);
}

TEST(Mosaic, ShowsASteepNarrowBeamBelowItsAxis) {
  for (const double pitch_rad : {0.3, 0.8, 1.3}) {
    // Nose down: the beam looks ahead and down.
    const Pose map_from_head = pose_from_rpy({3.0, -2.0, -1.0}, 0.0, pitch_rad, 0.5 * kPi);
    Beam beam{0.0, 0.0, 0.05, std::vector<std::uint8_t>(300, 10)};
    beam.intensities[200] = 200;
    Mosaic mosaic = mosaic_of({.resolution_m = 0.05});
    ASSERT_TRUE(mosaic.add(map_from_head, beam, {.width_rad = 0.02, .height_rad = 0.001}));
    const Eigen::Vector3d target = map_from_head * Eigen::Vector3d(200.5 * 0.05, 0.0, 0.0);
    EXPECT_LT((brightest_place(picture_of(mosaic)) - target.head<2>()).norm(), 0.1) << pitch_rad;
  }
}

TEST(Mosaic, LosesNoBinOfAThinBeam) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const Pose map_from_head =
        pose_from_rpy({uniform(random, -5, 5), uniform(random, -5, 5), 0}, 0, 0, uniform(random, -kPi, kPi));
    Beam beam{0.0, 0.0, 0.02, std::vector<std::uint8_t>(500, 7)};
    beam.intensities[50 + random() % 430] = 255;
    Mosaic mosaic = mosaic_of({.resolution_m = uniform(random, 0.02, 0.5), .blend = Blend::kMaximum});
    ASSERT_TRUE(mosaic.add(map_from_head, beam, {.width_rad = 0.001, .height_rad = 0.5}));
    const Raster<float> picture = picture_of(mosaic);
    EXPECT_EQ(std::ranges::count(picture.values, 255.0F) > 0, true);
  }
}

TEST(Mosaic, IsTurnedWithTheFrameOfTheMap) {
  std::size_t pixels = 0, different = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    std::mt19937_64 random(seed);
    const std::vector<Beam> turn = random_turn(random, 120, 60, 0.1);
    const Pose quarter = pose_from_rpy({0, 0, 0}, 0, 0, 0.5 * kPi);
    Mosaic mosaic = mosaic_of({.resolution_m = 0.1}), turned = mosaic_of({.resolution_m = 0.1});
    for (const Beam& beam : turn) {
      const Pose pose = pose_from_rpy({uniform(random, -4, 4), uniform(random, -4, 4), 0}, 0.05, 0.02, 0.7);
      ASSERT_TRUE(mosaic.add(pose, beam, {.width_rad = 0.05, .height_rad = 0.5}));
      ASSERT_TRUE(turned.add(quarter * pose, beam, {.width_rad = 0.05, .height_rad = 0.5}));
    }
    const Raster<float> before = picture_of(mosaic), after = picture_of(turned);
    ASSERT_EQ(after.columns, before.rows);
    ASSERT_EQ(after.rows, before.columns);
    EXPECT_NEAR(after.corner_m.y(), before.corner_m.x(), 1e-9) << "x becomes y";
    for (std::size_t row = 0; row < before.rows; ++row) {
      for (std::size_t column = 0; column < before.columns; ++column) {
        const float a = before.at(column, row), b = after.at(before.rows - 1 - row, column);
        const bool is_same = std::isnan(a) ? std::isnan(b) : std::abs(a - b) < 0.01F;
        ++pixels;
        different += is_same ? 0U : 1U;
      }
    }
  }
  EXPECT_GT(pixels, 50'000U);
  EXPECT_LT(different, pixels / 1000) << "only where a pixel is at the border of a beam";
}

TEST(Mosaic, OfTheSameBeamsTwiceIsThatOfOne) {
  std::mt19937_64 random(7);
  const std::vector<Beam> turn = random_turn(random, 200, 80, 0.05);
  for (const Blend blend : {Blend::kMean, Blend::kMaximum}) {
    Mosaic once = mosaic_of({.blend = blend}), twice = mosaic_of({.blend = blend});
    for (const Beam& beam : turn) ASSERT_TRUE(once.add(Pose::Identity(), beam, {.width_rad = 0.05, .height_rad = 0.5}));
    for (int n = 0; n < 2; ++n) {
      for (const Beam& beam : turn) {
        ASSERT_TRUE(twice.add(Pose::Identity(), beam, {.width_rad = 0.05, .height_rad = 0.5}));
      }
    }
    const Raster<float> a = picture_of(once), b = picture_of(twice);
    ASSERT_EQ(a.values.size(), b.values.size());
    for (std::size_t i = 0; i < a.values.size(); ++i) {
      ASSERT_EQ(std::isnan(a.values[i]), std::isnan(b.values[i]));
      if (!std::isnan(a.values[i])) {
        ASSERT_NEAR(a.values[i], b.values[i], 1e-3);
      }
    }
  }
}

TEST(Mosaic, BlendsToTheMeanOrTheMaximum) {
  Beam faint{0.0, 0.0, 0.1, std::vector<std::uint8_t>(50, 40)}, strong = faint;
  std::ranges::fill(strong.intensities, std::uint8_t{200});
  for (const auto& [blend, expected] : {std::pair{Blend::kMean, 120.0F}, std::pair{Blend::kMaximum, 200.0F}}) {
    Mosaic mosaic = mosaic_of({.resolution_m = 0.1, .blend = blend});
    for (const Beam& beam : {faint, strong}) {
      ASSERT_TRUE(mosaic.add(Pose::Identity(), beam, {.width_rad = 0.1, .height_rad = 0.5}));
    }
    for (const float value : picture_of(mosaic).values) {
      if (!std::isnan(value)) {
        ASSERT_NEAR(value, expected, 1e-3);
      }
    }
  }
}

// Between the beams of heads with coarse steps, and near the head, where beams are narrower than pixels.
TEST(Mosaic, HasNoGapsInATurn) {
  std::mt19937_64 random(3);
  for (const Blend blend : {Blend::kMean, Blend::kMaximum}) {
    for (const std::size_t beams : {40U, 100U, 200U, 400U}) {
      const double step_rad = 2.0 * kPi / static_cast<double>(beams);
      Mosaic mosaic = mosaic_of({.resolution_m = 0.05, .blend = blend, .min_range_m = 0.2});
      for (const Beam& beam : random_turn(random, beams, 100, 0.04)) {
        ASSERT_TRUE(mosaic.add(Pose::Identity(), beam, {.width_rad = 0.02, .height_rad = 0.5, .step_rad = step_rad}));
      }
      const Raster<float> picture = picture_of(mosaic);
      std::size_t heard = 0;
      for (std::size_t row = 0; row < picture.rows; ++row) {
        for (std::size_t column = 0; column < picture.columns; ++column) {
          const Eigen::Vector2d at = picture.corner_m + 0.05 * Eigen::Vector2d(static_cast<double>(column) + 0.5,
                                                                               static_cast<double>(row) + 0.5);
          const float intensity = picture.at(column, row);
          if (at.norm() > 0.3 && at.norm() < 3.9) {
            ASSERT_FALSE(std::isnan(intensity)) << at.transpose();
          }
          if (at.norm() < 0.15 || at.norm() > 4.05) {
            ASSERT_TRUE(std::isnan(intensity)) << at.transpose();
          }
          heard += std::isnan(intensity) ? 0U : 1U;
        }
      }
      EXPECT_GT(heard, 15'000U);
    }
  }
}

TEST(Mosaic, IsRefusedWhenItWouldBeTooLarge) {
  const Beam beam{0.0, 0.0, 0.1, std::vector<std::uint8_t>(100, 40)};
  const BeamExtent extent{.width_rad = 0.05, .height_rad = 0.5};
  Mosaic mosaic = mosaic_of({.resolution_m = 0.1});
  ASSERT_TRUE(mosaic.add(Pose::Identity(), beam, extent));
  const auto far = mosaic.add(pose_from_rpy({1e5, 2e5, 0}, 0, 0, 0), beam, extent);
  ASSERT_FALSE(far);
  EXPECT_EQ(far.error().code, Error::Code::kLimit);
  EXPECT_THAT(far.error().message, AllOf(HasSubstr("x 20000"), HasSubstr("pixels of 0.1 m")));
  for (const double nowhere_m : {1e18, -1e300}) {
    const auto lost = mosaic.add(pose_from_rpy({nowhere_m, 0, 0}, 0, 0, 0), beam, extent);
    ASSERT_FALSE(lost);
    EXPECT_EQ(lost.error().code, Error::Code::kLimit);
  }
  const Raster<float> picture = picture_of(mosaic);
  EXPECT_LT(picture.columns, 110U) << "as before";
}

TEST(Mosaic, OfNothingIsEmpty) {
  Mosaic mosaic = mosaic_of({.min_range_m = 2.0});
  const BeamExtent extent{.width_rad = 0.05, .height_rad = 0.5};
  ASSERT_TRUE(mosaic.add(Pose::Identity(), {0.0, 0.0, 0.1, {}}, extent)) << "no bins";
  ASSERT_TRUE(mosaic.add(Pose::Identity(), {0.0, 0.0, 0.1, std::vector<std::uint8_t>(19, 99)}, extent)) << "all near";
  EXPECT_TRUE(mosaic.empty());
  const auto picture = mosaic.picture();
  ASSERT_FALSE(picture);
  EXPECT_EQ(picture.error().code, Error::Code::kUnsupported);
  // A beam that is so narrow that it only looks straight down.
  const Pose down = pose_from_rpy({0, 0, 0}, 0, 0.5 * kPi, 0);
  ASSERT_TRUE(mosaic.add(down, {0.0, 0.0, 0.1, std::vector<std::uint8_t>(99, 99)}, {.width_rad = 0.05}));
}

}  // namespace
}  // namespace pingvox
