#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "pingvox/io/bag.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/nav.hpp"
#include "pingvox/nav/nav_trajectory.hpp"
#include "support/bag_writer.hpp"
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
bags::Bytes micron_bag(std::string_view compression, int chunks = 3) {
  bags::Ros1 bag;
  bag.topic(1, "/scan_line", "micron_driver_ros/ScanLine", kScanLine);
  for (int i = 0; i < 10 * chunks; ++i) {
    bag.message(1, 1000 + static_cast<std::uint32_t>(i), 0,
                scan_line(static_cast<float>(9 * i), 1000U + static_cast<unsigned>(i)));
    if (i % 10 == 9) bag.end_chunk(compression);
  }
  return bag.file();
}

// Made by another writer.
constexpr std::string_view kEcho =
    "00010000e80300000065cd1d02000000730000000000c03f01000400ee02dc050a00000004000000000a40ff";
constexpr std::string_view kFlatMcap =
    "894d434150300d0a 010d0000000000000004000000726f73320100000074"
    "03480000000000000001002000000070696e673336305f736f6e61725f6d7367732f6d73672f536f6e61724563686f07000000726f73326d"
    "7367 1300000075696e74385b5d20696e74656e736974696573"
    "04180000000000000000000100050000002f6563686f0300000063647200000000"
    "054200000000000000000000000000007572f2e8000000007572f2e8000000"
    "00010000e80300000065cd1d02000000730000000000c03f01000400ee02dc050a00000004000000000a40ff"
    "0f04000000000000005ed9b4d2 02140000000000000000000000000000000000000000000000b0c9c46f894d434150300d0a";

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
    // The first chunk names the topic; without that nothing is known of the others.
    if (at <= 900) continue;
    EXPECT_GE(read.items.size(), 19U) << "without byte " << at;
  }
  EXPECT_LT(fewest, 30U);
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
  EXPECT_THAT(strict.items, SizeIs(10));
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
    mcap.message(4, 1'000'000'000'000U + static_cast<unsigned>(i) * 100'000'000U, from_hex(kEcho));
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

TEST(Mcap, GivesTheBeamsOfAnImagingSonar) {
  bags::Mcap mcap;
  mcap.topic(1, "/image", "marine_acoustic_msgs/msg/ProjectedSonarImage", "");
  mcap.message(1, 1'000'500'000'000U,
               from_hex("00010000e80300000065cd1d0200000073000000 001b3749 0080bb44 01000000f628dc3e 01000000295c0f3d "
                        "01000000 00000000 000000000000f03f00000000000000000000000000000000 02000000 0000003f 0000803f "
                        "00000000 00000000 01000000 02000000 00ff"));
  mcap.end_chunk();
  const auto read = all_beams({"dive.mcap", mcap.closed()});
  EXPECT_EQ(read.skipped, 0U);
  ASSERT_THAT(read.items, SizeIs(1));
  EXPECT_EQ(read.items[0].bin_length_m, 0.5);
  EXPECT_THAT(read.items[0].intensities, ElementsAre(0, 0, 255));
}

/// The samples of a quantity in a message of ROS 2 alone in a bag.
std::vector<NavSample> samples_of(std::string_view type, std::string_view hex, NavQuantity quantity,
                                  std::string_view topic = "/topic", std::string_view definition = "") {
  bags::Mcap mcap;
  mcap.topic(1, topic, type, definition);
  mcap.message(1, 1'000'600'000'000U, from_hex(hex));
  mcap.end_chunk();
  const auto nav = read_nav(FileBytes{"dive.mcap", mcap.closed()});
  EXPECT_TRUE(nav);
  if (!nav) return {};
  EXPECT_TRUE(nav->damage.empty());
  EXPECT_EQ(nav->log.clock(), NavClock::kUnix);
  for (const NavSource& source : nav->log.sources()) {
    if (source.quantity == quantity && source.name == topic) return source.samples;
  }
  return {};
}

