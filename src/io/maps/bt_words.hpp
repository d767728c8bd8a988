#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

/// The words of a .bt file (docs/formats.md): one for each inner node, two bits for each of its eight children.
namespace pingvox {

namespace bt {
inline constexpr unsigned kUnknown = 0, kFree = 1, kOccupied = 2, kInner = 3;
}
inline constexpr unsigned kAllFree = 0x5555, kAllOccupied = 0xAAAA;

constexpr unsigned state_of(unsigned word, std::size_t octant) {
  return (word >> (2 * octant)) & 3U;
}

/// Number of known children of a word.
constexpr unsigned children_of(unsigned word) {
  unsigned children = (word | word >> 1) & 0x5555U;
  children = (children & 0x3333U) + (children >> 2 & 0x3333U);
  children = (children + (children >> 4)) & 0x0F0FU;
  return (children + (children >> 8)) & 0xFU;
}

/// Whether all children are leaves of the same state, or unknown.
constexpr bool is_uniform(unsigned word) {
  return word == 0 || word == kAllFree || word == kAllOccupied;
}

/// The word of eight leaves; bit i of each mask is child i.
constexpr unsigned word_of(unsigned free, unsigned occupied) {
  unsigned bits = free | occupied << 16;  // both at once: bit i of each half goes to bit 2 i
  bits = (bits | bits << 4) & 0x0F0F0F0FU;
  bits = (bits | bits << 2) & 0x33333333U;
  bits = (bits | bits << 1) & 0x55555555U;
  return (bits | bits >> 15) & 0xFFFFU;
}

struct States {
  unsigned free, occupied;  ///< inner children are set in both
};
/// Inverse of word_of.
constexpr States states_of(unsigned word) {
  unsigned bits = (word & 0x5555U) | (word & 0xAAAAU) << 15;
  bits = (bits | bits >> 1) & 0x33333333U;
  bits = (bits | bits >> 2) & 0x0F0F0F0FU;
  bits = (bits | bits >> 4) & 0x00FF00FFU;
  return {bits & 0xFFU, bits >> 16};
}

/// Expands bit i to all bits of byte i: all cells of each octant.
constexpr std::uint64_t whole_octants(unsigned octants) {
  // Byte i keeps bit i of a copy of the bits; a value that is not 0 then carries into the highest bit.
  const std::uint64_t kept = octants * 0x0101010101010101U & 0x8040201008040201U;
  return ((kept + 0x7F7F7F7F7F7F7F7FU) >> 7U & 0x0101010101010101U) * 0xFFU;
}

// The same for the eight octants of a brick at once.

using EightWords = std::uint16_t __attribute__((vector_size(16)));

/// Moves bit i of byte o to bit 2 i of word o.
inline EightWords spread_bytes(std::uint64_t bytes) {
  if constexpr (std::endian::native == std::endian::big) bytes = __builtin_bswap64(bytes);
  std::uint8_t __attribute__((vector_size(8))) lanes;
  std::memcpy(&lanes, &bytes, sizeof lanes);
  EightWords words = __builtin_convertvector(lanes, EightWords);
  words = (words | words << 4) & 0x0F0F;
  words = (words | words << 2) & 0x3333;
  return (words | words << 1) & 0x5555;
}

/// word_of for byte o of both masks in word o.
inline EightWords words_of(std::uint64_t free, std::uint64_t occupied) {
  return spread_bytes(free) | spread_bytes(occupied) << 1;
}

/// Mask of the words that are not is_uniform.
inline EightWords mixed_words(const EightWords& words) {
  return reinterpret_cast<EightWords>((words != 0) & (words != kAllFree) & (words != kAllOccupied));
}

/// The word of the parent: bt::kInner where a child is mixed, else the common state of its children.
inline unsigned word_above(const EightWords& words, const EightWords& mixed) {
  constexpr EightWords kPlaces{1, 1 << 2, 1 << 4, 1 << 6, 1 << 8, 1 << 10, 1 << 12, 1 << 14};
  const EightWords states = ((words | mixed) & 3) * kPlaces;
  std::uint64_t halves[2];
  std::memcpy(halves, &states, sizeof halves);
  std::uint64_t word = halves[0] | halves[1];
  word |= word >> 32;
  return static_cast<unsigned>(word | word >> 16) & 0xFFFFU;
}

}  // namespace pingvox
