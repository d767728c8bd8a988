#include "io/maps/mcap_writer.hpp"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>

namespace pingvox {
namespace {

constexpr std::string_view kMcapBothEnds = "\x89MCAP0\r\n";
constexpr std::size_t kChunkBytes = std::size_t{1} << 20;

enum class McapOp : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0b,
  kSummaryOffset = 0x0e,
  kDataEnd = 0x0f,
};

std::string mcap_record(McapOp op, std::string_view body) {
  std::string record(1, static_cast<char>(op));
  append_little_endian(record, static_cast<std::uint64_t>(body.size()));
  return record.append(body);
}

void append_mcap_text(std::string& bytes, std::string_view text) {
  append_little_endian(bytes, static_cast<std::uint32_t>(text.size()));
  bytes.append(text);
}

std::uint32_t continued_crc(std::uint32_t crc, std::string_view bytes) {
  return static_cast<std::uint32_t>(crc32_z(crc, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace

McapWriter::McapWriter(std::ostream& out, std::string_view profile) : out_(out) {
  write(kMcapBothEnds);
  std::string body;
  append_mcap_text(body, profile);
  append_mcap_text(body, "pingvox");
  write(mcap_record(McapOp::kHeader, body));
}

void McapWriter::write(std::string_view bytes) {
  out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  at_ += bytes.size();
  crc_ = continued_crc(crc_, bytes);
}

std::uint16_t McapWriter::add_channel(const McapChannel& channel) {
  messages_.push_back(0);
  const auto number = static_cast<std::uint16_t>(messages_.size());
  std::string schema;
  append_little_endian(schema, number);
  append_mcap_text(schema, channel.schema);
  append_mcap_text(schema, channel.schema_encoding);
  append_mcap_text(schema, channel.schema_data);
  std::string body, metadata;
  append_little_endian(body, number);
  append_little_endian(body, number);
  append_mcap_text(body, channel.topic);
  append_mcap_text(body, channel.message_encoding);
  for (const auto& [key, value] : channel.metadata) {
    append_mcap_text(metadata, key);
    append_mcap_text(metadata, value);
  }
  append_mcap_text(body, metadata);
  schemas_ += mcap_record(McapOp::kSchema, schema);
  channels_ += mcap_record(McapOp::kChannel, body);
  chunk_ += mcap_record(McapOp::kSchema, schema) + mcap_record(McapOp::kChannel, body);
  return number;
}

Result<void> McapWriter::add(std::uint16_t channel, std::uint64_t time_ns, std::string_view message) {
  const bool is_first = index_.empty();
  first_ns_ = is_first ? time_ns : std::min(first_ns_, time_ns);
  last_ns_ = is_first ? time_ns : std::max(last_ns_, time_ns);
  index_[channel].emplace_back(time_ns, chunk_.size());
  std::string body;
  append_little_endian(body, channel);
  append_little_endian(body, static_cast<std::uint32_t>(messages_[channel - 1U]++));
  append_little_endian(body, time_ns);
  append_little_endian(body, time_ns);
  body.append(message);
  chunk_ += mcap_record(McapOp::kMessage, body);
  return chunk_.size() < kChunkBytes ? Result<void>() : finish_chunk();
}

Result<void> McapWriter::finish_chunk() {
  if (chunk_.empty()) return {};
  std::string packed(ZSTD_compressBound(chunk_.size()), '\0');
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), chunk_.data(), chunk_.size(), 1);
  if (ZSTD_isError(size) != 0) return fail(Error::Code::kNoMemory, "out of memory: a chunk was not compressed");
  packed.resize(size);
  ChunkPlace place{first_ns_, last_ns_, at_, 0, 0, packed.size(), chunk_.size(), {}};
  std::string body;
  append_little_endian(body, first_ns_);
  append_little_endian(body, last_ns_);
  append_little_endian(body, static_cast<std::uint64_t>(chunk_.size()));
  append_little_endian(body, continued_crc(0, chunk_));
  append_mcap_text(body, "zstd");
  append_little_endian(body, static_cast<std::uint64_t>(packed.size()));
  body += packed;
  write(mcap_record(McapOp::kChunk, body));
  place.bytes = at_ - place.at;
  const std::uint64_t indexes_at = at_;
  for (const auto& [channel, entries] : index_) {
    place.indexes[channel] = at_;
    std::string list, index;
    for (const auto& [time_ns, offset] : entries) {
      append_little_endian(list, time_ns);
      append_little_endian(list, offset);
    }
    append_little_endian(index, channel);
    append_mcap_text(index, list);
    write(mcap_record(McapOp::kMessageIndex, index));
  }
  place.index_bytes = at_ - indexes_at;
  chunks_.push_back(std::move(place));
  chunk_.clear();
  index_.clear();
  return {};
}

void McapWriter::write_summary() {
  std::string chunk_indexes, counts, statistics;
  std::uint64_t first_ns = chunks_.empty() ? 0 : chunks_.front().first_ns, last_ns = 0, messages = 0;
  for (const ChunkPlace& chunk : chunks_) {
    first_ns = std::min(first_ns, chunk.first_ns);
    last_ns = std::max(last_ns, chunk.last_ns);
    std::string body, indexes;
    for (const std::uint64_t number : {chunk.first_ns, chunk.last_ns, chunk.at, chunk.bytes}) {
      append_little_endian(body, number);
    }
    for (const auto& [channel, at] : chunk.indexes) {
      append_little_endian(indexes, channel);
      append_little_endian(indexes, at);
    }
    append_mcap_text(body, indexes);
    append_little_endian(body, chunk.index_bytes);
    append_mcap_text(body, "zstd");
    append_little_endian(body, chunk.compressed);
    append_little_endian(body, chunk.uncompressed);
    chunk_indexes += mcap_record(McapOp::kChunkIndex, body);
  }
  for (std::size_t i = 0; i < messages_.size(); ++i) {
    messages += messages_[i];
    append_little_endian(counts, static_cast<std::uint16_t>(i + 1));
    append_little_endian(counts, messages_[i]);
  }
  append_little_endian(statistics, messages);
  append_little_endian(statistics, static_cast<std::uint16_t>(messages_.size()));
  for (const std::size_t count : {messages_.size(), std::size_t{0}, std::size_t{0}, chunks_.size()}) {
    append_little_endian(statistics, static_cast<std::uint32_t>(count));
  }
  append_little_endian(statistics, first_ns);
  append_little_endian(statistics, last_ns);
  append_mcap_text(statistics, counts);

  const std::uint64_t summary_at = at_;
  crc_ = 0;
  std::string offsets;
  const auto write_group = [&](McapOp op, const std::string& records) {
    if (records.empty()) return;
    std::string body(1, static_cast<char>(op));
    append_little_endian(body, at_);
    append_little_endian(body, static_cast<std::uint64_t>(records.size()));
    offsets += mcap_record(McapOp::kSummaryOffset, body);
    write(records);
  };
  write_group(McapOp::kSchema, schemas_);
  write_group(McapOp::kChannel, channels_);
  write_group(McapOp::kStatistics, mcap_record(McapOp::kStatistics, statistics));
  write_group(McapOp::kChunkIndex, chunk_indexes);
  const std::uint64_t offsets_at = at_;
  write(offsets);
  // Its own beginning counts, too.
  std::string footer(1, static_cast<char>(McapOp::kFooter));
  constexpr std::uint64_t kFooterBytes = 20;
  append_little_endian(footer, kFooterBytes);
  append_little_endian(footer, summary_at);
  append_little_endian(footer, offsets_at);
  write(footer);
  std::string crc;
  append_little_endian(crc, crc_);
  write(crc);
}

Result<void> McapWriter::finish() {
  if (const auto finished = finish_chunk(); !finished) return finished;
  std::string crc;
  append_little_endian(crc, crc_);
  write(mcap_record(McapOp::kDataEnd, crc));
  write_summary();
  write(kMcapBothEnds);
  out_.flush();
  if (!out_) return fail(Error::Code::kIo, "the recording could not be written");
  return {};
}

}  // namespace pingvox
