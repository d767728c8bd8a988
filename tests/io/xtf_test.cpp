#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <string>
#include <vector>

#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "support/logs.hpp"

namespace pingvox {
namespace {

using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

enum class Order { kLittle, kBig };

template <class T>
void put(Bytes& bytes, std::size_t at, T value, Order order = Order::kLittle) {
  std::array<std::uint8_t, sizeof(T)> raw{};
  std::memcpy(raw.data(), &value, sizeof(T));
  if (order == Order::kBig) std::reverse(raw.begin(), raw.end());
  std::copy(raw.begin(), raw.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at));
}

Bytes packet(std::uint8_t type, const Bytes& body) {
  Bytes bytes(14);
  bytes[0] = 0xce;
  bytes[1] = 0xfa;
  bytes[2] = type;
  bytes.insert(bytes.end(), body.begin(), body.end());
  put(bytes, 10, static_cast<std::uint32_t>(bytes.size()));
  return bytes;
}

struct Ping {
  double latitude_deg = 45.0, longitude_deg = 7.0;
  float pitch_deg = 0.0F, roll_deg = 0.0F, heading_deg = 0.0F, heave_m = 0.0F;
  float first_rad = 0.0F;              ///< to starboard
  std::vector<std::uint16_t> steps{};  ///< of 0.001 rad, one for each beam
  std::vector<std::uint16_t> times{};  ///< of 0.01 m at 1500 m/s
  float sound_speed_m_s = 1500.0F;
};

Bytes ping_packet(const Ping& ping) {
  Bytes body(256 - 14);
  put(body, 160 - 14, ping.latitude_deg);
  put(body, 168 - 14, ping.longitude_deg);
  put(body, 204 - 14, ping.pitch_deg);
  put(body, 208 - 14, ping.roll_deg);
  put(body, 212 - 14, ping.heading_deg);
  put(body, 216 - 14, ping.heave_m);
  const std::size_t count = ping.times.size();
  Bytes head(12), settings(116), times(8 + 2 * count), angles(36 + 2 * count);
  std::memcpy(head.data(), "BTH0", 4);
  const auto begin = [](Bytes& section, const char* name) {
    std::memcpy(section.data(), name, 2);
    put(section, 2, static_cast<std::uint16_t>(section.size()), Order::kBig);
  };
  begin(settings, "H0");
  put(settings, 44, ping.sound_speed_m_s, Order::kBig);
  put(settings, 114, static_cast<std::uint16_t>(count), Order::kBig);
  begin(times, "R0");
  put(times, 4, 0.01F * 2.0F / 1500.0F, Order::kBig);
  begin(angles, "A2");
  put(angles, 4, ping.first_rad, Order::kBig);
  put(angles, 8, 0.001F, Order::kBig);
  for (std::size_t i = 0; i < count; ++i) {
    put(times, 8 + 2 * i, ping.times[i], Order::kBig);
    put(angles, 36 + 2 * i, ping.steps[i], Order::kBig);
  }
  for (const Bytes& part : {head, settings, times, angles}) body.insert(body.end(), part.begin(), part.end());
  return packet(65, body);
}

Bytes xtf_file(const std::vector<Bytes>& packets) {
  Bytes file(1024);
  file[0] = 123;
  file[164] = 3;  // degrees
  for (const Bytes& one : packets) file.insert(file.end(), one.begin(), one.end());
  return file;
}

const Ping kDown = {.steps = {0}, .times = {1000}};

/// The only point of the only scan, from where the head was.
Eigen::Vector3d point_of(const Ping& ping) {
  const auto all = all_scans({"line.xtf", xtf_file({ping_packet(ping)})});
  EXPECT_EQ(all.error, "");
  if (all.items.size() != 1 || all.items[0].points_m.size() != 1) return Eigen::Vector3d::Constant(NAN);
  return all.items[0].points_m[0] - all.items[0].origin_m;
}

void expect_near(const Eigen::Vector3d& point, const Eigen::Vector3d& expected) {
  EXPECT_LT((point - expected).norm(), 1e-5) << point.transpose() << " is not " << expected.transpose();
}

TEST(Xtf, BeamsPointToStarboardOfStraightDown) {
  expect_near(point_of(kDown), {0.0, 0.0, -10.0});
  Ping ping = kDown;
  ping.first_rad = 0.5F;
  expect_near(point_of(ping), {10.0 * std::sin(0.5), 0.0, -10.0 * std::cos(0.5)});  // heading north: starboard is east
  ping.heading_deg = 90.0F;
  expect_near(point_of(ping), {0.0, -10.0 * std::sin(0.5), -10.0 * std::cos(0.5)});
}

// Otherwise a level bottom would rise and fall with the vessel.
TEST(Xtf, RollAndPitchAreTakenOut) {
  Ping ping = kDown;
  ping.roll_deg = 10.0F;  // starboard down: the beam straight down swings to port
  expect_near(point_of(ping),
              10.0 * Eigen::Vector3d(-std::sin(std::numbers::pi / 18), 0, -std::cos(std::numbers::pi / 18)));
  ping = kDown;
  ping.pitch_deg = 10.0F;  // the bow up: it swings ahead
  expect_near(point_of(ping),
              10.0 * Eigen::Vector3d(0, std::sin(std::numbers::pi / 18), -std::cos(std::numbers::pi / 18)));
}

TEST(Xtf, PlacesAreMetresFromTheFirstPing) {
  Ping next = kDown;
  next.latitude_deg += 0.001;
  next.longitude_deg += 0.001;
  next.heave_m = 0.25F;
  const auto all = all_scans({"line.xtf", xtf_file({ping_packet(kDown), ping_packet(next)})});
  ASSERT_EQ(all.items.size(), 2U);
  EXPECT_EQ(all.items[0].origin_m, Eigen::Vector3d::Zero());
  EXPECT_NEAR(all.items[1].origin_m.x(), 78.85, 0.01) << "a thousandth of a degree at 45 degrees north";
  EXPECT_NEAR(all.items[1].origin_m.y(), 111.13, 0.01);
  EXPECT_NEAR(all.items[1].origin_m.z(), 0.25, 1e-6);
  EXPECT_EQ(all.items[1].number, 1U);
}

TEST(Xtf, ABeamWithoutReturnIsNoPoint) {
  Ping ping = kDown;
  ping.steps = {0, 100, 100};
  ping.times = {1000, 0, 2000};
  const auto all = all_scans({"line.xtf", xtf_file({ping_packet(ping)})});
  ASSERT_EQ(all.items.size(), 1U);
  ASSERT_EQ(all.items[0].points_m.size(), 2U);
  expect_near(all.items[0].points_m[1], {20.0 * std::sin(0.2), 0.0, -20.0 * std::cos(0.2)});
  EXPECT_EQ(all.skipped, 0U);
}

TEST(Xtf, DamageIsToldByItsPlaceAndCostsNoPingBehindIt) {
  const Bytes ping = ping_packet(kDown), attitude = packet(3, Bytes(50));
  const Bytes whole = xtf_file({ping, attitude, ping, attitude, ping});
  EXPECT_EQ(format_of(whole), Format::kXtf);
  EXPECT_EQ(all_scans({"line.xtf", whole}).items.size(), 3U);
  const std::size_t second = 1024 + ping.size() + attitude.size();
  for (const std::size_t size : {0U, 13U, 0x7fffffffU, 100U, 3000U}) {
    Bytes damaged = whole;
    put(damaged, second + 10, static_cast<std::uint32_t>(size));
    const auto all = all_scans({"line.xtf", damaged});
    EXPECT_EQ(all.items.size(), 2U) << "a length of " << size;
    EXPECT_EQ(all.skipped, 1U);
    EXPECT_EQ(all_scans({"line.xtf", damaged}, Damage::kFail).error,
              "line.xtf: byte " + std::to_string(second) + ": no whole packet is here");
  }
  for (std::size_t place = second; place < second + ping.size(); ++place) {
    for (int bit = 0; bit < 8; bit += 3) {
      Bytes damaged = whole;
      damaged[place] = static_cast<std::uint8_t>(damaged[place] ^ (1U << bit));
      const auto all = all_scans({"line.xtf", damaged});
      ASSERT_EQ(all.error, "");
      ASSERT_GE(all.items.size(), 2U) << place;
    }
  }
  for (std::size_t left = 1; left < ping.size(); left += 5) {
    const Bytes cut(whole.begin(), whole.end() - static_cast<std::ptrdiff_t>(left));
    const auto all = all_scans({"line.xtf", cut});
    ASSERT_EQ(all.items.size(), 2U) << left;
    ASSERT_EQ(all.skipped, 1U);
  }
}

// Kills a line that spans half the Earth because its receiver had no fix at first.
TEST(Xtf, APingWithoutAFixIsLeftOut) {
  Ping none = kDown;
  none.latitude_deg = none.longitude_deg = 0.0;
  const Bytes file = xtf_file({ping_packet(none), ping_packet(kDown), ping_packet(kDown)});
  const auto all = all_scans({"line.xtf", file});
  ASSERT_EQ(all.items.size(), 2U);
  EXPECT_EQ(all.items[0].origin_m, Eigen::Vector3d::Zero()) << "the origin is the first place";
  EXPECT_EQ(all.skipped, 1U);
  EXPECT_THAT(all_scans({"line.xtf", file}, Damage::kFail).error, HasSubstr("latitude and longitude are 0"));
}

// Kills a ping that is left out as "impossible", without what is.
TEST(Xtf, ADamagedPingIsNamedWithItsNumber) {
  const auto error_of = [](const Ping& ping) {
    return all_scans({"line.xtf", xtf_file({ping_packet(ping)})}, Damage::kFail).error;
  };
  Ping ping = kDown;
  for (const float wrong_m_s : {0.0F, 4921.0F, 15000.0F}) {
    ping.sound_speed_m_s = wrong_m_s;
    EXPECT_THAT(error_of(ping), HasSubstr("a ping with a sound speed of " + std::to_string(std::lround(wrong_m_s))));
  }
  ping = kDown;
  ping.latitude_deg = 6'010'000.0;
  EXPECT_THAT(error_of(ping), HasSubstr("a ping at 6010000, 7, which is no latitude and longitude"));
}

// Kills a line of 25 m that becomes 0.4 mm long.
TEST(Xtf, DegreesInAFileOfMetresAreRefused) {
  const auto file_of = [](double step, std::uint8_t unit) {
    std::vector<Bytes> packets;
    for (int i = 0; i < 20; ++i) {
      Ping ping = kDown;
      ping.latitude_deg = 54.3 + step * i;
      packets.push_back(ping_packet(ping));
    }
    Bytes file = xtf_file(packets);
    file[164] = unit;
    return file;
  };
  const auto opened = open_scans({"line.xtf", file_of(1e-5, 0)});
  ASSERT_FALSE(opened);
  EXPECT_THAT(opened.error().message,
              HasSubstr("line.xtf: its positions are in metres by its header and stay within "));
  EXPECT_THAT(opened.error().message, HasSubstr("are they in degrees"));
  EXPECT_EQ(all_scans({"line.xtf", file_of(1e-5, 3)}).items.size(), 20U);
  EXPECT_EQ(all_scans({"line.xtf", file_of(0.5, 0)}).items.size(), 20U) << "a line in a local grid";
  EXPECT_EQ(all_scans({"line.xtf", file_of(0.0, 0)}).items.size(), 20U) << "a head that stands still";
}

TEST(Xtf, WithoutAMultibeamIsToldAsSuch) {
  const auto opened = open_scans({"side.xtf", xtf_file({packet(0, Bytes(500)), packet(3, Bytes(50))})});
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, Error::Code::kUnsupported);
  EXPECT_THAT(opened.error().message, HasSubstr("side.xtf: is an XTF file without pings of an R2Sonic"));
  EXPECT_THAT(opened.error().message, HasSubstr("type 0, 3"));
}

