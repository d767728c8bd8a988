#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace pingvox::app {

/// What a file is that none of our readers takes, as far as that can be told, and what to do about it: "is compressed:
/// unpack it first".
std::string stranger_text(std::span<const std::uint8_t> bytes);

}  // namespace pingvox::app
