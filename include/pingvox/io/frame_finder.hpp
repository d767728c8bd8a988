#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// What stands at some place of a stream of frames.
struct FrameCheck {
  enum class Verdict {
    kFrame,       ///< a frame of `size` bytes, with everything right that can be checked
    kIncomplete,  ///< what may become one when more bytes come
    kBroken,      ///< what says that it is a frame of `size` bytes, and is not right
    kNothing,     ///< `size` bytes where no frame begins
  };
  Verdict verdict = Verdict::kNothing;
  std::size_t size = 0;       ///< > 0, but for kIncomplete
  std::string_view why = {};  ///< of kBroken: what is wrong, as in "wrong checksum"
};

/// Looks at the bytes from some place on, at least one.
using CheckFrame = FrameCheck (*)(std::span<const std::uint8_t> bytes);

/// Finds the frames of a serial protocol in bytes that come in pieces of any size, from a log or from a device. Behind
/// anything that is no right frame it looks again one byte farther on, not behind the end that a damaged frame claims,
/// so that no right frame is lost. It holds one frame and what was pushed last.
class FrameFinder {
 public:
  explicit FrameFinder(CheckFrame check) : check_(check) {}

  struct Frame {
    std::uint64_t at;                     ///< where in the stream it begins, in bytes from the first one pushed
    std::span<const std::uint8_t> bytes;  ///< all of it; gone with the next push()
    std::uint64_t end() const { return at + bytes.size(); }
  };

  /// More of the stream.
  void push(std::span<const std::uint8_t> bytes);
  /// No more will come: what may have become a frame has not.
  void end() { ended_ = true; }
  /// The next frame; nullopt: none until more is pushed.
  std::optional<Frame> next();

  /// What was no frame, by kind, with places in the stream: broken frames, and bytes between frames.
  const std::vector<DamageKind>& damage() const { return damage_; }
  /// All that is before this place has been looked at.
  std::uint64_t position() const { return position_; }

  static constexpr std::string_view kBetween = "bytes between frames";
  static constexpr std::string_view kCutOff = "cut off at the end";

 private:
  void pass(const FrameCheck& check);

  CheckFrame check_;
  std::vector<std::uint8_t> bytes_;
  std::size_t start_ = 0;           ///< of what has not been looked at, in bytes_
  std::uint64_t position_ = 0;      ///< the same in the stream
  bool in_damage_ = false;          ///< what was passed last is no frame
  std::uint64_t broken_until_ = 0;  ///< the last broken frame claims what lies before
  bool ended_ = false;
  std::vector<DamageKind> damage_;
};

/// Counts one more of this kind.
void add_damage(std::vector<DamageKind>& kinds, std::string_view what, std::uint64_t at_byte);

}  // namespace pingvox
