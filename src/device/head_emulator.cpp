#include "device/internal/head_emulator.hpp"

#include "base/option_errors.hpp"

namespace pingvox {

OptionErrors HeadEmulatorOptions::errors() const {
  OptionErrors errors;
  errors.require("pings_per_s", pings_per_s, {0.1, 100'000.0});
  errors.require("lost", lost, {0.0, 0.5});
  errors.require("doubled", doubled, {0.0, 0.5});
  errors.require("damaged", damaged, {0.0, 0.5});
  errors.require("stall_s", stall_s, {0.0, 3600.0});
  errors.require("lines_per_request", lines_per_request, {1.0, 2.0});
  return errors;
}

Result<void> HeadEmulatorOptions::validate() const {
  return errors().result("emulator");
}

std::vector<std::uint8_t> LineFaults::pass(std::span<const std::uint8_t> bytes) {
  std::vector<std::uint8_t> arrived;
  for (const std::uint8_t byte : bytes) {
    if (random_.uniform() < options_.lost) continue;
    const bool is_damaged = random_.uniform() < options_.damaged;
    arrived.push_back(is_damaged ? static_cast<std::uint8_t>(byte ^ (1U << (random_.bits() % 8))) : byte);
    if (random_.uniform() < options_.doubled) arrived.push_back(arrived.back());
  }
  return arrived;
}

}  // namespace pingvox
