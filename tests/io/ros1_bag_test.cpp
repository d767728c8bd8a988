#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <numbers>
#include <random>
#include <string>
#include <string_view>

#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "support/bag_writer.hpp"
#include "support/folder.hpp"
#include "support/logs.hpp"

namespace pingvox {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

constexpr std::string_view kScanLine =
    "Header header\nfloat32 angle\nfloat32 bin_distance_step\nIntensityBin[] bins\n===\nMSG: std_msgs/Header\n"
    "uint32 seq\ntime stamp\nstring frame_id\n===\nMSG: micron_driver_ros/IntensityBin\nfloat32 distance\n"
    "uint8 intensity\n";

/// A line of 4 bins of 0.5 m: 0, 10, 64, 255.
bags::Bytes scan_line(float angle_deg, std::uint32_t seconds) {
  bags::Bytes message;
  bags::put(message, std::uint32_t{7});
  bags::put(message, seconds);
  bags::put(message, std::uint32_t{500'000'000});
  bags::put_text(message, "Micron");
  bags::put(message, angle_deg);
  bags::put(message, 0.5F);
  bags::put(message, std::uint32_t{4});
  for (const int intensity : {0, 10, 64, 255}) {
    bags::put(message, 1.0F);
    bags::put(message, static_cast<std::uint8_t>(intensity));
  }
  return message;
}

/// Chunks of ten lines each, 9 degrees apart.
bags::Ros1 micron_chunks(std::string_view compression, int chunks) {
  bags::Ros1 bag;
  bag.topic(1, "/scan_line", "micron_driver_ros/ScanLine", kScanLine);
  for (int i = 0; i < 10 * chunks; ++i) {
    bag.message(1, 1000 + static_cast<std::uint32_t>(i), 0,
                scan_line(static_cast<float>(9 * i), 1000U + static_cast<unsigned>(i)));
    if (i % 10 == 9) bag.end_chunk(compression);
  }
  return bag;
}

bags::Bytes micron_bag(std::string_view compression, int chunks = 3) {
  return micron_chunks(compression, chunks).file();
}

TEST(RosBag, GivesTheLinesOfAMicronInOurFrame) {
  const auto read = all_beams({"dive.bag", micron_bag("none", 1)});
  EXPECT_EQ(read.error, "");
  ASSERT_THAT(read.items, SizeIs(10));
  EXPECT_EQ(read.items[0].time_s, 1000.5);
  EXPECT_EQ(read.items[0].bearing_rad, 0.0);
  EXPECT_NEAR(read.items[1].bearing_rad, 2 * std::numbers::pi - 9 * std::numbers::pi / 180, 1e-12) << "clockwise there";
  EXPECT_EQ(read.items[0].bin_length_m, 0.5);
  EXPECT_THAT(read.items[0].intensities, ElementsAre(0, 10, 64, 255));
  const auto source = open_beams(FileBytes{"dive.bag", micron_bag("none", 1)});
  ASSERT_TRUE(source);
  EXPECT_EQ((*source)->device(), find_device("micron"));
}

TEST(RosBag, UnpacksItsChunks) {
  const auto plain = all_beams({"dive.bag", micron_bag("none")});
  for (const char* compression : {"bz2", "lz4"}) {
    SCOPED_TRACE(compression);
    const auto bag = micron_bag(compression);
    EXPECT_EQ(format_of(bag), Format::kRosBag);
    const auto read = all_beams({"dive.bag", bag});
    EXPECT_EQ(read.skipped, 0U);
    ASSERT_THAT(read.items, SizeIs(30));
    for (std::size_t i = 0; i < 30; ++i) EXPECT_TRUE(same(read.items[i], plain.items[i])) << i;
  }
}

TEST(RosBag, LosesOneChunkWithALostByte) {
  const auto whole = micron_bag("none");
  std::size_t fewest = 30;
  for (std::size_t at = 200; at < whole.size() - 40; at += 7) {
    auto bytes = whole;
    bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(at));
    const auto read = all_beams({"dive.bag", bytes});
    fewest = std::min(fewest, read.items.size());
    // The first chunk names the topic; this bag was not closed, so nothing else does.
    if (at <= 900) continue;
    EXPECT_GE(read.items.size(), 19U) << "without byte " << at;
  }
  EXPECT_LT(fewest, 30U);
}

