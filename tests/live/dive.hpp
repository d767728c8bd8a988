#pragma once

#include <gtest/gtest.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "device/internal/link.hpp"
#include "device/internal/nav_emulator.hpp"
#include "device/internal/ping360_emulator.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/live/live_mapping.hpp"

/// A run of LiveMapping against emulated devices.
namespace pingvox::test {

inline constexpr double kWall_m = 2.0;  ///< around the head

inline std::vector<std::uint8_t> hear_wall(int, std::size_t bins, double bin_length_m) {
  std::vector<std::uint8_t> heard(bins, 7);
  const auto wall = static_cast<std::size_t>(kWall_m / bin_length_m);
  for (std::size_t bin = wall; bin < std::min(wall + 10, bins); ++bin) heard[bin] = 220;
  return heard;
}

/// Bytes of the map's file.
inline std::string bytes_of(const OccupancyMap& map) {
  std::ostringstream out;
  const Result<void> written = write_map(map, Format::kPvx, "", out);
  EXPECT_TRUE(written);
  return std::move(out).str();
}

/// The events of one kind.
template <class Event>
std::vector<Event> events_of(const std::vector<LiveEvent>& events) {
  std::vector<Event> found;
  for (const LiveEvent& event : events) {
    if (const auto* const one = std::get_if<Event>(&event)) found.push_back(*one);
  }
  return found;
}

/// A head in the middle of a round room and, where the options name it, an autopilot, in virtual time.
class Dive {
 public:
  /// @param options  the head's address is filled in
  explicit Dive(LiveOptions options = {})
      : line_(Link::listen("udp://127.0.0.1:0")), live_(opened(std::move(options))) {
    if (!live_ || live_->status().nav.empty()) return;
    constexpr std::string_view kMavlink = "mavlink:";
    autopilot_line_ = Link::open(live_->status().nav.front().name.substr(kMavlink.size()));
    EXPECT_TRUE(*autopilot_line_);
  }
  Dive(const Dive&) = delete;
  Dive& operator=(const Dive&) = delete;

  LiveMapping& live() { return *live_; }
  double now_s() const { return now_s_; }

  enum class Power { kOn, kOff };
  void set_head(Power power) { head_power_ = power; }
  /// nullopt: no autopilot.
  void set_autopilot(std::optional<NavEmulator> autopilot) { autopilot_ = std::move(autopilot); }

  /// Runs until there are so many beams.
  void run_until_beams(std::size_t count) {
    run_until([&] { return live_->beams() >= count; });
    EXPECT_GE(live_->beams(), count);
  }
  void run_for(double seconds) {
    run_until([&, end_s = now_s_ + seconds] { return now_s_ >= end_s; });
  }

  /// All that happened so far.
  const std::vector<LiveEvent>& events() const { return events_; }

 private:
  Result<LiveMapping> opened(LiveOptions options) {
    options.head.address = line_->address();
    options.head.ping360 = {.range_m = 4.0, .step_grad = 10, .timeout_s = 1.0};
    options.map.resolution_m = 0.1;
    Result<LiveMapping> live = LiveMapping::open(options, [this] { return now_s_; });
    EXPECT_TRUE(live) << live.error().message;
    return live;
  }

  void run_until(const std::function<bool()>& is_over) {
    constexpr int kMaxTurns = 50'000;
    for (int turn = 0; turn < kMaxTurns && !is_over(); ++turn) {
      const Result<bool> goes_on = live_->step();
      ASSERT_TRUE(goes_on && *goes_on);
      const LiveStatus status = live_->status();
      EXPECT_EQ(status.mapped + status.not_mapped + status.waiting, status.beams);
      for (LiveEvent& event : live_->take_events()) events_.push_back(std::move(event));
      say_pose();
      if (!turn_head()) pass_time();
    }
  }

  void say_pose() {
    if (!autopilot_ || now_s_ < autopilot_->due_s()) return;
    for (const NavEmulator::Message& message : autopilot_->send(now_s_))
      EXPECT_TRUE((*autopilot_line_)->write(message));
  }

  /// Whether anything was said.
  bool turn_head() {
    std::array<std::uint8_t, 65536> bytes = {};
    const Result<std::size_t> got = line_->read(bytes);
    if (head_power_ == Power::kOff) return false;
    head_.take(std::span(bytes).first(got.value_or(0)), now_s_);
    const std::vector<std::uint8_t> sent = head_.send(now_s_);
    EXPECT_TRUE(line_->write(sent));
    return got.value_or(0) > 0 || !sent.empty();
  }

  /// Lines take a moment; what takes longer is asked for again.
  void pass_time() {
    constexpr double kTurn_s = 0.01;
    pollfd file = {line_->descriptor(), POLLIN, 0};
    if (head_power_ == Power::kOff || ::poll(&file, 1, 1) == 0) now_s_ += kTurn_s;
  }

  double now_s_ = 100.0;
  Result<Link> line_;
  Power head_power_ = Power::kOn;
  Ping360Emulator head_{{.pings_per_s = 50.0}, hear_wall};
  std::optional<NavEmulator> autopilot_;
  std::optional<Result<Link>> autopilot_line_;
  Result<LiveMapping> live_;
  std::vector<LiveEvent> events_;
};

}  // namespace pingvox::test
