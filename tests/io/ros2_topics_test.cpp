#include "io/internal/ros2_topics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/internal/ros2_messages.hpp"
#include "pingvox/geometry/pose.hpp"
#include "support/logs.hpp"
#include "support/ros_messages.hpp"

namespace pingvox {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double kPi = std::numbers::pi;
const std::string kTfType = "tf2_msgs/msg/TFMessage";

std::string as_text(const bags::Bytes& bytes) {
  return {bytes.begin(), bytes.end()};
}

/// Transforms of tf that come one after the other, and the poses that are told.
class TfStream {
 public:
  explicit TfStream(const std::optional<TfFrames>& frames = std::nullopt)
      : read_(read_ros2_tf("/tf", kTfType, frames)) {}

  void add_static(const std::vector<bags::Transform>& all) {
    EXPECT_TRUE(read_.still(as_text(bags::transforms(0.0, all)), kStart_s));
  }
  void add(double time_s, const std::vector<bags::Transform>& all) { add(time_s, time_s, all); }
  void add(double time_s, double arrival_s, const std::vector<bags::Transform>& all) {
    take(read_.moving(as_text(bags::transforms(kStart_s + time_s, all)), kStart_s + arrival_s));
  }
  void add_damaged(double time_s) { take(read_.moving("\xff", kStart_s + time_s)); }

  /// "/tf:map:base_link"; empty: none came.
  const std::string& name() const { return name_; }
  const std::vector<NavSample>& positions() const { return positions_; }
  const std::vector<NavSample>& attitudes() const { return attitudes_; }
  /// Of the last message; kNone of one that was read.
  const std::string& problem() const { return problem_; }
  Error::Code code() const { return code_; }

  static constexpr double kStart_s = 1.7e9;

 private:
  void take(const Result<std::vector<NavSource>>& sources) {
    problem_ = sources ? "" : sources.error().message;
    if (!sources) code_ = sources.error().code;
    if (!sources) return;
    for (const NavSource& source : *sources) {
      name_ = source.name;
      const bool is_position = source.quantity == NavQuantity::kPosition;
      std::vector<NavSample>& all = is_position ? positions_ : attitudes_;
      all.insert(all.end(), source.samples.begin(), source.samples.end());
    }
  }

