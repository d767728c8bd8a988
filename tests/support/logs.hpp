#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pingvox/io/beams.hpp"

namespace pingvox {

inline std::vector<std::uint8_t> bytes_of(std::string_view text) {
  return {text.begin(), text.end()};
}

/// "00ff 0a" as bytes.
inline std::vector<std::uint8_t> from_hex(std::string_view hex) {
  const auto digit = [](char c) { return c >= 'a' ? c - 'a' + 10 : c - '0'; };
  std::vector<std::uint8_t> bytes;
  std::optional<int> high;
  for (const char c : hex) {
    if (c == ' ' || c == '\n') continue;
    if (high) bytes.push_back(static_cast<std::uint8_t>(*high * 16 + digit(c)));
    high = high ? std::nullopt : std::optional(digit(c));
  }
  return bytes;
}

/// ReadResult that a source gives, and how it ends.
template <class T>
struct ReadResult {
  std::vector<T> items;
  std::size_t skipped = 0;
  std::string error;  ///< empty: the end of the source
};

template <class T, class Source>
ReadResult<T> read_everything(Result<std::unique_ptr<Source>> source) {
  ReadResult<T> all;
  if (!source) {
    all.error = source.error().message;
    return all;
  }
  for (;;) {
    Result<std::optional<T>> item = (*source)->next();
    all.skipped = (*source)->skipped();
    if (!item) all.error = item.error().message;
    if (!item || !*item) return all;
    all.items.push_back(std::move(**item));
  }
}

inline ReadResult<Beam> all_beams(FileBytes file, Damage damage = Damage::kSkip) {
  return read_everything<Beam>(open_beams(std::move(file), damage));
}

inline ReadResult<PointScan> all_scans(FileBytes file, Damage damage = Damage::kSkip) {
  return read_everything<PointScan>(open_scans(std::move(file), damage));
}

inline bool same(const Beam& a, const Beam& b) {
  return a.time_s == b.time_s && a.bearing_rad == b.bearing_rad && a.bin_length_m == b.bin_length_m &&
         a.intensities == b.intensities;
}

}  // namespace pingvox
