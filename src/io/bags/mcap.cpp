#include <zlib.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
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

constexpr std::array<std::uint8_t, 8> kMcapMagic = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
constexpr std::uint8_t kFooter = 2, kSchema = 3, kChannel = 4, kMcapMessage = 5, kMcapChunk = 6, kLastKnown = 15;
constexpr std::size_t kRecordHeader = 9;

std::optional<std::string_view> read_text(ByteReader& reader) {
  const auto length = reader.read<std::uint32_t>();
  const auto text = length ? reader.take(*length) : std::nullopt;
  if (!text) return std::nullopt;
  return text_of(*text);
}

struct ChunkHeader {
  std::uint64_t size = 0;  ///< unpacked
  std::uint32_t crc = 0;   ///< of the unpacked; 0: none
  std::string_view compression;
  std::uint64_t packed = 0;
  std::size_t data_at = 0;  ///< from the beginning of the chunk's body
};

/// What a writer that is killed leaves of the chunk at work: its length and sizes are written when it is ended.
bool is_open_chunk(Bytes body, std::uint64_t body_size) {
  constexpr std::uint64_t kLater = std::numeric_limits<std::uint64_t>::max();
  ByteReader reader(body);
  const auto start = reader.read<std::uint64_t>(), end = reader.read<std::uint64_t>();
  const auto size = reader.read<std::uint64_t>();
  const auto crc = reader.read<std::uint32_t>(), no_compression = reader.read<std::uint32_t>();
  const auto packed = reader.read<std::uint64_t>();
  const bool is_later = (body_size == 0 || body_size == kLater) && packed == body_size;
  return is_later && start && end && size == body_size && crc && no_compression == 0;
}
constexpr std::size_t kOpenChunkHeader = 8 + 8 + 8 + 4 + 4 + 8;
/// Writers end a chunk after some megabytes at most.
constexpr std::size_t kMaxOpenChunk = std::size_t{1} << 26;

/// The beginning of a chunk's body; nullopt: there is none.
std::optional<ChunkHeader> chunk_in(Bytes body, std::uint64_t body_size) {
  ByteReader reader(body);
  const auto start = reader.read<std::uint64_t>(), end = reader.read<std::uint64_t>();
  const auto size = reader.read<std::uint64_t>();
  const auto crc = reader.read<std::uint32_t>();
  if (!start || !end || !size || !crc) return std::nullopt;
  const auto compression = read_text(reader);
  const auto packed = compression ? reader.read<std::uint64_t>() : std::nullopt;
  if (!packed || body_size > kMaxChunk || *packed > body_size - reader.position()) return std::nullopt;
  return ChunkHeader{*size, *crc, *compression, *packed, reader.position()};
}

std::optional<Compression> compression_of(std::string_view name) {
  if (name.empty()) return Compression::kNone;
  if (name == "lz4") return Compression::kLz4;
  if (name == "zstd") return Compression::kZstd;
  return std::nullopt;
}

std::optional<RosEncoding> encoding_of(std::string_view name) {
  if (name == "ros1") return RosEncoding::kRos1;
  if (name == "cdr") return RosEncoding::kCdr;
  if (name == "json") return RosEncoding::kJson;
  return std::nullopt;
}

/// Where the next chunk may begin, behind the first byte; nullopt: not in these bytes.
std::optional<std::size_t> next_mcap_chunk(Bytes bytes) {
  for (std::size_t at = 1; at < bytes.size(); ++at) {
    if (bytes[at] != kMcapChunk || bytes.size() - at < kRecordHeader) continue;
    const auto length = value_from<std::uint64_t>(bytes.subspan(at + 1, 8), std::endian::little);
    const auto chunk = chunk_in(bytes.subspan(at + kRecordHeader), length);
    if (chunk && compression_of(chunk->compression) && chunk->data_at + chunk->packed == length) return at;
  }
  return std::nullopt;
}

bool has_crc(Bytes bytes, std::uint32_t crc) {
  return crc == 0 || ::crc32_z(0, bytes.data(), bytes.size()) == crc;
}

class Mcap final : public Bag {
 public:
  explicit Mcap(StreamReader reader) : reader_(std::move(reader)) {}

  const std::string& name() const override { return reader_.name(); }
  std::optional<double> share_read() const override { return reader_.share_read(); }

