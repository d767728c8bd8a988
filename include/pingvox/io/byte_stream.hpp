#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "pingvox/io/bytes.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// The bytes of a file, a pipe or a piece of memory, read as they are needed. Its beginning is always at hand, since it
/// tells the format.
class ByteStream {
 public:
  static constexpr std::size_t kBeginning = std::size_t{1} << 16;

  /// Bytes in memory.
  ByteStream(FileBytes file);  // NOLINT(google-explicit-constructor): whoever takes a stream takes a file's bytes too
  /// @param path  "-" is standard input
  /// @return kIo when it cannot be opened or read: not there, no right, a directory; the message names it
  static Result<ByteStream> open(const std::string& path);

  ByteStream(ByteStream&&) noexcept;
  ByteStream& operator=(ByteStream&&) noexcept;
  ~ByteStream();

  const std::string& name() const { return held_.name; }
  /// The first bytes, at most kBeginning, whatever has been read since.
  std::span<const std::uint8_t> beginning() const;

  /// Puts the next bytes at the front of `to`.
  /// @return how many, 0 only at the end; kIo when the operating system refuses
  /// REQUIRES a `to` that is not empty
  Result<std::size_t> read(std::span<std::uint8_t> to);
  /// How much was read so far, 0..1; nullopt: nobody knows how much there is.
  std::optional<double> share_read() const;

  /// Reads all there is into memory. REQUIRES that read() was not called.
  Result<void> hold_all();
  /// What is in memory: the beginning at least, all of it after hold_all().
  const FileBytes& held() const { return held_; }
  /// All of it, as hold_all. REQUIRES the same.
  static Result<FileBytes> whole(ByteStream stream);

 private:
  class Source;
  ByteStream(FileBytes beginning, std::unique_ptr<Source> rest);

  FileBytes held_;  ///< the beginning, or everything
  std::size_t taken_ = 0;
  std::unique_ptr<Source> rest_;  ///< what is not in held_; nullptr: nothing
};

}  // namespace pingvox
