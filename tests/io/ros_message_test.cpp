#include "io/bags/ros_message.hpp"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "support/bag_writer.hpp"
#include "support/logs.hpp"

namespace pingvox {
namespace {

using testing::ElementsAre;

constexpr std::string_view kHeader1 = R"(
================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
)";

constexpr std::string_view kHeader2 = R"(
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
)";

/// A message of a layout that must be one.
struct Decoded {
  RosLayout layout;
  std::vector<std::uint8_t> raw;  ///< the message, which the values are in
  RosMessage message;
  bool fits;

  double number(std::string_view path, std::size_t i = 0) const { return message.number(*layout.field(path), i); }
  std::size_t count(std::string_view path) const { return message.count(*layout.field(path)); }
  std::string_view text(std::string_view path) const { return message.text(*layout.field(path)); }
  std::vector<std::uint8_t> bytes(std::string_view path) const { return message.bytes(*layout.field(path)); }
};

Decoded decode(const std::string& definition, RosEncoding encoding, std::vector<std::uint8_t> bytes) {
  auto layout = RosLayout::make("test_msgs/Test", definition, encoding);
  Decoded decoded{layout.value_or(RosLayout{}), std::move(bytes), {}, false};
  EXPECT_TRUE(layout.has_value());
  if (layout) decoded.fits = decoded.message.read(decoded.layout, decoded.raw);
  return decoded;
}

TEST(RosMessage, ReadsWhatAnotherWriterMadeForRos1) {
  const std::string definition =
      "Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n"
      "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\n"
      "float32[] ranges\nfloat32[] intensities\n" +
      std::string(kHeader1);
  const auto bytes = from_hex(
      "07000000 e8030000 0065cd1d 01000000 73 0000c03f 0000c03f 00000000 00000000 00000000 0000003f 0000a041 00000000 "
      "02000000 00000000 00008042");
  const Decoded scan = decode(definition, RosEncoding::kRos1, bytes);
  ASSERT_TRUE(scan.fits);
  EXPECT_EQ(scan.number("header.seq"), 7.0);
  EXPECT_EQ(scan.number("header.stamp.sec"), 1000.0);
  EXPECT_EQ(scan.number("header.stamp.nanosec"), 5e8);
  EXPECT_EQ(scan.text("header.frame_id"), "s");
  EXPECT_EQ(scan.number("angle_max"), 1.5);
  EXPECT_EQ(scan.number("range_max"), 20.0);
  EXPECT_EQ(scan.count("ranges"), 0U);
  EXPECT_THAT(scan.bytes("intensities"), ElementsAre(0, 64));
}

TEST(RosMessage, AlignsWhatAnotherWriterMadeForRos2) {
  const std::string definition =
      "std_msgs/Header header\nfloat64 angle_grad\nfloat64 angle_rad\nint32 nbins\n"
      "int32 max_range\nint32[] beam_data\n" +
      std::string(kHeader2);
  const auto bytes = from_hex(
      "00010000 e8030000 0065cd1d 0d000000 736f6e61725f6d6963726f6e00 00000000000000 0000000000005940 "
      "182d4454fb21f93f 03000000 14000000 03000000 00000000 40000000 bf000000");
  const Decoded beam = decode(definition, RosEncoding::kCdr, bytes);
  ASSERT_TRUE(beam.fits);
  EXPECT_EQ(beam.text("header.frame_id"), "sonar_micron");
  EXPECT_EQ(beam.number("angle_grad"), 100.0);
  EXPECT_EQ(beam.number("max_range"), 20.0);
  EXPECT_THAT(beam.bytes("beam_data"), ElementsAre(0, 64, 191));
}

TEST(RosMessage, ReadsBigEndianCdr) {
  const Decoded read =
      decode("uint16 a\nuint32[] b", RosEncoding::kCdr, from_hex("00000000 0102 0000 00000002 00000003 00010000"));
  ASSERT_TRUE(read.fits);
  EXPECT_EQ(read.number("a"), 0x102);
  EXPECT_EQ(read.number("b", 1), 65536.0);
}

