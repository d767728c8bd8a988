// Navigation in bags by the fields that a user names.

#include "pingvox/io/nav_fields.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/io/bag.hpp"
#include "pingvox/nav/nav_trajectory.hpp"
#include "support/bag_writer.hpp"

namespace pingvox {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::SizeIs;

constexpr std::string_view kHeader = "Header header\n";
constexpr std::string_view kStamps = "===\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";

/// A message of ROS 1 with a header whose stamp is 1000.5 s.
template <class... Numbers>
bags::Bytes message(Numbers... numbers) {
  bags::Bytes bytes;
  bags::put(bytes, std::uint32_t{7});
  bags::put(bytes, std::uint32_t{1000});
  bags::put(bytes, std::uint32_t{500'000'000});
  bags::put_text(bytes, "hull");
  (bags::put(bytes, numbers), ...);
  return bytes;
}

/// The contents of a bag of messages of an unknown type, 0.25 s apart from 1000.25 s.
Result<BagContents> contents(std::string_view definition, const std::vector<bags::Bytes>& messages,
                             const std::vector<NavFields>& fields) {
  bags::Ros1 bag;
  bag.topic(1, "/unknown", "lab_msgs/Thing", std::string(kHeader) + std::string(definition) + std::string(kStamps));
  for (std::uint32_t i = 0; i < messages.size(); ++i) bag.message(1, 1000, (i + 1) * 250'000'000, messages[i]);
  bag.end_chunk();
  return read_bag(ByteStream(FileBytes{"dive.bag", bag.file()}), Damage::kSkip, fields);
}

std::vector<NavSample> samples(std::string_view definition, const std::vector<bags::Bytes>& messages,
                               const NavFields& fields) {
  const auto bag = contents(definition, messages, {fields});
  EXPECT_TRUE(bag) << bag.error().message;
  if (!bag || bag->nav.log.sources().size() != 1) return {};
  EXPECT_EQ(bag->topics[0].use, BagTopicSummary::Use::kNavigation);
  EXPECT_EQ(bag->nav.log.sources()[0].name, "/unknown");
  EXPECT_EQ(bag->nav.log.sources()[0].quantity, fields.quantity);
  return bag->nav.log.sources()[0].samples;
}

NavFields fields_of(NavQuantity quantity, std::vector<std::string> values) {
  NavFields fields;
  fields.topic = "/unknown";
  fields.quantity = quantity;
  fields.values = std::move(values);
  fields.stated_in = "lab.toml: line 3";
  return fields;
}

TEST(NavFields, TurnsAForwardRightDownVelocityAndItsUnit) {
  NavFields fields = fields_of(NavQuantity::kVelocity, {"v[0]", "v[1]", "v[2]"});
  fields.frame = NavFields::Frame::kNed;
  fields.unit = 0.001;
  fields.spread = {"covariance[0]", "covariance[4]", "covariance[8]"};
  fields.spread_is = NavFields::Spread::kVariance;
  const auto read = samples("int16[] v\nfloat32[9] covariance\n",
                            {message(std::uint32_t{3}, std::int16_t{500}, std::int16_t{-20}, std::int16_t{30}, 4.0F,
                                     1.0F, 1.0F, 1.0F, 9.0F, 1.0F, 1.0F, 1.0F, 0.0F)},
                            fields);
  ASSERT_THAT(read, SizeIs(1));
  EXPECT_TRUE(read[0].value.isApprox(Eigen::Vector3d(0.5, 0.02, -0.03), 1e-12));
  EXPECT_NEAR(read[0].deviation.x(), 0.002, 1e-12) << "the root of a variance";
  EXPECT_NEAR(read[0].deviation.y(), 0.003, 1e-12);
  EXPECT_TRUE(std::isnan(read[0].deviation.z())) << "0 is what drivers send that do not know";
  EXPECT_EQ(read[0].time_s, 1000.5);
  EXPECT_TRUE(read[0].valid);
}

TEST(NavFields, KnowsWhatTheDeviceMarksAsInvalid) {
  const std::vector<bags::Bytes> messages = {message(1.0F, std::int8_t{-1}), message(1.1F, std::int8_t{0}),
                                             message(1.2F, std::int8_t{2})};
  const auto valid = [&](const std::string& condition) {
    NavFields fields = fields_of(NavQuantity::kDepth, {"down"});
    fields.valid = condition;
    std::string marks;
    for (const NavSample& sample : samples("float32 down\nint8 status\n", messages, fields)) {
      marks += sample.valid ? 'v' : '-';
    }
    return marks;
  };
  EXPECT_EQ(valid(""), "vvv");
  EXPECT_EQ(valid("status"), "v-v");
  EXPECT_EQ(valid("status >= 0"), "-vv");
  EXPECT_EQ(valid("status>0"), "--v");
  EXPECT_EQ(valid("status == 0"), "-v-");
  EXPECT_EQ(valid("status != 0"), "v-v");
  EXPECT_EQ(valid("status <= 0"), "vv-");
  EXPECT_EQ(valid("status < -0.5"), "v--");
  NavFields fields = fields_of(NavQuantity::kDepth, {"down"});
  fields.valid = "status = 0";
  const auto wrong = contents("float32 down\nint8 status\n", messages, {fields});
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().message, HasSubstr("valid: 'status = 0' must be a field"));
}

