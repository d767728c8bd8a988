#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "device/internal/link.hpp"
#include "device/internal/live_source.hpp"

/// A source of live beams and the emulator of its head, at the two ends of a real line.
namespace pingvox::test {

/// Lets them talk, in virtual time, until `beams` has this many beams.
template <class Emulator>
void run(LiveSource& source, Link& line, Emulator& head, double& now_s, std::vector<Beam>& beams, std::size_t count) {
  std::array<std::uint8_t, 65536> bytes;
  for (int i = 0; i < 50'000 && beams.size() < count; ++i) {
    ASSERT_TRUE(source.step(now_s, beams));
    const Result<std::size_t> got = line.read(bytes);
    ASSERT_TRUE(got);
    head.take(std::span(bytes).first(*got), now_s);
    const std::vector<std::uint8_t> sent = head.send(now_s);
    ASSERT_TRUE(line.write(sent));
    if (*got > 0 || !sent.empty()) continue;
    // Terminals take a moment; what takes longer is asked for again.
    constexpr int kPatience_ms = 1;
    std::array<pollfd, 2> ends = {pollfd{line.descriptor(), POLLIN, 0}, pollfd{source.descriptor(), POLLIN, 0}};
    if (::poll(ends.data(), ends.size(), kPatience_ms) > 0) continue;
    now_s = std::max(now_s + 1e-3, std::min(head.due_s(), source.due_s()));
  }
}

/// A head that is switched off and on a hundred times: each time another one, at another socket of the same address.
/// @param line  that the source opens, by UDP
/// @param make_head  returns the next head
template <class MakeHead>
void expect_found_again(LiveSource& source, Result<Link>& line, MakeHead make_head, double& now_s,
                        std::vector<Beam>& beams) {
  const std::string address = line->address();
  for (std::size_t round = 1; round <= 100; ++round) {
    auto head = make_head();
    run(source, *line, head, now_s, beams, 3 * round);
    ASSERT_EQ(beams.size(), 3 * round);
    EXPECT_EQ(source.status().connections, round);
    line = Link::listen("udp://127.0.0.1:0");  // the head is gone
    ASSERT_TRUE(line);
    for (int i = 0; i < 100 && source.status().is_connected; ++i) ASSERT_TRUE(source.step(now_s += 0.5, beams));
    EXPECT_FALSE(source.status().is_connected);
    EXPECT_THAT(source.status().problem, testing::HasSubstr(address));
    line = Link::listen(address);
    ASSERT_TRUE(line) << line.error().message;
  }
}

}  // namespace pingvox::test
