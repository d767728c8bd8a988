#include "pingvox/io/las.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <sstream>

#include "io/two_occupied_leaves.hpp"
#include "pingvox/geometry/degree.hpp"

namespace pingvox {
namespace {

using testing::HasSubstr;

std::string las_of(const OccupancyMap& map, const std::optional<Eigen::Vector3d>& origin_fix = std::nullopt) {
  std::ostringstream out;
  const Result<std::size_t> points = write_las(map, origin_fix, out);
  EXPECT_TRUE(points) << points.error().message;
  return out.str();
}

template <class T>
T field_at(const std::string& bytes, std::size_t at) {
  T value{};
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

// Offsets by the specification of the ASPRS, LAS 1.4 R15.
TEST(Las, HasThePointsOfTheOccupiedLeaves) {
  const std::string file = las_of(samples::map_of_two_occupied_leaves());
  EXPECT_EQ(file.substr(0, 4), "LASF");
  EXPECT_EQ(field_at<std::uint16_t>(file, 6), 16U) << "the coordinate reference system would be well-known text";
  EXPECT_EQ(file.substr(24, 2), "\1\4");
  EXPECT_EQ(field_at<std::uint16_t>(file, 94), 375U);
  const std::size_t at = field_at<std::uint32_t>(file, 96);
  EXPECT_EQ(field_at<std::uint32_t>(file, 100), 1U);
  EXPECT_EQ(field_at<std::uint8_t>(file, 104), 6U);
  ASSERT_EQ(field_at<std::uint16_t>(file, 105), 38U);
  EXPECT_EQ(field_at<std::uint64_t>(file, 247), 2U);
  EXPECT_EQ(field_at<std::uint64_t>(file, 255), 2U) << "all are first returns";
  ASSERT_EQ(file.size(), at + 2 * 38);
  EXPECT_EQ(field_at<double>(file, 179), 1.5) << "highest x";
  EXPECT_EQ(field_at<double>(file, 219), -1.5) << "lowest z";

  const auto place = [&](std::size_t point, std::size_t axis) {
    return field_at<std::int32_t>(file, at + point * 38 + 4 * axis) * field_at<double>(file, 131 + 8 * axis) +
           field_at<double>(file, 155 + 8 * axis);
  };
  EXPECT_NEAR(place(0, 0), 1.5, 1e-9);
  EXPECT_NEAR(place(0, 1), 0.5, 1e-9);
  EXPECT_NEAR(place(0, 2), -1.5, 1e-9);
  EXPECT_NEAR(place(1, 2), 0.25, 1e-9);
  const double probability = LogOdds(2.0F).probability();
  EXPECT_NEAR(field_at<std::uint16_t>(file, at + 12), probability * 65535, 1.0);
  EXPECT_EQ(field_at<float>(file, at + 30), static_cast<float>(probability));
  EXPECT_EQ(field_at<float>(file, at + 34), 1.0F) << "its edge";
}

TEST(Las, DescribesItsExtraBytes) {
  const std::string file = las_of(samples::map_of_two_occupied_leaves());
  EXPECT_EQ(file.substr(375 + 2, 9), "LASF_Spec");
  EXPECT_EQ(field_at<std::uint16_t>(file, 375 + 18), 4U);
  EXPECT_EQ(field_at<std::uint16_t>(file, 375 + 20), 384U);
  EXPECT_EQ(field_at<std::uint8_t>(file, 375 + 54 + 2), 9U) << "float";
  EXPECT_STREQ(file.c_str() + 375 + 54 + 4, "probability");
  EXPECT_STREQ(file.c_str() + 375 + 54 + 192 + 4, "size");
}

TEST(Las, NamesItsReferenceSystemWhereItsOriginIsKnown) {
  const Eigen::Vector3d origin(54.5 * kDegree_rad, -10.25 * kDegree_rad, 3.0);
  const std::string file = las_of(samples::map_of_two_occupied_leaves(), origin);
  EXPECT_EQ(field_at<std::uint32_t>(file, 100), 2U);
  const std::size_t record = 375 + 54 + 384;
  EXPECT_EQ(file.substr(record + 2, 15), "LASF_Projection");
  EXPECT_EQ(field_at<std::uint16_t>(file, record + 18), 2112U);
  const std::string text = file.c_str() + record + 54;
  EXPECT_EQ(text.size() + 1, field_at<std::uint16_t>(file, record + 20));
  EXPECT_THAT(text, HasSubstr("PARAMETER[\"latitude_of_origin\",54.5],PARAMETER[\"central_meridian\",-10.25]"));
  EXPECT_EQ(field_at<std::uint32_t>(file, 96), record + 54 + text.size() + 1);
}

TEST(Las, IsRefusedWhereNothingIsOccupied) {
  std::ostringstream out;
  const Result<std::size_t> none = write_las(OccupancyMap(), std::nullopt, out);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, Error::Code::kUnsupported);
}

TEST(Las, SaysWhenItCouldNotBeWritten) {
  std::ostringstream closed;
  closed.setstate(std::ios::badbit);
  EXPECT_FALSE(write_las(samples::map_of_two_occupied_leaves(), std::nullopt, closed));
}

}  // namespace
}  // namespace pingvox
