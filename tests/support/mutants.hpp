#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

namespace pingvox {

/// A damaged copy of a seed: flipped bits, changed bytes, numbers that look like lengths, pieces lost, doubled or taken
/// from another seed, an end that is missing. Mostly one such accident, at most four.
inline std::vector<std::uint8_t> mutant(std::vector<std::uint8_t> bytes, const std::vector<std::uint8_t>& other,
                                        std::mt19937_64& random) {
  const auto below = [&random](std::size_t n) { return n == 0 ? 0 : static_cast<std::size_t>(random() % n); };
  const auto at = [](std::size_t n) { return static_cast<std::ptrdiff_t>(n); };
  for (std::size_t accidents = 1 + below(1 + below(4)); accidents > 0; --accidents) {
    if (bytes.empty()) break;
    const std::size_t place = below(bytes.size());
    const std::size_t length = std::min(1 + below(64), bytes.size() - place);
    switch (below(8)) {
      case 0:
        bytes[place] = static_cast<std::uint8_t>(bytes[place] ^ (1U << below(8)));
        break;
      case 1:
        bytes[place] = static_cast<std::uint8_t>(random());
        break;
      case 2: {  // a count that is off by little or by much, at any place or where 32-bit counts stand
        constexpr std::uint32_t kCounts[] = {0, 1, 2, 0x7f, 0xff, 0x100, 0xffff, 0x7fffffff, 0x80000000, 0xffffffff};
        std::size_t count_at = below(2) == 0 ? place : place / 4 * 4;
        if (count_at + 4 > bytes.size()) break;
        std::uint32_t count = 0;
        std::memcpy(&count, bytes.data() + count_at, 4);
        count = below(2) == 0 ? kCounts[below(std::size(kCounts))] : count + static_cast<std::uint32_t>(below(9)) - 4;
        std::memcpy(bytes.data() + count_at, &count, 4);
        break;
      }
      case 3: {  // what means something in a text
        constexpr char kMarks[] = "0123456789+-.eE,; \t\r\n#xnNODE\"";
        bytes[place] = static_cast<std::uint8_t>(kMarks[below(std::size(kMarks) - 1)]);
        break;
      }
      case 4:
        bytes.resize(place);
        break;
      case 5:
        bytes.erase(bytes.begin() + at(place), bytes.begin() + at(place + length));
        break;
      case 6: {
        const std::vector<std::uint8_t> piece(bytes.begin() + at(place), bytes.begin() + at(place + length));
        bytes.insert(bytes.begin() + at(below(bytes.size())), piece.begin(), piece.end());
        break;
      }
      default: {
        if (other.empty()) break;
        const std::size_t from = below(other.size());
        const std::size_t to = std::min(from + length, other.size());
        bytes.insert(bytes.begin() + at(place), other.begin() + at(from), other.begin() + at(to));
        break;
      }
    }
  }
  return bytes;
}

}  // namespace pingvox
