// `pingvox live`, and other commands, where their output cannot be written, their terminal is closed, or their
// recording is taken away.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdint>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "call.hpp"
#include "json_reader.hpp"
#include "live_head.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;

std::uintmax_t bytes_in(const Workplace& here, const std::string& name) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(here.path(name), error);
  return error ? 0 : size;
}

/// Waits until a recording has so many bytes more than now.
bool waits_for_more(const Workplace& here, const std::string& recording, std::uintmax_t more) {
  const std::uintmax_t before = bytes_in(here, recording);
  return wait_until([&] { return bytes_in(here, recording) >= before + more; });
}

// A status line on a full disk, or in a terminal that is gone, ended the dive within a second.
TEST(LiveOutput, AStatusThatCannotBeWrittenEndsNothing) {
  const Head head({}, "40");
  const Workplace here;
  const Outcome outcome =
      here.call(live(head.address(), {"--beams", "80", "--progress", "always"}), {.err_path = "/dev/full"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.out, HasSubstr("80 beams"));
  EXPECT_TRUE(here.has("live.bt"));
}

// Nothing was recorded, and SIGTERM was not heard.
TEST(LiveOutput, AFullPipeForMessagesHoldsNothingUp) {
  const Head head;
  const Workplace here;
  const FullPipe messages(here.path("messages"));
  const pid_t child = here.start(live(head.address(), {"--progress", "always"}), {.err_path = here.path("messages")});
  EXPECT_TRUE(wait_until([&] { return bytes_in(here, "dive.bin") > 40'000; }));
  ::kill(child, SIGTERM);
  EXPECT_EQ(status_in_time(child), 0);
  EXPECT_TRUE(here.has("live.bt"));
}

// The last object was waited for without an end.
TEST(LiveOutput, AFullPipeForTheReportCostsTheReportOnly) {
  const Head head;
  const Workplace here;
  const FullPipe report(here.path("report"));
  const pid_t child =
      here.start(live(head.address(), {"--json"}), {.out_path = here.path("report"), .err_path = here.path("notes")});
  EXPECT_TRUE(wait_until([&] { return bytes_in(here, "dive.bin") > 40'000; }));
  ::kill(child, SIGTERM);
  EXPECT_EQ(status_in_time(child), 1);
  EXPECT_TRUE(here.has("live.bt"));
  EXPECT_THAT(here.read("notes"), HasSubstr("standard output: nobody reads it"));
}

TEST(LiveOutput, AReaderThatIsGoneCostsTheReportOnly) {
  const Head head({}, "40");
  const Workplace here;
  const Outcome outcome = here.call(live(head.address(), {"--beams", "80", "--json"}), {.out_is_broken_pipe = true});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("standard output: Broken pipe"));
  EXPECT_TRUE(here.has("live.bt"));
}

// A map for a pipe that nobody reads was written without an end.
TEST(LiveOutput, AMapIsNotWrittenToAPipe) {
  const Workplace here;
  const FullPipe map(here.path("live.bt"));
  expect_error(here.call({"live", "ping360:udp://127.0.0.1:9", "-o", "live.bt"}), 2, {"-o live.bt", "a pipe"});
}

TEST(Output, ABarThatCannotBeDrawnCostsNoResult) {
  const Workplace here;
  here.simulate_tank();
  const Outcome outcome =
      here.call({"map", "tank.csv", "-o", "map.bt", "--progress", "always"}, {.err_path = "/dev/full"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_TRUE(here.has("map.bt"));
}

// A dropped SSH connection lost the map since it was last written, and left the head turning.
TEST(LiveSignals, AClosedTerminalFinishesRecordingAndMap) {
  const Head head;
  const Workplace here;
  const pid_t child = here.start(live(head.address(), {"--quiet"}));
  EXPECT_TRUE(wait_until([&] { return bytes_in(here, "dive.bin") > 40'000; }));
  ::kill(child, SIGHUP);
  EXPECT_EQ(status_in_time(child), 0);
  EXPECT_TRUE(here.has("live.bt"));
}

TEST(LiveSignals, UnderNohupItGoesOn) {
  const Head head;
  const Workplace here;
  const pid_t child = here.start(live(head.address(), {"--quiet"}), {.ignores_hangup = true});
  EXPECT_TRUE(wait_until([&] { return bytes_in(here, "dive.bin") > 40'000; }));
  ::kill(child, SIGHUP);
  EXPECT_TRUE(waits_for_more(here, "dive.bin", 40'000));
  ::kill(child, SIGTERM);
  EXPECT_EQ(status_in_time(child), 0);
}

/// A dive whose folder of recordings is taken away in its middle.
struct Taken {
  int status = -1;
  std::string notes, last_object;
};

template <class TakeAway>
Taken dive_without_its_folder(const Workplace& here, const TakeAway& take_away, const std::string& expected) {
  const Head head;
  std::filesystem::create_directory(here.path("dives"));
  const pid_t child = here.start({"live", head.address(), "-o", "live.bt", "--record", "dives/dive.bin", "--range", "4",
                                  "--step", "18", "--resolution", "0.1", "--json"},
                                 {.out_path = here.path("report"), .err_path = here.path("notes")});
  EXPECT_TRUE(wait_until([&] { return bytes_in(here, "dives/dive.bin") > 40'000; }));
  take_away();
  EXPECT_TRUE(wait_until([&] { return here.read("notes").find(expected) != std::string::npos; })) << here.read("notes");
  ::kill(child, SIGTERM);
  Taken taken;
  taken.status = status_in_time(child);
  taken.notes = here.read("notes");
  std::istringstream report(here.read("report"));
  for (std::string line; std::getline(report, line);) taken.last_object = line;
  return taken;
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

// The recording was lost, the exit status 0.
TEST(LiveRecording, AFolderThatIsRemovedIsNoticed) {
  const Workplace here;
  const Taken taken = dive_without_its_folder(
      here, [&] { std::filesystem::remove_all(here.path("dives")); }, "dives/dive.bin: was removed");
  EXPECT_EQ(taken.status, 1);
  EXPECT_EQ(count_of(taken.notes, "mapping goes on"), 1U) << taken.notes;
  EXPECT_THAT(taken.last_object, HasSubstr(R"("recording_failed": true)"));
  EXPECT_TRUE(here.has("live.bt"));
}

TEST(LiveRecording, AFolderThatIsMovedIsNoticedAndRecordedTo) {
  const Workplace here;
  const Taken taken = dive_without_its_folder(
      here,
      [&] {
        std::filesystem::rename(here.path("dives"), here.path("moved"));
        EXPECT_TRUE(waits_for_more(here, "moved/dive.bin", 40'000));
      },
      "dives/dive.bin: was moved or replaced");
  EXPECT_EQ(taken.status, 1);
  EXPECT_EQ(count_of(taken.notes, "mapping goes on"), 1U) << taken.notes;
  EXPECT_THAT(taken.last_object, HasSubstr(R"("recording_failed": true)"));
  EXPECT_EQ(here.call({"info", "moved/dive.bin", "--strict"}).status, 0);
}

// Beams that reach out of the map counted twice: as mapped and as not mapped.
TEST(LiveCounts, BeamsAreMappedOrNotMapped) {
  const Head head;
  const Workplace here;
  // The map reaches 1.6 m from its origin.
  const Outcome outcome = here.call({"live", head.address(), "-o", "live.pvx", "--depth", "5", "--resolution", "0.1",
                                     "--range", "8", "--step", "18", "--beams", "50", "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  std::istringstream report(outcome.out);
  std::string last;
  for (std::string line; std::getline(report, line);) last = line;
  auto json = flat_json(last + "\n");
  ASSERT_TRUE(json) << last;
  EXPECT_EQ(std::stoul((*json)["beams"]), 50U);
  EXPECT_EQ(std::stoul((*json)["mapped"]) + std::stoul((*json)["not_mapped"]), 50U) << last;
  EXPECT_EQ((*json)["waiting"], "0");
}

}  // namespace
}  // namespace pingvox::test
