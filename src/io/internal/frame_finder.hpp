#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// Result of checking for a frame at some position of a stream.
struct FrameCheck {
  enum class Verdict {
    kFrame,       ///< a valid frame of `size` bytes
    kIncomplete,  ///< possibly a frame; needs more bytes
    kBroken,      ///< claims to be a frame of `size` bytes but is damaged
    kNothing,     ///< no frame begins within `size` bytes
  };
  Verdict verdict = Verdict::kNothing;
  std::size_t size = 0;       ///< > 0, except for kIncomplete
  std::string_view why = {};  ///< kBroken: reason, as in "wrong checksum"
};

/// Sums of bytes modulo 2^16. In damage a long frame may seem to begin at each byte: summed each time, they would take
/// the square of its length.
class PrefixSums {
 public:
  void clear() { sums_.resize(1); }
  /// Of the bytes [from, to). REQUIRES the same bytes since the last clear().
  std::uint16_t sum(std::span<const std::uint8_t> bytes, std::size_t from, std::size_t to);

 private:
  std::vector<std::uint16_t> sums_ = {0};  ///< sums_[n]: of the first n
};

/// The bytes of a stream from where a frame may begin.
struct FrameBytes {
  std::span<const std::uint8_t> stream;
  std::size_t start = 0;       ///< where the frame may begin; there is at least one byte from there on
  PrefixSums* sums = nullptr;  ///< of the stream, where its frames are damaged; nullptr: each sum is computed directly

  std::span<const std::uint8_t> bytes() const { return stream.subspan(start); }
  /// Sum of the first bytes modulo 2^16.
  std::uint16_t sum(std::size_t size) const;
};

/// Checks for a frame at the start of the bytes.
using CheckFrame = FrameCheck (*)(const FrameBytes& at);

/// Finds the frames of a serial protocol in a stream pushed in pieces of any size. After a damaged frame it continues
/// one byte further, not at the end that the frame claims, so that no valid frame is lost. Holds at most one frame and
/// the last push.
class FrameFinder {
 public:
  /// @param least_between  bytes between two frames, fewer of which are no damage: fewer than a frame has are noise of
  ///                       the line, as of a transceiver that is switched on
  explicit FrameFinder(CheckFrame check, std::size_t least_between = 1)
      : check_(check), least_between_(least_between) {}

  struct Frame {
    std::uint64_t at;                     ///< position in the stream [bytes]
    std::span<const std::uint8_t> bytes;  ///< valid until the next push()
    std::uint64_t end() const { return at + bytes.size(); }
  };

  /// Appends bytes of the stream.
  void push(std::span<const std::uint8_t> bytes);
  /// Ends the stream: an incomplete frame is now damaged.
  void end() { ended_ = true; }
  /// The next frame; nullopt: needs more bytes.
  std::optional<Frame> next();

  /// Damaged frames and bytes between frames, by kind, with positions in the stream.
  const std::vector<DamageKind>& damage() const { return damage_; }
  /// Position in the stream up to which bytes were processed.
  std::uint64_t position() const { return position_; }
  /// Position before which no damage will be found any more.
  std::uint64_t settled() const { return between_from_.value_or(position_); }

  static constexpr std::string_view kBetween = "bytes between frames";
  static constexpr std::string_view kCutOff = "cut off at the end";

 private:
  void pass(const FrameCheck& check);

  CheckFrame check_;
  std::size_t least_between_;
  std::vector<std::uint8_t> bytes_;
  std::size_t start_ = 0;                      ///< of the unprocessed bytes, in bytes_
  std::uint64_t position_ = 0;                 ///< the same in the stream
  bool in_damage_ = false;                     ///< the last bytes were no frame
  std::optional<std::uint64_t> between_from_;  ///< the first of them, while they are too few to be damage
  std::uint64_t broken_until_ = 0;             ///< end that the last damaged frame claims
  PrefixSums sums_;                            ///< of bytes_, once there is damage
  bool ended_ = false;
  std::vector<DamageKind> damage_;
};

/// Counts one more damage of this kind.
void add_damage(std::vector<DamageKind>& kinds, std::string_view what, std::optional<std::uint64_t> at_byte);

}  // namespace pingvox
