#include "io/clouds/lzf.hpp"

#include <algorithm>

namespace pingvox {

bool lzf_decompress(std::span<const std::uint8_t> compressed, std::span<std::uint8_t> out) {
  std::size_t from = 0, to = 0;
  while (from < compressed.size()) {
    const std::size_t control = compressed[from++];
    if (control < 32) {  // literal bytes
      const std::size_t length = control + 1;
      if (length > compressed.size() - from || length > out.size() - to) return false;
      std::copy_n(compressed.data() + from, length, out.data() + to);
      from += length;
      to += length;
      continue;
    }
    // Copy of earlier bytes: three bits of length (7: plus another byte), 13 of distance.
    std::size_t length = (control >> 5) + 2;
    if (control >> 5 == 7) {
      if (from == compressed.size()) return false;
      length += compressed[from++];
    }
    if (from == compressed.size()) return false;
    const std::size_t back = ((control & 31) << 8) + compressed[from++] + 1;
    if (back > to || length > out.size() - to) return false;
    // Byte by byte, as source and target may overlap.
    for (; length > 0; --length, ++to) out[to] = out[to - back];
  }
  return to == out.size();
}

}  // namespace pingvox
