#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "pingvox/mapping/build_map.hpp"

namespace pingvox {
namespace {

constexpr double kBin_m = 0.4;

/// A turn in which each beam is silent but for three bins from this one on.
class EchoesFromBin : public BeamSource {
 public:
  explicit EchoesFromBin(std::size_t bin) : bin_(bin) {}

  Result<std::optional<Beam>> next() override {
    constexpr int kBeams = 200;
    if (n_ == kBeams) return std::nullopt;
    Beam beam{.time_s = 0.1 * n_,
              .bearing_rad = 2.0 * std::numbers::pi * n_ / kBeams,
              .bin_length_m = kBin_m,
              .intensities = std::vector<std::uint8_t>(40, 5)};
    std::fill_n(beam.intensities.begin() + static_cast<std::ptrdiff_t>(bin_), 3, 200);
    ++n_;
    return beam;
  }

 private:
  std::size_t bin_;
  int n_ = 0;
};

// Kills a beam that frees a bin too many or too few: what the sound came back from as soon as it was there is not free.
TEST(BeamEvidence, FreesAllBeforeTheFirstBinOfTheEchoAndNothingInIt) {
  for (const BeamShape shape : {BeamShape::kRay, BeamShape::kFan, BeamShape::kCone}) {
    for (const std::size_t bin : {6U, 12U, 20U}) {
      SCOPED_TRACE(testing::Message() << "shape " << static_cast<int>(shape) << ", bin " << bin);
      BuildOptions options;
      options.filter.filter = Filter::kNone;
      options.model.shape = shape;
      EchoesFromBin source(bin);
      OccupancyMap map;
      // In the middle of a cell, so that no axis runs along faces.
      const Eigen::Vector3d head_m = Eigen::Vector3d::Constant(0.025);
      const auto report = build_map(source, Trajectory::still(pose_from_rpy(head_m, 0.0, 0.0, 0.0)), options, map);
      ASSERT_TRUE(report) << report.error().message;
      EXPECT_EQ(report->echoes, 200U);
      // The echo's first bin begins there; cells are 0.05 m.
      const double begin_m = static_cast<double>(bin) * kBin_m;
      for (const auto& [ahead, left] : {std::pair{1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}}) {
        const auto at = [&](double range_m) {
          return map.classify(Eigen::Vector3d(head_m + range_m * Eigen::Vector3d(ahead, left, 0.0)));
        };
        EXPECT_EQ(at(begin_m - 0.12), Occupancy::kFree);
        EXPECT_NE(at(begin_m + 0.12), Occupancy::kFree);
      }
    }
  }
}

/// The widest step between neighbours.
double widest_step(std::vector<double> numbers) {
  std::sort(numbers.begin(), numbers.end());
  double widest = 0.0;
  for (std::size_t i = 1; i < numbers.size(); ++i) widest = std::max(widest, numbers[i] - numbers[i - 1]);
  return widest;
}

// Kills a ray too few, which leaves cells between its neighbours.
TEST(BeamBundle, HasNoGapsAtItsRange) {
  constexpr double kResolution_m = 0.05;
  BeamModelOptions options;
  options.shape = BeamShape::kCone;
  for (double range_m = 0.5; range_m < 8.0; range_m += 0.37) {
    SCOPED_TRACE(range_m);
    std::vector<double> azimuths, elevations;
    for (const BundleRay& ray : beam_bundle(options, 0.0, range_m, kResolution_m)) {
      azimuths.push_back(std::atan2(ray.direction.y(), ray.direction.x()));
      elevations.push_back(std::asin(ray.direction.z()));
    }
    const double apart_rad = kResolution_m / std::numbers::sqrt2 / range_m * (1.0 + 1e-9);
    EXPECT_LE(widest_step(azimuths), apart_rad);
    EXPECT_LE(widest_step(elevations), apart_rad);
  }
}

}  // namespace
}  // namespace pingvox
