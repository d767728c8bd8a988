#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "support/bag_writer.hpp"
#include "support/logs.hpp"

namespace pingvox {
namespace {

using testing::ElementsAre;
using testing::SizeIs;

// Made by another writer.
constexpr std::string_view kFlatMcap =
    "894d434150300d0a 010d0000000000000004000000726f73320100000074"
    "03480000000000000001002000000070696e673336305f736f6e61725f6d7367732f6d73672f536f6e61724563686f07000000726f73326d"
    "7367 1300000075696e74385b5d20696e74656e736974696573"
    "04180000000000000000000100050000002f6563686f0300000063647200000000"
    "054200000000000000000000000000007572f2e8000000007572f2e8000000"
    "00010000e80300000065cd1d02000000730000000000c03f01000400ee02dc050a00000004000000000a40ff"
    "0f04000000000000005ed9b4d2 02140000000000000000000000000000000000000000000000b0c9c46f894d434150300d0a";

TEST(Mcap, ReadsWhatAnotherWriterMade) {
  const auto bytes = from_hex(kFlatMcap);
  ASSERT_EQ(bytes.size(), 269U);
  EXPECT_EQ(format_of(bytes), Format::kMcap);
  const auto read = all_beams({"dive.mcap", bytes});
  EXPECT_EQ(read.error, "");
  EXPECT_EQ(read.skipped, 0U);
  ASSERT_THAT(read.items, SizeIs(1));
  EXPECT_EQ(read.items[0].time_s, 1000.5);
  EXPECT_NEAR(read.items[0].bearing_rad, std::numbers::pi - 1.5, 1e-12) << "as the head counts, clockwise";
  EXPECT_EQ(read.items[0].bin_length_m, 2.5);
  EXPECT_THAT(read.items[0].intensities, ElementsAre(0, 10, 64, 255));
}

bags::Mcap echoes(std::string_view compression, int chunks = 3) {
  bags::Mcap mcap;
  mcap.topic(4, "/echo", "ping360_sonar_msgs/msg/SonarEcho", "");
  for (int i = 0; i < 10 * chunks; ++i) {
    mcap.message(4, 1'000'000'000'000U + static_cast<unsigned>(i) * 100'000'000U, from_hex(bags::kSonarEcho));
    if (i % 10 == 9) mcap.end_chunk(compression);
  }
  return mcap;
}

constexpr std::size_t kBehindChunks = 50;  ///< bytes

TEST(Mcap, UnpacksItsChunks) {
  for (const char* compression : {"", "lz4", "zstd"}) {
    const auto read = all_beams({"dive.mcap", echoes(compression).closed()});
    EXPECT_EQ(read.skipped, 0U) << compression;
    EXPECT_THAT(read.items, SizeIs(30)) << compression;
  }
}

TEST(Mcap, DropsOnlyTheChunkWithAFlippedBit) {
  for (const char* compression : {"", "lz4", "zstd"}) {
    SCOPED_TRACE(compression);
    auto bytes = echoes(compression, 1).closed();
    const std::size_t first = bytes.size() - kBehindChunks;
    bytes = echoes(compression).closed();
    const std::size_t in_second = first + (bytes.size() - first) / 4;
    bytes[in_second] ^= 4;
    const auto read = all_beams({"dive.mcap", bytes});
    EXPECT_THAT(read.items, SizeIs(20));
    EXPECT_EQ(read.skipped, 1U);
  }
}

TEST(Mcap, ReadsOnBehindLostBytes) {
  const auto whole = echoes("").closed();
  for (std::size_t at = echoes("", 1).closed().size() - kBehindChunks; at < whole.size() - kBehindChunks; at += 5) {
    auto bytes = whole;
    bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.begin() + static_cast<std::ptrdiff_t>(at) + 3);
    EXPECT_GE(all_beams({"dive.mcap", bytes}).items.size(), 19U) << "without bytes " << at;
  }
}

TEST(Mcap, NeedsNoEnd) {
  const auto whole = echoes("lz4").closed();
  const auto cut = all_beams({"dive.mcap", {whole.begin(), whole.end() - std::ptrdiff_t{kBehindChunks}}});
  EXPECT_THAT(cut.items, SizeIs(30));
  EXPECT_EQ(cut.skipped, 1U) << "it was not closed";
}

// Kills beams of a second file behind the first one that are lost without a word, and a record of the end that a wrong
// bit made in the middle.
TEST(Mcap, SaysWhatIsBehindItsEnd) {
  const auto whole = echoes("lz4").closed();
  auto twice = whole;
  twice.insert(twice.end(), whole.begin(), whole.end());
  const auto read = all_beams({"dive.mcap", twice});
  EXPECT_THAT(read.items, SizeIs(30));
  EXPECT_EQ(read.skipped, 1U);

  const std::size_t second = echoes("lz4", 1).closed().size() - kBehindChunks;
  for (const std::uint8_t end : {std::uint8_t{2}, std::uint8_t{15}}) {
    auto wrong = whole;
    ASSERT_EQ(wrong[second], 6) << "a chunk";
    wrong[second] = end;
    const auto damaged = all_beams({"dive.mcap", wrong});
    EXPECT_GE(damaged.items.size(), 20U) << int{end};
  }
}

// Kills ranges that are right at the driver's speed of sound, and scaled as if it were 1500 m/s.
TEST(Mcap, LengthsAtTheDriversSpeedOfSoundAreThoseAtTheAssumedOne) {
  struct Case {
    std::uint16_t sound_speed_m_s;
    double bin_length_m;
  };
  for (const Case& c : {Case{1450, 2.5 * 1500.0 / 1450.0}, Case{1500, 2.5}, Case{0, 2.5}, Case{15000, 2.5}}) {
    auto echo = from_hex(bags::kSonarEcho);
    echo[30] = static_cast<std::uint8_t>(c.sound_speed_m_s & 0xffU);
    echo[31] = static_cast<std::uint8_t>(c.sound_speed_m_s >> 8);
    bags::Mcap mcap;
    mcap.topic(4, "/echo", "ping360_sonar_msgs/msg/SonarEcho", "");
    mcap.message(4, 1'000'000'000'000U, echo);
    mcap.end_chunk();
    const auto read = all_beams({"dive.mcap", mcap.closed()});
    ASSERT_THAT(read.items, SizeIs(1));
    EXPECT_DOUBLE_EQ(read.items[0].bin_length_m, c.bin_length_m) << c.sound_speed_m_s;
  }
}

/// A bag with a ProjectedSonarImage of one beam and two ranges.
/// @param image  its last fields in hex: type of the samples, beams, samples
std::vector<std::uint8_t> sonar_image(const std::string& image) {
  bags::Mcap mcap;
  mcap.topic(1, "/image", "marine_acoustic_msgs/msg/ProjectedSonarImage", "");
  mcap.message(1, 1'000'500'000'000U,
               from_hex("00010000e80300000065cd1d0200000073000000 001b3749 0080bb44 01000000f628dc3e 01000000295c0f3d "
                        "01000000 00000000 000000000000f03f00000000000000000000000000000000 02000000 0000003f 0000803f "
                        "00000000 " +
                        image));
  mcap.end_chunk();
  return mcap.closed();
}

// Kills "has no beams in the topic /image, only in /image".
TEST(Mcap, SaysWhyTheImagesOfASonarAreNotUsed) {
  EXPECT_EQ(all_beams({"dive.mcap", sonar_image("02000000 01000000 04000000 00ff00ff")}).error,
            "dive.mcap: none of its messages can be used as a beam: 1 x samples that are not of 8 bits");
}

TEST(Mcap, GivesTheBeamsOfAnImagingSonar) {
  const auto read = all_beams({"dive.mcap", sonar_image("00000000 01000000 02000000 00ff")});
  EXPECT_EQ(read.skipped, 0U);
  ASSERT_THAT(read.items, SizeIs(1));
  EXPECT_EQ(read.items[0].bin_length_m, 0.5);
  EXPECT_THAT(read.items[0].intensities, ElementsAre(0, 0, 255));
}

// 20 chunks of a few kilobytes took 2 GB and minutes.
TEST(Mcap, ChunksThatUnpackToMoreThanTheFileCanBeAreDamage) {
  bags::Mcap bomb;
  bomb.message(9, 1, bags::Bytes(70'000'000));
  bomb.end_chunk("zstd");
  const bags::Bytes one = bomb.closed();
  constexpr std::ptrdiff_t kBefore = 8 + 9 + 16, kBehind = kBehindChunks;  // magic and header
  bags::Bytes file = echoes("zstd", 1).closed();
  file.resize(file.size() - kBehindChunks);
  for (int i = 0; i < 20; ++i) file.insert(file.end(), one.begin() + kBefore, one.end() - kBehind);
  const auto source = open_beams({"dive.mcap", file});
  ASSERT_TRUE(source) << source.error().message;
  while (const auto beam = (*source)->next()) {
    if (!*beam) break;
  }
  const std::vector<DamageKind> damage = (*source)->damage();
  const auto refused =
      std::ranges::find(damage, std::string_view("unpacks to more than its file can be"), &DamageKind::what);
  ASSERT_NE(refused, damage.end());
  EXPECT_EQ(refused->count, 19U);
}

TEST(Mcap, ReadsMessagesThatAreCompressedOneByOne) {
  bags::Mcap mcap;
  mcap.topic(4, "/echo", "ping360_sonar_msgs/msg/SonarEcho", "");
  mcap.message(4, 1'000'000'000'000U, bags::packed("zstd", from_hex(bags::kSonarEcho)));
  mcap.end_chunk();
  const auto read = all_beams({"dive.mcap", mcap.closed()});
  EXPECT_EQ(read.error, "");
  ASSERT_THAT(read.items, SizeIs(1));
  EXPECT_THAT(read.items[0].intensities, ElementsAre(0, 10, 64, 255));
}

TEST(Mcap, MessagesInAnotherEncodingAreNamed) {
  bags::Mcap other;
  other.topic(1, "/echo", "lab.Echo", "", "protobuf");
  other.message(1, 1'000'000'000'000U, {1, 2});
  other.end_chunk();
  EXPECT_THAT(all_beams({"x.mcap", other.closed()}).error,
              testing::HasSubstr("holds messages in the encoding 'protobuf', which is not read: /echo (lab.Echo)"));
}

}  // namespace
}  // namespace pingvox