  ReadRos2Tf read_;
  std::string name_, problem_;
  Error::Code code_ = Error::Code::kIo;
  std::vector<NavSample> positions_, attitudes_;
};

TEST(Ros2Tf, IsReadByItsTypeAndName) {
  EXPECT_TRUE(is_ros2_tf("/tf", kTfType));
  EXPECT_TRUE(is_ros2_tf("/rov/tf", kTfType));
  EXPECT_FALSE(is_ros2_tf("/tf_static", kTfType));
  EXPECT_FALSE(is_ros2_tf("/tf", "nav_msgs/msg/Odometry"));
}

TEST(Ros2Tf, TheVehicleIsToldInTheFrameAtTheRoot) {
  TfStream tf;
  tf.add_static({{"base_link", "sonar", bags::pose_numbers(0.3, 0, 0, 0)},
                 {"base", "base_link", bags::pose_numbers(0, 1, 0, 0)}});
  for (int i = 0; i <= 100; ++i) {
    const double time_s = 0.1 * i;
    tf.add(time_s, {{"map", "odom", bags::pose_numbers(10, 0, 0, kPi / 2)}});
    tf.add(time_s + 0.05, {{"odom", "base", bags::pose_numbers(time_s + 0.05, 0, -5, 0)}});
  }
  EXPECT_EQ(tf.name(), "/tf:map:base_link");
  EXPECT_EQ(tf.problem(), "");
  ASSERT_GT(tf.positions().size(), 190U) << "at the times of both";
  ASSERT_EQ(tf.positions().size(), tf.attitudes().size());
  double last_s = 0.0;
  for (std::size_t i = 0; i < tf.positions().size(); ++i) {
    const NavSample& position = tf.positions()[i];
    const double time_s = position.time_s - TfStream::kStart_s;
    EXPECT_GT(time_s, last_s) << "each once, in order";
    last_s = time_s;
    EXPECT_TRUE(position.value.isApprox(Eigen::Vector3d(9, time_s, -5), 1e-6)) << position.value.transpose();
    EXPECT_NEAR(tf.attitudes()[i].value.z(), kPi / 2, 1e-9);
  }
  EXPECT_GT(last_s, 9.8);
}

// tf2 does not extrapolate: a node that has ended must not leave the vehicle standing where it was.
TEST(Ros2Tf, NoPoseIsToldWithoutEachOfItsTransforms) {
  TfStream tf;
  for (int i = 0; i <= 200; ++i) {
    const double time_s = 0.1 * i;
    tf.add(time_s, {{"map", "odom", bags::pose_numbers(0.1 * i, 0, 0, 0)}});
    if (time_s <= 5.0) tf.add(time_s + 0.01, {{"odom", "base_link", bags::pose_numbers(1, 0, -5, 0)}});
  }
  ASSERT_FALSE(tf.positions().empty());
  EXPECT_NEAR(tf.positions().back().time_s, TfStream::kStart_s + 5.01, 1e-6);
  EXPECT_EQ(tf.code(), Error::Code::kUnsupported);
  EXPECT_EQ(tf.problem(), "tf has had no base_link in odom for 5 s");
}

// A gap of one transform is one of the pose, however often the others come.
TEST(Ros2Tf, AGapIsNotBridged) {
  TfStream tf;
  for (int i = 0; i <= 100; ++i) {
    const double time_s = 0.1 * i;
    tf.add(time_s, {{"map", "odom", bags::pose_numbers(0, 0, 0, 0)}});
    if (time_s <= 4.0 || time_s >= 6.0) tf.add(time_s, {{"odom", "base_link", bags::pose_numbers(time_s, 0, 0, 0)}});
  }
  for (const NavSample& position : tf.positions()) {
    const double time_s = position.time_s - TfStream::kStart_s;
    EXPECT_TRUE(time_s < 4.05 || time_s > 5.95) << time_s;
  }
  EXPECT_GT(tf.positions().size(), 70U);
}

TEST(Ros2Tf, NamedFramesAreTaken) {
  TfStream tf(TfFrames{"/odom", "camera"});
  tf.add_static({{"base_link", "camera", bags::pose_numbers(2, 0, 0, 0)}});
  for (int i = 0; i <= 40; ++i) {
    tf.add(0.1 * i, {{"map", "odom", bags::pose_numbers(10, 0, 0, 0)},
                     {"odom", "base_link", bags::pose_numbers(1, 0, 0, kPi / 2)}});
  }
  EXPECT_EQ(tf.name(), "/tf:odom:camera");
  ASSERT_FALSE(tf.positions().empty());
  EXPECT_TRUE(tf.positions().front().value.isApprox(Eigen::Vector3d(1, 2, 0), 1e-9));
}

TEST(Ros2Tf, WhatCannotBeToldHasAReason) {
  const auto problem_of = [](TfStream tf, const std::vector<bags::Transform>& all) {
    for (int i = 0; i <= 30; ++i) tf.add(0.1 * i, all);
    EXPECT_THAT(tf.positions(), IsEmpty());
    return tf.problem();
  };
  const std::vector<double> pose = bags::pose_numbers(0, 0, 0, 0);
  EXPECT_EQ(problem_of(TfStream(), {{"map", "odom", pose}, {"base_footprint", "base_link", pose}}),
            "tf does not join base_link to map");
  EXPECT_EQ(problem_of(TfStream(), {{"world", "uuv", pose}}),
            "tf has no vehicle (base_link) in a fixed frame (map, odom, world): if it is one of world:uuv, name it");
  EXPECT_EQ(problem_of(TfStream(), {{"map", "base_link", pose}, {"odom", "base_link", pose}}),
            "tf has several vehicles, or one in several frames: name one of map:base_link, odom:base_link");
  EXPECT_EQ(problem_of(TfStream(), {{"a/odom", "a/base_link", pose}, {"b/odom", "b/base_link", pose}}),
            "tf has several vehicles, or one in several frames: name one of a/odom:a/base_link, b/odom:b/base_link");
  EXPECT_EQ(problem_of(TfStream(TfFrames{"map", "base_link"}), {{"odom", "base_link", pose}}),
            "tf does not join base_link to map");
  EXPECT_THAT(problem_of(TfStream(), {{"odom", "base_link_frd", pose}}), HasSubstr("one of the two names is wrong"));
  TfStream still(TfFrames{"map", "base_link"});
  still.add_static({{"map", "base_link", pose}});
  EXPECT_EQ(problem_of(std::move(still), {{"base_link", "wheel", pose}}),
            "all transforms of tf from map to base_link are static");
}

// Named, one of two parents is taken though the other one comes more often.
TEST(Ros2Tf, ANamedParentIsTakenOfTwo) {
  TfStream tf(TfFrames{"map", "base_link"});
  for (int i = 0; i <= 40; ++i) {
    tf.add(0.1 * i, {{"odom", "base_link", bags::pose_numbers(1, 0, 0, 0)}});
    tf.add(0.1 * i + 0.05, {{"odom", "base_link", bags::pose_numbers(1, 0, 0, 0)},
                            {"map", "base_link", bags::pose_numbers(2, 0, 0, 0)}});
  }
  ASSERT_FALSE(tf.positions().empty());
  for (const NavSample& position : tf.positions()) EXPECT_NEAR(position.value.x(), 2.0, 1e-9);
}

TEST(Ros2Tf, WhatIsMissingAtTheStartMayCome) {
  TfStream tf;
  const std::vector<double> pose = bags::pose_numbers(1, 2, 3, 0);
  for (int i = 0; i <= 60; ++i) {
    tf.add(0.1 * i, {{"map", "odom", pose}, {"base_footprint", "base_link", pose}});
    if (i == 30) {
      EXPECT_EQ(tf.problem(), "tf does not join base_link to map");
    }
    if (i > 30) tf.add(0.1 * i, {{"odom", "base_footprint", pose}});
  }
  EXPECT_EQ(tf.problem(), "");
  EXPECT_EQ(tf.name(), "/tf:map:base_link");
  tf.add_damaged(6.1);
  EXPECT_EQ(tf.code(), Error::Code::kCorrupt);
}

// Far beyond what is kept.
TEST(Ros2Tf, EachPoseOfALongTimeIsToldOnce) {
  TfStream tf;
  for (int i = 0; i <= 2000; ++i) {
    tf.add(0.1 * i, {{"map", "base_link", bags::pose_numbers(0.01 * i, 0, 0, 0)}});
  }
  EXPECT_GT(tf.positions().size(), 1990U);
  EXPECT_LE(tf.positions().size(), 2001U);
}

TEST(Ros2Topics, ContradictingFramesAreRefused) {
  const Result<ReadRos2Nav> read = read_ros2_nav("/odom", "nav_msgs/msg/Odometry");
  ASSERT_TRUE(read);
  const std::vector<double> pose = bags::pose_numbers(1, 2, 3, 0);
  EXPECT_THAT(*(*read)(as_text(bags::odometry(1000.0, "odom", "base_link", pose)), 1000.0), SizeIs(3));
  const auto refused = (*read)(as_text(bags::odometry(1000.0, "odom", "base_link_frd", pose)), 1000.0);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("one of the two names is wrong"));
  const auto damaged = (*read)("\xff", 1000.0);
  ASSERT_FALSE(damaged);
  EXPECT_EQ(damaged.error().code, Error::Code::kCorrupt);
}