// Kills whole chunks that are passed over as the end of the one before.
TEST(RosBag, AChunkWhoseLengthIsTooLargeCostsNoOther) {
  constexpr std::string_view kSize = "size=";
  for (const char* compression : {"none", "bz2", "lz4"}) {
    const bags::Bytes whole = micron_bag(compression);
    const auto field = std::search(whole.begin(), whole.end(), kSize.begin(), kSize.end());
    ASSERT_NE(field, whole.end());
    const auto at = static_cast<std::size_t>(field - whole.begin()) + kSize.size() + 4;
    std::uint32_t length = 0;
    std::memcpy(&length, whole.data() + at, sizeof(length));
    for (const std::size_t more :
         {std::size_t{100}, (whole.size() - at - 4 - length) / 2, whole.size() - at - 4 - length}) {
      bags::Bytes bytes = whole;
      const auto wrong = static_cast<std::uint32_t>(length + more);
      std::memcpy(bytes.data() + at, &wrong, sizeof(wrong));
      const auto read = all_beams({"dive.bag", bytes});
      EXPECT_THAT(read.items, SizeIs(30)) << compression << ", " << more << " bytes more";
      EXPECT_GE(read.skipped, 1U);
    }
  }
}

// lz4 stores what it cannot pack as it is. Kills a bag in a message that is read as chunks of the outer one.
TEST(RosBag, ABagInAMessageIsNoChunk) {
  bags::Ros1 bag;
  bag.topic(1, "/scan_line", "micron_driver_ros/ScanLine", kScanLine);
  bag.topic(2, "/upload", "std_msgs/String", "string data\n");
  bag.message(1, 1000, 0, scan_line(9.0F, 1000));
  std::mt19937 random(1);
  std::string data(100'000, ' ');
  std::ranges::generate(data, [&] { return static_cast<char>(random()); });
  constexpr std::string_view kField = "compression=";
  const bags::Bytes inner = micron_bag("none", 1);
  const auto field = std::search(inner.begin(), inner.end(), kField.begin(), kField.end());
  ASSERT_NE(field, inner.end());
  std::copy(field - 8, field + 60, data.begin() + 20'000);  // the header of a chunk, in what cannot be packed
  bags::Bytes upload;
  bags::put_text(upload, data);
  bag.message(2, 1001, 0, upload);
  bag.end_chunk("lz4");
  const auto read = all_beams({"dive.bag", bag.file()}, Damage::kFail);
  EXPECT_EQ(read.error, "");
  EXPECT_THAT(read.items, SizeIs(1));
}

TEST(RosBag, FindsTheTopicsOfADamagedChunkInTheIndex) {
  const auto whole = micron_chunks("bz2", 3).closed();
  const auto undamaged = all_beams({"dive.bag", whole});
  ASSERT_THAT(undamaged.items, SizeIs(30));
  EXPECT_EQ(undamaged.skipped, 0U);
  std::size_t without_first = 0;
  for (std::size_t at = 13; at < whole.size(); ++at) {  // behind "#ROSBAG V2.0"
    auto bytes = whole;
    bytes[at] ^= 1;
    const auto read = all_beams({"dive.bag", bytes});
    EXPECT_GE(read.items.size(), 20U) << "byte " << at;
    without_first += !read.items.empty() && read.items.front().time_s > 1010.0 ? 1U : 0U;
  }
  EXPECT_GT(without_first, 100U);
}

/// A closed bag with a wrong bit in the data of its first chunk.
std::string damaged_bag(int chunks) {
  const auto bytes = micron_chunks("bz2", chunks).closed();
  std::string bag(bytes.begin(), bytes.end());
  bag[bag.find("BZh9") + 20] ^= 4;
  return bag;
}

TEST(RosBag, ReadsOnAfterTheIndexOfAFile) {
  const test::Folder folder;
  const std::string bag = damaged_bag(500), path = folder.path("index.bag");
  ASSERT_GT(bag.size(), 2 * ByteStream::kBeginning) << "longer than what stays in memory";
  std::ofstream(path, std::ios::binary) << bag;
  const auto read = read_everything<Beam>(open_beams(*ByteStream::open(path)));
  EXPECT_EQ(read.error, "");
  EXPECT_THAT(read.items, SizeIs(4990));
  EXPECT_EQ(read.skipped, 1U);
}

TEST(RosBag, DoesNotLookForTheIndexOfAPipe) {
  const std::string bag = damaged_bag(3);
  std::array<int, 2> ends = {};
  ASSERT_EQ(::pipe(ends.data()), 0);
  ASSERT_EQ(::write(ends[1], bag.data(), bag.size()), static_cast<ssize_t>(bag.size()));
  ::close(ends[1]);
  const auto read = read_everything<Beam>(open_beams(*ByteStream::open("/dev/fd/" + std::to_string(ends[0]))));
  ::close(ends[0]);
  EXPECT_THAT(read.error, HasSubstr("or it is damaged"));
}

TEST(RosBag, ReadsWhatThereIsBeforeTheCut) {
  const auto whole = micron_bag("none");
  std::size_t before = 0;
  for (std::size_t size = whole.size() / 2; size < whole.size(); ++size) {
    const auto read = all_beams({"dive.bag", {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)}});
    EXPECT_GE(read.items.size(), before);
    before = read.items.size();
    EXPECT_LE(read.skipped, 1U) << size;
  }
  EXPECT_EQ(before, 30U);
  const auto packed = micron_bag("lz4");
  const auto cut = all_beams({"dive.bag", {packed.begin(), packed.end() - 100}});
  EXPECT_GE(cut.items.size(), 20U);
  EXPECT_EQ(cut.skipped, 1U);
}

TEST(RosBag, SaysWhereTheDamageIsWhenItMust) {
  auto bytes = micron_bag("none");
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::size_t second = text.find("compression=none", text.find("compression=none") + 1);
  bytes[second + 12] = 'x';  // its compression is unknown now
  const auto lenient = all_beams({"dive.bag", bytes});
  EXPECT_THAT(lenient.items, SizeIs(20));
  EXPECT_EQ(lenient.skipped, 1U);
  const auto strict = all_beams({"dive.bag", bytes}, Damage::kFail);
  EXPECT_THAT(strict.items, testing::IsEmpty()) << "before the damage too few angles tell their unit";
  EXPECT_EQ(strict.error, "dive.bag: byte " + std::to_string(second - 8) + ": unknown compression");
}

TEST(RosBag, AsksForATopicWhereSeveralHaveBeams) {
  bags::Ros1 bag;
  bag.topic(1, "/port", "micron_driver_ros/ScanLine", kScanLine);
  bag.topic(2, "/starboard", "micron_driver_ros/ScanLine", kScanLine);
  bag.message(1, 1000, 0, scan_line(0, 1000));
  bag.message(2, 1001, 0, scan_line(9, 1001));
  bag.message(2, 1002, 0, scan_line(18, 1002));
  bag.end_chunk();
  const auto all = all_beams({"dive.bag", bag.file()});
  EXPECT_THAT(all.error, HasSubstr("/port (micron_driver_ros/ScanLine), /starboard"));
  EXPECT_THAT(all.error, HasSubstr("--topic"));
  const auto one =
      read_everything<Beam>(open_beams(FileBytes{"dive.bag", bag.file()}, Damage::kSkip, {.name = "/starboard"}));
  EXPECT_EQ(one.error, "");
  EXPECT_THAT(one.items, SizeIs(2));
  const auto none = open_beams(FileBytes{"dive.bag", bag.file()}, Damage::kSkip, {.name = "/stern"});
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().message, HasSubstr("only in /port"));
}

