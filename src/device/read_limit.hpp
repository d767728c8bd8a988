#pragma once

#include <cstddef>

namespace pingvox {

/// How much is read from a line at once: a sender that never falls silent has to leave time for the rest, so that beams
/// are mapped and signals heard within milliseconds.
class ReadLimit {
 public:
  bool allows_more() const { return reads_ < kMaxReads && bytes_ < kMaxBytes; }
  void count(std::size_t bytes) {
    ++reads_;
    bytes_ += bytes;
  }

 private:
  static constexpr int kMaxReads = 64;
  static constexpr std::size_t kMaxBytes = 256 << 10;  ///< 0.2 s of a network cable of 10 Mbit/s
  int reads_ = 0;
  std::size_t bytes_ = 0;
};

}  // namespace pingvox
