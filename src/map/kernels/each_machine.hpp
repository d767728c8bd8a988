// Includes PINGVOX_LOOPS, a file of loops over kLanes numbers of 64 bits, once for each kind of machine, in a namespace
// of its own (PINGVOX_BY_LANES chooses one). There is no guard: each source of kernels does it. What each x86-64 and
// ARM64 machine has are 16 bytes; PINGVOX_PLAIN_LANES says so where loops want more.

#ifndef PINGVOX_PLAIN_LANES
#define PINGVOX_PLAIN_LANES 2
#endif

namespace plain {
constexpr std::size_t kLanes = PINGVOX_PLAIN_LANES;
#include PINGVOX_LOOPS
}  // namespace plain

#ifdef PINGVOX_X86_LANES
#pragma GCC push_options
#pragma GCC target("avx2")
#define PINGVOX_AVX2
namespace avx2 {
constexpr std::size_t kLanes = 4;
#include PINGVOX_LOOPS
}  // namespace avx2
#undef PINGVOX_AVX2
#pragma GCC pop_options
#pragma GCC push_options
#pragma GCC target("avx512f,avx512dq,avx512vl")
#define PINGVOX_AVX512
namespace avx512 {
constexpr std::size_t kLanes = 8;
#include PINGVOX_LOOPS
}  // namespace avx512
#undef PINGVOX_AVX512
#pragma GCC pop_options
#endif
