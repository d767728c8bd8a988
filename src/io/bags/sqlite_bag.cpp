#include <fmt/core.h>
#include <sqlite3.h>

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <memory>
#include <system_error>
#include <utility>

#include "io/bags/bag.hpp"
#include "io/bytes/byte_reader.hpp"
#include "io/bytes/text.hpp"
#include "io/internal/frame_finder.hpp"

namespace pingvox {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::string_view kSqliteMagic("SQLite format 3\0", 16);

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

/// How the changes in a database's write-ahead log are read without writing anything beside it.
enum class ChangeLog {
  kNone,    ///< there are none
  kShared,  ///< with the locks of a recorder that may be at work
  kAlone,   ///< without locks: nobody has the database open
};

/// 0: there is no such file.
std::uint64_t size_of(const std::string& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  return error ? 0 : size;
}

ChangeLog change_log_of(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path + "-wal", error)) return ChangeLog::kNone;
  // Whoever writes shares memory by this file.
  if (std::filesystem::exists(path + "-shm", error)) return ChangeLog::kShared;
  return size_of(path + "-wal") > 0 ? ChangeLog::kAlone : ChangeLog::kNone;
}

/// Name for sqlite3_open_v2.
std::string uri_of(const std::string& path, ChangeLog changes) {
  // Two slashes after the colon are followed by an authority, which is empty.
  std::string uri = path.starts_with('/') ? "file://" : "file:";
  for (const char c : path) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '/' ||
                          c == '.' || c == '-' || c == '_';
    uri += is_plain ? std::string(1, c) : fmt::format("%{:02x}", static_cast<unsigned char>(c));
  }
  return uri + (changes == ChangeLog::kNone     ? "?immutable=1"
                : changes == ChangeLog::kShared ? "?readonly_shm=1"
                                                : "?vfs=unix-none");
}

/// Limits what a damaged or malicious file can do: it can neither write nor call anything, and no value is larger than
/// the file.
void set_limits(sqlite3* database, std::uint64_t size) {
  constexpr std::uint64_t kMaxLength = std::uint64_t{1} << 28, kMinLength = 4096;
  sqlite3_limit(database, SQLITE_LIMIT_LENGTH, static_cast<int>(std::clamp(size, kMinLength, kMaxLength)));
  for (const int forbidden :
       {SQLITE_DBCONFIG_TRUSTED_SCHEMA, SQLITE_DBCONFIG_ENABLE_TRIGGER, SQLITE_DBCONFIG_ENABLE_VIEW}) {
    sqlite3_db_config(database, forbidden, 0, nullptr);
  }
  // Without the last one SQLite refuses a file that is shorter than its header says; it has no effect together with
  // SQLITE_DBCONFIG_DEFENSIVE, which only forbids what writes.
  for (const int wanted : {SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, SQLITE_DBCONFIG_WRITABLE_SCHEMA}) {
    sqlite3_db_config(database, wanted, 1, nullptr);
  }
  sqlite3_drop_modules(database, nullptr);  // those of virtual tables
  sqlite3_exec(database, "PRAGMA cell_size_check=ON", nullptr, nullptr, nullptr);
}

class SqliteBag final : public Bag {
  /// Steps of SQLite's machine: a row of 16 bytes or more takes some ten.
  static constexpr std::uint64_t kFreeSteps = 10'000'000, kStepsPerByte = 4;
  static constexpr int kCountedSteps = 1000;

 public:
  SqliteBag(std::string name, FileBytes held, Database database, std::uint64_t size)
      : name_(std::move(name)),
        held_(std::move(held)),
        database_(std::move(database)),
        size_(size),
        steps_left_(kFreeSteps + kStepsPerByte * size) {
    const auto count = [](void* left) -> int {
      auto& steps = *static_cast<std::uint64_t*>(left);
      if (steps < kCountedSteps) return 1;
      steps -= kCountedSteps;
      return 0;
    };
    sqlite3_progress_handler(database_.get(), kCountedSteps, count, &steps_left_);
  }

  const std::string& name() const override { return name_; }
  std::optional<double> share_read() const override {
    return last_row_ > 0 ? std::optional(std::clamp(static_cast<double>(row_) / last_row_, 0.0, 1.0)) : std::nullopt;
  }

  Result<void> start() {
    const auto refuse = [&](std::string_view what) {
      return fail(Error::Code::kUnsupported, fmt::format("{}: is an SQLite database {}", name_, what));
    };
    if (!has_columns("topics", {"id", "name", "type", "serialization_format"}) ||
        !has_columns("messages", {"topic_id", "timestamp", "data"})) {
      return no_tables();
    }
    if (const Query last = query_of(database_.get(), "SELECT max(rowid) FROM messages");
        last && sqlite3_step(last.get()) == SQLITE_ROW) {
      last_row_ = static_cast<double>(sqlite3_column_int64(last.get(), 0));
    }
    std::map<std::string, std::shared_ptr<const RosLayout>> layouts;
    if (has_columns("message_definitions", {"topic_type", "encoding", "encoded_message_definition"})) {
      const Query query = query_of(database_.get(),
                                   "SELECT topic_type, encoded_message_definition FROM message_definitions NOT "
                                   "INDEXED WHERE encoding = 'ros2msg'");
      while (query && has_row(query.get())) {
        const std::string type = text_in(query.get(), 0);
        layouts[type] = shared_layout(type, text_in(query.get(), 1), RosEncoding::kCdr);
      }
    }
    const Query query =
        query_of(database_.get(), "SELECT id, name, type, serialization_format FROM topics NOT INDEXED");
    if (!query) return refuse("with other columns than those of ROS");
    while (has_row(query.get())) {
      numbers_.try_emplace(sqlite3_column_int64(query.get(), 0), topics_.size());
      const std::string encoding = text_in(query.get(), 3);
      BagTopic topic{text_in(query.get(), 1), text_in(query.get(), 2), {}, RosEncoding::kCdr, encoding == "cdr"};
      if (!topic.is_readable) topic.other_encoding = printable(encoding);
      if (const auto layout = layouts.find(topic.type); layout != layouts.end()) topic.layout = layout->second;
      topics_.push_back(std::move(topic));
    }
    messages_ = query_of(database_.get(), "SELECT topic_id, timestamp, data, rowid FROM messages NOT INDEXED");
    if (!messages_) return refuse("with other columns than those of ROS");
    return {};
  }

