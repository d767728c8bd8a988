#pragma once

#include <string>

#include "pingvox/result.hpp"

namespace pingvox::app {

/// Limits this process to the vector instructions that the environment variable PINGVOX_VECTORS names (avx2, sse4,
/// ...): to measure for lesser machines. kBadOption for an unknown or unavailable name.
Result<void> limit_vectors();

/// The widest instructions in use.
std::string vectors_in_use();

}  // namespace pingvox::app