/// Why a message of a topic is refused; empty: it is not.
std::string refusal_of(const std::string& type, const bags::Bytes& message) {
  const Result<ReadRos2Nav> read = read_ros2_nav("/odom", type);
  EXPECT_TRUE(read);
  const auto sources = (*read)(as_text(message), 1000.0);
  return sources ? "" : sources.error().message;
}

// They would be mapped, and the vehicle would not move.
TEST(Ros2Topics, PosesInAFrameThatMovesWithTheVehicleAreRefused) {
  const std::vector<double> pose = bags::pose_numbers(1, 2, 3, 0);
  const std::string posed = "geometry_msgs/msg/PoseStamped", odometry = "nav_msgs/msg/Odometry";
  EXPECT_EQ(refusal_of(posed, bags::pose_stamped(1000.0, "base_link", pose)), "base_link moves with the vehicle");
  EXPECT_EQ(refusal_of(posed, bags::pose_stamped(1000.0, "map", pose)), "");
  EXPECT_EQ(refusal_of(odometry, bags::odometry(1000.0, "base_link", "odom", pose)),
            "base_link moves with the vehicle and odom does not: it is the inverse of a pose of the vehicle");
  EXPECT_EQ(refusal_of(odometry, bags::odometry(1000.0, "odom", "base_link", pose)), "");
  EXPECT_EQ(
      refusal_of("geometry_msgs/msg/TwistStamped", bags::twist_stamped(1000.0, "odom", std::vector<double>(6, 0.1))),
      "in the axes of odom, not of the vehicle");
}

