#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <string>
#include <thread>

#include "device/internal/ros2_node.hpp"
#include "pingvox/live/live_mapping.hpp"

/// Topics of ROS 2 on the loopback interface, and runs of LiveMapping by them.
namespace pingvox::test {

/// One that no vehicle has, of this process: tests that run at the same time do not hear each other.
inline int own_domain() {
  constexpr int kFirst = 60, kDomains = 30;
  return kFirst + static_cast<int>(::getpid() % kDomains);
}

inline constexpr double kPatience_s = 10.0;

inline Ros2Network loopback() {
  return {.domain = own_domain(), .interface = "lo"};
}

/// Tests that need Cyclone DDS, and a loopback interface that it can use.
class Ros2 : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto built = check_ros2_is_built(); !built) GTEST_SKIP() << built.error().message;
    node_ = Ros2Node::open(loopback());
    if (!node_) GTEST_SKIP() << node_.error().message;
  }

  const Ros2Node& node() const { return *node_; }

  Ros2Reader reader_of(const std::string& topic, const std::string& type, Ros2Delivery delivery) const {
    Result<Ros2Reader> reader = node().read({topic, type}, delivery);
    EXPECT_TRUE(reader);
    return *reader;
  }

 private:
  Result<Ros2Node> node_ = fail(Error::Code::kIo, "not opened");
};

/// Puts a message together in CDR.
class CdrText {
 public:
  template <class T>
  CdrText& number(T value) {
    while ((bytes_.size() - 4) % sizeof(T) != 0) bytes_.push_back('\0');
    std::array<char, sizeof(T)> raw{};
    std::memcpy(raw.data(), &value, sizeof(T));
    bytes_.append(raw.data(), raw.size());
    return *this;
  }
  CdrText& header(double stamp_s, const std::string& frame) {
    const double whole_s = std::floor(stamp_s);
    number(static_cast<std::int32_t>(whole_s)).number(static_cast<std::uint32_t>((stamp_s - whole_s) * 1e9));
    number(static_cast<std::uint32_t>(frame.size() + 1));
    bytes_.append(frame.c_str(), frame.size() + 1);
    return *this;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_ = std::string("\0\1\0\0", 4);
};

inline constexpr int kEchoesOfTurn = 100;
inline const std::string kEchoType = "ping360_sonar_msgs/msg/SonarEcho";

/// Of a wall 5 m around the head.
inline std::string echo(double stamp_s, int step) {
  constexpr std::uint32_t kSamples = 100;
  CdrText message;
  const double angle_rad = 2.0 * std::numbers::pi * (step % kEchoesOfTurn) / kEchoesOfTurn;
  message.header(stamp_s, "sonar").number(static_cast<float>(angle_rad)).number(std::uint8_t{1});
  message.number(static_cast<std::uint16_t>(kSamples)).number(std::uint16_t{750}).number(std::uint16_t{1500});
  message.number(std::uint8_t{10}).number(kSamples);
  for (std::uint32_t i = 0; i < kSamples; ++i) message.number(static_cast<std::uint8_t>(i / 5 == 10 ? 220 : 7));
  return message.bytes();
}

inline double now_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// Calls publish(i) and steps the run, until is_done() or a minute has passed.
template <class Publish, class Done>
void run_until(LiveMapping& live, Publish publish, Done is_done) {
  const double end_s = now_s() + 60.0;
  for (int i = 0; !is_done() && now_s() < end_s; ++i) {
    publish(i);
    // No node publishes tens of thousands of poses in a second, which are refused.
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    live.wait(0.01);
    ASSERT_TRUE(live.step());
  }
  EXPECT_TRUE(is_done());
}

/// A run whose poses are those of a topic.
inline LiveOptions run_by(const std::string& address) {
  return {.head = {.kind = LiveHead::Kind::kRos2, .address = "/scan_echo"},
          .nav = {{.kind = LiveNav::Kind::kRos2, .address = address}},
          .ros2 = loopback()};
}

}  // namespace pingvox::test
