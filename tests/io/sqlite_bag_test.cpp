#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <utility>

#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "support/bag_writer.hpp"
#include "support/logs.hpp"

namespace pingvox {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

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
    database.run(
        fmt::format("INSERT INTO messages VALUES({}, 1, {}, x'{}')", i + 1, 1'000'500'000'000 + i, bags::kSonarEcho));
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

TEST(SqliteBag, AFolderOfSeveralBagsIsNotOne) {
  Database database;
  add_echoes(database, 1);
  std::ofstream(database.folder() + "/dive_1.mcap") << "x";
  const auto stream = ByteStream::open(database.folder());
  ASSERT_FALSE(stream);
  EXPECT_THAT(stream.error().message, HasSubstr("2 bags"));
}

}  // namespace
}  // namespace pingvox
