#pragma once

#include <string>

#include "pingvox/result.hpp"

namespace pingvox::app {

/// Limits this process to the vector instructions that the environment variable PINGVOX_VECTORS names (avx2, sse4,
/// ...): to measure here what another machine would do. kBadOption when this machine has none of that name.
Result<void> limit_vectors();

/// The widest ones in use.
std::string vectors_in_use();

}  // namespace pingvox::app
