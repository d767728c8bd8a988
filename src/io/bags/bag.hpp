#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/bags/ros_layout.hpp"
#include "io/bags/unpack.hpp"
#include "pingvox/io/byte_stream.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"

// The containers of ROS messages: bags of ROS 1, and those of ROS 2 as SQLite databases and MCAP (docs/formats.md).
namespace pingvox {

/// A topic of a bag. Several may have one name: each publisher can have its own.
struct BagTopic {
  std::string name, type;
  /// By the definition in the bag, shared by the topics of a type; of JSON by the first message. nullptr: there is
  /// none, or it cannot be read.
  std::shared_ptr<const RosLayout> layout;
  RosEncoding encoding = RosEncoding::kRos1;
  bool is_readable = true;          ///< false: its messages are in another encoding
  std::string other_encoding = {};  ///< its name in the bag, as in "protobuf"; empty where it is readable
};

/// One message as it was recorded.
struct BagMessage {
  std::size_t topic;                    ///< in Bag::topics()
  double time_s;                        ///< of the recording, since 1970
  double published_s;                   ///< when it was sent to the recorder; where that is not known, time_s
  std::span<const std::uint8_t> bytes;  ///< valid until the next call
  /// Its position in the file, or that of its compressed chunk; nullopt in a database.
  std::optional<std::uint64_t> file_byte;
};

/// A time in nanoseconds [s].
inline double seconds_of(std::int64_t time_ns) {
  constexpr std::int64_t kNs = 1'000'000'000;
  const std::int64_t whole = time_ns / kNs;
  return static_cast<double>(whole) + static_cast<double>(time_ns - whole * kNs) * 1e-9;
}

/// Reads the messages of a bag in the order in which they were recorded, one chunk in memory at a time.
class Bag {
 public:
  virtual ~Bag() = default;
  virtual const std::string& name() const = 0;
  /// The next message, unpacked where it was compressed by itself (rosbag2's compression mode MESSAGE). nullopt: the
  /// end; an error when the operating system reports one.
  Result<std::optional<BagMessage>> next();
  virtual std::optional<double> share_read() const { return std::nullopt; }

  /// Those met so far.
  const std::vector<BagTopic>& topics() const { return topics_; }
  /// Of the container, with positions in the file.
  const std::vector<DamageKind>& damage() const { return damage_; }

 protected:
  std::vector<BagTopic> topics_;
  std::vector<DamageKind> damage_;
  UnpackBudget budget_;  ///< of the file's chunks and messages

 private:
  /// The next message as it is in the file.
  virtual Result<std::optional<BagMessage>> read() = 0;

  std::vector<std::uint8_t> unpacked_message_;
};

bool looks_like_ros1_bag(std::span<const std::uint8_t> beginning);
Result<std::unique_ptr<Bag>> open_ros1_bag(ByteStream stream);

bool looks_like_sqlite(std::span<const std::uint8_t> beginning);
Result<std::unique_ptr<Bag>> open_sqlite_bag(ByteStream stream);

bool looks_like_mcap(std::span<const std::uint8_t> beginning);
Result<std::unique_ptr<Bag>> open_mcap(ByteStream stream);

/// Whichever it is, or all files of a folder's bag one after the other. REQUIRES a stream that looks like one of them.
Result<std::unique_ptr<Bag>> open_bag(ByteStream stream);

/// The beams of a bag whose messages come while it is read, of the one topic that it has.
std::unique_ptr<BeamSource> beams_of(std::unique_ptr<Bag> bag);

}  // namespace pingvox
