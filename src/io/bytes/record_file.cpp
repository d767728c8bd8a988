#include "io/internal/record_file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

namespace pingvox {
namespace {

/// The name of a new file is part of its folder, which the system would write some seconds later. File systems without
/// this are no error.
void sync_folder_of(const std::filesystem::path& file) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  const Descriptor opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (opened.valid()) static_cast<void>(::fsync(opened.get()));
}

}  // namespace

double recorded_time_s(std::uint64_t time_ms) {
  // Added as readers do, to the last bit.
  constexpr double kDay_s = 86'400.0;
  constexpr std::uint64_t kDay_ms = 86'400'000;
  const std::uint64_t days = time_ms / kDay_ms, of_day = time_ms % kDay_ms, seconds = of_day / 1000;
  const double of_day_s = static_cast<double>(seconds) + static_cast<double>(of_day % 1000) / 1000.0;
  return of_day_s + static_cast<double>(days) * kDay_s;
}

Result<RecordFile> RecordFile::create(const std::string& path) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666));
  if (!file.valid() && errno == EEXIST) {
    return fail(Error::Code::kIo, fmt::format("{}: exists, and a recording is never overwritten", path));
  }
  if (!file.valid()) return os_error(path, errno);
  sync_folder_of(path);
  return RecordFile(path, std::move(file));
}

Result<void> RecordFile::append(std::span<const std::uint8_t> record) {
  for (std::size_t done = 0; done < record.size();) {
    const ssize_t written = ::write(file_.get(), record.data() + done, record.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      const int error = written < 0 ? errno : EIO;
      // On a full disk a part of the record may be written. A later record goes to the new end, by O_APPEND.
      static_cast<void>(::ftruncate(file_.get(), static_cast<off_t>(size_)));
      return os_error(path_, error);
    }
    done += static_cast<std::size_t>(written);
  }
  size_ += record.size();
  return {};
}

Result<void> RecordFile::sync_if_due(double now_s) {
  constexpr double kInterval_s = 1.0;
  if (now_s < sync_due_s_) return {};
  sync_due_s_ = now_s + kInterval_s;
  // It may fail where the file is not on a disk; the operating system writes everything in time anyway.
  static_cast<void>(::sync_file_range(file_.get(), 0, 0, SYNC_FILE_RANGE_WRITE));
  return check_place();
}

Result<void> RecordFile::check_place() const {
  struct stat open = {}, named = {};
  if (::fstat(file_.get(), &open) != 0) return os_error(path_, errno);
  if (open.st_nlink == 0) {
    return fail(Error::Code::kIo, fmt::format("{}: was removed: the recording is lost", path_));
  }
  const bool is_there =
      ::stat(path_.c_str(), &named) == 0 && open.st_dev == named.st_dev && open.st_ino == named.st_ino;
  if (is_there) return {};
  return fail(Error::Code::kIo,
              fmt::format("{}: was moved or replaced: the recording continues in the moved file", path_));
}

}  // namespace pingvox
