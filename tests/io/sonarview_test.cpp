#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <span>
#include <string>
#include <vector>

#include "io/internal/ping_frame.hpp"
#include "pingvox/io/format.hpp"
#include "support/frames.hpp"
#include "support/logs.hpp"

namespace pingvox {
namespace {

using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

void put_u16(Bytes& bytes, std::size_t value) {
  bytes.push_back(static_cast<std::uint8_t>(value));
  bytes.push_back(static_cast<std::uint8_t>(value >> 8));
}

Bytes frame_of(std::size_t id, const Bytes& payload) {
  Bytes frame = {'B', 'R'};
  put_u16(frame, payload.size());
  put_u16(frame, id);
  frame.insert(frame.end(), {2, 0});
  frame.insert(frame.end(), payload.begin(), payload.end());
  std::size_t sum = 0;
  for (const std::uint8_t byte : frame) sum += byte;
  put_u16(frame, sum);
  return frame;
}

Bytes ping(std::size_t angle, const Bytes& samples) {
  Bytes payload = {1, 0};
  for (const std::size_t value :
       {angle, std::size_t{11}, std::size_t{88}, std::size_t{750}, samples.size(), samples.size()}) {
    put_u16(payload, value);
  }
  payload.insert(payload.end(), samples.begin(), samples.end());
  return frame_of(2300, payload);
}

/// JSON_WRAPPER of some length.
Bytes session(std::size_t size) {
  std::string text = R"({"timestamp":"2024-03-13T15:50:16.000Z","session_devices":[)";
  text.resize(size, ' ');
  return frame_of(10, bytes_of(text));
}

const Bytes kMavlink = frame_of(150, bytes_of(R"({"header":{},"message":{"type":"ATTITUDE"}})"));

TEST(SonarView, PingsBetweenMessagesOfAnyLengthAreRead) {
  const Bytes log = joined({session(65'535), ping(200, {1, 2, 3}), session(10'000), kMavlink, ping(201, {4, 5})});
  EXPECT_EQ(format_of(log), Format::kSonarView);
  const auto source = open_beams({"dive.svlog", log});
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ((*source)->device(), find_device("ping360"));
  const auto beams = read_all(**source);
  ASSERT_TRUE(beams);
  ASSERT_EQ(beams->size(), 2U);
  EXPECT_EQ((*beams)[0].intensities, (Bytes{1, 2, 3}));
  EXPECT_EQ((*beams)[0].bearing_rad, 0.0);
  EXPECT_LT((*beams)[0].time_s, (*beams)[1].time_s);
  EXPECT_EQ((*beams)[1].intensities, (Bytes{4, 5}));
  EXPECT_EQ((*source)->skipped(), 0U);
}

TEST(SonarView, FramesAreFoundHoweverTheStreamIsCutIntoPieces) {
  const Frames frames = {session(5000), ping(3, {7, 8, 9}), kMavlink, ping(4, {'B', 'R', 0xff, 0xff})};
  const Bytes stream = joined(frames);
  for (const std::size_t piece : {1U, 2U, 7U, 64U, 1000U, 5009U, 5010U, 5011U}) {
    EXPECT_EQ(frames_in(check_sonarview_frame, stream, piece), frames) << "pieces of " << piece;
  }
  for (std::size_t place = 0; place <= stream.size(); ++place) {
    FrameFinder finder(check_sonarview_frame);
    std::size_t found = 0;
    finder.push(std::span(stream).first(place));
    while (finder.next()) ++found;
    finder.push(std::span(stream).subspan(place));
    while (finder.next()) ++found;
    ASSERT_EQ(found, frames.size()) << "split at " << place;
  }
}

// Kills a search through damage that takes the square of its length: a long frame may begin at each of its bytes.
TEST(SonarView, SumsOfDamageAreNotMadeAnewAtEachByte) {
  const auto check = [](const FrameBytes& at) {
    // A frame behind a damaged one is told where the stream's sums are.
    EXPECT_TRUE(at.start == 0 || at.bytes().size() <= 100 || at.sums != nullptr) << at.start;
    return check_sonarview_frame(at);
  };
  Bytes stream;
  for (int i = 0; i < 20'000; ++i) stream.insert(stream.end(), {'B', 'R', 0xff, 0x3f});
  const Frames frames = {ping(3, {7, 8, 9}), ping(4, {1})};
  for (const Bytes& frame : frames) stream.insert(stream.end(), frame.begin(), frame.end());
  EXPECT_EQ(frames_in(check, stream, stream.size()), frames);
  EXPECT_EQ(frames_in(check_sonarview_frame, stream, 5000), frames) << "sums begin anew with each piece";
}

TEST(SonarView, AWrongBitCostsItsFrameAndNoOther) {
  const Bytes before = ping(1, {1, 2}), hit = ping(2, {3, 'B', 'R', 0xff, 0x7f, 4}), behind = ping(3, {5, 6});
  for (std::size_t i = 0; i < hit.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      Bytes damaged = hit;
      damaged[i] = static_cast<std::uint8_t>(damaged[i] ^ (1U << bit));
      const auto all = all_beams({"a.svlog", joined({before, damaged, behind})});
      ASSERT_EQ(all.error, "");
      ASSERT_EQ(all.items.size(), 2U) << "byte " << i << " bit " << bit;
      EXPECT_EQ(all.items[0].intensities, (Bytes{1, 2}));
      EXPECT_EQ(all.items[1].intensities, (Bytes{5, 6}));
      EXPECT_GT(all.skipped, 0U);
    }
  }
}

TEST(SonarView, DamageIsCountedByKindWithItsPlace) {
  Bytes wrong = ping(2, {3, 4});
  wrong[23] ^= 1;
  const Bytes first = session(300);
  const auto source = open_beams({"a.svlog", joined({first, wrong, {0, 0}, ping(3, {5}), {'B', 'R', 4}})});
  ASSERT_TRUE(source);
  ASSERT_EQ(read_all(**source)->size(), 1U);
  const auto damage = (*source)->damage();
  ASSERT_EQ(damage.size(), 2U);
  EXPECT_EQ(damage[0].what, "wrong checksum");
  EXPECT_EQ(damage[0].first_byte, first.size());
  EXPECT_EQ(damage[1].what, "cut off at the end");
}

// A capture of the line begins anywhere.
TEST(SonarView, MayBeginWithinAFrame) {
  const Bytes whole = ping(2, Bytes(200, 9));
  for (const std::size_t from : {1U, 8U, 100U, 223U}) {
    const Bytes part(whole.begin() + static_cast<std::ptrdiff_t>(from), whole.end());
    const auto all = all_beams({"line.bin", joined({part, ping(3, {5}), ping(4, {6})})});
    EXPECT_EQ(all.error, "");
    EXPECT_EQ(all.items.size(), 2U);
  }
}

TEST(SonarView, WithoutPingsOfAScanningSonarIsToldAsSuch) {
  const auto opened = open_beams({"omniscan.svlog", joined({session(100), frame_of(2198, Bytes(60, 1))})});
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, Error::Code::kUnsupported);
  EXPECT_THAT(opened.error().message, HasSubstr("omniscan.svlog: is a log of SonarView without pings of a Ping360"));
}

TEST(SonarView, TextAboutItIsNot) {
  EXPECT_EQ(format_of(bytes_of("BR is how a frame begins, and BR again\n")), std::nullopt);
  EXPECT_EQ(format_of(Bytes{'B'}), std::nullopt);
  EXPECT_EQ(format_of(Bytes{'B', 'R', 0, 0}), std::nullopt);
  // A pipe may begin with less than its first message: the brace of the JSON is enough.
  const Bytes beginning = session(65'535);
  EXPECT_EQ(format_of(std::span(beginning).first(9)), Format::kSonarView);
  EXPECT_EQ(format_of(std::span(beginning).first(8)), std::nullopt);
}

}  // namespace
}  // namespace pingvox
