#include "io/bags/unpack.hpp"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <memory>
#include <optional>

namespace pingvox {
namespace {

using Bytes = std::span<const std::uint8_t>;
using Room = std::span<std::uint8_t>;

/// Each unpacks the next bytes into `room` and takes what it needs of `packed`.
/// @return how many; nullopt: the data ended, or are damaged from here on
class Bz2 {
 public:
  Bz2() : is_open_(BZ2_bzDecompressInit(&stream_, 0, 0) == BZ_OK) {}
  ~Bz2() { BZ2_bzDecompressEnd(&stream_); }
  Bz2(const Bz2&) = delete;
  Bz2& operator=(const Bz2&) = delete;

  std::optional<std::size_t> next(Bytes& packed, Room room) {
    if (!is_open_) return std::nullopt;
    // libbz2 does not change its input, but takes it as char*.
    stream_.next_in = const_cast<char*>(reinterpret_cast<const char*>(packed.data()));
    stream_.avail_in = static_cast<unsigned>(packed.size());
    stream_.next_out = reinterpret_cast<char*>(room.data());
    stream_.avail_out = static_cast<unsigned>(room.size());
    is_open_ = BZ2_bzDecompress(&stream_) == BZ_OK;
    packed = packed.last(stream_.avail_in);
    const std::size_t written = room.size() - stream_.avail_out;
    return written > 0 || is_open_ ? std::optional(written) : std::nullopt;
  }

 private:
  bz_stream stream_ = {};
  bool is_open_;
};

class Lz4 {
 public:
  std::optional<std::size_t> next(Bytes& packed, Room room) {
    if (!context_) return std::nullopt;
    std::size_t taken = packed.size(), written = room.size();
    const std::size_t result = LZ4F_decompress(context_.get(), room.data(), &written, packed.data(), &taken, nullptr);
    if (LZ4F_isError(result) != 0) return std::nullopt;
    packed = packed.subspan(taken);
    return written;
  }

 private:
  static LZ4F_dctx* make_context() {
    LZ4F_dctx* context = nullptr;
    return LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0 ? nullptr : context;
  }

  static constexpr auto kFree = [](LZ4F_dctx* context) { LZ4F_freeDecompressionContext(context); };
  std::unique_ptr<LZ4F_dctx, decltype(kFree)> context_{make_context()};
};

class Zstd {
 public:
  std::optional<std::size_t> next(Bytes& packed, Room room) {
    if (!context_) return std::nullopt;
    ZSTD_inBuffer in = {packed.data(), packed.size(), 0};
    ZSTD_outBuffer out = {room.data(), room.size(), 0};
    const std::size_t result = ZSTD_decompressStream(context_.get(), &out, &in);
    packed = packed.subspan(in.pos);
    if (in.pos > 0 || out.pos > 0) has_ended_ = result == 0;
    if (ZSTD_isError(result) != 0) return std::nullopt;
    return out.pos;
  }
  /// Whether the last bytes were those of a frame's end.
  bool has_ended() const { return has_ended_; }

 private:
  bool has_ended_ = false;
  static constexpr auto kFree = [](ZSTD_DCtx* context) { ZSTD_freeDCtx(context); };
  std::unique_ptr<ZSTD_DCtx, decltype(kFree)> context_{ZSTD_createDCtx()};
};

/// Unpacks at most `size` bytes. Grows with what is there, as a damaged size may be any.
/// @return what is left of `packed`
template <class Unpacker>
Bytes unpack_with(Unpacker&& unpacker, Bytes packed, std::size_t size, std::vector<std::uint8_t>& to) {
  constexpr std::size_t kMinRoom = std::size_t{1} << 16, kUsualRatio = 4;
  to.clear();
  while (to.size() < size) {
    const std::size_t done = to.size(), before = packed.size();
    to.resize(done + std::min(size - done, std::max({kMinRoom, kUsualRatio * packed.size(), done})));
    const std::optional<std::size_t> written = unpacker.next(packed, Room(to).subspan(done));
    to.resize(done + written.value_or(0));
    if (!written || (*written == 0 && packed.size() == before)) break;
  }
  return packed;
}

}  // namespace

Unpacked unpack(Compression compression, std::span<const std::uint8_t> packed, std::uint64_t size, UnpackBudget& budget,
                std::vector<std::uint8_t>& to) {
  assert(compression != Compression::kNone);
  to.clear();
  if (packed.size() > kMaxChunk || size > budget.limit(packed.size())) return {.is_refused = true};
  const auto whole = static_cast<std::size_t>(size);
  const Bytes left = compression == Compression::kBz2   ? unpack_with(Bz2(), packed, whole, to)
                     : compression == Compression::kLz4 ? unpack_with(Lz4(), packed, whole, to)
                                                        : unpack_with(Zstd(), packed, whole, to);
  budget.add(packed.size(), to.size());
  return {to.size() == whole, packed.size() - left.size(), false};
}

bool begins_zstd(std::span<const std::uint8_t> bytes) {
  constexpr std::array<std::uint8_t, 4> kMagic = {0x28, 0xb5, 0x2f, 0xfd};
  return bytes.size() > kMagic.size() && std::equal(kMagic.begin(), kMagic.end(), bytes.begin());
}

Unpacked unpack_zstd_frame(std::span<const std::uint8_t> packed, UnpackBudget& budget, std::vector<std::uint8_t>& to) {
  to.clear();
  const std::uint64_t most = budget.limit(packed.size());
  const unsigned long long stated = ZSTD_getFrameContentSize(packed.data(), packed.size());
  if (stated == ZSTD_CONTENTSIZE_ERROR) return {};
  const bool is_stated = stated != ZSTD_CONTENTSIZE_UNKNOWN;
  if (is_stated && stated > most) return {.is_refused = true};
  Zstd frame;
  const Bytes left = unpack_with(frame, packed, static_cast<std::size_t>(is_stated ? stated : most), to);
  budget.add(packed.size(), to.size());
  // Of a size that is not stated the end of the frame tells that it is whole.
  const bool is_whole = is_stated ? to.size() == stated : frame.has_ended();
  return {is_whole, packed.size() - left.size(), !is_whole && to.size() == most};
}

}  // namespace pingvox