TEST(Ros2Topics, AnAttitudeThatIsNoneSaysWhy) {
  const Result<ReadRos2Nav> read = read_ros2_nav("/odom", "nav_msgs/msg/Odometry");
  ASSERT_TRUE(read);
  const auto fault_of = [&](const std::vector<double>& pose) {
    const auto sources = (*read)(as_text(bags::odometry(1000.0, "odom", "base_link", pose)), 1000.0);
    EXPECT_TRUE(sources);
    EXPECT_THAT(*sources, SizeIs(3));
    for (const NavSource& source : *sources) {
      if (source.quantity != NavQuantity::kAttitude) continue;
      EXPECT_EQ(source.samples.empty(), !source.fault.empty());
      return source.fault;
    }
    return std::string("no attitude");
  };
  EXPECT_EQ(fault_of({1, 2, 3, 0, 0, 0, 2}), "the quaternion has the length 2, not 1");
  EXPECT_EQ(fault_of({1, 2, 3, 0, 0, 0, 1.02}), "the quaternion has the length 1.02, not 1");
  EXPECT_EQ(fault_of({1, 2, 3, std::nan(""), 0, 0, 1}), "the quaternion has a number that is not finite");
  EXPECT_EQ(fault_of({1, 2, 3, 0, 0, 0, 1}), "") << "of this message, not of one before";
}

TEST(Ros2Topics, AScanOfATurnSaysThatItIsNoBeam) {
  bags::Cdr message;
  message.header(1000.0, "sonar");
  for (const float number : {0.0F, 6.2F, 0.0157F, 0.0F, 4.0F, 0.75F, 8.0F}) message.number(number);
  constexpr std::uint32_t kDirections = 400;
  for (int array = 0; array < 2; ++array) {
    message.number(kDirections);
    for (std::uint32_t i = 0; i < kDirections; ++i) message.number(3.0F);
  }
  std::vector<Ros2Arrival> arrivals = {{1000.0, as_text(message.bytes())}};
  const auto beams = read_ros2_beams("/scan", "sensor_msgs/msg/LaserScan", [&]() -> std::optional<Ros2Arrival> {
    if (arrivals.empty()) return std::nullopt;
    Ros2Arrival next = std::move(arrivals.back());
    arrivals.pop_back();
    return next;
  });
  ASSERT_TRUE(beams);
  const auto beam = (*beams)->next();
  ASSERT_FALSE(beam);
  EXPECT_EQ(beam.error().code, Error::Code::kUnsupported);
  EXPECT_THAT(beam.error().message, HasSubstr("a message holds 400 directions"));
}

/// 16 bytes that count up.
DdsGuid guid_from(std::uint8_t first) {
  DdsGuid guid{};
  for (std::uint8_t& byte : guid) byte = first++;
  return guid;
}

// As another maker's DDS received it.
TEST(Ros2Graph, TheLayoutIsThatOfTheDistribution) {
  const Ros2ParticipantInfo info{
      .participant = guid_from(0), .node = "pingvox", .readers = {}, .writers = {guid_from(0x80)}};
  const auto hex = [&](Ros2GidSize size) { return ros2_participant_info(info, size); };
  const auto expected = [](std::string_view text) { return as_text(from_hex(text)); };
  EXPECT_EQ(hex(Ros2GidSize::k16),
            expected("00010000 000102030405060708090a0b0c0d0e0f 01000000 02000000 2f000000 08000000 70696e67766f7800 "
                     "00000000 01000000 808182838485868788898a8b8c8d8e8f"));
  EXPECT_EQ(hex(Ros2GidSize::k24),
            expected("00010000 000102030405060708090a0b0c0d0e0f 0000000000000000 01000000 02000000 2f000000 08000000 "
                     "70696e67766f7800 00000000 01000000 808182838485868788898a8b8c8d8e8f 0000000000000000"));
}

}  // namespace
}  // namespace pingvox