TEST(NavFields, ReadsAttitudesInEitherFrameAndForm) {
  // 30 degrees nose up and 10 to starboard, towards south-east.
  const Eigen::Matrix3d ned =
      pose_from_rpy(Eigen::Vector3d::Zero(), 10.0 * kDegree_rad, 30.0 * kDegree_rad, 135.0 * kDegree_rad).rotation();
  const Eigen::Quaterniond q(ned);
  NavFields angles = fields_of(NavQuantity::kAttitude, {"roll", "pitch", "yaw"});
  angles.frame = NavFields::Frame::kNed;
  angles.unit = kDegree_rad;
  NavFields quaternion = fields_of(NavQuantity::kAttitude, {"q.x", "q.y", "q.z", "q.w"});
  quaternion.frame = NavFields::Frame::kNed;
  const Eigen::Vector3d expected(10.0 * kDegree_rad, -30.0 * kDegree_rad, -45.0 * kDegree_rad);
  const auto by_angles = samples("float64 roll\nfloat64 pitch\nfloat64 yaw\n", {message(10.0, 30.0, 135.0)}, angles);
  ASSERT_THAT(by_angles, SizeIs(1));
  EXPECT_TRUE(by_angles[0].value.isApprox(expected, 1e-12)) << by_angles[0].value.transpose();
  const std::string definition = "lab_msgs/Q q\n";
  bags::Ros1 bag;
  bag.topic(1, "/unknown", "lab_msgs/Thing",
            std::string(kHeader) + definition + "===\nMSG: lab_msgs/Q\nfloat64 w\nfloat64 x\nfloat64 y\nfloat64 z\n" +
                std::string(kStamps));
  bag.message(1, 1000, 0, message(q.w(), q.x(), q.y(), q.z()));
  bag.message(1, 1001, 0, message(0.0, 0.0, 0.0, 0.0));  // it does not know
  bag.end_chunk();
  const auto read = read_bag(ByteStream(FileBytes{"dive.bag", bag.file()}), Damage::kSkip, std::vector{quaternion});
  ASSERT_TRUE(read);
  ASSERT_THAT(read->nav.log.sources(), SizeIs(1));
  const auto& by_quaternion = read->nav.log.sources()[0].samples;
  ASSERT_THAT(by_quaternion, SizeIs(1));
  EXPECT_TRUE(by_quaternion[0].value.isApprox(expected, 1e-9)) << by_quaternion[0].value.transpose();
}

