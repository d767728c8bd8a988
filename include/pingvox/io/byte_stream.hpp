#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pingvox/io/bytes.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// The bytes of a file, a pipe or memory, read as they are needed. The beginning stays in memory, because it shows the
/// format.
class ByteStream {
 public:
  static constexpr std::size_t kBeginning = std::size_t{1} << 16;
  static constexpr std::string_view kStandardInput = "standard input";  ///< its name

  /// Bytes in memory.
  ByteStream(FileBytes file);  // NOLINT(google-explicit-constructor): functions of streams accept bytes in memory
  /// @param path  "-" is standard input; a folder with one ROS 2 bag (.db3 or .mcap files) in it is that bag
  /// @return kIo when it cannot be opened or read (not found, no permission, another directory); the message names it
  static Result<ByteStream> open(const std::string& path);

  ByteStream(ByteStream&&) noexcept;
  ByteStream& operator=(ByteStream&&) noexcept;
  ~ByteStream();

  const std::string& name() const { return held_.name; }
  /// The file that is read, for readers that open it again; nullopt: a pipe, or memory. Of a bag of several files their
  /// folder.
  std::optional<std::string> path() const;
  /// The files of a bag in a folder, in their order, where they are several: the bytes are those of the first one, and
  /// the name is that of the folder. Else empty.
  const std::vector<std::string>& bag_files() const { return bag_files_; }
  /// The first bytes, at most kBeginning, also after reading on.
  std::span<const std::uint8_t> beginning() const;

  /// Copies the next bytes to the front of `to`.
  /// @return their number, 0 only at the end; kIo when the operating system reports an error
  /// REQUIRES a `to` that is not empty
  Result<std::size_t> read(std::span<std::uint8_t> to);
  /// Copies the bytes from `position` on to the front of `to`; read() goes on where it was.
  /// @return their number, fewer than wanted only at the end, 0 for a stream that is read only once (a pipe, a device,
  ///         standard input); kIo when the operating system reports an error
  Result<std::size_t> read_at(std::uint64_t position, std::span<std::uint8_t> to) const;
  /// Fraction read so far, 0..1; nullopt if the size is unknown.
  std::optional<double> share_read() const;

  /// Reads everything into memory. REQUIRES that read() was not called.
  Result<void> load_all();
  /// The bytes in memory: at least the beginning, everything after load_all().
  const FileBytes& held() const { return held_; }
  bool is_all_held() const { return rest_ == nullptr; }
  /// Everything, as load_all(). REQUIRES the same.
  static Result<FileBytes> whole(ByteStream stream);

 private:
  class Source;
  ByteStream(FileBytes beginning, std::unique_ptr<Source> rest);

  FileBytes held_;  ///< the beginning, or everything
  std::size_t taken_ = 0;
  std::vector<std::string> bag_files_;
  std::unique_ptr<Source> rest_;  ///< what is not in held_; nullptr: nothing
};

}  // namespace pingvox
