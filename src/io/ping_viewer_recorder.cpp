#include "pingvox/io/ping_viewer_recorder.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <array>
#include <cassert>
#include <cerrno>
#include <string_view>
#include <utility>
#include <vector>

namespace pingvox {
namespace {

constexpr std::uint64_t kDay_ms = 86'400'000;

/// Big-endian, as Qt's QDataStream.
class QtBytes {
 public:
  void put(std::uint32_t value) {
    for (unsigned shift = 32; shift > 0; shift -= 8) {
      bytes_.push_back(static_cast<std::uint8_t>((value >> (shift - 8)) & 0xffU));
    }
  }
  /// ASCII text, as UTF-16.
  void put(std::string_view text) {
    put(static_cast<std::uint32_t>(2 * text.size()));
    for (const char c : text) {
      bytes_.push_back(0);
      bytes_.push_back(static_cast<std::uint8_t>(c));
    }
  }
  void put(std::span<const std::uint8_t> data) {
    put(static_cast<std::uint32_t>(data.size()));
    bytes_.insert(bytes_.end(), data.begin(), data.end());
  }
  std::span<const std::uint8_t> bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

}  // namespace

Result<PingViewerRecorder> PingViewerRecorder::create(const std::string& path) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (!file.valid()) return os_error(path, errno);
  PingViewerRecorder recorder(path, std::move(file));
  constexpr std::uint32_t kVersion = 1, kPingFamily = 1, kPing360 = 2;
  QtBytes header;
  header.put(std::string_view("PingViewer sensor log file"));
  header.put(kVersion);
  for (const std::string_view about : {"", "", "pingvox", "", ""}) header.put(about);
  header.put(kPingFamily);
  header.put(kPing360);
  if (const auto written = recorder.write(header.bytes()); !written) return tl::unexpected(written.error());
  return recorder;
}

Result<void> PingViewerRecorder::append(std::uint64_t time_ms, std::span<const std::uint8_t> bytes) {
  constexpr std::uint64_t kSecond_ms = 1000, kMinute_ms = 60 * kSecond_ms, kHour_ms = 60 * kMinute_ms;
  const std::uint64_t of_day = time_ms % kDay_ms;
  QtBytes record;
  record.put(fmt::format("{:02}:{:02}:{:02}.{:03}", of_day / kHour_ms, of_day % kHour_ms / kMinute_ms,
                         of_day % kMinute_ms / kSecond_ms, of_day % kSecond_ms));
  record.put(bytes);
  return write(record.bytes());
}

void PingViewerRecorder::start_sync() {
  // It may fail where the file is not on a disk; the operating system writes everything in time anyway.
  static_cast<void>(::sync_file_range(file_.get(), 0, 0, SYNC_FILE_RANGE_WRITE));
}

double PingViewerRecorder::time_s(std::uint64_t time_ms) {
  // Added as readers do, to the last bit.
  constexpr double kDay_s = 86'400.0;
  const std::uint64_t days = time_ms / kDay_ms, of_day = time_ms % kDay_ms, seconds = of_day / 1000;
  const double of_day_s = static_cast<double>(seconds) + static_cast<double>(of_day % 1000) / 1000.0;
  return of_day_s + static_cast<double>(days) * kDay_s;
}

Result<void> PingViewerRecorder::write(std::span<const std::uint8_t> bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t written = ::write(file_.get(), bytes.data() + done, bytes.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      const int error = written < 0 ? errno : EIO;
      // On a full disk a part of the record may be written.
      static_cast<void>(::ftruncate(file_.get(), static_cast<off_t>(size_)));
      return os_error(path_, error);
    }
    done += static_cast<std::size_t>(written);
  }
  size_ += bytes.size();
  return {};
}

}  // namespace pingvox