TEST(RosMessage, FindsEachRecordOfAnArrayAlsoBetweenGaps) {
  const std::string definition =
      "uint8 before\nBin[] bins\nuint8 behind\n===\nMSG: test_msgs/Bin\n"
      "float32 distance\nuint8 intensity\n";
  const Decoded packed =
      decode(definition, RosEncoding::kRos1, from_hex("01 03000000 0000803f 0a 00000040 0b 00004040 0c 02"));
  const Decoded aligned =
      decode(definition, RosEncoding::kCdr,
             from_hex("00010000 01000000 03000000 0000803f 0a000000 00000040 0b000000 00004040 0c 02"));
  for (const Decoded* read : {&packed, &aligned}) {
    ASSERT_TRUE(read->fits);
    EXPECT_EQ(read->count("bins.distance"), 3U);
    EXPECT_EQ(read->number("bins.distance", 2), 3.0);
    EXPECT_THAT(read->bytes("bins.intensity"), ElementsAre(10, 11, 12));
    EXPECT_EQ(read->number("behind"), 2.0);
  }
}

// Kills arrays of which only the first record is read, as its first field is not the one that is aligned most.
TEST(RosMessage, FindsEachRecordOfAnArrayWhoseGapsAreInside) {
  const Decoded read =
      decode("Bin[] bins\nuint8 behind\n===\nMSG: test_msgs/Bin\nuint8 intensity\nfloat32 distance\n",
             RosEncoding::kCdr, from_hex("00010000 03000000 0a000000 0000803f 0b000000 00000040 0c000000 00004040 02"));
  ASSERT_TRUE(read.fits);
  EXPECT_EQ(read.count("bins.distance"), 3U);
  EXPECT_EQ(read.number("bins.distance", 2), 3.0);
  EXPECT_THAT(read.bytes("bins.intensity"), ElementsAre(10, 11, 12));
  EXPECT_EQ(read.number("behind"), 2.0);
  // Here the gaps differ from record to record.
  const Decoded uneven =
      decode("Bin[] bins\nuint8 behind\n===\nMSG: test_msgs/Bin\nuint8 a\nfloat32 b\nuint8 c\n", RosEncoding::kCdr,
             from_hex("00010000 02000000 01000000 0000803f 02 03 0000 00000040 04 05"));
  ASSERT_TRUE(uneven.fits);
  EXPECT_EQ(uneven.number("bins.c"), 2.0);
  EXPECT_EQ(uneven.number("behind"), 5.0);
}

TEST(RosMessage, TakesTheFirstOfRecordsWhoseSizeVaries) {
  const std::string definition =
      "Channel[] channels\nuint8 behind\n===\nMSG: test_msgs/Channel\nstring name\n"
      "uint8[] values\n";
  const Decoded read = decode(definition, RosEncoding::kRos1,
                              from_hex("02000000 01000000 61 02000000 0102 02000000 6263 01000000 03 09"));
  ASSERT_TRUE(read.fits);
  EXPECT_EQ(read.text("channels.name"), "a");
  EXPECT_THAT(read.bytes("channels.values"), ElementsAre(1, 2));
  EXPECT_EQ(read.number("behind"), 9.0);
}

TEST(RosMessage, SkipsConstantsCommentsBoundsAndDefaults) {
  const std::string definition =
      "# int32 no\nbyte DEBUG=10 # int8\nstring TEXT = a # b\nuint8   DEBUG2  =  3\n\n"
      "string<=8 name\nuint8[<=4] few\nuint8[3] three\nint16 last 5\r\n";
  const Decoded read = decode(definition, RosEncoding::kRos1, from_hex("01000000 78 01000000 07 010203 ffff"));
  ASSERT_TRUE(read.fits);
  EXPECT_EQ(read.text("name"), "x");
  EXPECT_THAT(read.bytes("few"), ElementsAre(7));
  EXPECT_THAT(read.bytes("three"), ElementsAre(1, 2, 3));
  EXPECT_EQ(read.number("last"), -1.0);
  EXPECT_FALSE(read.layout.field("DEBUG"));
}

