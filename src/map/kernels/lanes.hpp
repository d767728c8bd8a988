#pragma once

// clang has no pragmas to compile for another machine; there the plain loops do. PINGVOX_MOST_LANES (CMake) leaves out
// wider ones than 1 (what every machine has) or 4 (AVX2), to see what a machine without them would do.
#ifndef PINGVOX_MOST_LANES
#define PINGVOX_MOST_LANES 8
#endif
#if defined(__x86_64__) && !defined(__clang__) && PINGVOX_MOST_LANES >= 4
#define PINGVOX_X86_LANES
#include <immintrin.h>
#endif

namespace pingvox::detail {

/// The machines that loops over lanes are compiled for. Each gives the same results.
enum class Lanes {
  kOne,     ///< what every machine has
  kAvx2,    ///< vectors of 32 bytes
  kAvx512,  ///< vectors of 64 bytes
};

/// The widest that this machine has.
inline Lanes widest_lanes() {
#ifdef PINGVOX_X86_LANES
  if (PINGVOX_MOST_LANES >= 8 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl")) {
    return Lanes::kAvx512;
  }
  if (__builtin_cpu_supports("avx2")) return Lanes::kAvx2;
#endif
  return Lanes::kOne;
}

/// Returns what CALL gives in the namespace of the loops for `lanes`, or what PLAIN gives where there are no others.
#ifdef PINGVOX_X86_LANES
#define PINGVOX_BY_LANES(lanes, CALL, PLAIN) \
  switch (lanes) {                           \
    case Lanes::kAvx512:                     \
      return avx512::CALL;                   \
    case Lanes::kAvx2:                       \
      return avx2::CALL;                     \
    case Lanes::kOne:                        \
      break;                                 \
  }                                          \
  return PLAIN
#else
#define PINGVOX_BY_LANES(lanes, CALL, PLAIN) \
  static_cast<void>(lanes);                  \
  return PLAIN
#endif

}  // namespace pingvox::detail