 private:
  Result<std::optional<BagMessage>> read() override {
    while (!at_end_) {
      std::optional<BagMessage> message;
      if (!rest_.empty()) {
        message = next_in_chunk();
      } else {
        reader_.skip(std::exchange(held_, 0));
        auto read = read_record();
        if (!read) return tl::unexpected(read.error());
        message = *read;
      }
      if (message) return message;
    }
    return std::nullopt;
  }

  /// The next message of the chunk; nullopt: another record, or the end of the chunk.
  std::optional<BagMessage> next_in_chunk() {
    const std::uint64_t at = is_packed_ ? chunk_at_ : chunk_at_ + (chunk_size_ - rest_.size());
    ByteReader reader(rest_);
    const auto op = reader.read<std::uint8_t>();
    const auto length = reader.read<std::uint64_t>();
    const auto body = length ? reader.take(*length) : std::nullopt;
    if (!body) {
      // In a chunk that was cut, this is not one more damage.
      if (!is_cut_) add_damage(damage_, "damaged record", at);
      rest_ = {};
      return std::nullopt;
    }
    rest_ = rest_.subspan(reader.position());
    return take(*op, *body, at);
  }

  /// A message; nullopt: another record.
  std::optional<BagMessage> take(std::uint8_t op, Bytes body, std::uint64_t at) {
    bool is_whole = true;
    if (op == kSchema) {
      is_whole = add_schema(body);
    } else if (op == kChannel) {
      is_whole = add_channel(body);
    } else if (op == kMcapMessage) {
      ByteReader reader(body);
      const auto channel = reader.read<std::uint16_t>();
      const auto sequence = reader.read<std::uint32_t>();
      const auto time_ns = reader.read<std::uint64_t>(), published_ns = reader.read<std::uint64_t>();
      is_whole = sequence && time_ns && published_ns;
      if (is_whole) {
        const Bytes data = body.subspan(reader.position());
        const auto topic = topic_of(*channel, data);
        const double time_s = seconds_of(static_cast<std::int64_t>(*time_ns));
        const double published_s = seconds_of(static_cast<std::int64_t>(*published_ns));
        if (topic) return BagMessage{*topic, time_s, published_s, data, at};
        add_damage(damage_, topic.error(), at);
      }
    }
    if (!is_whole) add_damage(damage_, "damaged record", at);
    return std::nullopt;
  }

  /// The topic of a channel; the error is a kind of damage. One of JSON becomes a topic with its first message, which
  /// tells its fields: schemas of recorders are made from any message.
  tl::expected<std::size_t, std::string_view> topic_of(std::uint16_t channel, Bytes message) {
    const auto known = channels_.find(channel);
    if (known != channels_.end()) return known->second;
    const auto json = json_channels_.find(channel);
    if (json == json_channels_.end()) return tl::unexpected<std::string_view>("message of an unknown topic");
    std::optional<RosLayout> layout = RosLayout::of_json(text_of(message));
    if (!layout) return tl::unexpected<std::string_view>("message that is not a JSON object");
    json->second.layout = std::make_shared<const RosLayout>(*std::move(layout));
    topics_.push_back(std::move(json->second));
    json_channels_.erase(json);
    return channels_.emplace(channel, topics_.size() - 1).first->second;
  }

  struct Schema {
    std::string name;
    RosEncoding encoding = RosEncoding::kCdr;
    std::shared_ptr<const RosLayout> layout;
  };

  bool add_schema(Bytes body) {
    ByteReader reader(body);
    const auto id = reader.read<std::uint16_t>();
    const auto name = id ? read_text(reader) : std::nullopt;
    const auto encoding = name ? read_text(reader) : std::nullopt;
    const auto text = encoding ? read_text(reader) : std::nullopt;
    constexpr std::size_t kMaxName = 1000;  // each topic has a copy
    if (!text || name->size() > kMaxName) return false;
    if (schemas_.contains(*id)) return true;
    Schema schema{std::string(*name), *encoding == "ros1msg" ? RosEncoding::kRos1 : RosEncoding::kCdr, nullptr};
    const bool is_message = *encoding == "ros1msg" || *encoding == "ros2msg";
    if (is_message) schema.layout = shared_layout(schema.name, *text, schema.encoding);
    schemas_.emplace(*id, std::move(schema));
    return true;
  }

