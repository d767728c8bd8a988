#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "io/bags/bag.hpp"
#include "io/bags/unpack.hpp"
#include "io/beams/stream_reader.hpp"
#include "io/bytes/byte_reader.hpp"
#include "io/bytes/text.hpp"
#include "io/internal/frame_finder.hpp"

namespace pingvox {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::string_view kBagMagic = "#ROSBAG V2.0\n";
constexpr std::uint8_t kBagMessage = 2, kBagHeader = 3, kIndex = 4, kBagChunk = 5, kChunkInfo = 6, kConnection = 7;
constexpr std::size_t kMaxHeader = 65'536;

/// The fields of a record header that are needed.
struct RecordHeader {
  std::uint8_t op = 0;
  std::uint32_t connection = 0, size = 0, count = 0;
  std::uint32_t time_s = 0, time_ns = 0;
  std::uint64_t index_at = 0;  ///< of the index in the file; 0: the bag was not closed
  std::string_view compression, topic, type, definition;
};

template <class T>
bool take_number(Bytes value, T& number) {
  if (value.size() != sizeof(T)) return false;
  number = value_from<T>(value, std::endian::little);
  return true;
}

/// Reads fields: u32 length, "name=value". false: they do not fill the bytes, or one has another size than it must
/// have.
bool read_fields(Bytes bytes, RecordHeader& header) {
  ByteReader reader(bytes);
  while (reader.left() > 0) {
    const auto length = reader.read<std::uint32_t>();
    const auto field = length ? reader.take(*length) : std::nullopt;
    if (!field) return false;
    const std::string_view text = text_of(*field);
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos) return false;
    const std::string_view name = text.substr(0, equals), value_text = text.substr(equals + 1);
    const Bytes value = field->subspan(equals + 1);
    bool fits = true;
    if (name == "op") {
      fits = take_number(value, header.op);
    } else if (name == "conn") {
      fits = take_number(value, header.connection);
    } else if (name == "size") {
      fits = take_number(value, header.size);
    } else if (name == "count") {
      fits = take_number(value, header.count);
    } else if (name == "time") {
      fits = value.size() == 8 && take_number(value.first(4), header.time_s) &&
             take_number(value.subspan(4), header.time_ns);
    } else if (name == "index_pos") {
      fits = take_number(value, header.index_at);
    } else if (name == "compression") {
      header.compression = value_text;
    } else if (name == "topic") {
      header.topic = value_text;
    } else if (name == "type") {
      header.type = value_text;
    } else if (name == "message_definition") {
      header.definition = value_text;
    }
    if (!fits) return false;
  }
  return true;
}

/// A record: header and data, each behind its length.
struct Record {
  RecordHeader header;
  std::size_t data_at = 0;  ///< from its beginning
  std::uint32_t data = 0;
};

/// The record that begins here, its data need not be there; nullopt: there is none, or its header is cut.
std::optional<Record> record_in(Bytes bytes) {
  ByteReader reader(bytes);
  const auto length = reader.read<std::uint32_t>();
  if (!length || *length > kMaxHeader) return std::nullopt;
  const auto fields = reader.take(*length);
  const auto data = fields ? reader.read<std::uint32_t>() : std::nullopt;
  Record record;
  if (!data || !read_fields(*fields, record.header) || record.header.op == 0) return std::nullopt;
  record.data_at = reader.position();
  record.data = *data;
  return record;
}

std::optional<Compression> compression_of(const RecordHeader& header) {
  if (header.compression == "none") return Compression::kNone;
  if (header.compression == "bz2") return Compression::kBz2;
  if (header.compression == "lz4") return Compression::kLz4;
  return std::nullopt;
}

/// Whether the data can be as long as the record says.
bool has_possible_length(const Record& record) {
  constexpr std::uint64_t kIndexEntry = 12, kInfoEntry = 8, kMaxRecordHeader = 65'536;
  const std::uint64_t length = record.data;
  switch (record.header.op) {
    case kIndex:
      return length == kIndexEntry * record.header.count;
    case kChunkInfo:
      return length == kInfoEntry * record.header.count;
    case kBagHeader:
      return length <= kMaxRecordHeader;
    default:
      return length <= kMaxChunk;
  }
}

bool is_chunk(Bytes bytes) {
  constexpr std::uint32_t kMaxChunkHeader = 256;  // that of a chunk has some 50 bytes
  const auto length = ByteReader(bytes).read<std::uint32_t>();
  if (!length || *length > kMaxChunkHeader) return false;
  const std::optional<Record> record = record_in(bytes);
  return record && record->header.op == kBagChunk && compression_of(record->header) && record->data <= kMaxChunk;
}