 private:
  Result<std::optional<BagMessage>> read() override {
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
      return BagMessage{topic->second, time_s, time_s, {data, static_cast<std::size_t>(size)}, std::nullopt};
    }
    messages_.reset();
    return std::nullopt;
  }

  /// Whether a query gives one more row; damage ends it.
  bool has_row(sqlite3_stmt* query) {
    // More than the file has room for are pages that are read over and over.
    const int result = read_ > size_ ? SQLITE_CORRUPT : sqlite3_step(query);
    if (result == SQLITE_ROW) {
      constexpr std::uint64_t kMinRow = 4;
      read_ += kMinRow;
      for (int column = 0; column < sqlite3_column_count(query); ++column) {
        const int type = sqlite3_column_type(query, column);
        if (type == SQLITE_TEXT || type == SQLITE_BLOB) {
          read_ += static_cast<std::uint64_t>(sqlite3_column_bytes(query, column));
        }
      }
      return true;
    }
    if (result != SQLITE_DONE) add_damage(damage_, "damaged database page", std::nullopt);
    return false;
  }

  /// Whether these are columns of an ordinary table that are stored: what computes them (a view, a generated column, a
  /// virtual table) may have no end.
  bool has_columns(std::string_view table, std::initializer_list<std::string_view> columns) const {
    constexpr int kName = 1, kHidden = 6;
    const Query query = query_of(database_.get(), fmt::format("PRAGMA table_xinfo({})", table).c_str());
    std::size_t found = 0;
    while (query && sqlite3_step(query.get()) == SQLITE_ROW) {
      const bool is_wanted = std::ranges::find(columns, text_in(query.get(), kName)) != columns.end();
      if (is_wanted && sqlite3_column_int(query.get(), kHidden) == 0) ++found;
    }
    return found == columns.size();
  }

  /// After tables were looked for in vain.
  tl::unexpected<Error> no_tables() const {
    const int error = sqlite3_errcode(database_.get());
    if (error == SQLITE_OK || error == SQLITE_ERROR || error == SQLITE_DONE) {
      return fail(
          Error::Code::kUnsupported,
          fmt::format("{}: is an SQLite database that holds no ROS messages in ordinary tables topics and messages",
                      name_));
    }
    const bool is_damage = error == SQLITE_CORRUPT || error == SQLITE_NOTADB || error == SQLITE_INTERRUPT;
    return fail(is_damage ? Error::Code::kCorrupt : Error::Code::kIo,
                fmt::format("{}: cannot be read: {}", name_,
                            error == SQLITE_INTERRUPT ? "its tables take more steps than its size explains"
                                                      : printable(sqlite3_errmsg(database_.get()))));
  }

  std::string name_;
  FileBytes held_;  ///< the database, when it is in memory
  Database database_;
  std::uint64_t size_;
  std::map<std::int64_t, std::size_t> numbers_;  ///< of topics
  Query messages_;
  std::uint64_t read_ = 0;  ///< bytes of all rows
  std::uint64_t steps_left_;
  bool in_damage_ = false;
  double row_ = 0.0, last_row_ = 0.0;
};

}  // namespace

bool looks_like_sqlite(Bytes beginning) {
  return text_of(beginning).starts_with(kSqliteMagic);
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
    const ChangeLog changes = change_log_of(*path);
    const std::string uri = uri_of(*path, changes);
    result = sqlite3_open_v2(uri.c_str(), &opened, kFlags | SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    size = size_of(*path) + (changes == ChangeLog::kNone ? 0 : size_of(*path + "-wal"));
    // Then no memory is shared, which would take a file.
    if (changes == ChangeLog::kAlone) {
      sqlite3_exec(opened, "PRAGMA locking_mode=EXCLUSIVE", nullptr, nullptr, nullptr);
    }
  } else {
    // Its pages are not in order: a pipe has to be read as a whole.
    Result<FileBytes> whole = ByteStream::whole(std::move(stream));
    if (!whole) return tl::unexpected(whole.error());
    held = *std::move(whole);
    size = held.bytes.size();
    // Memory has no write-ahead log: its mark says that there may be one.
    constexpr std::size_t kWriteVersion = 18, kReadVersion = 19;
    if (size > kReadVersion) held.bytes[kWriteVersion] = held.bytes[kReadVersion] = 1;
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
  set_limits(opened, size);
  auto bag = std::make_unique<SqliteBag>(name, std::move(held), std::move(database), size);
  if (const Result<void> started = bag->start(); !started) {
    Error error = started.error();
    if (error.code == Error::Code::kIo && path) error.message += ", with the log of changes beside it (-wal)";
    return tl::unexpected(std::move(error));
  }
  return bag;
}

}  // namespace pingvox