  bool add_channel(Bytes body) {
    ByteReader reader(body);
    const auto id = reader.read<std::uint16_t>(), schema_id = reader.read<std::uint16_t>();
    const auto topic = schema_id ? read_text(reader) : std::nullopt;
    const auto encoding = topic ? read_text(reader) : std::nullopt;
    if (!encoding) return false;
    if (channels_.contains(*id) || json_channels_.contains(*id)) return true;
    const std::optional<RosEncoding> known = encoding_of(*encoding);
    BagTopic added{std::string(*topic), {}, {}, known.value_or(RosEncoding::kCdr), known.has_value()};
    if (!added.is_readable) added.other_encoding = printable(*encoding);
    if (const auto schema = schemas_.find(*schema_id); schema != schemas_.end()) {
      added.type = schema->second.name;
      if (schema->second.encoding == added.encoding) added.layout = schema->second.layout;
    }
    if (known == RosEncoding::kJson) {
      json_channels_.emplace(*id, std::move(added));
      return true;
    }
    channels_.emplace(*id, topics_.size());
    topics_.push_back(std::move(added));
    return true;
  }

  /// Reads a record of the file, and opens it when it is a chunk.
  Result<std::optional<BagMessage>> read_record() {
    const auto start = reader_.peek(kRecordHeader);
    if (!start) return tl::unexpected(start.error());
    if (start->size() < kRecordHeader) return end_early(start->size());
    const std::uint8_t op = start->front();
    const auto length = value_from<std::uint64_t>(start->subspan(1), std::endian::little);
    if (op == kFooter) return end_at_footer(length);
    // Records of the format that need not be read may be of any length, others are not longer than a chunk.
    const bool is_known = op >= 1 && op <= kLastKnown;
    if (!is_known && op < 0x80) return skip_damage();
    if (op != kSchema && op != kChannel && op != kMcapMessage && op != kMcapChunk) return pass_over(length);
    if (op == kMcapChunk && (length == 0 || length > kMaxChunk)) return read_open_chunk(length);
    if (length > kMaxChunk) return skip_damage();
    const auto bytes = reader_.peek(kRecordHeader + static_cast<std::size_t>(length));
    if (!bytes) return tl::unexpected(bytes.error());
    const Bytes body = bytes->subspan(kRecordHeader);
    if (op == kMcapChunk) return open_chunk(body, length);
    if (body.size() < length) return skip_damage();
    held_ = bytes->size();
    return take(op, body, reader_.position());
  }

  /// Of a file whose writer was killed, what is whole of the chunk at work, up to the end.
  Result<std::optional<BagMessage>> read_open_chunk(std::uint64_t length) {
    const auto start = reader_.peek(kRecordHeader + kOpenChunkHeader);
    if (!start) return tl::unexpected(start.error());
    if (!is_open_chunk(start->subspan(kRecordHeader), length)) return skip_damage();
    const auto bytes = reader_.peek(kRecordHeader + kOpenChunkHeader + kMaxOpenChunk);
    if (!bytes) return tl::unexpected(bytes.error());
    held_ = bytes->size();
    is_cut_ = true;  // which the end of the file says
    is_packed_ = false;
    chunk_at_ = reader_.position() + kRecordHeader + kOpenChunkHeader;
    rest_ = bytes->subspan(kRecordHeader + kOpenChunkHeader);
    chunk_size_ = rest_.size();
    return std::nullopt;
  }

  Result<std::optional<BagMessage>> open_chunk(Bytes body, std::uint64_t length) {
    const std::optional<ChunkHeader> chunk = chunk_in(body, length);
    if (!chunk || chunk->data_at + chunk->packed != length) return skip_damage();
    const std::optional<Compression> compression = compression_of(chunk->compression);
    held_ = kRecordHeader + body.size();
    is_cut_ = body.size() < length;
    chunk_at_ = reader_.position() + kRecordHeader + chunk->data_at;
    is_packed_ = compression != Compression::kNone;
    Bytes data = body.subspan(std::min(chunk->data_at, body.size()));
    if (!compression) {
      add_damage(damage_, "unknown compression", reader_.position());
      return std::nullopt;
    }
    if (is_cut_) {
      add_damage(damage_, FrameFinder::kCutOff, reader_.position());
      if (is_packed_) data = {};
    } else if (is_packed_) {
      const Unpacked unpacked = unpack(*compression, data, chunk->size, budget_, unpacked_);
      if (!unpacked.is_whole) {
        add_damage(damage_, unpacked.is_refused ? kTooLargeUnpacked : "damaged chunk", reader_.position());
        unpacked_.clear();
      }
      data = unpacked_;
    }
    if (!is_cut_ && !data.empty() && !has_crc(data, chunk->crc)) {
      add_damage(damage_, "wrong checksum", reader_.position());
      data = {};
    }
    rest_ = data;
    chunk_size_ = rest_.size();
    return std::nullopt;
  }