/// Where the next chunk may begin, behind the first byte; nullopt: not in these bytes.
std::optional<std::size_t> next_bag_chunk(Bytes bytes) {
  constexpr std::string_view kOp = "op=\x05";
  constexpr std::size_t kMaxOffset = 64;  // of this field from the beginning of the record
  const std::string_view text = text_of(bytes);
  for (std::size_t op = text.find(kOp); op != std::string_view::npos; op = text.find(kOp, op + 1)) {
    for (std::size_t back = 8; back <= std::min(op - 1, kMaxOffset) && op > 8; ++back) {
      if (is_chunk(bytes.subspan(op - back))) return op - back;
    }
  }
  return std::nullopt;
}

class Ros1Bag final : public Bag {
 public:
  explicit Ros1Bag(StreamReader reader) : reader_(std::move(reader)) {}

  const std::string& name() const override { return reader_.name(); }
  std::optional<double> share_read() const override { return reader_.share_read(); }

 private:
  Result<std::optional<BagMessage>> read() override {
    for (;;) {
      if (!rest_.empty()) {
        if (std::optional<BagMessage> message = next_in_chunk()) return message;
        continue;
      }
      reader_.skip(std::exchange(held_, 0));
      const Result<bool> more = read_record();
      if (!more) return tl::unexpected(more.error());
      if (!*more) return std::nullopt;
    }
  }

  /// The next message of the chunk; nullopt: another record, or the end of the chunk.
  std::optional<BagMessage> next_in_chunk() {
    const std::uint64_t at = is_packed_ ? chunk_at_ : chunk_at_ + (chunk_size_ - rest_.size());
    const std::optional<Record> record = record_in(rest_);
    if (!is_packed_ && record && record->header.op == kBagChunk && is_chunk(rest_)) {
      // The length of the chunk before it was wrong.
      add_damage(damage_, "damaged record", at);
      held_ -= rest_.size();
      rest_ = {};
      return std::nullopt;
    }
    if (!record || record->data > rest_.size() - record->data_at) {
      // In a chunk that was cut or could not be unpacked, this is not one more damage.
      if (!is_cut_) add_damage(damage_, "damaged record", at);
      if (!is_packed_) give_back_next_chunk(rest_);
      rest_ = {};
      return std::nullopt;
    }
    const Bytes data = rest_.subspan(record->data_at, record->data);
    rest_ = rest_.subspan(record->data_at + record->data);
    return take(record->header, data, at);
  }

  /// A message; nullopt: another record.
  std::optional<BagMessage> take(const RecordHeader& header, Bytes data, std::uint64_t at) {
    if (header.op == kConnection) add_connection(header, data, at);
    if (header.op != kBagMessage) return std::nullopt;
    if (!connections_.contains(header.connection)) read_index();
    const auto topic = connections_.find(header.connection);
    if (topic == connections_.end()) {
      add_damage(damage_, "message of an unknown topic", at);
      return std::nullopt;
    }
    const double time_s = header.time_s + header.time_ns * 1e-9;
    return BagMessage{topic->second, time_s, time_s, data, at};
  }

  void add_connection(const RecordHeader& header, Bytes data, std::uint64_t at) {
    RecordHeader about;
    if (!read_fields(data, about)) {
      add_damage(damage_, "damaged record", at);
      return;
    }
    if (!connections_.try_emplace(header.connection, topics_.size()).second) return;
    topics_.push_back({std::string(header.topic), std::string(about.type),
                       shared_layout(about.type, about.definition, RosEncoding::kRos1), RosEncoding::kRos1, true});
  }

  /// Each connection stands in one chunk, which may be damaged, and once more in the index at the end of the file. Of a
  /// pipe, and of a bag that was not closed, nothing is read.
  void read_index() {
    constexpr std::size_t kBlock = std::size_t{1} << 20;
    if (index_at_ == 0) return;
    std::vector<std::uint8_t> block(kBlock);
    for (std::uint64_t at = std::exchange(index_at_, 0);;) {
      // An error of the operating system comes again when reading gets there.
      const std::size_t size = reader_.read_at(at, block).value_or(0);
      Bytes rest = Bytes(block).first(size);
      for (;;) {
        const std::optional<Record> record = record_in(rest);
        if (!record || record->header.op != kConnection || record->data > rest.size() - record->data_at) break;
        add_connection(record->header, rest.subspan(record->data_at, record->data), at + (size - rest.size()));
        rest = rest.subspan(record->data_at + record->data);
      }
      if (rest.size() == size) return;
      at += size - rest.size();
    }
  }

