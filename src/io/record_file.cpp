#include "pingvox/io/record_file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>

namespace pingvox {

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

void RecordFile::sync_if_due(double now_s) {
  constexpr double kInterval_s = 1.0;
  if (now_s < sync_due_s_) return;
  sync_due_s_ = now_s + kInterval_s;
  // It may fail where the file is not on a disk; the operating system writes everything in time anyway.
  static_cast<void>(::sync_file_range(file_.get(), 0, 0, SYNC_FILE_RANGE_WRITE));
}

}  // namespace pingvox
