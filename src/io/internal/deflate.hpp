#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pingvox/result.hpp"

namespace pingvox {

/// The bytes compressed as DEFLATE (RFC 1951) without a header: what browsers call `deflate-raw`.
/// @return kNoMemory when memory runs out
Result<std::vector<std::uint8_t>> deflate_raw(std::span<const std::uint8_t> bytes);

}  // namespace pingvox
