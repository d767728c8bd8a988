#include "pingvox/io/byte_stream.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <new>
#include <stdexcept>
#include <utility>

#include "io/bags/bag_folder.hpp"
#include "io/internal/descriptor.hpp"

namespace pingvox {

/// The rest of a file, a pipe or a device after the beginning.
class ByteStream::Source {
 public:
  /// @param size  of a regular file; nullopt: unknown
  Source(Descriptor owned, int fd, std::optional<std::uint64_t> size)
      : owned_(std::move(owned)), fd_(fd), size_(size) {}

  /// Number of bytes read, 0 at the end, or errno.
  tl::expected<std::size_t, int> read(std::span<std::uint8_t> to) {
    for (;;) {
      const ssize_t got = ::read(fd_, to.data(), to.size());
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) return tl::unexpected(errno);
      read_ += static_cast<std::uint64_t>(got);
      return static_cast<std::size_t>(got);
    }
  }

  /// The same from a position on, without moving. REQUIRES a regular file.
  tl::expected<std::size_t, int> read_at(std::uint64_t position, std::span<std::uint8_t> to) const {
    std::size_t filled = 0;
    while (filled < to.size() && position + filled < *size_) {
      const ssize_t got = ::pread(fd_, &to[filled], to.size() - filled, static_cast<off_t>(position + filled));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) return tl::unexpected(errno);
      if (got == 0) break;
      filled += static_cast<std::size_t>(got);
    }
    return filled;
  }

  std::uint64_t bytes_read() const { return read_; }
  std::optional<std::uint64_t> size() const { return size_; }
  bool is_standard_input() const { return !owned_.valid(); }

 private:
  Descriptor owned_;  ///< empty for standard input, which stays open
  int fd_;
  std::optional<std::uint64_t> size_;
  std::uint64_t read_ = 0;
};

ByteStream::ByteStream(FileBytes file) : held_(std::move(file)) {}
ByteStream::ByteStream(FileBytes beginning, std::unique_ptr<Source> rest)
    : held_(std::move(beginning)), rest_(std::move(rest)) {}
ByteStream::ByteStream(ByteStream&&) noexcept = default;
ByteStream& ByteStream::operator=(ByteStream&&) noexcept = default;
ByteStream::~ByteStream() = default;

Result<ByteStream> ByteStream::open(const std::string& path) {
  const bool standard_input = path == "-";
  FileBytes beginning{standard_input ? std::string(kStandardInput) : path, {}};

  Descriptor opened(standard_input ? -1 : ::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!standard_input && !opened.valid()) return os_error(beginning.name, errno);
  const int fd = standard_input ? STDIN_FILENO : opened.get();

  struct stat status = {};
  if (::fstat(fd, &status) != 0) return os_error(beginning.name, errno);
  if (S_ISDIR(status.st_mode)) {
    Result<std::vector<std::string>> files = bag_files_in(path);
    if (!files) return tl::unexpected(files.error());
    Result<ByteStream> first = open(files->front());
    if (!first || files->size() == 1) return first;
    first->held_.name = path;
    first->bag_files_ = *std::move(files);
    return first;
  }
  std::optional<std::uint64_t> size;
  if (S_ISREG(status.st_mode)) size = static_cast<std::uint64_t>(status.st_size);

  auto rest = std::make_unique<Source>(std::move(opened), fd, size);
  beginning.bytes.resize(kBeginning);
  std::size_t filled = 0;
  while (filled < kBeginning) {
    const auto got = rest->read(std::span(beginning.bytes).subspan(filled));
    if (!got) return os_error(beginning.name, got.error());
    if (*got == 0) break;
    filled += *got;
  }
  beginning.bytes.resize(filled);
  return ByteStream(std::move(beginning), std::move(rest));
}

std::optional<std::string> ByteStream::path() const {
  if (!rest_ || !rest_->size()) return std::nullopt;
  return rest_->is_standard_input() ? std::nullopt : std::optional(held_.name);
}

std::span<const std::uint8_t> ByteStream::beginning() const {
  return held_.view().first(std::min(held_.bytes.size(), kBeginning));
}

Result<std::size_t> ByteStream::read(std::span<std::uint8_t> to) {
  assert(!to.empty());
  const std::size_t held = std::min(to.size(), held_.bytes.size() - taken_);
  if (held > 0) {
    std::copy_n(held_.bytes.begin() + static_cast<std::ptrdiff_t>(taken_), held, to.begin());
    taken_ += held;
    return held;
  }
  if (!rest_) return std::size_t{0};
  const auto got = rest_->read(to);
  if (!got) return os_error(name(), got.error());
  return *got;
}

Result<std::size_t> ByteStream::read_at(std::uint64_t position, std::span<std::uint8_t> to) const {
  if (!rest_) {
    const std::span<const std::uint8_t> held = held_.view();
    const std::span<const std::uint8_t> from = held.subspan(std::min<std::uint64_t>(position, held.size()));
    const std::size_t count = std::min(from.size(), to.size());
    std::copy_n(from.begin(), count, to.begin());
    return count;
  }
  if (!path()) return std::size_t{0};
  const auto got = rest_->read_at(position, to);
  if (!got) return os_error(name(), got.error());
  return *got;
}

std::optional<double> ByteStream::share_read() const {
  std::uint64_t all = held_.bytes.size(), read = taken_;
  if (rest_) {
    if (!rest_->size() || *rest_->size() == 0) return std::nullopt;
    // A file may grow while it is read.
    all = std::max(*rest_->size(), rest_->bytes_read());
    read += rest_->bytes_read() - held_.bytes.size();
  }
  return all > 0 ? static_cast<double>(read) / static_cast<double>(all) : 1.0;
}

Result<void> ByteStream::load_all() {
  assert(taken_ == 0);
  if (!rest_) return {};
  if (!bag_files_.empty()) {
    return fail(Error::Code::kUnsupported,
                fmt::format("{}: is a bag of {} files, not one: name them one by one", name(), bag_files_.size()));
  }
  const auto too_large = [&] { return fail(Error::Code::kIo, fmt::format("{}: does not fit into memory", name())); };
  constexpr std::size_t kChunk = std::size_t{1} << 20;
  std::vector<std::uint8_t>& bytes = held_.bytes;
  try {
    // One byte more than the file, so that its end is read without reallocation.
    bytes.reserve(static_cast<std::size_t>(rest_->size().value_or(0)) + 1);
    for (std::size_t size = bytes.size();;) {
      const std::size_t room = bytes.capacity() - size;
      bytes.resize(size + (room > 0 ? std::min(room, kChunk) : kChunk));
      const auto got = rest_->read(std::span(bytes).subspan(size));
      if (!got) return os_error(name(), got.error());
      size += *got;
      if (*got == 0) {
        bytes.resize(size);
        rest_.reset();
        return {};
      }
    }
  } catch (const std::bad_alloc&) {
    return too_large();
  } catch (const std::length_error&) {
    return too_large();
  }
}

Result<FileBytes> ByteStream::whole(ByteStream stream) {
  if (const Result<void> held = stream.load_all(); !held) return tl::unexpected(held.error());
  return std::move(stream.held_);
}

}  // namespace pingvox