  /// The file ends with its magic bytes behind the footer.
  Result<std::optional<BagMessage>> end_at_footer(std::uint64_t length) {
    constexpr std::size_t kLength = 20, kFooterSize = kRecordHeader + kLength, kEnd = kFooterSize + kMcapMagic.size();
    if (length != kLength) return skip_damage();
    const auto bytes = reader_.peek(kEnd + 1);
    if (!bytes) return tl::unexpected(bytes.error());
    if (bytes->size() < kEnd) {
      add_damage(damage_, FrameFinder::kCutOff, reader_.position());
    } else if (!looks_like_mcap(bytes->subspan(kFooterSize))) {
      return skip_damage();
    } else if (bytes->size() > kEnd) {
      add_damage(damage_, "bytes after the end", reader_.position() + kEnd);
    }
    at_end_ = true;
    return std::nullopt;
  }

  Result<std::optional<BagMessage>> pass_over(std::uint64_t length) {
    const std::uint64_t at = reader_.position();
    reader_.skip(kRecordHeader);
    while (length > 0) {
      constexpr std::uint64_t kBlock = 65'536;
      const auto bytes = reader_.peek(static_cast<std::size_t>(std::min(length, kBlock)));
      if (!bytes) return tl::unexpected(bytes.error());
      if (bytes->empty()) {
        add_damage(damage_, FrameFinder::kCutOff, at);
        at_end_ = true;
        return std::nullopt;
      }
      length -= bytes->size();
      reader_.skip(bytes->size());
    }
    return std::nullopt;
  }

  /// There is no mark between records: the next thing that is one without doubt is a chunk.
  Result<std::optional<BagMessage>> skip_damage() {
    constexpr std::size_t kBlock = std::size_t{1} << 18, kMaxHeader = 64;
    add_damage(damage_, "damaged record", reader_.position());
    for (;;) {
      const auto bytes = reader_.peek(kBlock);
      if (!bytes) return tl::unexpected(bytes.error());
      if (const auto chunk = next_mcap_chunk(*bytes)) {
        reader_.skip(*chunk);
        return std::nullopt;
      }
      if (bytes->size() < kBlock) {
        at_end_ = true;
        return std::nullopt;
      }
      reader_.skip(kBlock - kMaxHeader);  // a header may be across the end of the block
    }
  }

  /// The file ends without saying so, as after a power cut.
  Result<std::optional<BagMessage>> end_early(std::size_t left) {
    add_damage(damage_, FrameFinder::kCutOff, reader_.position() - (left == 0 ? 1 : 0));
    at_end_ = true;
    return std::nullopt;
  }

  StreamReader reader_;
  std::unordered_map<std::uint16_t, Schema> schemas_;
  std::unordered_map<std::uint16_t, std::size_t> channels_;
  std::unordered_map<std::uint16_t, BagTopic> json_channels_;  ///< those without a message so far
  std::vector<std::uint8_t> unpacked_;
  Bytes rest_;            ///< of the chunk
  std::size_t held_ = 0;  ///< bytes of the stream that the record takes
  std::size_t chunk_size_ = 0;
  std::uint64_t chunk_at_ = 0;  ///< its data in the file
  bool is_packed_ = false, is_cut_ = false, at_end_ = false;
};

}  // namespace

bool looks_like_mcap(Bytes beginning) {
  return beginning.size() >= kMcapMagic.size() && std::equal(kMcapMagic.begin(), kMcapMagic.end(), beginning.begin());
}

Result<std::unique_ptr<Bag>> open_mcap(ByteStream stream) {
  StreamReader reader(std::move(stream));
  const auto magic = reader.peek(kMcapMagic.size());
  if (!magic) return tl::unexpected(magic.error());
  reader.skip(magic->size());
  return std::make_unique<Mcap>(std::move(reader));
}

}  // namespace pingvox
