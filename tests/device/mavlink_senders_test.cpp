// Who is followed where several send MAVLink to one port.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "device/internal/link.hpp"
#include "device/internal/mavlink_receiver.hpp"
#include "io/internal/mavlink.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/nav.hpp"
#include "tests/device/recording.hpp"

namespace pingvox {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using Bytes = std::vector<std::uint8_t>;

/// LOCAL_POSITION_NED.
Bytes position(std::uint8_t system, std::uint32_t boot_ms, float north_m) {
  Bytes payload;
  const auto put = [&](std::uint32_t word) {
    for (unsigned shift = 0; shift < 32; shift += 8)
      payload.push_back(static_cast<std::uint8_t>((word >> shift) & 0xffU));
  };
  put(boot_ms);
  put(std::bit_cast<std::uint32_t>(north_m));
  for (int i = 0; i < 5; ++i) put(std::bit_cast<std::uint32_t>(1.0F));
  return make_mavlink_frame(32, payload, {0, system, 1});
}

/// GPS_INPUT, as an extension of the companion computer sends it.
Bytes gps_input(std::uint8_t system) {
  Bytes payload(63, 1);
  return make_mavlink_frame(232, payload, {0, system, 0});
}

Bytes heartbeat(std::uint8_t system) {
  return make_mavlink_frame(0, Bytes(9, 1), {0, system, 190});
}

/// The port of a host, in virtual time.
class Port {
 public:
  Port() {
    Result<TlogRecorder> recorder = TlogRecorder::create(folder_.path("dive.tlog"));
    EXPECT_TRUE(recorder);
    Result<MavlinkReceiver> receiver = MavlinkReceiver::listen("udp://127.0.0.1:0", *std::move(recorder), 1e9);
    EXPECT_TRUE(receiver);
    receiver_ = *std::move(receiver);
  }