// Kills a frame that is named and not turned, and one that is turned against what the mapping says.
TEST(NavFields, FollowsTheNameOfTheFrameWhereNothingElseIsSaid) {
  const auto velocity = [](std::string_view frame, NavFields::Frame said) {
    bags::Ros1 bag;
    bag.topic(1, "/unknown", "lab_msgs/Thing",
              std::string(kHeader) + "float64 x\nfloat64 y\nfloat64 z\n" + std::string(kStamps));
    bags::Bytes bytes;
    for (const std::uint32_t number : {7U, 1000U, 0U}) bags::put(bytes, number);
    bags::put_text(bytes, frame);
    for (const double number : {1.0, 2.0, 3.0}) bags::put(bytes, number);
    bag.message(1, 1000, 0, bytes);
    bag.end_chunk();
    NavFields fields = fields_of(NavQuantity::kVelocity, {"x", "y", "z"});
    fields.frame = said;
    const auto read = read_bag(ByteStream(FileBytes{"dive.bag", bag.file()}), Damage::kSkip, std::vector{fields});
    EXPECT_TRUE(read);
    return read ? read->nav.log.sources().at(0).samples.at(0).value : Eigen::Vector3d(0, 0, 0);
  };
  using Frame = NavFields::Frame;
  const Eigen::Vector3d as_is(1, 2, 3), turned(1, -2, -3);
  EXPECT_EQ(velocity("dvl", Frame::kByName), as_is);
  EXPECT_EQ(velocity("dvl_frd", Frame::kByName), turned);
  EXPECT_EQ(velocity("ned", Frame::kByName), turned);
  EXPECT_EQ(velocity("dvl_frd", Frame::kEnu), as_is);
  EXPECT_EQ(velocity("dvl_flu", Frame::kNed), turned);
}

TEST(NavFields, TurnsWhatIsInTheWorld) {
  NavFields heading = fields_of(NavQuantity::kHeading, {"a"});
  heading.frame = NavFields::Frame::kNed;
  heading.unit = kDegree_rad;
  const std::string abc = "float64 a\nfloat64 b\nfloat64 c\n";
  const auto compass = samples(abc, {message(90.0, 0.0, 0.0)}, heading);
  ASSERT_THAT(compass, SizeIs(1));
  EXPECT_NEAR(compass[0].value.x(), 0.0, 1e-12) << "east";

  NavFields position = fields_of(NavQuantity::kPosition, {"a", "b"});
  position.frame = NavFields::Frame::kNed;
  position.spread = {"b", "c"};
  const auto place = samples(abc, {message(10.0, 2.0, 3.0)}, position);
  ASSERT_THAT(place, SizeIs(1));
  EXPECT_EQ(place[0].value.head<2>(), Eigen::Vector2d(2.0, 10.0));
  EXPECT_EQ(place[0].value.z(), 0.0);
  EXPECT_EQ(place[0].deviation.x(), 3.0) << "of east, the second";
  EXPECT_EQ(place[0].deviation.y(), 2.0);
  EXPECT_TRUE(std::isnan(place[0].deviation.z())) << "it was not told";

  NavFields fix = fields_of(NavQuantity::kFix, {"lat", "lon", "height"});
  fix.unit = kDegree_rad * 1e-7;
  const auto fixed = samples("int32 lat\nint32 lon\nfloat32 height\n",
                             {message(std::int32_t{421'234'567}, std::int32_t{-31'234'567}, 12.5F)}, fix);
  ASSERT_THAT(fixed, SizeIs(1));
  EXPECT_TRUE(
      fixed[0].value.isApprox(Eigen::Vector3d(42.1234567 * kDegree_rad, -3.1234567 * kDegree_rad, 12.5), 1e-12));

  const auto depth = samples(abc, {message(0.0, 0.0, -7.5)}, fields_of(NavQuantity::kDepth, {"-c"}));
  ASSERT_THAT(depth, SizeIs(1));
  EXPECT_EQ(depth[0].value.x(), 7.5) << "of a z that points up";
}

