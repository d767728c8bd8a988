#include "io/internal/deflate.hpp"

#include <zlib.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>

namespace pingvox {

Result<std::vector<std::uint8_t>> deflate_raw(std::span<const std::uint8_t> bytes) {
  constexpr int kRawWindow = -15, kMemoryLevel = 9;  // negative: without a header
  constexpr std::size_t kLongest = std::numeric_limits<uInt>::max();
  z_stream stream{};
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kRawWindow, kMemoryLevel, Z_DEFAULT_STRATEGY) != Z_OK) {
    return fail(Error::Code::kNoMemory, "out of memory");
  }
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, &deflateEnd);
  std::vector<std::uint8_t> packed(deflateBound(&stream, static_cast<uLong>(bytes.size())));
  std::size_t read = 0, written = 0;
  for (int status = Z_OK; status != Z_STREAM_END;) {
    // In pieces whose lengths zlib's numbers hold.
    const std::size_t input = std::min(bytes.size() - read, kLongest);
    const std::size_t output = std::min(packed.size() - written, kLongest);
    stream.next_in = const_cast<Bytef*>(bytes.data() + read);  // NOLINT(*-const-cast): zlib does not write there
    stream.avail_in = static_cast<uInt>(input);
    stream.next_out = packed.data() + written;
    stream.avail_out = static_cast<uInt>(output);
    status = deflate(&stream, read + input == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
    if (status != Z_OK && status != Z_STREAM_END) return fail(Error::Code::kUnsupported, "could not be compressed");
    read += input - stream.avail_in;
    written += output - stream.avail_out;
  }
  packed.resize(written);
  return packed;
}

}  // namespace pingvox