  /// One more who sends to it.
  Link sender() const {
    Result<Link> link = Link::open(receiver_->address());
    EXPECT_TRUE(link);
    return *std::move(link);
  }
  /// A frame is sent and read. @return names of the sources that told something
  std::vector<std::string> take(Link& from, const Bytes& frame, double now_s) {
    EXPECT_TRUE(from.write(frame));
    pollfd file = {receiver_->descriptor(), POLLIN, 0};
    EXPECT_EQ(::poll(&file, 1, 60'000), 1);
    const auto reports = receiver_->read(now_s);
    EXPECT_TRUE(reports);
    std::vector<std::string> names;
    for (const auto& report : *reports) names.push_back(report.source);
    return names;
  }
  const MavlinkReceiver::Status& status() const { return receiver_->status(); }
  std::size_t recorded() const {
    const Result<FileBytes> file = read_file(folder_.path("dive.tlog"));
    const auto nav = read_nav(*file);
    return nav ? nav->records : 0;
  }

 private:
  test::Folder folder_;
  std::optional<MavlinkReceiver> receiver_;
};

// A second vehicle with the same system was mixed in without a word: walls 100 m apart.
TEST(MavlinkSenders, TheFirstVehicleIsFollowedAndOthersAreNamed) {
  Port port;
  Link first = port.sender(), second = port.sender();
  EXPECT_THAT(port.take(first, position(1, 1000, 1.0F), 0.0), ElementsAre("LOCAL_POSITION_NED"));
  for (int i = 1; i <= 20; ++i) {
    const double now_s = i;
    EXPECT_THAT(port.take(second, position(1, 5000, 100.0F), now_s), IsEmpty());
    EXPECT_THAT(port.take(first, position(2, 5000, 100.0F), now_s), IsEmpty()) << "another system by the same router";
    EXPECT_THAT(port.take(first, position(1, 1000, 1.0F), now_s), ElementsAre("LOCAL_POSITION_NED"));
  }
  EXPECT_EQ(port.status().frames, 21U);
  EXPECT_EQ(port.status().ignored, 40U);
  EXPECT_EQ(port.status().vehicles, 1U);
  EXPECT_THAT(port.status().vehicle, HasSubstr("(system 1)"));
  EXPECT_THAT(port.status().others, ElementsAre(HasSubstr("(system 1)"), HasSubstr("(system 2)")));
  EXPECT_EQ(port.recorded(), 21U);
}

// Kills a ground station that is followed because its heartbeat came first, and extensions that are not heard.
TEST(MavlinkSenders, AGroundStationIsNoVehicleButMayComeWithOne) {
  Port port;
  Link router = port.sender(), station = port.sender();
  EXPECT_THAT(port.take(station, heartbeat(255), 0.0), IsEmpty());
  EXPECT_THAT(port.take(station, gps_input(255), 0.1), IsEmpty());
  EXPECT_EQ(port.status().vehicle, "");
  EXPECT_THAT(port.take(router, position(3, 1000, 1.0F), 0.2), SizeIs(1));
  EXPECT_THAT(port.take(router, gps_input(255), 0.3), ElementsAre("GPS_INPUT 255/0"));
  EXPECT_THAT(port.take(station, gps_input(255), 0.4), IsEmpty());
  EXPECT_THAT(port.status().others, IsEmpty());
}

// Kills a dive without poses after the autopilot was switched off and on.
TEST(MavlinkSenders, AVehicleThatIsBackAtAnotherPortIsFollowedAgain) {
  Port port;
  Link before = port.sender(), beside = port.sender(), after = port.sender();
  EXPECT_THAT(port.take(before, position(1, 1000, 1.0F), 0.0), SizeIs(1));
  EXPECT_THAT(port.take(beside, position(1, 1000, 50.0F), 1.0), IsEmpty());
  EXPECT_THAT(port.take(before, position(1, 3000, 1.0F), 2.0), SizeIs(1));
  EXPECT_THAT(port.take(after, position(1, 100, 1.0F), 4.0), IsEmpty()) << "the first one may only be delayed";
  EXPECT_THAT(port.take(beside, position(1, 1000, 50.0F), 8.0), IsEmpty()) << "it was heard beside the first one";
  EXPECT_THAT(port.take(after, position(1, 4100, 1.0F), 8.0), SizeIs(1));
  EXPECT_EQ(port.status().vehicles, 2U);
  EXPECT_THAT(port.take(before, position(1, 3000, 1.0F), 8.1), IsEmpty());
}

// Kills lists that grow with made-up senders.
TEST(MavlinkSenders, ManyMadeUpOnesAreCounted) {
  Port port;
  Link vehicle = port.sender(), stranger = port.sender();
  EXPECT_THAT(port.take(vehicle, position(1, 1000, 1.0F), 0.0), SizeIs(1));
  for (int system = 2; system < 250; ++system) {
    EXPECT_THAT(port.take(stranger, position(static_cast<std::uint8_t>(system), 1000, 1.0F), 0.1), IsEmpty());
  }
  EXPECT_THAT(port.status().others, SizeIs(16));
  EXPECT_EQ(port.status().ignored, 248U);
}

// "mavlink:udp://127.0.0.1:14550" is not to be reached from elsewhere.
TEST(MavlinkSenders, AnAddressIsTheOnlyOneThatIsListenedAt) {
  Result<MavlinkReceiver> own = MavlinkReceiver::listen("udp://127.0.0.1:0", std::nullopt, 0.0);
  ASSERT_TRUE(own);
  EXPECT_THAT(own->address(), HasSubstr("udp://127.0.0.1:"));
  Result<Link> other = Link::open("udp://127.0.0.2" + own->address().substr(own->address().rfind(':')));
  ASSERT_TRUE(other);
  EXPECT_TRUE(other->write(position(1, 1000, 1.0F)));
  pollfd file = {own->descriptor(), POLLIN, 0};
  EXPECT_EQ(::poll(&file, 1, 100), 0);
}

}  // namespace
}  // namespace pingvox
