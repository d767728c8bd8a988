#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <utility>

#include "pingvox/io/bag.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "support/bag_writer.hpp"
#include "support/folder.hpp"
#include "support/logs.hpp"

namespace pingvox {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

/// An SQLite database in a temporary folder, which is removed with it.
class Database {
 public:
  Database() {
    sqlite3_open(file().c_str(), &database_);
    run("PRAGMA page_size=512");
  }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;
  ~Database() { close(); }

  void run(const std::string& sql) {
    EXPECT_EQ(sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(database_);
  }
  void close() { sqlite3_close(std::exchange(database_, nullptr)); }
  /// Goes on in another file of the folder.
  void begin(const std::string& name) {
    close();
    sqlite3_open(folder_.path(name).c_str(), &database_);
  }

  std::string folder() const { return folder_.path().string(); }
  std::string file() const { return folder_.path("dive_0.db3"); }

 private:
  const test::Folder folder_;
  sqlite3* database_ = nullptr;
};

void add_topics(Database& database) {
  database.run(
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT, "
      "offered_qos_profiles TEXT)");
  database.run("INSERT INTO topics VALUES(1, '/echo', 'ping360_sonar_msgs/msg/SonarEcho', 'cdr', '')");
}

/// @param hex  of a message
void add_messages(Database& database, int count, std::string_view hex) {
  for (int i = 0; i < count; ++i) {
    database.run(fmt::format("INSERT INTO messages(topic_id, timestamp, data) VALUES(1, {}, x'{}')",
                             1'000'500'000'000 + i, hex));
  }
}

void add_echoes(Database& database, int count, std::string_view hex = bags::kSonarEcho) {
  add_topics(database);
  database.run("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)");
  add_messages(database, count, hex);
}

std::string hex_of(const bags::Bytes& bytes) {
  std::string hex;
  for (const std::uint8_t byte : bytes) hex += fmt::format("{:02x}", byte);
  return hex;
}

ReadResult<Beam> beams_in(const std::string& path) {
  return read_everything<Beam>(
      ByteStream::open(path).and_then([](ByteStream stream) { return open_beams(std::move(stream)); }));
}

std::size_t files_in(const std::string& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
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
  for (const std::string& path : {database.file(), database.folder(), "/" + database.file()}) {
    SCOPED_TRACE(path);
    auto stream = ByteStream::open(path);
    ASSERT_TRUE(stream) << stream.error().message;
    EXPECT_THAT(*stream->path(), testing::EndsWith(database.file()));
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

// Kills values that no file holds: 12 KB filled the memory.
TEST(SqliteBag, RefusesColumnsThatAreComputed) {
  for (const char* data : {"BLOB GENERATED ALWAYS AS (zeroblob(200000000)) VIRTUAL", "BLOB AS (zeroblob(9)) STORED"}) {
    SCOPED_TRACE(data);
    Database database;
    add_topics(database);
    database.run(fmt::format(
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data {})", data));
    database.run("INSERT INTO messages(topic_id, timestamp) VALUES(1, 1000500000000)");
    database.close();
    EXPECT_THAT(beams_in(database.file()).error, HasSubstr("holds no ROS messages in ordinary tables"));
  }
}

// Kills definitions that take a gigabyte each.
TEST(SqliteBag, ReadsNoDefinitionsThatAreComputed) {
  Database database;
  add_topics(database);
  database.run("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)");
  database.run(
      "CREATE TABLE message_definitions(topic_type TEXT, encoding TEXT, encoded_message_definition TEXT AS "
      "('float64 depth'))");
  database.run("INSERT INTO message_definitions VALUES('lab_msgs/msg/Depth', 'ros2msg')");
  database.run("UPDATE topics SET type = 'lab_msgs/msg/Depth'");
  add_messages(database, 3, "0001000000000000");
  database.close();
  const auto bag =
      ByteStream::open(database.file()).and_then([](ByteStream stream) { return read_bag(std::move(stream)); });
  ASSERT_TRUE(bag) << bag.error().message;
  ASSERT_THAT(bag->topics, SizeIs(1));
  EXPECT_EQ(bag->topics[0].messages, 3U);
  EXPECT_EQ(bag->topics[0].fields, "");
}

TEST(SqliteBag, RefusesVirtualTables) {
  Database database;
  add_topics(database);
  sqlite3* probe = nullptr;
  sqlite3_open(":memory:", &probe);
  const bool has_fts =
      sqlite3_exec(probe, "CREATE VIRTUAL TABLE probe USING fts5(a)", nullptr, nullptr, nullptr) == SQLITE_OK;
  sqlite3_close(probe);
  if (!has_fts) GTEST_SKIP() << "this SQLite has no fts5";
  database.run("CREATE VIRTUAL TABLE messages USING fts5(topic_id, timestamp, data)");
  database.close();
  EXPECT_THAT(beams_in(database.file()).error, HasSubstr("holds no ROS messages"));
}

// Kills messages in the log of changes that are left out without a word, and files that are left beside a recording.
TEST(SqliteBag, ReadsALogOfChangesAndLeavesNothingBesideIt) {
  Database database;
  database.run("PRAGMA journal_mode=WAL");
  add_echoes(database, 30);
  const std::string copy = database.folder() + "/copy";
  std::filesystem::create_directory(copy);
  for (const char* suffix : {"", "-wal"}) {
    std::filesystem::copy_file(database.file() + suffix, copy + "/dive_0.db3" + suffix);
  }
  const auto before = read_file(copy + "/dive_0.db3-wal");
  ASSERT_TRUE(before);
  ASSERT_FALSE(before->bytes.empty());
  for (const std::string& path : {copy, copy + "/dive_0.db3"}) {
    const auto read = beams_in(path);
    EXPECT_EQ(read.error, "");
    EXPECT_THAT(read.items, SizeIs(30));
  }
  EXPECT_EQ(files_in(copy), 2U);
  EXPECT_EQ(read_file(copy + "/dive_0.db3-wal")->bytes, before->bytes);
  // The recorder is still at work, and has memory shared beside it.
  EXPECT_THAT(beams_in(database.file()).items, SizeIs(30));
  EXPECT_EQ(files_in(database.folder()), 4U) << "with the folder of copies";
  add_messages(database, 5, bags::kSonarEcho);
  EXPECT_THAT(beams_in(database.file()).items, SizeIs(35));
}

// Kills a recording in WAL mode that cannot be read from a pipe.
TEST(SqliteBag, ReadsTheBytesOfAFileInWalMode) {
  Database database;
  database.run("PRAGMA journal_mode=WAL");
  add_echoes(database, 30);
  database.close();
  const auto read = all_beams(*read_file(database.file()));
  EXPECT_EQ(read.error, "");
  EXPECT_THAT(read.items, SizeIs(30));
}

// rosbag2's compression mode MESSAGE: the bag was one "without beams".
TEST(SqliteBag, ReadsMessagesThatAreCompressedOneByOne) {
  Database database;
  const bags::Bytes packed = bags::packed("zstd", from_hex(bags::kSonarEcho));
  add_echoes(database, 3, hex_of(packed));
  add_messages(database, 1, bags::kSonarEcho);
  // One that is cut, and one that unpacks to more than a file of this size can.
  add_messages(database, 1, hex_of(bags::Bytes(packed.begin(), packed.end() - 4)));
  add_messages(database, 1, hex_of(bags::packed("zstd", bags::Bytes(150'000'000))));
  database.close();
  const auto source = open_beams(*ByteStream::open(database.file()));
  ASSERT_TRUE(source) << source.error().message;
  std::size_t beams = 0;
  while (const auto beam = (*source)->next()) {
    if (!*beam) break;
    ++beams;
    EXPECT_THAT((*beam)->intensities, testing::ElementsAre(0, 10, 64, 255));
  }
  EXPECT_EQ(beams, 4U);
  ASSERT_THAT((*source)->damage(), SizeIs(2));
  EXPECT_EQ((*source)->damage()[0].what, "damaged compressed message");
  EXPECT_EQ((*source)->damage()[1].what, "unpacks to more than its file can be");
}

/// A folder of dive_0.db3 with two messages and dive_1.db3 with three.
void add_two_files(Database& database) {
  add_echoes(database, 2);
  database.begin("dive_1.db3");
  std::string other(bags::kSonarEcho);
  other.back() = 'e';
  add_echoes(database, 3, other);
  database.close();
}

void write_metadata(const Database& database, const std::string& files) {
  std::ofstream(database.folder() + "/metadata.yaml")
      << "rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:" << files << "\n  duration:\n"
      << "    nanoseconds: 1\n";
}

// Kills a long recording, which rosbag2 splits, of which a part is read, or in another order.
TEST(SqliteBag, AFolderOfSeveralFilesIsReadInTheirOrder) {
  Database database;
  add_two_files(database);
  const auto series = beams_in(database.folder());
  EXPECT_EQ(series.error, "");
  EXPECT_THAT(series.items, SizeIs(5));
  EXPECT_EQ(series.items.at(1).intensities.back(), 255);
  EXPECT_EQ(series.items.at(2).intensities.back(), 254);

  std::filesystem::rename(database.folder() + "/dive_1.db3", database.folder() + "/late_7.db3");
  EXPECT_THAT(beams_in(database.folder()).error, HasSubstr("is a folder of 2 bags: name them one by one"));
  for (const char* files : {"\n    - late_7.db3\n    - dive_0.db3", " [late_7.db3, \"dive_0.db3\"]"}) {
    SCOPED_TRACE(files);
    write_metadata(database, files);
    const auto listed = beams_in(database.folder());
    EXPECT_EQ(listed.error, "");
    ASSERT_THAT(listed.items, SizeIs(5));
    EXPECT_EQ(listed.items[0].intensities.back(), 254) << "the late file comes first";
    EXPECT_EQ(listed.items[3].intensities.back(), 255);
  }
  write_metadata(database, "\n    - dive_0.db3\n    - late_7.db3\n    - dive_2.db3");
  EXPECT_THAT(beams_in(database.folder()).error, HasSubstr("lacks dive_2.db3, which its metadata.yaml lists"));
}

TEST(SqliteBag, SeveralFilesAreOneBagToInfoAndNavigationToo) {
  Database database;
  add_two_files(database);
  const auto bag =
      ByteStream::open(database.folder()).and_then([](ByteStream stream) { return read_bag(std::move(stream)); });
  ASSERT_TRUE(bag) << bag.error().message;
  ASSERT_THAT(bag->topics, SizeIs(1));
  EXPECT_EQ(bag->topics[0].messages, 5U);
  const auto stream = ByteStream::open(database.folder());
  ASSERT_TRUE(stream);
  EXPECT_EQ(stream->path(), database.folder());
  EXPECT_THAT(read_file(database.folder()).error().message, HasSubstr("is a bag of 2 files"));
}

TEST(SqliteBag, AFolderOfOtherBagsIsNotOne) {
  Database database;
  add_echoes(database, 1);
  std::ofstream(database.folder() + "/dive_1.mcap") << "x";
  EXPECT_THAT(ByteStream::open(database.folder()).error().message, HasSubstr("2 bags"));
  std::filesystem::rename(database.folder() + "/dive_1.mcap", database.folder() + "/dive_2.db3");
  EXPECT_THAT(ByteStream::open(database.folder()).error().message, HasSubstr("2 bags")) << "the second one is missing";
  std::filesystem::rename(database.folder() + "/dive_2.db3", database.folder() + "/dive_2.db3.zstd");
  std::filesystem::rename(database.folder() + "/dive_0.db3", database.folder() + "/dive_0.db3.zstd");
  EXPECT_THAT(ByteStream::open(database.folder()).error().message,
              HasSubstr("files are compressed as a whole (dive_0.db3.zstd): unpack them first"));
}

}  // namespace
}  // namespace pingvox