TEST(NavFields, TakesTheTimeThatIsNamed) {
  const auto time_of = [](const std::string& time, double unit_s = 1.0) {
    NavFields fields = fields_of(NavQuantity::kDepth, {"down"});
    fields.time = time;
    fields.time_unit_s = unit_s;
    bags::Bytes bytes = message(4.0F, std::uint64_t{1'234'567'891}, std::uint32_t{900}, std::uint32_t{250'000'000});
    const auto read = samples("float32 down\nuint64 since_start_us\ntime true_at\n", {std::move(bytes)}, fields);
    return read.size() == 1 ? read[0].time_s : 0.0;
  };
  EXPECT_EQ(time_of(""), 1000.5) << "the stamp, near the recording";
  EXPECT_EQ(time_of("received"), 1000.25);
  EXPECT_EQ(time_of("true_at"), 900.25) << "however far from the recording";
  EXPECT_NEAR(time_of("since_start_us", 1e-6), 1234.567891, 1e-9);
}

TEST(NavFields, NamesWhatDoesNotFitAndWhatThereIs) {
  const auto error = [](const NavFields& fields) {
    const auto bag = contents("float64 x\nfloat64[3] v\nstring name\n", {[] {
                                bags::Bytes bytes = message(1.0, 2.0, 3.0, 4.0);
                                bags::put_text(bytes, "depth");
                                return bytes;
                              }()},
                              {fields});
    return bag ? std::string("none") : bag.error().message;
  };
  const auto depth_error = [&](const std::string& field) { return error(fields_of(NavQuantity::kDepth, {field})); };
  EXPECT_EQ(depth_error("x"), "none");
  EXPECT_EQ(depth_error("y"),
            "dive.bag: /unknown (lab_msgs/Thing): lab.toml: line 3: fields: there is no field 'y', but x float64, "
            "v float64[3]");
  EXPECT_THAT(depth_error("name"), HasSubstr("'name' is text: numbers are x float64"));
  EXPECT_THAT(depth_error("v"), HasSubstr("'v' is float64[3]: say which, as in v[0]"));
  EXPECT_THAT(depth_error("v[3]"), HasSubstr("'v' is float64[3]: 3 is too much"));
  EXPECT_THAT(depth_error("x[0]"), HasSubstr("'x' is one float64, not an array"));
  EXPECT_THAT(depth_error("v[x]"), HasSubstr("must be as in x[0]"));
  NavFields fields = fields_of(NavQuantity::kDepth, {"x"});
  for (std::string NavFields::* member : {&NavFields::valid, &NavFields::time}) {
    NavFields wrong = fields;
    wrong.*member = "nothing";
    EXPECT_THAT(error(wrong), HasSubstr("there is no field 'nothing'"));
  }
  fields.spread = {"sd"};
  EXPECT_THAT(error(fields), HasSubstr("sd: there is no field 'sd'"));
}

TEST(NavFields, NamesTheTopicsThatThereAre) {
  NavFields fields = fields_of(NavQuantity::kDepth, {"x"});
  const auto bag = contents("float64 x\n", {message(1.0)}, {fields});
  ASSERT_TRUE(bag);
  EXPECT_TRUE(check_topics(std::vector{fields}, bag->topics));
  fields.topic = "";
  fields.type = "lab_msgs/msg/Thing";
  EXPECT_TRUE(check_topics(std::vector{fields}, bag->topics)) << "as ROS 2 writes it";
  fields.topic = "/depth";
  const auto missing = check_topics(std::vector{fields}, bag->topics);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().message,
            "lab.toml: line 3: there is no topic '/depth' of type 'lab_msgs/msg/Thing', but /unknown (lab_msgs/Thing)");
}

TEST(NavFields, InfoHasTheFieldsOfTopicsThatAreNotRead) {
  const std::string definition =
      "float64 x\nfloat32[3] v\nlab_msgs/Beam[] beams\nstring name\n===\n"
      "MSG: lab_msgs/Beam\nuint8 id\nfloat32[2] d\n";
  const auto unread = contents(definition, {}, {});
  ASSERT_TRUE(unread);
  ASSERT_THAT(unread->topics, SizeIs(1));
  EXPECT_EQ(unread->topics[0].use, BagTopicSummary::Use::kNone);
  EXPECT_EQ(unread->topics[0].fields, "x float64, v float32[3], beams.id uint8[], beams.d float32[][2]");
  const auto read = contents(definition, {}, {fields_of(NavQuantity::kDepth, {"x"})});
  ASSERT_TRUE(read);
  EXPECT_EQ(read->topics[0].fields, "");
}

TEST(NavFields, RefusesWhatDoesNotFitTheQuantity) {
  const NavFields good = fields_of(NavQuantity::kVelocity, {"x", "y", "z"});
  EXPECT_TRUE(good.validate());
  const auto refused = [](NavFields fields, const char* why) {
    const auto valid = fields.validate();
    ASSERT_FALSE(valid) << why;
    EXPECT_THAT(valid.error().message, HasSubstr(why));
  };
  NavFields fields = good;
  fields.values.emplace_back("w");
  refused(fields, "velocity must be of 2 or 3 fields, not of 4");
  refused(fields_of(NavQuantity::kAttitude, {"qw", "qx", "qy", "qz"}), "in the order x, y, z, w: 'qw' is the first");
  refused(fields_of(NavQuantity::kAttitude, {"yaw", "pitch", "roll"}), "roll, pitch, yaw: 'yaw' is the first");
  EXPECT_TRUE(fields_of(NavQuantity::kAttitude, {"qx", "qy", "qz", "qw"}).validate());
  EXPECT_TRUE(fields_of(NavQuantity::kAttitude, {"roll", "pitch", "yaw"}).validate());
  fields = good;
  fields.topic.clear();
  refused(fields, "topic");
  fields = good;
  fields.spread = {"a", "b"};
  refused(fields, "1 or 3 fields");
  fields = good;
  fields.quantity = NavQuantity::kFix;
  fields.spread = {"a"};
  refused(fields, "fix");
  fields = good;
  fields.unit = 0.0;
  refused(fields, "unit");
  fields = good;
  fields.time_unit_s = NAN;
  refused(fields, "time");
}

TEST(NavFields, ReplaceTheReadingByTheType) {
  bags::Mcap mcap;
  mcap.topic(1, "/pose", "geometry_msgs/msg/PoseStamped", "");
  bags::Bytes pose = {0, 1, 0, 0};
  bags::put(pose, std::uint32_t{1000});
  bags::put(pose, std::uint32_t{0});
  bags::put_text(pose, std::string_view("m\0\0\0", 4));
  for (const double number : {5.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0}) bags::put(pose, number);
  mcap.message(1, 1'000'000'000'000U, pose);
  mcap.end_chunk();
  const auto by_type = read_bag(ByteStream(FileBytes{"dive.mcap", mcap.closed()}));
  ASSERT_TRUE(by_type);
  EXPECT_THAT(by_type->nav.log.sources(), SizeIs(2));
  NavFields depth = fields_of(NavQuantity::kDepth, {"-pose.position.z"});
  depth.topic = "/pose";
  const auto by_fields = read_bag(ByteStream(FileBytes{"dive.mcap", mcap.closed()}), Damage::kSkip, std::vector{depth});
  ASSERT_TRUE(by_fields);
  ASSERT_THAT(by_fields->nav.log.sources(), SizeIs(1));
  EXPECT_EQ(by_fields->nav.log.sources()[0].samples[0].value.x(), -3.0);
}

std::uint64_t bits(double number) {
  return std::bit_cast<std::uint64_t>(number);
}

bool same_samples(const NavSource& a, const NavSource& b) {
  const auto same = [](const NavSample& x, const NavSample& y) {
    return bits(x.time_s) == bits(y.time_s) && bits(x.value.x()) == bits(y.value.x()) &&
           bits(x.value.y()) == bits(y.value.y()) && bits(x.value.z()) == bits(y.value.z()) && x.valid == y.valid;
  };
  return a.quantity == b.quantity && std::ranges::equal(a.samples, b.samples, same);
}

// Topics that we know, read by their fields: the same samples to the last bit.
TEST(NavFieldsRecordings, EqualTheReadersOfKnownTypes) {
  const std::string path = PINGVOX_SHARED_DATA "/solaqua-ping360-dvl/sintef_dataset_ros2_bag_fixed.db3";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no recording";
  const auto known = read_bag(*ByteStream::open(path));
  ASSERT_TRUE(known);
  const auto of = [](std::string topic, NavQuantity quantity, std::vector<std::string> values) {
    NavFields fields;
    fields.topic = std::move(topic);
    fields.quantity = quantity;
    fields.values = std::move(values);
    return fields;
  };
  // It looks ahead: x left, y up, z ahead.
  NavFields velocity = of("/sensor/dvl_velocity", NavQuantity::kVelocity, {"velocity.z", "velocity.x", "velocity.y"});
  velocity.valid = "velocity_valid";
  NavFields attitude = of("", NavQuantity::kAttitude, {"roll", "pitch", "yaw"});
  NavFields turn_rate = of("", NavQuantity::kTurnRate, {"rollspeed", "pitchspeed", "yawspeed"});
  for (NavFields* fields : {&attitude, &turn_rate}) {
    fields->type = "messages/Attitude";
    fields->frame = NavFields::Frame::kNed;
  }
  NavFields pressure = of("/sensor/depth_temperature", NavQuantity::kPressure, {"pressure"});
  pressure.unit = 1e2;
  NavFields usbl = of("/sensor/usbl", NavQuantity::kPosition, {"east", "north", "-depth"});
  usbl.spread = {"sigma"};
  const std::vector<NavFields> all = {velocity,
                                      attitude,
                                      turn_rate,
                                      pressure,
                                      of("/sensor/depth_temperature", NavQuantity::kDepth, {"depth"}),
                                      of("/sensor/depth_temperature", NavQuantity::kTemperature, {"temperature"}),
                                      usbl};
  const auto read = read_bag(*ByteStream::open(path), Damage::kSkip, all);
  ASSERT_TRUE(read) << read.error().message;
  std::size_t compared = 0;
  for (const NavSource& source : read->nav.log.sources()) {
    if (source.name == "/sensor/usbl") {
      EXPECT_THAT(source.samples, SizeIs(48)) << "nothing else reads them";
      continue;
    }
    for (const NavSource& same : known->nav.log.sources()) {
      if (same.name != source.name || same.quantity != source.quantity) continue;
      EXPECT_TRUE(same_samples(source, same)) << source.name << ' ' << name_of(source.quantity);
      compared += source.samples.size();
    }
  }
  // Velocity, three of the depth sensor, two of the attitude; position and attitude of the DVL by their type.
  EXPECT_EQ(compared, 834U + 3 * 1412U + 2 * 1498U + 2 * 427U);
}

// The lake's bag has its attitude as a Vector3: without it there are fixes and depths, but no poses.
TEST(NavFieldsRecordings, MakePosesOfABagThatHadNone) {
  const std::string path = PINGVOX_SHARED_DATA "/micron-ratzeburg-bag/RatzeburgerSee-2019-01-22-15-05-01.bag";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no recording";
  EXPECT_FALSE(nav_trajectory(read_bag(*ByteStream::open(path))->nav.log));
  NavFields attitude;
  attitude.topic = "/xsens/imu";
  attitude.quantity = NavQuantity::kAttitude;
  attitude.values = {"x", "y", "z"};
  attitude.unit = kDegree_rad;
  const auto bag = read_bag(*ByteStream::open(path), Damage::kSkip, std::vector{attitude});
  ASSERT_TRUE(bag) << bag.error().message;
  const auto made = nav_trajectory(bag->nav.log);
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_EQ(made->attitude, "/xsens/imu");
  EXPECT_EQ(bag->nav.log.best(NavQuantity::kAttitude)->samples.size(), 1352U);
}

}  // namespace
}  // namespace pingvox
