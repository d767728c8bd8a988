#pragma once

#include <bzlib.h>
#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// Small bags for tests, by the published layouts.
namespace pingvox::bags {

using Bytes = std::vector<std::uint8_t>;

/// A SonarEcho of a Ping360 as another writer made it: hex, in CDR, with the intensities 0, 10, 64 and 255.
inline constexpr std::string_view kSonarEcho =
    "00010000e80300000065cd1d02000000730000000000c03f01000400ee02dc050a00000004000000000a40ff";

template <class T>
void put(Bytes& to, T value) {
  const auto* raw = reinterpret_cast<const std::uint8_t*>(&value);
  to.insert(to.end(), raw, raw + sizeof(T));
}

inline void append(Bytes& to, const Bytes& bytes) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}

inline void put_text(Bytes& to, std::string_view text) {
  put(to, static_cast<std::uint32_t>(text.size()));
  to.insert(to.end(), text.begin(), text.end());
}

inline Bytes packed(std::string_view compression, const Bytes& bytes) {
  if (compression == "bz2") {
    Bytes to(bytes.size() + bytes.size() / 100 + 600);
    auto size = static_cast<unsigned>(to.size());
    Bytes from = bytes;
    BZ2_bzBuffToBuffCompress(reinterpret_cast<char*>(to.data()), &size, reinterpret_cast<char*>(from.data()),
                             static_cast<unsigned>(from.size()), 9, 0, 0);
    to.resize(size);
    return to;
  }
  if (compression == "lz4") {
    Bytes to(LZ4F_compressFrameBound(bytes.size(), nullptr));
    to.resize(LZ4F_compressFrame(to.data(), to.size(), bytes.data(), bytes.size(), nullptr));
    return to;
  }
  if (compression == "zstd") {
    Bytes to(ZSTD_compressBound(bytes.size()));
    to.resize(ZSTD_compress(to.data(), to.size(), bytes.data(), bytes.size(), 3));
    return to;
  }
  return bytes;
}

/// A bag of ROS 1, chunk by chunk.
class Ros1 {
 public:
  Ros1() {
    const std::string_view magic = "#ROSBAG V2.0\n";
    file_.assign(magic.begin(), magic.end());
    Bytes header;
    field(header, "op", Bytes{3});
    field(header, "index_pos", Bytes(8));
    field(header, "conn_count", Bytes(4));
    field(header, "chunk_count", Bytes(4));
    record(file_, header, Bytes(64, ' '));
  }

  void topic(std::uint32_t connection, std::string_view name, std::string_view type, std::string_view definition) {
    Bytes header, about;
    field(header, "conn", number(connection));
    field(header, "op", Bytes{7});
    field(header, "topic", text(name));
    field(about, "topic", text(name));
    field(about, "type", text(type));
    field(about, "md5sum", text("*"));
    field(about, "message_definition", text(definition));
    record(chunk_, header, about);
    record(connections_, header, about);
  }

  void message(std::uint32_t connection, std::uint32_t seconds, std::uint32_t nanoseconds, const Bytes& data) {
    Bytes header, time;
    put(time, seconds);
    put(time, nanoseconds);
    field(header, "conn", number(connection));
    field(header, "op", Bytes{2});
    field(header, "time", time);
    record(chunk_, header, data);
  }

  /// @param compression  none, bz2 or lz4
  void end_chunk(std::string_view compression = "none") {
    Bytes header;
    field(header, "compression", text(compression));
    field(header, "op", Bytes{5});
    field(header, "size", number(static_cast<std::uint32_t>(chunk_.size())));
    record(file_, header, packed(compression, chunk_));
    chunk_.clear();
    // An index, of which nothing is needed.
    Bytes index;
    field(index, "count", number(1));
    field(index, "op", Bytes{4});
    record(file_, index, Bytes(12));
  }

  const Bytes& file() const { return file_; }

