#include "pingvox/io/geojson.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <sstream>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/nav/nav_trajectory.hpp"

namespace pingvox {
namespace {

using testing::HasSubstr;
using testing::Not;

const Eigen::Vector3d kGeoOrigin(54.5 * kDegree_rad, 10.25 * kDegree_rad, 0.0);

StampedPose pose_at(double time_s, const Eigen::Vector3d& place_m, double yaw_rad = 0.0) {
  return {time_s, pose_from_rpy(place_m, 0.0, 0.0, yaw_rad)};
}

std::string geojson_of(const Trajectory& path, const GeoJsonOptions& options) {
  std::ostringstream out;
  const Result<std::size_t> points = write_geojson(path, options, out);
  EXPECT_TRUE(points);
  EXPECT_EQ(points.value_or(0), path.poses().size());
  return out.str();
}

TEST(FixOfPosition, IsTheInverseOfPositionOfFix) {
  for (const Eigen::Vector3d& place_m : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(2500.0, -4000.0, -12.5)}) {
    const Eigen::Vector3d again = position_of_fix(fix_of_position(place_m, kGeoOrigin), kGeoOrigin);
    EXPECT_LT((again - place_m).norm(), 1e-7);
  }
  const Eigen::Vector3d far_east(0.1, std::numbers::pi - 1e-6, 0.0);
  const Eigen::Vector3d beyond = fix_of_position({100.0, 0.0, 0.0}, far_east);
  EXPECT_LT(beyond.y(), 0.0) << "east of the longitude of 180 degrees";
  EXPECT_NEAR(position_of_fix(beyond, far_east).x(), 100.0, 1e-6);
}

TEST(GeoJson, HasALineForEachPartAndAPointForEachPose) {
  const auto path = Trajectory::make({pose_at(0.0, {0, 0, -1}), pose_at(1.0, {0, 111.0, -1}, std::numbers::pi / 2),
                                      pose_at(9.0, {10, 0, -2}), pose_at(10.0, {20, 0, -2})},
                                     5.0);
  ASSERT_TRUE(path);
  const std::string text = geojson_of(*path, {.origin_fix = kGeoOrigin, .name = "a\"b\n.tum"});
  EXPECT_THAT(text, HasSubstr("\"type\":\"LineString\",\"coordinates\":[[10.250000000,54.500000000],"
                              "[10.250000000,54.500997"));
  EXPECT_THAT(text, HasSubstr("\"name\": \"a\\\"b\\u000a.tum\", \"from_s\": 0, \"to_s\": 1"));
  EXPECT_THAT(text, HasSubstr("\"from_s\": 9, \"to_s\": 10"));
  EXPECT_THAT(text, HasSubstr("\"time_s\": 0, \"x_m\": 0, \"y_m\": 0, \"z_m\": -1, \"heading_deg\": 90}"));
  EXPECT_THAT(text, Not(HasSubstr("\"time\":")));
  EXPECT_THAT(text, Not(HasSubstr("deviation")));
}

TEST(GeoJson, TellsDatesOfClocksThatCountFrom1970) {
  const Trajectory path = Trajectory::still(Pose::Identity(), 1509613126.75);
  EXPECT_THAT(geojson_of(path, {.origin_fix = kGeoOrigin, .clock = NavClock::kUnix}),
              HasSubstr("\"time\": \"2017-11-02T08:58:46.750Z\""));
}

TEST(GeoJson, TellsHowUncertainThePlaceIs) {
  NavSource source;
  source.quantity = NavQuantity::kPosition;
  source.samples.push_back({.time_s = 0.0, .deviation = Eigen::Vector3d(1.0, 2.0, 3.0)});
  source.samples.push_back({.time_s = 2.0, .deviation = Eigen::Vector3d(3.0, 4.0, 5.0)});
  source.samples.push_back({.time_s = 3.0});
  const auto path = Trajectory::make({pose_at(0.0, {0, 0, 0}), pose_at(1.0, {1, 0, 0}), pose_at(3.0, {2, 0, 0})});
  ASSERT_TRUE(path);
  const std::string text = geojson_of(*path, {.origin_fix = kGeoOrigin, .has_attitude = false, .positions = &source});
  EXPECT_THAT(text, HasSubstr("\"z_m\": 0, \"deviation_east_m\": 2, \"deviation_north_m\": 3, \"deviation_up_m\": 4}"));
  EXPECT_THAT(text, HasSubstr("\"time_s\": 3, \"x_m\": 2, \"y_m\": 0, \"z_m\": 0}"));
}

TEST(GeoJson, OfOnePoseIsAPoint) {
  EXPECT_THAT(geojson_of(Trajectory::still(Pose::Identity()), {.origin_fix = kGeoOrigin}),
              Not(HasSubstr("LineString")));
}

TEST(GeoJson, SaysWhenItCouldNotBeWritten) {
  std::ostringstream closed;
  closed.setstate(std::ios::badbit);
  EXPECT_FALSE(write_geojson(Trajectory::still(Pose::Identity()), {}, closed));
}

}  // namespace
}  // namespace pingvox
