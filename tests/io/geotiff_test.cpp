#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <sstream>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/grids.hpp"
#include "pingvox/nav/nav_trajectory.hpp"

namespace pingvox {
namespace {

using testing::ElementsAre;

constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();

/// A file by the specification of TIFF 6, little-endian, with one picture.
class Tiff {
 public:
  explicit Tiff(std::string bytes) : bytes_(std::move(bytes)) {
    EXPECT_EQ(bytes_.substr(0, 4), std::string("II*\0", 4));
    const std::size_t directory = at<std::uint32_t>(4);
    int last = 0;
    for (std::size_t i = 0; i < at<std::uint16_t>(directory); ++i) {
      const std::size_t entry = directory + 2 + 12 * i;
      EXPECT_GT(at<std::uint16_t>(entry), last) << "tags are in order";
      last = at<std::uint16_t>(entry);
      entries_[last] = entry;
    }
  }

  template <class T>
  std::vector<T> values(int tag) const {
    const std::size_t entry = entries_.at(tag), count = at<std::uint32_t>(entry + 4);
    const std::size_t place = count * sizeof(T) > 4 ? at<std::uint32_t>(entry + 8) : entry + 8;
    std::vector<T> values;
    for (std::size_t i = 0; i < count; ++i) values.push_back(at<T>(place + i * sizeof(T)));
    return values;
  }

  std::vector<float> pixels() const {
    std::vector<float> all;
    const auto places = values<std::uint32_t>(273), sizes = values<std::uint32_t>(279);
    for (std::size_t strip = 0; strip < places.size(); ++strip) {
      std::vector<float> piece(1U << 17U);
      uLongf size = piece.size() * sizeof(float);
      EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(piece.data()), &size,
                           reinterpret_cast<const Bytef*>(bytes_.data()) + places[strip], sizes[strip]),
                Z_OK);
      piece.resize(size / sizeof(float));
      all.insert(all.end(), piece.begin(), piece.end());
    }
    return all;
  }

 private:
  template <class T>
  T at(std::size_t place) const {
    T value{};
    std::memcpy(&value, bytes_.data() + place, sizeof(T));
    return value;
  }

  std::string bytes_;
  std::map<int, std::size_t> entries_;
};

Tiff tiff_of(const Raster<float>& raster, const std::optional<Eigen::Vector3d>& origin_fix = std::nullopt) {
  std::ostringstream out;
  EXPECT_TRUE(write_geotiff(raster, origin_fix, "height [m]", out));
  return Tiff(out.str());
}

TEST(GeoTiff, HasItsHighestRowFirst) {
  const Tiff tiff = tiff_of({2, 2, 0.5, {-1.0, 3.5}, {-1.5F, kNoValue, 7.0F, 0.25F}});
  EXPECT_THAT(tiff.values<std::uint32_t>(256), ElementsAre(2U));
  EXPECT_THAT(tiff.values<std::uint32_t>(257), ElementsAre(2U));
  const std::vector<float> pixels = tiff.pixels();
  ASSERT_EQ(pixels.size(), 4U);
  EXPECT_EQ(pixels[0], 7.0F);
  EXPECT_EQ(pixels[1], 0.25F);
  EXPECT_EQ(pixels[2], -1.5F);
  EXPECT_TRUE(std::isnan(pixels[3]));
  EXPECT_THAT(tiff.values<double>(33550), ElementsAre(0.5, 0.5, 0.0));
  EXPECT_THAT(tiff.values<double>(33922), ElementsAre(0.0, 0.0, 0.0, -1.0, 4.5, 0.0));
}

TEST(GeoTiff, HasItsUpperLeftCornerAtItsFix) {
  const Eigen::Vector3d origin(-33.9 * kDegree_rad, 151.2 * kDegree_rad, 0.0);
  const Tiff tiff = tiff_of({2, 1, 0.5, {-100.0, 50.0}, {1.0F, 2.0F}}, origin);
  const std::vector<double> scale = tiff.values<double>(33550), tie = tiff.values<double>(33922);
  const Eigen::Vector3d corner(tie[4] * kDegree_rad, tie[3] * kDegree_rad, 0.0);
  EXPECT_LT((position_of_fix(corner, origin) - Eigen::Vector3d(-100.0, 50.5, 0.0)).norm(), 1e-6);
  const Eigen::Vector3d across = corner + Eigen::Vector3d(-scale[1], scale[0], 0.0) * kDegree_rad;
  EXPECT_LT((position_of_fix(across, origin) - Eigen::Vector3d(-99.5, 50.0, 0.0)).norm(), 1e-6);
  EXPECT_THAT(tiff.values<std::uint16_t>(34735), testing::Contains(4326));
}

TEST(GeoTiff, OfManyRowsIsInStrips) {
  Raster<float> raster{1000, 300, 1.0, {0.0, 0.0}, {}};
  for (std::size_t i = 0; i < 300'000; ++i) raster.values.push_back(static_cast<float>(i));
  const Tiff tiff = tiff_of(raster);
  EXPECT_GT(tiff.values<std::uint32_t>(273).size(), 1U);
  const std::vector<float> pixels = tiff.pixels();
  ASSERT_EQ(pixels.size(), 300'000U);
  for (std::size_t row = 0; row < 300; ++row) ASSERT_EQ(pixels[row * 1000], static_cast<float>((299 - row) * 1000));
}

TEST(GeoTiff, SaysWhenItCouldNotBeWritten) {
  std::ostringstream closed;
  closed.setstate(std::ios::badbit);
  EXPECT_FALSE(write_geotiff({1, 1, 1.0, {0.0, 0.0}, {1.0F}}, std::nullopt, "x", closed));
  EXPECT_FALSE(write_prj(Eigen::Vector3d::Zero(), closed));
}

TEST(Occupancy, AsNumbersIsOneZeroOrNothing) {
  using enum Occupancy;
  const Raster<float> numbers = occupancy_numbers({3, 1, 0.5, {1.0, 2.0}, {kFree, kUnknown, kOccupied}});
  EXPECT_EQ(numbers.values[0], 0.0F);
  EXPECT_TRUE(std::isnan(numbers.values[1]));
  EXPECT_EQ(numbers.values[2], 1.0F);
  EXPECT_EQ(numbers.corner_m, Eigen::Vector2d(1.0, 2.0));
}

}  // namespace
}  // namespace pingvox