TEST(RosBag, ReadsBeamsOfAnUnknownTypeByTheirFields) {
  bags::Ros1 bag;
  bag.topic(1, "/sonar", "micron_driver_ros/Line", kScanLine);
  for (unsigned i = 0; i < 3; ++i) {
    bag.message(1, 1000 + i, 0, scan_line(110.0F + 10.0F * static_cast<float>(i), 1000U + i));
  }
  bag.end_chunk();
  const FileBytes file{"dive.bag", bag.file()};
  EXPECT_THAT(all_beams(file).error, HasSubstr("that we know"));
  // Of 400 a turn, clockwise, 100 ahead.
  BeamFields fields{.angle = "angle",
                    .length = "bin_distance_step",
                    .intensities = "bins.intensity",
                    .length_of = BeamFields::Length::kBin,
                    .angle_unit_rad = -std::numbers::pi / 200.0,
                    .ahead = 100.0};
  const auto by_bin = read_everything<Beam>(open_beams(file, Damage::kSkip, {"/sonar", fields}));
  EXPECT_EQ(by_bin.error, "");
  ASSERT_THAT(by_bin.items, SizeIs(3));
  EXPECT_NEAR(by_bin.items[0].bearing_rad, 2.0 * std::numbers::pi - std::numbers::pi / 20.0, 1e-6) << "to starboard";
  EXPECT_EQ(by_bin.items[0].bin_length_m, 0.5);
  EXPECT_THAT(by_bin.items[0].intensities, ElementsAre(0, 10, 64, 255));
  EXPECT_EQ(by_bin.items[2].time_s, 1002.5);

  fields.length_of = BeamFields::Length::kBeam;
  const auto by_beam = read_everything<Beam>(open_beams(file, Damage::kSkip, {"/sonar", fields}));
  ASSERT_THAT(by_beam.items, SizeIs(3));
  EXPECT_EQ(by_beam.items[0].bin_length_m, 0.125);

  fields.angle = "bearing";
  const auto lacking = open_beams(file, Damage::kSkip, {"/sonar", fields});
  ASSERT_FALSE(lacking);
  EXPECT_THAT(lacking.error().message,
              testing::AllOf(HasSubstr("lacks a field of bearing"), HasSubstr("it has"),
                             HasSubstr("bin_distance_step float32, bins.distance float32[], bins.intensity uint8[]")));
  EXPECT_THAT(open_beams(file, Damage::kSkip, {"", fields}).error().message, HasSubstr("--topic"));
}

TEST(RosBag, IsRefusedWithoutBeams) {
  bags::Ros1 bag;
  bag.topic(1, "/text", "std_msgs/String", "string data");
  bag.message(1, 1000, 0, {0, 0, 0, 0});
  bag.end_chunk();
  const auto source = open_beams(FileBytes{"dive.bag", bag.file()});
  ASSERT_FALSE(source);
  EXPECT_EQ(source.error().code, Error::Code::kUnsupported);
  EXPECT_THAT(source.error().message, HasSubstr("without beams"));
}

TEST(RosBag, PrefersStampsNearTheRecording) {
  bags::Ros1 bag;
  bag.topic(1, "/scan_line", "micron_driver_ros/ScanLine", kScanLine);
  bag.message(1, 1059, 0, scan_line(0, 1000));    // 58.5 s late
  bag.message(1, 99'000, 0, scan_line(9, 1000));  // another clock
  bag.end_chunk();
  const auto read = all_beams({"dive.bag", bag.file()});
  ASSERT_THAT(read.items, SizeIs(2));
  EXPECT_EQ(read.items[0].time_s, 1000.5);
  EXPECT_EQ(read.items[1].time_s, 99'000.0);
}

}  // namespace
}  // namespace pingvox
