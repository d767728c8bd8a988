#include "pingvox/io/record_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

namespace pingvox {

Result<RecordFile> RecordFile::create(const std::string& path) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (!file.valid()) return os_error(path, errno);
  return RecordFile(path, std::move(file));
}

Result<void> RecordFile::append(std::span<const std::uint8_t> record) {
  for (std::size_t done = 0; done < record.size();) {
    const ssize_t written = ::write(file_.get(), record.data() + done, record.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      const int error = written < 0 ? errno : EIO;
      // On a full disk a part of the record may be written.
      static_cast<void>(::ftruncate(file_.get(), static_cast<off_t>(size_)));
      return os_error(path_, error);
    }
    done += static_cast<std::size_t>(written);
  }
  size_ += record.size();
  return {};
}

void RecordFile::start_sync() {
  // It may fail where the file is not on a disk; the operating system writes everything in time anyway.
  static_cast<void>(::sync_file_range(file_.get(), 0, 0, SYNC_FILE_RANGE_WRITE));
}

}  // namespace pingvox