TEST(BagNav, ReadsWhatAnotherWriterMade) {
  const auto pressure =
      samples_of("sensor_msgs/msg/FluidPressure",
                 "00010000e80300000065cd1d0200000073000000000000002003fe400000000000000000", NavQuantity::kPressure);
  ASSERT_THAT(pressure, SizeIs(1));
  EXPECT_EQ(pressure[0].value.x(), 122'930.0);
  EXPECT_EQ(pressure[0].time_s, 1000.5);
  const auto velocity = samples_of(
      "geometry_msgs/msg/TwistStamped",
      "00010000e80300000065cd1d0400000064766c00 000000000000e03f 000000000000d0bf 0000000000000000 0000000000000000 "
      "0000000000000000 000000000000c03f",
      NavQuantity::kVelocity);
  ASSERT_THAT(velocity, SizeIs(1));
  EXPECT_EQ(velocity[0].value, Eigen::Vector3d(0.5, -0.25, 0.0)) << "already in our frame";
}

TEST(BagNav, TellsUnitsOfPressureByTheirSize) {
  const auto pascals = [](double value) {
    bags::Bytes message = {0, 1, 0, 0};
    bags::put(message, value);
    std::string hex;
    for (const std::uint8_t byte : message) hex += fmt::format("{:02x}", byte);
    const auto samples = samples_of("std_msgs/msg/Float64", hex, NavQuantity::kPressure, "/bar30/pressure");
    return samples.empty() ? 0.0 : samples[0].value.x();
  };
  EXPECT_NEAR(pascals(1.5), 150'000.0, 1e-6);
  EXPECT_NEAR(pascals(101.3), 101'300.0, 1e-6);
  EXPECT_NEAR(pascals(1500.0), 150'000.0, 1e-6);
  EXPECT_NEAR(pascals(150'000.0), 150'000.0, 1e-6);
}

TEST(BagNav, TurnsADvlThatLooksDown) {
  constexpr std::string_view kDefinition =
      "geometry_msgs/Vector3 velocity\nfloat64 fom\nfloat64 altitude\nbool velocity_valid\n";
  const std::string hex =
      "00010000 000000000000f03f 0000000000000040 0000000000000840 0000000000000000 0000000000001040 01";
  const auto down = samples_of("waterlinked_a50_ros_driver/msg/DVL", hex, NavQuantity::kVelocity, "/dvl", kDefinition);
  ASSERT_THAT(down, SizeIs(1));
  EXPECT_EQ(down[0].value, Eigen::Vector3d(1, -2, -3));
  const auto ahead = samples_of("sensors/msg/DVLVelocity", hex, NavQuantity::kVelocity, "/dvl", kDefinition);
  ASSERT_THAT(ahead, SizeIs(1));
  EXPECT_EQ(ahead[0].value, Eigen::Vector3d(3, 1, 2)) << "of SOLAQUA: x left, y up, z ahead";
}

/// An SQLite database in a temporary folder, which is removed with it.
class Database {
 public:
  Database()
      : folder_(std::filesystem::temp_directory_path() /
                ("pingvox_bag_" + std::to_string(std::hash<std::string>{}(
                                      testing::UnitTest::GetInstance()->current_test_info()->name())))) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directory(folder_);
    sqlite3_open(file().c_str(), &database_);
    run("PRAGMA page_size=512");
  }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;
  ~Database() {
    close();
    std::filesystem::remove_all(folder_);
  }

  void run(const std::string& sql) {
    EXPECT_EQ(sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(database_);
  }
  void close() { sqlite3_close(std::exchange(database_, nullptr)); }

  std::string folder() const { return folder_.string(); }
  std::string file() const { return (folder_ / "dive_0.db3").string(); }

 private:
  std::filesystem::path folder_;
  sqlite3* database_ = nullptr;
};

void add_echoes(Database& database, int count) {
  database.run(
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT, "
      "offered_qos_profiles TEXT)");
  database.run("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)");
  database.run("INSERT INTO topics VALUES(1, '/echo', 'ping360_sonar_msgs/msg/SonarEcho', 'cdr', '')");
  for (int i = 0; i < count; ++i) {
    database.run(fmt::format("INSERT INTO messages VALUES({}, 1, {}, x'{}')", i + 1, 1'000'500'000'000 + i, kEcho));
  }
}

TEST(SqliteBag, ReadsAFileItsFolderAndItsBytesAlike) {
  Database database;
  add_echoes(database, 30);
  database.close();
  const auto bytes = read_file(database.file());
  ASSERT_TRUE(bytes);
  EXPECT_EQ(format_of(bytes->view()), Format::kRosSqlite);
  const auto in_memory = all_beams(*bytes);
  EXPECT_EQ(in_memory.error, "");
  EXPECT_THAT(in_memory.items, SizeIs(30));
  for (const std::string& path : {database.file(), database.folder()}) {
    auto stream = ByteStream::open(path);
    ASSERT_TRUE(stream) << stream.error().message;
    EXPECT_EQ(stream->path(), database.file());
    const auto read = read_everything<Beam>(open_beams(*std::move(stream)));
    EXPECT_EQ(read.error, "");
    EXPECT_THAT(read.items, SizeIs(30));
  }
}

TEST(SqliteBag, WritesNothingBesideTheFile) {
  Database database;
  add_echoes(database, 3);
  database.run("PRAGMA journal_mode=WAL");
  database.close();
  auto stream = ByteStream::open(database.file());
  ASSERT_TRUE(stream);
  const auto source = open_beams(*std::move(stream));
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(database.folder()), {}), 1);
}

TEST(SqliteBag, ReadsWhatThereIsBeforeTheCut) {
  Database database;
  add_echoes(database, 300);
  database.close();
  const auto whole = read_file(database.file());
  ASSERT_TRUE(whole);
  const auto half = static_cast<std::ptrdiff_t>(whole->bytes.size() / 2);
  const auto cut = all_beams({"dive.db3", {whole->bytes.begin(), whole->bytes.begin() + half}});
  EXPECT_EQ(cut.error, "");
  EXPECT_GE(cut.items.size(), 100U);
  EXPECT_LT(cut.items.size(), 300U);
  EXPECT_GE(cut.skipped, 1U);
  EXPECT_LE(cut.skipped, 3U) << "the page at the cut, what is in it, and the next one";
}

TEST(SqliteBag, NamesNoByteOfDamageAsADatabaseHasNone) {
  Database database;
  add_echoes(database, 3);
  database.run("INSERT INTO messages VALUES(99, 77, 0, x'00')");
  database.close();
  const auto source = open_beams(*read_file(database.file()));
  ASSERT_TRUE(source) << source.error().message;
  while (const auto beam = (*source)->next()) {
    if (!*beam) break;
  }
  ASSERT_EQ((*source)->damage().size(), 1U);
  EXPECT_EQ((*source)->damage().front().first_byte, std::nullopt);
  EXPECT_EQ((*source)->first_damage(), "message of an unknown topic");
}

TEST(SqliteBag, RefusesOtherDatabasesAndEndlessViews) {
  Database other;
  other.run("CREATE TABLE things(id INTEGER)");
  const auto read = [&] { return open_beams(*read_file(other.file())); };
  ASSERT_FALSE(read());
  EXPECT_THAT(read().error().message, HasSubstr("SQLite database that holds no ROS messages"));
  other.run("CREATE TABLE topics(id INTEGER, name TEXT, type TEXT, serialization_format TEXT)");
  other.run(
      "CREATE VIEW messages AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT i AS topic_id,"
      " i AS timestamp, i AS data, i AS rowid FROM n");
  EXPECT_FALSE(read());
}

TEST(SqliteBag, AFolderOfSeveralBagsIsNotOne) {
  Database database;
  add_echoes(database, 1);
  std::ofstream(database.folder() + "/dive_1.mcap") << "x";
  const auto stream = ByteStream::open(database.folder());
  ASSERT_FALSE(stream);
  EXPECT_THAT(stream.error().message, HasSubstr("2 bags"));
}

/// A recording beside the project; tests without it are skipped.
std::string recording(const std::string& name) {
  const std::string path = PINGVOX_SHARED_DATA "/" + name;
  return std::filesystem::exists(path) ? path : "";
}

ReadResult<Beam> beams_of(const std::string& path) {
  auto stream = ByteStream::open(path);
  if (!stream) return {{}, 0, stream.error().message};
  return read_everything<Beam>(open_beams(*std::move(stream)));
}

TEST(BagRecordings, LinesOfAMicron) {
  for (const auto& [name, beams, step_m, first_s] :
       {std::tuple("2014-07-18-21-02-59.bag", 2028U, 0.05, 1405710180.828797),
        std::tuple("2014-07-18-21-11-13.bag", 1690U, 0.10, 1405710674.652755)}) {
    const std::string path = recording(std::string("micron-lines-bags/") + name);
    if (path.empty()) GTEST_SKIP() << "no recording";
    const auto read = beams_of(path);
    EXPECT_EQ(read.error, "");
    EXPECT_EQ(read.skipped, 0U);
    ASSERT_THAT(read.items, SizeIs(beams));
    EXPECT_NEAR(read.items.front().time_s, first_s, 1e-5);
    for (const Beam& beam : read.items) {
      ASSERT_THAT(beam.intensities, SizeIs(200));
      ASSERT_NEAR(beam.bin_length_m, step_m, 1e-8);
    }
  }
}

TEST(BagRecordings, CompressedSlicesAreThoseOfTheList) {
  const std::string path = recording("micron-ratzeburg-bag/RatzeburgerSee-2019-01-22-15-05-01.bag");
  const std::string list = recording("micron-ratzeburg-bag/micron_beams.txt");
  if (path.empty() || list.empty()) GTEST_SKIP() << "no recording";
  const auto read = beams_of(path);
  EXPECT_EQ(read.error, "");
  ASSERT_THAT(read.items, SizeIs(666));
  std::ifstream lines(list);
  std::string line;
  std::getline(lines, line);
  for (const Beam& beam : read.items) {
    std::getline(lines, line);
    std::istringstream words(line);
    double stamp_s = 0, recorded_s = 0, angle_rad = 0, range_m = 0;
    std::size_t bins = 0;
    words >> stamp_s >> recorded_s >> angle_rad >> range_m >> bins;
    ASSERT_NEAR(beam.time_s, stamp_s, 1e-5);
    ASSERT_NEAR(std::sin(beam.bearing_rad), std::sin(std::numbers::pi - angle_rad), 1e-8);
    ASSERT_NEAR(std::cos(beam.bearing_rad), std::cos(std::numbers::pi - angle_rad), 1e-8);
    ASSERT_EQ(beam.intensities.size(), bins);
    ASSERT_NEAR(beam.bin_length_m * static_cast<double>(bins), range_m, 1e-9);
    for (const std::uint8_t intensity : beam.intensities) {
      int listed = -1;
      words >> listed;
      ASSERT_EQ(listed, intensity);
    }
  }
}

TEST(BagRecordings, Ping360AndNavigationInOneDatabase) {
  const std::string path = recording("solaqua-ping360-dvl/sintef_dataset_ros2_bag_fixed.db3");
  if (path.empty()) GTEST_SKIP() << "no recording";
  const auto read = beams_of(path);
  EXPECT_EQ(read.error, "");
  EXPECT_THAT(read.items, SizeIs(333));
  EXPECT_EQ(read.skipped, 8U) << "pings without an answer";
  for (const Beam& beam : read.items) {
    ASSERT_THAT(beam.intensities, SizeIs(1200));
    ASSERT_NEAR(beam.bin_length_m, 0.0041625, 1e-12) << "of the settings, not of the ping";
  }
  auto stream = ByteStream::open(path);
  ASSERT_TRUE(stream);
  const auto bag = read_bag(*std::move(stream));
  ASSERT_TRUE(bag) << bag.error().message;
  EXPECT_THAT(bag->topics, SizeIs(26));
  std::size_t messages = 0;
  for (const BagTopicSummary& topic : bag->topics) messages += topic.messages;
  EXPECT_EQ(messages, 15'761U);
  const auto summary = [&](std::string_view name, NavQuantity quantity) {
    for (const NavSource& source : bag->nav.log.sources()) {
      if (source.name == name && source.quantity == quantity) return summary_of(source);
    }
    return NavSummary{};
  };
  EXPECT_EQ(summary("/sensor/dvl_velocity", NavQuantity::kVelocity).samples, 834U);
  EXPECT_EQ(summary("/sensor/dvl_velocity", NavQuantity::kVelocity).invalid, 13U);
  EXPECT_EQ(summary("/sensor/dvl_position", NavQuantity::kPosition).samples, 427U);
  EXPECT_EQ(summary("/sensor/attitude", NavQuantity::kAttitude).samples, 1498U);
  EXPECT_EQ(summary("/sensor/depth_temperature", NavQuantity::kDepth).samples, 1412U);
  const auto path_of_vehicle = nav_trajectory(bag->nav.log);
  ASSERT_TRUE(path_of_vehicle);
  // It moves to its left along the net, 15 m in all, at one depth.
  const auto& poses = path_of_vehicle->trajectory.poses();
  const Eigen::Vector3d early = poses[40].map_from_body.translation(), late = poses[400].map_from_body.translation();
  const Eigen::Vector3d left = poses[40].map_from_body.rotation().col(1);
  EXPECT_GT((late - early).dot(left), 11.0);
  EXPECT_NEAR((late - early).z(), 0.0, 0.4);
}

TEST(BagRecordings, ADvlA50) {
  for (const auto& [name, reports, valid] :
       {std::tuple("dvl_slow_rectangle.bag", 457U, 407U), std::tuple("dvl_circle.bag", 378U, 303U)}) {
    const std::string path = recording(std::string("dvl-a50/") + name);
    if (path.empty()) GTEST_SKIP() << "no recording";
    const auto nav = read_nav(*ByteStream::open(path));
    ASSERT_TRUE(nav);
    // Velocity and range as its driver sends them, and as the device says them itself.
    ASSERT_THAT(nav->log.sources(), SizeIs(4));
    const NavSource* own = nullptr;
    const NavSource* sent = nullptr;
    for (const NavSource& source : nav->log.sources()) {
      if (source.quantity != NavQuantity::kVelocity) continue;
      const NavSummary summary = summary_of(source);
      EXPECT_EQ(summary.samples, reports);
      EXPECT_EQ(summary.samples - summary.invalid, valid);
      (source.name == "/dvl/json_data" ? own : sent) = &source;
    }
    ASSERT_TRUE(own != nullptr && sent != nullptr);
    for (const NavSample& sample : own->samples) {
      if (!sample.valid) continue;
      const auto same =
          std::ranges::find_if(sent->samples, [&](const NavSample& s) { return s.value == sample.value; });
      ASSERT_NE(same, sent->samples.end());
      // By the README: what the device held back before it sent it.
      const double late_s = same->time_s - sample.time_s;
      ASSERT_GT(late_s, 0.09);
      ASSERT_LT(late_s, name == std::string("dvl_circle.bag") ? 4.7 : 0.4);
    }
  }
}

TEST(BagRecordings, McapOfOtherWriters) {
  if (recording("mcap-samples/rosbag2_part_0.mcap").empty()) GTEST_SKIP() << "no recording";
  const auto bag = read_bag(*ByteStream::open(recording("mcap-samples/rosbag2_part_0.mcap")));
  ASSERT_TRUE(bag);
  std::size_t messages = 0;
  for (const BagTopicSummary& topic : bag->topics) messages += topic.messages;
  EXPECT_EQ(messages, 15U);
  for (const char* name : {"none", "lz4", "zstd"}) {
    const auto file = read_file(recording(std::string("mcap-samples/ours_chunk_") + name + ".mcap"));
    ASSERT_TRUE(file);
    for (const std::size_t cut : {0U, 8U, 40U, 300U}) {
      const auto end = file->bytes.end() - static_cast<std::ptrdiff_t>(cut);
      EXPECT_THAT(all_beams({"cut.mcap", {file->bytes.begin(), end}}).items, SizeIs(3)) << name << " without " << cut;
    }
  }
}

}  // namespace
}  // namespace pingvox
