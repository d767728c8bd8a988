#include "pingvox/io/file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <optional>
#include <streambuf>
#include <string_view>
#include <system_error>
#include <utility>

#include "io/internal/descriptor.hpp"
#include "pingvox/io/byte_stream.hpp"

namespace pingvox {
namespace {

namespace fs = std::filesystem;

/// A stream buffer on a file descriptor: std::ofstream has neither the descriptor, needed for fsync, nor errno.
class DescriptorBuffer : public std::streambuf {
 public:
  explicit DescriptorBuffer(int fd) : fd_(fd) { reset(); }

  /// 0, or the first error of the operating system.
  int error() const { return error_; }

 protected:
  int_type overflow(int_type c) override {
    if (!drain()) return traits_type::eof();
    if (!traits_type::eq_int_type(c, traits_type::eof())) {
      *pptr() = traits_type::to_char_type(c);
      pbump(1);
    }
    return traits_type::not_eof(c);
  }
  int sync() override { return drain() ? 0 : -1; }

 private:
  void reset() { setp(buffer_.data(), buffer_.data() + buffer_.size()); }

  bool drain() {
    const char* from = pbase();
    while (error_ == 0 && from < pptr()) {
      const ssize_t written = ::write(fd_, from, static_cast<std::size_t>(pptr() - from));
      if (written > 0) from += written;
      if (written < 0 && errno != EINTR) error_ = errno;
      if (written == 0) error_ = EIO;
    }
    reset();
    return error_ == 0;
  }

  int fd_;
  int error_ = 0;
  std::array<char, 1 << 16> buffer_;
};

using Writer = std::function<Result<void>(std::ostream&)>;

Result<void> write_to(int fd, std::string_view name, const Writer& write) {
  DescriptorBuffer buffer(fd);
  std::ostream out(&buffer);
  Result<void> written = write(out);
  out.flush();
  // The cause first: the writer only knows that its stream failed.
  if (buffer.error() != 0) return os_error(name, buffer.error());
  if (!written) return written;
  if (!out) return fail(Error::Code::kIo, fmt::format("{}: could not be written", name));
  return {};
}

/// Whether `path` still names the open file.
bool is_at(int fd, const fs::path& path) {
  struct stat open = {}, named = {};
  return ::fstat(fd, &open) == 0 && ::lstat(path.c_str(), &named) == 0 && open.st_dev == named.st_dev &&
         open.st_ino == named.st_ino;
}

int lock(int fd, int operation) {
  int status = 0;
  do status = ::flock(fd, operation);
  while (status != 0 && errno == EINTR);
  return status;
}

/// A temporary file beside its target, removed unless it is moved there. It is locked while in use: one without a lock
/// was left by a killed process.
class TemporaryFile {
 public:
  TemporaryFile() = default;
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (!path_.empty()) ::unlink(path_.c_str());
    if (locked_ >= 0) ::close(locked_);
  }

  /// A descriptor to write to, or -1 with errno.
  int create_for(const fs::path& target) {
    // Fewer processes write one file at once.
    for (int number = 0; number < 16; ++number) remove_abandoned(path_for(target, number));
    for (int number = 0; number < 1000; ++number) {
      const fs::path path = path_for(target, number);
      const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (fd < 0 && errno == EEXIST) continue;
      if (fd < 0) return -1;
      // On file systems without locks no process removes files of others.
      if (lock(fd, LOCK_EX) != 0 || is_at(fd, path)) {
        path_ = path;
        locked_ = fd;
        return ::fcntl(fd, F_DUPFD_CLOEXEC, 0);
      }
      ::close(fd);  // removed by another process before it was locked
    }
    errno = EEXIST;
    return -1;
  }

  /// 0 or errno.
  int move_to(const fs::path& target) {
    if (::rename(path_.c_str(), target.c_str()) != 0) return errno;
    path_.clear();
    return 0;
  }

