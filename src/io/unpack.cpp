#include "io/unpack.hpp"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <cassert>
#include <cstddef>

namespace pingvox {
namespace {

/// Unpacks what it can. @return the number of bytes
std::size_t unpack_bz2(std::span<const std::uint8_t> packed, std::span<std::uint8_t> to) {
  bz_stream stream = {};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return 0;
  // libbz2 does not change its input, but takes it as char*.
  stream.next_in = const_cast<char*>(reinterpret_cast<const char*>(packed.data()));
  stream.avail_in = static_cast<unsigned>(packed.size());
  stream.next_out = reinterpret_cast<char*>(to.data());
  stream.avail_out = static_cast<unsigned>(to.size());
  while (stream.avail_in > 0 && stream.avail_out > 0 && BZ2_bzDecompress(&stream) == BZ_OK) {
  }
  const std::size_t left = stream.avail_out;
  BZ2_bzDecompressEnd(&stream);
  return to.size() - left;
}

std::size_t unpack_lz4(std::span<const std::uint8_t> packed, std::span<std::uint8_t> to) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0) return 0;
  std::size_t done = 0;
  while (!packed.empty() && done < to.size()) {
    std::size_t taken = packed.size(), written = to.size() - done;
    const std::size_t result = LZ4F_decompress(context, to.data() + done, &written, packed.data(), &taken, nullptr);
    if (LZ4F_isError(result) != 0) break;
    done += written;
    packed = packed.subspan(taken);
    if (taken == 0 && written == 0) break;
  }
  LZ4F_freeDecompressionContext(context);
  return done;
}

/// All or nothing: unpacking a part takes a window of up to 128 MB.
std::size_t unpack_zstd(std::span<const std::uint8_t> packed, std::span<std::uint8_t> to) {
  const std::size_t result = ZSTD_decompress(to.data(), to.size(), packed.data(), packed.size());
  return ZSTD_isError(result) != 0 ? 0 : result;
}

}  // namespace

bool unpack(Compression compression, std::span<const std::uint8_t> packed, std::uint64_t size,
            std::vector<std::uint8_t>& to) {
  assert(compression != Compression::kNone);
  // No sonar compresses like this, but a damaged size does.
  constexpr std::uint64_t kMaxRatio = 1024, kMaxUnchecked = 65'536;
  if (size > kMaxChunk || packed.size() > kMaxChunk || size > kMaxUnchecked + kMaxRatio * packed.size()) {
    to.clear();
    return false;
  }
  to.resize(static_cast<std::size_t>(size));
  std::size_t done = 0;
  if (size > 0) {
    done = compression == Compression::kBz2   ? unpack_bz2(packed, to)
           : compression == Compression::kLz4 ? unpack_lz4(packed, to)
                                              : unpack_zstd(packed, to);
  }
  to.resize(done);
  return done == size;
}

}  // namespace pingvox
