#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "device/internal/head_emulator.hpp"

/// A head whose answers are right by their checksums, but not what was asked for.
namespace pingvox::test {

/// An emulator whose every n-th frame of a kind is altered, in the place of the emulator in `run`.
template <class Emulator>
class AlteredHead {
 public:
  using Bytes = std::vector<std::uint8_t>;
  /// The frame to send in place of a frame; an empty one: this frame is not counted and stays.
  using Alter = std::function<Bytes(const Bytes&)>;

  AlteredHead(const typename Emulator::Hear& hear, std::size_t every, Alter alter)
      : head_(HeadEmulatorOptions{}, hear), every_(every), alter_(std::move(alter)) {}

  double due_s() const { return head_.due_s(); }
  void take(std::span<const std::uint8_t> bytes, double now_s) { head_.take(bytes, now_s); }
  Bytes send(double now_s) {
    Bytes frame = head_.send(now_s);
    Bytes altered = frame.empty() ? frame : alter_(frame);
    if (altered.empty() || ++answers_ % every_ != 0) return frame;
    ++altered_;
    return altered;
  }
  std::size_t altered() const { return altered_; }

 private:
  Emulator head_;
  std::size_t every_, answers_ = 0, altered_ = 0;
  Alter alter_;
};

}  // namespace pingvox::test
