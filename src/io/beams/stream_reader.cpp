#include "io/beams/stream_reader.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "io/bytes/text.hpp"

namespace pingvox {

Result<std::span<const std::uint8_t>> StreamReader::peek(std::size_t count) {
  constexpr std::size_t kChunk = std::size_t{1} << 18;
  while (end_ - start_ < count && !at_end_) {
    if (start_ > 0 && bytes_.size() - start_ < count + kChunk) {
      std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(start_),
                bytes_.begin() + static_cast<std::ptrdiff_t>(end_), bytes_.begin());
      end_ -= start_;
      start_ = 0;
    }
    if (bytes_.size() - end_ < kChunk) bytes_.resize(end_ + 2 * kChunk);
    const Result<std::size_t> got = stream_.read(std::span(bytes_).subspan(end_));
    if (!got) return tl::unexpected(got.error());
    end_ += *got;
    at_end_ = *got == 0;
  }
  return std::span<const std::uint8_t>(bytes_).subspan(start_, std::min(count, end_ - start_));
}

void StreamReader::skip(std::size_t count) {
  assert(count <= end_ - start_);
  start_ += count;
  position_ += count;
}

Result<std::optional<std::string_view>> StreamReader::next_line() {
  constexpr std::size_t kUsual = 4096;
  for (std::size_t wanted = kUsual;; wanted = std::min(2 * wanted, kMaxLine)) {
    const auto bytes = peek(wanted);
    if (!bytes) return tl::unexpected(bytes.error());
    if (bytes->empty()) return std::nullopt;
    std::string_view line = text_of(*bytes);
    const std::size_t end = line.find('\n');
    const bool is_last = bytes->size() < wanted;
    if (end == std::string_view::npos && !is_last && wanted < kMaxLine) continue;
    line_has_end_ = end != std::string_view::npos;
    skip(line_has_end_ ? end + 1 : line.size());
    line = line.substr(0, end);
    if (line.ends_with('\r')) {
      line.remove_suffix(1);
      line_has_end_ = true;
    }
    return line;
  }
}

}  // namespace pingvox
