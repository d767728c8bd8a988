#pragma once

#include <cstddef>

/// For tests that run for seconds on code that others run as well.
#if defined(PINGVOX_SANITIZE_ADDRESS) || defined(PINGVOX_SANITIZE_THREAD)
#define PINGVOX_SKIP_UNDER_SANITIZERS() GTEST_SKIP() << "too slow under sanitizers, and covered by the tests beside it"
#else
#define PINGVOX_SKIP_UNDER_SANITIZERS()
#endif

namespace pingvox::test {

/// Rounds of a random test: a quarter of them under sanitizers, where a round takes some ten times longer. All of them
/// run in the optimised build.
constexpr std::size_t rounds(std::size_t all) {
#if defined(PINGVOX_SANITIZE_ADDRESS) || defined(PINGVOX_SANITIZE_THREAD)
  return (all + 3) / 4;
#else
  return all;
#endif
}

}  // namespace pingvox::test
