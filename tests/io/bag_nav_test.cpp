#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "pingvox/io/file.hpp"
#include "pingvox/io/nav.hpp"
#include "support/bag_writer.hpp"
#include "support/logs.hpp"

namespace pingvox {
namespace {

using testing::SizeIs;

/// The samples of a quantity in a message of ROS 2 alone in a bag.
std::vector<NavSample> samples_of(std::string_view type, std::string_view hex, NavQuantity quantity,
                                  std::string_view topic = "/topic", std::string_view definition = "") {
  bags::Mcap mcap;
  mcap.topic(1, topic, type, definition);
  mcap.message(1, 1'000'600'000'000U, from_hex(hex));
  mcap.end_chunk();
  const auto nav = read_nav(FileBytes{"dive.mcap", mcap.closed()});
  EXPECT_TRUE(nav);
  if (!nav) return {};
  EXPECT_TRUE(nav->damage.empty());
  EXPECT_EQ(nav->log.clock(), NavClock::kUnix);
  for (const NavSource& source : nav->log.sources()) {
    if (source.quantity == quantity && source.name == topic) return source.samples;
  }
  return {};
}

TEST(BagNav, ReadsWhatAnotherWriterMade) {
  const auto pressure =
      samples_of("sensor_msgs/msg/FluidPressure",
                 "00010000e80300000065cd1d0200000073000000000000002003fe400000000000000000", NavQuantity::kPressure);
  ASSERT_THAT(pressure, SizeIs(1));
  EXPECT_EQ(pressure[0].value.x(), 122'930.0);
  EXPECT_EQ(pressure[0].time_s, 1000.5);
  const auto velocity = samples_of(
      "geometry_msgs/msg/TwistStamped",
      "00010000e80300000065cd1d0400000064766c00 000000000000e03f 000000000000d0bf 0000000000000000 0000000000000000 "
      "0000000000000000 000000000000c03f",
      NavQuantity::kVelocity);
  ASSERT_THAT(velocity, SizeIs(1));
  EXPECT_EQ(velocity[0].value, Eigen::Vector3d(0.5, -0.25, 0.0)) << "already in our frame";
}

TEST(BagNav, TellsUnitsOfPressureByTheirSize) {
  const auto pascals = [](double value) {
    bags::Bytes message = {0, 1, 0, 0};
    bags::put(message, value);
    std::string hex;
    for (const std::uint8_t byte : message) hex += fmt::format("{:02x}", byte);
    const auto samples = samples_of("std_msgs/msg/Float64", hex, NavQuantity::kPressure, "/bar30/pressure");
    return samples.empty() ? 0.0 : samples[0].value.x();
  };
  EXPECT_NEAR(pascals(1.5), 150'000.0, 1e-6);
  EXPECT_NEAR(pascals(101.3), 101'300.0, 1e-6);
  EXPECT_NEAR(pascals(1020.0), 102'000.0, 1e-6);
  EXPECT_NEAR(pascals(150'000.0), 150'000.0, 1e-6);
}

/// The values of one quantity in messages of a topic, one after the other.
std::vector<Eigen::Vector3d> values_of(std::string_view topic, std::string_view type, std::string_view definition,
                                       const std::vector<std::vector<double>>& messages, NavQuantity quantity) {
  bags::Mcap mcap;
  mcap.topic(1, topic, type, definition);
  for (std::size_t i = 0; i < messages.size(); ++i) {
    bags::Bytes message = {0, 1, 0, 0};
    for (const double number : messages[i]) bags::put(message, number);
    mcap.message(1, 1'000'000'000'000U + i * 1'000'000'000U, message);
  }
  mcap.end_chunk();
  const auto nav = read_nav(FileBytes{"dive.mcap", mcap.closed()});
  EXPECT_TRUE(nav);
  std::vector<Eigen::Vector3d> values;
  if (!nav) return values;
  for (const NavSource& source : nav->log.sources()) {
    if (source.quantity != quantity) continue;
    for (const NavSample& sample : source.samples) values.push_back(sample.value);
  }
  return values;
}

// A log in kPa, from the surface to 60 m: kills a unit that changes at 500 kPa, and one of a sensor that starts with 0.
TEST(BagNav, ATopicHasOneUnitOfPressure) {
  const auto values = values_of("/bar30/pressure", "std_msgs/msg/Float64", "",
                                {{0.0}, {101.3}, {499.0}, {501.0}, {700.0}}, NavQuantity::kPressure);
  ASSERT_THAT(values, SizeIs(5));
  EXPECT_NEAR(values[1].x(), 101'300.0, 1e-6);
  EXPECT_NEAR(values[2].x(), 499'000.0, 1e-6);
  EXPECT_NEAR(values[3].x(), 501'000.0, 1e-6);
  EXPECT_NEAR(values[4].x(), 700'000.0, 1e-6);
}

// 604 kPa at the beginning were read as 604 hPa, which is above the surface, and a gauge's Pa as hPa.
TEST(BagNav, ThePressuresOfFluidsAreAbsolutePascals) {
  const auto pressures = [](double first_pa, double zero_pa, double unit_pa) {
    std::vector<std::vector<double>> messages;
    for (int i = 0; i < 100; ++i) messages.push_back({(first_pa + 500.0 * i - zero_pa) / unit_pa});
    return values_of("/pressure", "lab_msgs/msg/FluidPressure", "float64 fluid_pressure\n", messages,
                     NavQuantity::kPressure);
  };
  const std::vector<std::tuple<double, double, double>> drivers = {
      {603'916.0, 0.0, 1.0}, {603'916.0, 0.0, 1e3}, {106'351.0, 101'325.0, 1.0}, {106'351.0, 0.0, 1e2}};
  for (const auto& [first_pa, zero_pa, unit_pa] : drivers) {
    const auto values = pressures(first_pa, zero_pa, unit_pa);
    ASSERT_THAT(values, SizeIs(100));
    EXPECT_NEAR(values[0].x(), first_pa, 1e-6) << unit_pa;
    EXPECT_NEAR(values[99].x(), first_pa + 49'500.0, 1e-6) << unit_pa;
  }
}

// Kills fixes that are lost, or jump to height 0, where the receiver knows no altitude.
TEST(BagNav, AFixWithoutAltitudeKeepsTheLastOne) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const auto values =
      values_of("/gps", "lab_msgs/msg/NavSatFix",
                "float64 latitude\nfloat64 longitude\nfloat64 altitude\n"
                "Status status\n================\nMSG: lab_msgs/Status\nfloat64 status\n",
                {{60.0, 10.0, kNone, 0.0}, {60.0, 10.0, 41.5, 0.0}, {60.0, 10.0, kNone, 0.0}}, NavQuantity::kFix);
  ASSERT_THAT(values, SizeIs(3));
  EXPECT_EQ(values[0].z(), 0.0);
  EXPECT_EQ(values[1].z(), 41.5);
  EXPECT_EQ(values[2].z(), 41.5);
}

/// A message of tf in CDR, as it grows.
class Transforms {
 public:
  explicit Transforms(std::uint32_t count) { number(count); }

  void add(std::string_view parent, std::string_view child, const std::vector<double>& place_and_rotation) {
    number(std::int32_t{1000});
    number(std::uint32_t{500'000'000});
    text(parent);
    text(child);
    for (const double each : place_and_rotation) number(each);
  }
  const bags::Bytes& bytes() const { return bytes_; }

 private:
  template <class T>
  void number(T value) {
    while ((bytes_.size() - 4) % sizeof(T) != 0) bytes_.push_back(0);
    bags::put(bytes_, value);
  }
  void text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size() + 1));
    bytes_.insert(bytes_.end(), value.begin(), value.end());
    bytes_.push_back(0);
  }

  bags::Bytes bytes_ = {0, 1, 0, 0};
};

/// A bag with one message of tf, in which the vehicle is the last of three.
bags::Mcap bag_of_transforms(std::string_view topic) {
  Transforms transforms(3);
  transforms.add("base_link", "sonar", {0.1, 0, -0.4, 1, 0, 0, 0});
  transforms.add("map", "odom", {7, 7, 7, 0, 0, 0, 1});
  transforms.add("rov/odom", "rov/base_link", {1, 2, -3, 0, 0, std::sqrt(0.5), std::sqrt(0.5)});
  bags::Mcap mcap;
  mcap.topic(1, topic, "tf2_msgs/msg/TFMessage", "");
  mcap.message(1, 1'000'600'000'000U, transforms.bytes());
  return mcap;
}

std::vector<NavSource> sources_in(bags::Mcap mcap) {
  mcap.end_chunk();
  const auto nav = read_nav(FileBytes{"dive.mcap", mcap.closed()});
  EXPECT_TRUE(nav);
  return nav ? std::vector(nav->log.sources().begin(), nav->log.sources().end()) : std::vector<NavSource>{};
}

// Kills a reader that takes the first transform of a message only, or a sensor for the vehicle.
TEST(BagNav, TheVehicleIsWhatMovesInAFixedFrameOfTf) {
  const auto sources = sources_in(bag_of_transforms("/tf"));
  ASSERT_THAT(sources, SizeIs(2));
  for (const NavSource& source : sources) {
    EXPECT_EQ(source.name, "/tf:rov/odom:rov/base_link");
    ASSERT_THAT(source.samples, SizeIs(1));
    EXPECT_EQ(source.samples[0].time_s, 1000.5);
    if (source.quantity == NavQuantity::kPosition) {
      EXPECT_EQ(source.samples[0].value, Eigen::Vector3d(1, 2, -3));
    } else {
      EXPECT_EQ(source.quantity, NavQuantity::kAttitude);
      EXPECT_NEAR((source.samples[0].value - Eigen::Vector3d(0, 0, std::acos(0.0))).norm(), 0.0, 1e-12);
    }
  }
  EXPECT_THAT(sources_in(bag_of_transforms("/tf_static")), SizeIs(0)) << "what does not move";
}

// Kills a path of tf, which may be filtered or in another frame, instead of the one that was measured.
TEST(BagNav, TfIsUsedWhereNoOtherTopicHasAPosition) {
  bags::Mcap mcap = bag_of_transforms("/tf");
  mcap.topic(2, "/fix", "lab_msgs/msg/NavSatFix",
             "float64 latitude\nfloat64 longitude\nfloat64 altitude\n"
             "Status status\n================\nMSG: lab_msgs/Status\nfloat64 status\n");
  bags::Bytes fix = {0, 1, 0, 0};
  for (const double number : {60.0, 10.0, 0.0, 0.0}) bags::put(fix, number);
  mcap.message(2, 1'000'700'000'000U, fix);
  const auto sources = sources_in(std::move(mcap));
  ASSERT_THAT(sources, SizeIs(1));
  EXPECT_EQ(sources[0].name, "/fix");
}

TEST(BagNav, TurnsADvlThatLooksDown) {
  constexpr std::string_view kDefinition =
      "geometry_msgs/Vector3 velocity\nfloat64 fom\nfloat64 altitude\nbool velocity_valid\n";
  const std::string hex =
      "00010000 000000000000f03f 0000000000000040 0000000000000840 0000000000000000 0000000000001040 01";
  const auto down = samples_of("waterlinked_a50_ros_driver/msg/DVL", hex, NavQuantity::kVelocity, "/dvl", kDefinition);
  ASSERT_THAT(down, SizeIs(1));
  EXPECT_EQ(down[0].value, Eigen::Vector3d(1, -2, -3));
  const auto ahead = samples_of("sensors/msg/DVLVelocity", hex, NavQuantity::kVelocity, "/dvl", kDefinition);
  ASSERT_THAT(ahead, SizeIs(1));
  EXPECT_EQ(ahead[0].value, Eigen::Vector3d(3, 1, 2)) << "of SOLAQUA: x left, y up, z ahead";
}

}  // namespace
}  // namespace pingvox
