#pragma once

#include <cstdint>

namespace pingvox {

/// Gain of a head's receiver.
enum class ReceiverGain : std::uint8_t { kLow, kNormal, kHigh };

}  // namespace pingvox