  /// Reads a record of the file, and opens it when it is a chunk. @return false at the end of the file
  Result<bool> read_record() {
    constexpr std::size_t kUsual = 1024;
    auto bytes = reader_.peek(kUsual);
    if (!bytes) return tl::unexpected(bytes.error());
    if (bytes->empty()) return false;
    std::optional<Record> record = record_in(*bytes);
    if (!record && bytes->size() == kUsual) {
      bytes = reader_.peek(kMaxHeader + 8);
      if (!bytes) return tl::unexpected(bytes.error());
      record = record_in(*bytes);
    }
    if (!record || !has_possible_length(*record)) return skip_damage();
    if (record->header.op == kBagChunk) return open_chunk(*record);
    if (record->header.op == kBagHeader) index_at_ = record->header.index_at;
    return pass_over(*record);
  }

  Result<bool> open_chunk(Record record) {
    const auto bytes = reader_.peek(record.data_at + record.data);
    if (!bytes) return tl::unexpected(bytes.error());
    record = *record_in(*bytes);  // its texts are in the bytes
    const Bytes data = bytes->subspan(record.data_at);
    is_cut_ = data.size() < record.data;
    const std::optional<Compression> compression = compression_of(record.header);
    chunk_at_ = reader_.position() + record.data_at;
    is_packed_ = compression != Compression::kNone;
    held_ = bytes->size();
    if (!compression) {
      add_damage(damage_, "unknown compression", reader_.position());
      return true;
    }
    if (is_cut_) add_damage(damage_, FrameFinder::kCutOff, reader_.position());
    if (is_cut_) give_back_next_chunk(data);
    rest_ = bytes->first(held_).subspan(record.data_at);
    if (is_packed_) {
      const auto [is_whole, packed, is_refused] = unpack(*compression, rest_, record.header.size, budget_, unpacked_);
      // What is packed ends by itself: with another chunk behind it, the length is wrong.
      const Bytes behind = data.subspan(is_whole ? packed : 0);
      if (!is_cut_ && (!is_whole || next_bag_chunk(behind))) {
        add_damage(damage_, is_refused ? kTooLargeUnpacked : "damaged chunk", reader_.position());
        give_back_next_chunk(behind);
      }
      is_cut_ = is_cut_ || !is_whole;
      rest_ = unpacked_;
    }
    chunk_size_ = rest_.size();
    return true;
  }

  /// Reads on at a chunk in the last bytes of what is held: its own chunk has a wrong length.
  void give_back_next_chunk(Bytes last) {
    if (const auto chunk = next_bag_chunk(last)) held_ -= last.size() - *chunk;
  }

  /// Skips a record of the index.
  Result<bool> pass_over(const Record& record) {
    const std::uint64_t at = reader_.position();
    std::uint64_t left = record.data_at + std::uint64_t{record.data};
    while (left > 0) {
      constexpr std::uint64_t kBlock = 65'536;
      const auto bytes = reader_.peek(static_cast<std::size_t>(std::min(left, kBlock)));
      if (!bytes) return tl::unexpected(bytes.error());
      if (bytes->empty()) {
        add_damage(damage_, FrameFinder::kCutOff, at);
        return false;
      }
      left -= bytes->size();
      reader_.skip(bytes->size());
    }
    return true;
  }

  /// There is no mark between records: the next thing that is one without doubt is a chunk.
  Result<bool> skip_damage() {
    constexpr std::size_t kBlock = std::size_t{1} << 18;
    add_damage(damage_, "damaged record", reader_.position());
    for (;;) {
      const auto bytes = reader_.peek(kBlock);
      if (!bytes) return tl::unexpected(bytes.error());
      if (const auto chunk = next_bag_chunk(*bytes)) {
        reader_.skip(*chunk);
        return true;
      }
      if (bytes->size() < kBlock) {
        reader_.skip(bytes->size());
        return false;
      }
      reader_.skip(kBlock - kMaxHeader);  // a header may be across the end of the block
    }
  }

  StreamReader reader_;
  std::unordered_map<std::uint32_t, std::size_t> connections_;
  std::vector<std::uint8_t> unpacked_;
  Bytes rest_;            ///< of the chunk
  std::size_t held_ = 0;  ///< bytes of the stream that the chunk takes
  std::size_t chunk_size_ = 0;
  std::uint64_t chunk_at_ = 0;  ///< its data in the file
  bool is_packed_ = false, is_cut_ = false;
  std::uint64_t index_at_ = 0;  ///< of the index, unless it was read or there is none
};

}  // namespace

bool looks_like_ros1_bag(Bytes beginning) {
  return text_of(beginning).starts_with(kBagMagic);
}

Result<std::unique_ptr<Bag>> open_ros1_bag(ByteStream stream) {
  StreamReader reader(std::move(stream));
  const auto magic = reader.peek(kBagMagic.size());
  if (!magic) return tl::unexpected(magic.error());
  reader.skip(magic->size());
  return std::make_unique<Ros1Bag>(std::move(reader));
}

}  // namespace pingvox