 private:
  static fs::path path_for(const fs::path& target, int number) {
    constexpr std::size_t kMaxName = 200;  // of the 255 bytes that a name may have
    return target.parent_path() /
           fmt::format(".{}.pingvox-{}.tmp", target.filename().string().substr(0, kMaxName), number);
  }

  static void remove_abandoned(const fs::path& path) {
    // Open for writing, as network file systems require for a lock.
    const Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
    if (file.valid() && lock(file.get(), LOCK_EX | LOCK_NB) == 0 && is_at(file.get(), path)) ::unlink(path.c_str());
  }

  fs::path path_;
  int locked_ = -1;
};

/// 0 or errno. File systems without fsync (some network and FUSE ones) are no error.
int sync_to_disk(int fd) {
  if (::fsync(fd) == 0 || errno == EINVAL || errno == ENOSYS || errno == ENOTSUP || errno == EROFS) return 0;
  return errno;
}

/// Target of a chain of symbolic links, so that the rename replaces the file, not the link.
Result<fs::path> end_of_links(const std::string& name) {
  fs::path path = name;
  for (int links = 0; links < 40; ++links) {
    std::error_code error;
    if (!fs::is_symlink(fs::symlink_status(path, error))) return path;
    const fs::path next = fs::read_symlink(path, error);
    if (error) return os_error(name, error.value());
    path = next.is_absolute() ? next : path.parent_path() / next;
  }
  return os_error(name, ELOOP);
}

Result<void> replace(const fs::path& target, std::optional<mode_t> mode, const std::string& name, const Writer& write) {
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  TemporaryFile temporary;
  Descriptor file(temporary.create_for(target));
  if (!file.valid()) return os_error(name, errno);
  if (mode && ::fchmod(file.get(), *mode) != 0) return os_error(name, errno);

  if (const Result<void> written = write_to(file.get(), name, write); !written) return written;
  if (const int error = sync_to_disk(file.get())) return os_error(name, error);
  if (const int error = file.close()) return os_error(name, error);
  if (const int error = temporary.move_to(target)) return os_error(name, error);

  // Sync the folder, which holds the rename. It may be writable but not readable; then it cannot be synced.
  const Descriptor opened_folder(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!opened_folder.valid()) return {};
  if (const int error = sync_to_disk(opened_folder.get())) return os_error(name, error);
  return {};
}

}  // namespace

Result<FileBytes> read_file(const std::string& path) {
  Result<ByteStream> stream = ByteStream::open(path);
  if (!stream) return tl::unexpected(stream.error());
  return ByteStream::whole(std::move(*stream));
}

Result<void> write_file(const std::string& path, const Writer& write) {
  if (path == "-") return write_to(STDOUT_FILENO, "standard output", write);
  if (path.empty()) return fail(Error::Code::kIo, "a file to be written needs a name");

  const Result<fs::path> target = end_of_links(path);
  if (!target) return tl::unexpected(target.error());

  struct stat status = {};
  const bool exists = ::stat(target->c_str(), &status) == 0;
  if (!exists && errno != ENOENT) return os_error(path, errno);
  if (!exists) return replace(*target, std::nullopt, path, write);
  if (S_ISDIR(status.st_mode)) return os_error(path, EISDIR);
  // A rename needs permission for the folder only, and would ignore a write protection of the file.
  if (::faccessat(AT_FDCWD, target->c_str(), W_OK, AT_EACCESS) != 0) return os_error(path, errno);
  if (S_ISREG(status.st_mode)) return replace(*target, status.st_mode & 0777, path, write);

  // Devices and pipes are written in place: a rename would replace them by a file.
  Descriptor device(::open(target->c_str(), O_WRONLY | O_CLOEXEC));
  if (!device.valid()) return os_error(path, errno);
  if (const Result<void> written = write_to(device.get(), path, write); !written) return written;
  if (const int error = device.close()) return os_error(path, error);
  return {};
}

}  // namespace pingvox
