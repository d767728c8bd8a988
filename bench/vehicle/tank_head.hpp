#pragma once

#include "device/internal/ping360_emulator.hpp"

namespace pingvox::bench {

/// What a Ping360 hears in the simulated tank, the same at an angle each time.
Ping360Emulator::Hear hear_in_tank();

}  // namespace pingvox::bench