TEST(Xtf, ARealLineHasTheBeamsOfItsReadme) {
  auto file = read_file(PINGVOX_SHARED_DATA "/mbes-r2sonic-sfbay/0009_150708_R2Testing_0001.xtf");
  if (!file) GTEST_SKIP() << "mbes-r2sonic-sfbay is missing: skipped";
  const auto all = all_scans(*std::move(file));
  EXPECT_EQ(all.error, "");
  EXPECT_EQ(all.skipped, 0U);
  ASSERT_EQ(all.items.size(), 923U);
  std::vector<double> ranges_m, first_deg;
  for (const PointScan& scan : all.items) {
    ASSERT_EQ(scan.points_m.size(), 256U);
    for (const Eigen::Vector3d& point : scan.points_m) ranges_m.push_back((point - scan.origin_m).norm());
    const Eigen::Vector3d first = (scan.points_m.front() - scan.origin_m).normalized();
    first_deg.push_back(std::acos(-first.z()) * 180.0 / std::numbers::pi);
  }
  std::ranges::sort(ranges_m);
  EXPECT_NEAR(ranges_m.front(), 10.12, 0.01);
  EXPECT_NEAR(ranges_m.back(), 24.24, 0.01);
  EXPECT_NEAR(ranges_m[ranges_m.size() / 2], 14.35, 0.01);
  // The head keeps its sector level while the vessel rolls by some degrees, so the roll taken out has the right sense.
  const auto [least, most] = std::ranges::minmax(first_deg);
  EXPECT_LT(most - least, 0.5);
}

}  // namespace
}  // namespace pingvox
