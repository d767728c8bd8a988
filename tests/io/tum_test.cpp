#include "pingvox/io/tum.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <sstream>

#include "support/logs.hpp"

namespace pingvox {
namespace {

using testing::HasSubstr;

Result<Trajectory> read_as_tum(std::string_view text) {
  return read_tum({"poses.tum", bytes_of(text)});
}

std::string tum_error_of(std::string_view text) {
  const auto read_back = read_as_tum(text);
  return read_back ? "" : read_back.error().message;
}

TEST(Tum, TakesTheRealPartLast) {
  const auto trajectory = read_as_tum(
      "# timestamp tx ty tz qx qy qz qw\n"
      "1000.500000000 1 2 -0.5 0 0 0.7071067811865476 0.7071067811865476\n");
  ASSERT_TRUE(trajectory) << trajectory.error().message;
  ASSERT_EQ(trajectory->poses().size(), 1U);
  EXPECT_EQ(trajectory->poses()[0].time_s, 1000.5);
  const Pose expected = pose_from_rpy({1, 2, -0.5}, 0, 0, std::numbers::pi / 2);
  EXPECT_TRUE(trajectory->poses()[0].map_from_body.isApprox(expected, 1e-12));
}

TEST(Tum, TakesTabsCommasCarriageReturnsAndBlankLines) {
  const auto trajectory = read_as_tum("\r\n1,0,0,0,0,0,0,1\r\n  2\t0 0\t0, 0 0 0 1\r\n # note\n3 0 0 0 0 0 0 -1");
  ASSERT_TRUE(trajectory) << trajectory.error().message;
  EXPECT_EQ(trajectory->poses().size(), 3U);
}

// EuRoC has the real part first.
TEST(Tum, RefusesAHeaderWithTheRealPartFirst) {
  constexpr std::string_view kPose = "1 0 0 0 0 0 0 1\n";
  for (const std::string_view header : {"#timestamp,p_x,p_y,p_z,q_w,q_x,q_y,q_z\n", "# t x y z qw qx qy qz\n"}) {
    EXPECT_THAT(tum_error_of(std::string(header) + std::string(kPose)), HasSubstr("names qw before qx"));
  }
  EXPECT_EQ(tum_error_of("# timestamp tx ty tz qx qy qz qw\n" + std::string(kPose)), "");
}

TEST(Tum, NormalisesALittleAndRefusesMore) {
  const auto trajectory = read_as_tum("1 0 0 0 0 0 0 1.0009\n");
  ASSERT_TRUE(trajectory);
  EXPECT_TRUE(trajectory->poses()[0].map_from_body.isApprox(Pose::Identity(), 1e-15));
  EXPECT_THAT(tum_error_of("1 0 0 0 0 0 0 1.0011\n"), HasSubstr("poses.tum: line 1: its quaternion has length 1.0011"));
  EXPECT_THAT(tum_error_of("1 0 0 0 0 0 0 0\n"), HasSubstr("length 0"));
  EXPECT_NE(tum_error_of("1 0 0 0 1e200 1e200 0 0\n"), "");
}

TEST(Tum, NamesTheLineThatIsWrong) {
  const std::string good = "1 0 0 0 0 0 0 1\n";
  EXPECT_EQ(tum_error_of(good + "# note\n2 0 0 0 0 0 1\n"),
            "poses.tum: line 3: 7 numbers instead of 8: a pose is 't x y z qx qy qz qw'");
  EXPECT_EQ(tum_error_of(good + "2 0 0 0 0 0 0 1 9\n"),
            "poses.tum: line 2: more than 8 numbers: a pose is 't x y z qx qy qz qw'");
  EXPECT_EQ(tum_error_of(good + "2 0 zero 0 0 0 0 1\n"),
            "poses.tum: line 2: \"zero\" is not a finite number: a pose is 't x y z qx qy qz qw'");
  EXPECT_EQ(tum_error_of(good + "2 nan 0 0 0 0 0 1\n"),
            "poses.tum: line 2: \"nan\" is not a finite number: a pose is 't x y z qx qy qz qw'");
  EXPECT_EQ(tum_error_of(good + "0.5 0 0 0 0 0 0 1\n"),
            "poses.tum: line 2: time 0.5 s does not come after 1 s of the pose before it");
  EXPECT_THAT(tum_error_of(good + good), HasSubstr("line 2: time"));
  EXPECT_EQ(tum_error_of("# nothing\n\n"), "poses.tum: holds no poses");
  EXPECT_EQ(tum_error_of(""), "poses.tum: holds no poses");
}

TEST(Tum, ReadsBackWhatItWrote) {
  std::size_t checked = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const auto share = [&random] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    std::vector<StampedPose> poses(50);
    double time_s = seed % 2 == 0 ? 1.7e9 : 1e-12;
    for (StampedPose& pose : poses) {
      pose.time_s = time_s;
      // Closer than nine decimals show.
      time_s += seed % 2 == 0 ? 0.01 + share() : 1e-12 * (1.0 + share());
      pose.map_from_body =
          pose_from_rpy({share() * 100, -share(), share() * 1e-9}, share() * 6, share() * 6, share() * 6);
    }
    std::stringstream text;
    ASSERT_TRUE(write_tum(*Trajectory::make(poses), text));
    const auto trajectory = read_as_tum(text.str());
    ASSERT_TRUE(trajectory) << trajectory.error().message;
    ASSERT_EQ(trajectory->poses().size(), poses.size());
    for (std::size_t i = 0; i < poses.size(); ++i) {
      EXPECT_EQ(trajectory->poses()[i].time_s, poses[i].time_s);
      EXPECT_EQ(trajectory->poses()[i].map_from_body.translation(), poses[i].map_from_body.translation());
      EXPECT_TRUE(trajectory->poses()[i].map_from_body.isApprox(poses[i].map_from_body, 1e-14));
      ++checked;
    }
  }
  EXPECT_EQ(checked, 1000U);
}

TEST(Tum, WritesNineDecimalsOfTime) {
  std::stringstream text;
  ASSERT_TRUE(write_tum(*Trajectory::make({{1000.5, Pose::Identity()}}), text));
  EXPECT_EQ(text.str(), "# timestamp tx ty tz qx qy qz qw\n1000.500000000 0 0 0 0 0 0 1\n");
}

// Kills poses across a time for which there are none.
TEST(Tum, GapsStayGaps) {
  const Pose still = Pose::Identity();
  std::stringstream text;
  ASSERT_TRUE(write_tum(*Trajectory::make({{0.0, still}, {0.25, still}, {9.0, still}, {9.25, still}}, 0.5), text));
  EXPECT_THAT(text.str(), HasSubstr("\n# steps of more than 0.5 s are gaps\n"));
  const auto trajectory = read_as_tum(text.str());
  ASSERT_TRUE(trajectory) << trajectory.error().message;
  EXPECT_EQ(trajectory->gaps(), 1U);
  EXPECT_TRUE(trajectory->at(9.1));
  EXPECT_FALSE(trajectory->at(5.0));
}

}  // namespace
// Kills a path of one pose that all but one beam lie outside of.
TEST(Tum, OnePoseIsAVehicleThatStandsStill) {
  const auto still = read_as_tum("# standing\n12.5 1 2 3 0 0 0 1\n");
  ASSERT_TRUE(still) << still.error().message;
  ASSERT_EQ(still->poses().size(), 1U);
  EXPECT_EQ(still->poses().front().time_s, 12.5);
  for (const double time_s : {0.0, 12.5, 1e9}) {
    const auto pose = still->at(time_s);
    ASSERT_TRUE(pose) << time_s;
    EXPECT_EQ(pose->translation(), Eigen::Vector3d(1.0, 2.0, 3.0));
  }
}

}  // namespace pingvox