  /// The file with its index, as a recorder leaves it that was ended.
  Bytes closed() const {
    Bytes file = file_, index_at, info;
    put(index_at, std::uint64_t{file_.size()});
    const std::string_view name = "index_pos=";
    std::copy(
        index_at.begin(), index_at.end(),
        std::search(file.begin(), file.end(), name.begin(), name.end()) + static_cast<std::ptrdiff_t>(name.size()));
    append(file, connections_);
    field(info, "count", number(1));
    field(info, "op", Bytes{6});
    record(file, info, Bytes(8));
    return file;
  }

 private:
  static Bytes text(std::string_view value) { return {value.begin(), value.end()}; }
  static Bytes number(std::uint32_t value) {
    Bytes bytes;
    put(bytes, value);
    return bytes;
  }
  static void field(Bytes& to, std::string_view name, const Bytes& value) {
    put(to, static_cast<std::uint32_t>(name.size() + 1 + value.size()));
    to.insert(to.end(), name.begin(), name.end());
    to.push_back('=');
    append(to, value);
  }
  static void record(Bytes& to, const Bytes& header, const Bytes& data) {
    put(to, static_cast<std::uint32_t>(header.size()));
    append(to, header);
    put(to, static_cast<std::uint32_t>(data.size()));
    append(to, data);
  }

  Bytes file_, chunk_, connections_;
};

/// An MCAP of ROS 2, chunk by chunk.
class Mcap {
 public:
  Mcap() : file_{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'} {
    Bytes header;
    put_text(header, "ros2");
    put_text(header, "test");
    record(file_, 1, header);
  }

  void topic(std::uint16_t id, std::string_view name, std::string_view type, std::string_view definition,
             std::string_view encoding = "cdr") {
    Bytes schema, channel;
    put(schema, id);
    put_text(schema, type);
    put_text(schema, "ros2msg");
    put_text(schema, definition);
    put(channel, id);
    put(channel, id);
    put_text(channel, name);
    put_text(channel, encoding);
    put(channel, std::uint32_t{0});
    record(chunk_, 3, schema);
    record(chunk_, 4, channel);
  }

  void message(std::uint16_t id, std::uint64_t time_ns, const Bytes& data) { message(id, time_ns, time_ns, data); }
  void message(std::uint16_t id, std::uint64_t time_ns, std::uint64_t published_ns, const Bytes& data) {
    Bytes body;
    put(body, id);
    put(body, std::uint32_t{0});
    put(body, time_ns);
    put(body, published_ns);
    append(body, data);
    record(chunk_, 5, body);
  }
  /// The same of a text, as JSON.
  void text(std::uint16_t id, std::uint64_t time_ns, std::string_view text) {
    message(id, time_ns, Bytes(text.begin(), text.end()));
  }

  /// @param compression  "" (none), lz4 or zstd
  void end_chunk(std::string_view compression = "") {
    const Bytes data = packed(compression, chunk_);
    Bytes body(16);
    put(body, std::uint64_t{chunk_.size()});
    put(body, static_cast<std::uint32_t>(::crc32_z(0, chunk_.data(), chunk_.size())));
    put_text(body, compression);
    put(body, std::uint64_t{data.size()});
    append(body, data);
    record(file_, 6, body);
    chunk_.clear();
    record(file_, 7, Bytes(6));  // an index, of which nothing is needed
  }

  /// The file of a writer that was killed: the chunk at work has neither length nor sizes.
  /// @param later  what stands in their place
  Bytes killed(std::uint64_t later) const {
    Bytes file = file_;
    file.push_back(6);
    put(file, later);
    file.resize(file.size() + 16);
    put(file, later);
    put(file, std::uint32_t{0xffffffff});
    put_text(file, "");
    put(file, later);
    append(file, chunk_);
    return file;
  }

  /// Writes what is not in a chunk.
  void end_flat() { append(file_, std::exchange(chunk_, {})); }

  Bytes closed() const {
    Bytes file = file_;
    record(file, 15, Bytes(4));
    record(file, 2, Bytes(20));
    file.insert(file.end(), file_.begin(), file_.begin() + 8);
    return file;
  }

 private:
  static void record(Bytes& to, std::uint8_t op, const Bytes& body) {
    to.push_back(op);
    put(to, std::uint64_t{body.size()});
    append(to, body);
  }

  Bytes file_, chunk_;
};

}  // namespace pingvox::bags
