#include <fmt/core.h>
#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <system_error>
#include <utility>

#include "io/bag.hpp"
#include "io/byte_reader.hpp"
#include "io/text.hpp"
#include "pingvox/io/frame_finder.hpp"

namespace pingvox {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::string_view kMagic("SQLite format 3\0", 16);

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close(database); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;

struct FinishQuery {
  void operator()(sqlite3_stmt* query) const { sqlite3_finalize(query); }
};
using Query = std::unique_ptr<sqlite3_stmt, FinishQuery>;

/// nullptr: it has no such table or columns.
Query query_of(sqlite3* database, const char* text) {
  sqlite3_stmt* query = nullptr;
  sqlite3_prepare_v2(database, text, -1, &query, nullptr);
  return Query(query);
}

std::string text_in(sqlite3_stmt* row, int column) {
  const unsigned char* text = sqlite3_column_text(row, column);
  if (text == nullptr) return {};
  return {reinterpret_cast<const char*>(text), static_cast<std::size_t>(sqlite3_column_bytes(row, column))};
}

/// Name for sqlite3_open_v2. A database beside which there is no log of changes is opened so that nothing is written
/// beside it.
std::string uri_of(const std::string& path) {
  // Two slashes after the colon are followed by an authority, which is empty.
  std::string uri = path.starts_with('/') ? "file://" : "file:";
  for (const char c : path) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '/' ||
                          c == '.' || c == '-' || c == '_';
    uri += is_plain ? std::string(1, c) : fmt::format("%{:02x}", static_cast<unsigned char>(c));
  }
  std::error_code error;
  return uri + (std::filesystem::exists(path + "-wal", error) ? "" : "?immutable=1");
}

/// Limits what a damaged or malicious file can do.
void set_limits(sqlite3* database) {
  sqlite3_limit(database, SQLITE_LIMIT_LENGTH, 1 << 28);
  sqlite3_db_config(database, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  // Nothing can be written; but without it SQLite refuses a file that is shorter than its header says.
  sqlite3_db_config(database, SQLITE_DBCONFIG_WRITABLE_SCHEMA, 1, nullptr);
  sqlite3_exec(database, "PRAGMA cell_size_check=ON", nullptr, nullptr, nullptr);
}

class SqliteBag final : public Bag {
 public:
  SqliteBag(std::string name, FileBytes held, Database database, std::uint64_t size)
      : name_(std::move(name)), held_(std::move(held)), database_(std::move(database)), size_(size) {}

  const std::string& name() const override { return name_; }
  std::optional<double> share_read() const override {
    return last_row_ > 0 ? std::optional(std::clamp(static_cast<double>(row_) / last_row_, 0.0, 1.0)) : std::nullopt;
  }

  Result<void> start() {
    const auto refuse = [&](std::string_view what) {
      return fail(Error::Code::kUnsupported, fmt::format("{}: is an SQLite database {}", name_, what));
    };
    // Real tables only: a view can be endless.
    const Query tables =
        query_of(database_.get(),
                 "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND rootpage > 0 AND name IN "
                 "('topics', 'messages')");
    constexpr int kWanted = 2;
    if (!tables || sqlite3_step(tables.get()) != SQLITE_ROW || sqlite3_column_int(tables.get(), 0) != kWanted) {
      return refuse("that holds no ROS messages, or is damaged at its beginning");
    }
    if (const Query last = query_of(database_.get(), "SELECT max(rowid) FROM messages");
        last && sqlite3_step(last.get()) == SQLITE_ROW) {
      last_row_ = static_cast<double>(sqlite3_column_int64(last.get(), 0));
    }
    std::map<std::string, std::shared_ptr<const RosLayout>> layouts;
    if (const Query query = query_of(database_.get(),
                                     "SELECT topic_type, encoded_message_definition FROM message_definitions WHERE "
                                     "encoding = 'ros2msg'")) {
      while (has_row(query.get())) {
        const std::string type = text_in(query.get(), 0);
        layouts[type] = shared_layout(type, text_in(query.get(), 1), RosEncoding::kCdr);
      }
    }
    const Query query = query_of(database_.get(), "SELECT id, name, type, serialization_format FROM topics");
    if (!query) return refuse("with other columns than those of ROS");
    while (has_row(query.get())) {
      numbers_.try_emplace(sqlite3_column_int64(query.get(), 0), topics_.size());
      BagTopic topic{
          text_in(query.get(), 1), text_in(query.get(), 2), {}, RosEncoding::kCdr, text_in(query.get(), 3) == "cdr"};
      if (const auto layout = layouts.find(topic.type); layout != layouts.end()) topic.layout = layout->second;
      topics_.push_back(std::move(topic));
    }
    messages_ = query_of(database_.get(), "SELECT topic_id, timestamp, data, rowid FROM messages NOT INDEXED");
    if (!messages_) return refuse("with other columns than those of ROS");
    return {};
  }

  Result<std::optional<BagMessage>> next() override {
    while (messages_ && has_row(messages_.get())) {
      sqlite3_stmt* row = messages_.get();
      row_ = static_cast<double>(sqlite3_column_int64(row, 3));
      // A page that the end of a file cuts has rows of nothing.
      const bool is_row = sqlite3_column_type(row, 0) == SQLITE_INTEGER &&
                          sqlite3_column_type(row, 1) == SQLITE_INTEGER && sqlite3_column_type(row, 2) == SQLITE_BLOB;
      if (!is_row && !in_damage_) add_damage(damage_, "damaged database page", std::nullopt);
      in_damage_ = !is_row;
      if (!is_row) continue;
      const auto topic = numbers_.find(sqlite3_column_int64(row, 0));
      if (topic == numbers_.end()) {
        add_damage(damage_, "message of an unknown topic", std::nullopt);
        continue;
      }
      const double time_s = seconds_of(sqlite3_column_int64(row, 1));
      const auto* data = static_cast<const std::uint8_t*>(sqlite3_column_blob(row, 2));
      const int size = data != nullptr ? sqlite3_column_bytes(row, 2) : 0;
      return BagMessage{topic->second, time_s, {data, static_cast<std::size_t>(size)}, std::nullopt};
    }
    messages_.reset();
    return std::nullopt;
  }

 private:
  /// Whether a query gives one more row; damage ends it.
  bool has_row(sqlite3_stmt* query) {
    // The smallest row takes four bytes: more of them are pages that are read over and over.
    const bool are_too_many = rows_ > size_ / 4;
    const int result = are_too_many ? SQLITE_CORRUPT : sqlite3_step(query);
    if (result == SQLITE_ROW) {
      ++rows_;
      return true;
    }
    if (result != SQLITE_DONE) add_damage(damage_, "damaged database page", std::nullopt);
    return false;
  }

  std::string name_;
  FileBytes held_;  ///< the database, when it is in memory
  Database database_;
  std::uint64_t size_;
  std::map<std::int64_t, std::size_t> numbers_;  ///< of topics
  Query messages_;
  std::uint64_t rows_ = 0;  ///< of all queries
  bool in_damage_ = false;
  double row_ = 0.0, last_row_ = 0.0;
};

}  // namespace

