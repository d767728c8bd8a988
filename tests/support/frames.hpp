#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "io/internal/frame_finder.hpp"

namespace pingvox {

using Frames = std::vector<std::vector<std::uint8_t>>;

/// All frames of a stream that comes in pieces of `piece` bytes.
inline Frames frames_in(CheckFrame check, std::span<const std::uint8_t> stream, std::size_t piece) {
  FrameFinder finder(check);
  Frames frames;
  const auto take = [&] {
    while (const auto frame = finder.next()) frames.emplace_back(frame->bytes.begin(), frame->bytes.end());
  };
  while (!stream.empty()) {
    const auto next = stream.first(std::min(piece, stream.size()));
    finder.push(next);
    take();
    stream = stream.subspan(next.size());
  }
  finder.end();
  take();
  return frames;
}

inline std::vector<std::uint8_t> joined(const Frames& pieces) {
  std::vector<std::uint8_t> all;
  for (const auto& piece : pieces) all.insert(all.end(), piece.begin(), piece.end());
  return all;
}

}  // namespace pingvox
