#include "pingvox/device/head_emulator.hpp"

#include <fmt/core.h>

#include <string>
#include <string_view>

namespace pingvox {

Result<void> HeadEmulatorOptions::validate() const {
  std::string bad;
  const auto check = [&bad](std::string_view name, double value, double min, double max) {
    if (!(value >= min && value <= max)) bad += fmt::format(" {} must be in {}..{}, is {};", name, min, max, value);
  };
  check("pings_per_s", pings_per_s, 0.1, 100'000.0);
  check("lost", lost, 0.0, 0.5);
  check("doubled", doubled, 0.0, 0.5);
  check("damaged", damaged, 0.0, 0.5);
  check("stall_s", stall_s, 0.0, 3600.0);
  check("lines_per_request", lines_per_request, 1, 2);
  if (bad.empty()) return {};
  bad.pop_back();
  return fail(Error::Code::kBadOption, "emulator:" + bad);
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
