// Logs as sonars write them: streams whose head the program knows.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "call.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;

std::string u16(std::size_t value) {
  return {static_cast<char>(value & 255), static_cast<char>(value >> 8)};
}

/// What a SeaNet head of type 0x11 says of a round wall 2 m away: 200 lines of 160 bins of 2.5 cm.
std::string serial_capture() {
  std::string capture;
  for (std::size_t line = 0; line < 200; ++line) {
    std::string samples;
    for (std::size_t bin = 0; bin < 160; ++bin) samples += static_cast<char>(bin >= 80 && bin < 84 ? 200 : 10);
    const std::string block = std::string("\x11\x10\0", 3) + u16(0x2307) + u16(40) + std::string(4, '\0') + "T" +
                              std::string(6, '\0') + u16(52) + u16(0) + u16(6399) + "\x20" + u16(line * 32) +
                              u16(samples.size()) + samples;
    const std::size_t length = block.size() + 10;
    constexpr const char* kDigits = "0123456789ABCDEF";
    capture += '@';
    for (int shift = 12; shift >= 0; shift -= 4) capture += kDigits[(length >> shift) & 15];
    capture += u16(length) + std::string("\x02\xff\0\x02\x80\x02", 6) + u16(block.size() + 2) + block + '\n';
  }
  return capture;
}

TEST(DeviceLogs, InfoTellsTheHeadAndWhereDamageIs) {
  const Workplace here;
  const std::string whole = serial_capture(), cut = whole.substr(30, whole.size() - 40);
  const Outcome told = here.call({"info", "-", "--json"}, {.in = cut});
  EXPECT_EQ(told.status, 0) << told.err;
  EXPECT_THAT(told.out, HasSubstr(R"("format": "seanet", "beams": 198)"));
  EXPECT_THAT(told.out, HasSubstr(R"("device": {"name": "micron", "beam_width_deg": 3, "beam_height_deg": 35)"));
  EXPECT_THAT(told.out, HasSubstr(R"("what": "bytes between frames", "count": 1, "first_byte": 0)"));
  EXPECT_THAT(told.out, HasSubstr(R"("what": "cut off at the end", "count": 1)"));
  const Outcome strict = here.call({"info", "-", "--strict"}, {.in = cut});
  EXPECT_EQ(strict.status, 1);
  EXPECT_THAT(strict.err, HasSubstr("standard input: byte 0: bytes between frames"));
}

// Kills "0, all complete".
TEST(DeviceLogs, ALogWithoutABeamHasNoSweeps) {
  const Workplace here;
  const Outcome told = here.call({"info", "-"}, {.in = "SON,00:00:00.500,2,16\nSON,00:00:00.600,2,16\n"});
  EXPECT_EQ(told.status, 0) << told.err;
  EXPECT_THAT(told.out, HasSubstr("sweeps      0\n"));
  EXPECT_THAT(told.out, HasSubstr("2 damaged records"));
}

TEST(DeviceLogs, ABeamIsAsWideAndHighAsThatOfTheHead) {
  const Workplace here;
  here.write("log", serial_capture());
  const auto map_of = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"map", "log", "-o", "out.ot", "--beam", "cone", "--quiet"});
    const Outcome mapped = here.call(words);
    EXPECT_EQ(mapped.status, 0) << mapped.err;
    return here.read("out.ot");
  };
  const std::string usual = map_of({});
  EXPECT_EQ(map_of({"--device", "micron"}), usual);
  const std::string other = map_of({"--device", "ping360"});
  EXPECT_NE(other, usual);
  EXPECT_EQ(map_of({"--beam-width", "2", "--beam-height", "25"}), other);
  EXPECT_EQ(map_of({"--device", "seaking-325", "--beam-width", "2", "--beam-height", "25"}), other)
      << "what the call says counts";
}

TEST(DeviceLogs, AreConvertedToTheSameBeams) {
  const Workplace here;
  here.write("log", serial_capture());
  const Outcome converted = here.call({"convert", "log", "-o", "log.csv"});
  ASSERT_EQ(converted.status, 0);
  EXPECT_THAT(converted.out, ::testing::HasSubstr("CSV names no sonar: map it with --device micron"));
  ASSERT_EQ(here.call({"map", "log", "-o", "a.ot", "--quiet"}).status, 0);
  ASSERT_EQ(here.call({"map", "log.csv", "-o", "b.ot", "--quiet"}).status, 0);
  EXPECT_EQ(here.read("a.ot"), here.read("b.ot"));
}

}  // namespace
}  // namespace pingvox::test