TEST(RosMessage, RoundsAndLimitsIntensities) {
  const Decoded floats = decode("float32[] a", RosEncoding::kRos1, from_hex("03000000 9a99 b93f 0000c8c3 00008043"));
  EXPECT_THAT(floats.bytes("a"), ElementsAre(1, 0, 255));
  const Decoded integers = decode("int32[] a", RosEncoding::kRos1, from_hex("03000000 ff000000 00010000 ffffffff"));
  EXPECT_THAT(integers.bytes("a"), ElementsAre(255, 255, 0));
  const Decoded nan = decode("float64[] a", RosEncoding::kRos1, from_hex("01000000 000000000000f87f"));
  EXPECT_THAT(nan.bytes("a"), ElementsAre(0));
}

TEST(RosMessage, RefusesBytesThatDoNotFit) {
  const auto fits = [](const std::string& definition, RosEncoding encoding, std::string_view hex) {
    return decode(definition, encoding, from_hex(hex)).fits;
  };
  EXPECT_TRUE(fits("uint32 a", RosEncoding::kRos1, "00000000"));
  EXPECT_FALSE(fits("uint32 a", RosEncoding::kRos1, "000000"));
  EXPECT_FALSE(fits("uint32 a", RosEncoding::kRos1, "0000000000"));
  EXPECT_FALSE(fits("float64[] a", RosEncoding::kRos1, "ffffffff00"));
  EXPECT_FALSE(fits("string a", RosEncoding::kRos1, "0500000061"));
  EXPECT_FALSE(fits("uint8[4000000000] a", RosEncoding::kRos1, "00"));
  EXPECT_FALSE(fits("uint8 a", RosEncoding::kCdr, "00070000 01")) << "another CDR";
  EXPECT_FALSE(fits("uint8 a", RosEncoding::kCdr, "0001"));
  EXPECT_FALSE(
      fits("A[] a\nuint8 b\nMSG: test_msgs/A\nuint8 x\nfloat64 y", RosEncoding::kCdr, "00010000 ffffffff 00000000"));
}

TEST(RosMessage, EndsSoonWithManyRecordsOfNothing) {
  // 4 billion records without bytes, many times over.
  std::string hex = "00000100";
  for (int i = 0; i < 65536; ++i) hex += "ffffffff";
  const Decoded read = decode("A[] a\nMSG: test_msgs/A\nB[] b\nMSG: test_msgs/B\n", RosEncoding::kRos1, from_hex(hex));
  EXPECT_TRUE(read.fits);
}

// Kills layouts of gigabytes from a bag of kilobytes: each level doubles the fields, and lengthens their paths.
TEST(RosLayout, RefusesPathsOutOfProportion) {
  const auto layout_with = [](std::size_t name_size) {
    const std::string name(name_size, 'a');
    std::string definition;
    constexpr int kLevels = 10;
    for (int level = 0; level < kLevels; ++level) {
      const std::string type = level + 1 < kLevels ? fmt::format("T{}", level + 1) : "float32";
      if (level > 0) definition += fmt::format("================\nMSG: lab/T{}\n", level);
      definition += fmt::format("{0} {1}\n{0} b{1}\n", type, name);
    }
    return RosLayout::make("lab/T0", definition, RosEncoding::kCdr);
  };
  EXPECT_TRUE(layout_with(2));
  EXPECT_FALSE(layout_with(2500));
}

TEST(RosLayout, RefusesDefinitionsWithoutEndAndUnknownTypes) {
  const auto is_layout = [](const std::string& definition, RosEncoding encoding = RosEncoding::kRos1) {
    return RosLayout::make("test_msgs/Test", definition, encoding).has_value();
  };
  EXPECT_FALSE(is_layout("Test again"));
  EXPECT_FALSE(is_layout("other_msgs/Unknown a"));
  EXPECT_FALSE(is_layout(""));
  std::string wide = "L0 a\nL0 b";
  for (int i = 0; i < 14; ++i) {
    wide += "\nMSG: test_msgs/L" + std::to_string(i) + "\nL" + std::to_string(i + 1) + " a\nL" + std::to_string(i + 1) +
            " b";
  }
  EXPECT_FALSE(is_layout(wide + "\nMSG: test_msgs/L14\nuint8 x")) << "two to the power of 15 fields";
  EXPECT_TRUE(is_layout("geometry_msgs/Vector3 v", RosEncoding::kCdr)) << "a common type";
  EXPECT_TRUE(RosLayout::make("sensor_msgs/msg/Imu", "", RosEncoding::kCdr));
}

}  // namespace
}  // namespace pingvox
