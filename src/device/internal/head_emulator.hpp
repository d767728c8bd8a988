#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pingvox/geometry/random.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

class OptionErrors;

/// Options of the emulator of a sonar head.
struct HeadEmulatorOptions {
  double pings_per_s = 20.0;  ///< 0.1..100,000
  // Faults of the line, as fractions of the bytes that the head sends.
  double lost = 0.0, doubled = 0.0, damaged = 0.0;  ///< 0..0.5 each
  // Faults of the head: after this many pings it hears and says nothing for a while, as one that restarts.
  std::size_t stall_every = 0;  ///< pings; 0: never
  double stall_s = 5.0;         ///< 0..3600
  std::uint64_t seed = 1;       ///< of the faults
  /// Of a SeaNet head: 2 as full-duplex ones send.
  int lines_per_request = 1;

  OptionErrors errors() const;    ///< what is wrong with each field
  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// A line that loses, doubles and damages bytes.
class LineFaults {
 public:
  /// REQUIRES valid options.
  explicit LineFaults(const HeadEmulatorOptions& options) : options_(options), random_(options.seed) {}

  /// The bytes of these that arrive.
  std::vector<std::uint8_t> pass(std::span<const std::uint8_t> bytes);

 private:
  HeadEmulatorOptions options_;
  Random random_;
};

}  // namespace pingvox
