#pragma once

#include <cstdint>
#include <optional>

#include "pingvox/limits.hpp"
#include "pingvox/result.hpp"

/// How sonar heads are driven.
namespace pingvox {

/// Gain of a head's receiver.
enum class ReceiverGain : std::uint8_t { kLow, kNormal, kHigh };

/// Of the answer to a request.
inline constexpr Limits kHeadTimeouts_s{0.01, 60.0};

/// How a SeaNet head, a Micron or MiniKing, is driven. Its angles are of 6400 a turn, clockwise; 3200 is ahead.
struct MicronSettings {
  static constexpr Limits kRanges_m{0.5, 300.0};

  using Gain = ReceiverGain;
  /// Turned to and fro, from `left` clockwise to `right`.
  struct Sector {
    int left = 0, right = 0;  ///< 0..6399
  };

  double range_m = 10.0;                        ///< of a Micron up to 75
  Gain gain = Gain::kNormal;                    ///< of the receiver
  int step = 16;                                ///< from line to line, 1..255
  std::optional<Sector> sector = std::nullopt;  ///< nullopt: full turns
  double timeout_s = 2.0;                       ///< for an answer

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// How a Ping360 is driven. Its angles are of 400 a turn, clockwise; 200 is ahead.
struct Ping360Settings {
  static constexpr Limits kRanges_m{0.5, 100.0};

  using Gain = ReceiverGain;
  /// Turned to and fro, from the first angle clockwise.
  struct Sector {
    int first_grad = 0;  ///< 0..399
    int width_grad = 0;  ///< 1..399

    friend bool operator==(const Sector&, const Sector&) = default;
  };

  double range_m = 10.0;
  Gain gain = Gain::kNormal;                    ///< of the receiver
  int step_grad = 1;                            ///< from ping to ping, 1..20
  std::optional<Sector> sector = std::nullopt;  ///< nullopt: full turns
  double timeout_s = 4.0;                       ///< for an answer; a head that turns far takes seconds

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

}  // namespace pingvox
