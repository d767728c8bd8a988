#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace pingvox {

/// Compression of the chunks of a bag.
enum class Compression { kNone, kBz2, kLz4, kZstd };

/// The largest chunk that is unpacked.
inline constexpr std::uint64_t kMaxChunk = std::uint64_t{1} << 30;

/// What the compressed parts of one file may unpack to, in proportion to what was unpacked of it so far: a file made to
/// fill the memory, or to keep the program busy, ends there.
class UnpackBudget {
 public:
  /// How much `packed` bytes may unpack to.
  std::uint64_t limit(std::uint64_t packed) const {
    return std::min(kMaxChunk, kFree + kRatio * (packed_ + packed) - unpacked_);
  }
  /// Counts a part that was unpacked. REQUIRES one within the limit.
  void add(std::uint64_t packed, std::uint64_t unpacked) {
    packed_ += packed;
    unpacked_ += unpacked;
  }

 private:
  /// Recordings compress to a fifth or so. Silence compresses more, but hardly for long.
  static constexpr std::uint64_t kRatio = 32, kFree = std::uint64_t{128} << 20;

  std::uint64_t packed_ = 0, unpacked_ = 0;
};

struct Unpacked {
  bool is_whole = false;    ///< else `to` holds the beginning as far as it could be unpacked
  std::size_t packed = 0;   ///< bytes that were needed; an end mark may follow
  bool is_refused = false;  ///< the budget does not allow it; `to` is empty
};

/// The kind of damage where a budget does not allow to unpack a part.
inline constexpr std::string_view kTooLargeUnpacked = "unpacks to more than its file can be";

/// Unpacks `packed` (lz4: frames) to exactly `size` bytes in `to`, unless the data are damaged or the budget is spent.
/// REQUIRES a compression other than kNone.
Unpacked unpack(Compression compression, std::span<const std::uint8_t> packed, std::uint64_t size, UnpackBudget& budget,
                std::vector<std::uint8_t>& to);

/// Whether the bytes begin a frame of zstd.
bool begins_zstd(std::span<const std::uint8_t> bytes);
/// Unpacks one frame of zstd, whatever its size.
Unpacked unpack_zstd_frame(std::span<const std::uint8_t> packed, UnpackBudget& budget, std::vector<std::uint8_t>& to);

}  // namespace pingvox