bool looks_like_sqlite(Bytes beginning) {
  return text_of(beginning).starts_with(kMagic);
}

Result<std::unique_ptr<Bag>> open_sqlite_bag(ByteStream stream) {
  const std::string name = stream.name();
  const std::optional<std::string> path = stream.path();
  sqlite3* opened = nullptr;
  FileBytes held;
  std::uint64_t size = 0;
  int result = SQLITE_OK;
  constexpr int kFlags = SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_PRIVATECACHE;
  if (path) {
    result = sqlite3_open_v2(uri_of(*path).c_str(), &opened, kFlags | SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    std::error_code error;
    size = std::filesystem::file_size(*path, error);
  } else {
    // Its pages are not in order: a pipe has to be read as a whole.
    Result<FileBytes> whole = ByteStream::whole(std::move(stream));
    if (!whole) return tl::unexpected(whole.error());
    held = *std::move(whole);
    size = held.bytes.size();
    result = sqlite3_open_v2(":memory:", &opened, kFlags | SQLITE_OPEN_READWRITE | SQLITE_OPEN_MEMORY, nullptr);
  }
  Database database(opened);
  if (result == SQLITE_OK && !path) {
    result = sqlite3_deserialize(opened, "main", held.bytes.data(), static_cast<sqlite3_int64>(size),
                                 static_cast<sqlite3_int64>(size), SQLITE_DESERIALIZE_READONLY);
  }
  if (result != SQLITE_OK) {
    return fail(Error::Code::kCorrupt, fmt::format("{}: cannot be opened: {}", name, sqlite3_errstr(result)));
  }
  set_limits(opened);
  auto bag = std::make_unique<SqliteBag>(name, std::move(held), std::move(database), size);
  if (const Result<void> started = bag->start(); !started) return tl::unexpected(started.error());
  return bag;
}

}  // namespace pingvox
