#include "io/internal/ping_viewer_recorder.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/bytes/date.hpp"

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

Result<PingViewerRecorder> PingViewerRecorder::create(const std::string& path, std::uint64_t since_1970_ms) {
  Result<RecordFile> file = RecordFile::create(path);
  if (!file) return tl::unexpected(file.error());
  PingViewerRecorder recorder(*std::move(file));
  constexpr std::uint32_t kVersion = 1, kPingFamily = 1, kPing360 = 2;
  QtBytes header;
  header.put(std::string_view("PingViewer sensor log file"));
  header.put(kVersion);
  // Its second string is the date of Ping Viewer's own build.
  const std::string date = since_1970_ms > 0 ? date_time_text(since_1970_ms) : "";
  for (const std::string_view about : {std::string_view(), std::string_view(date), std::string_view("pingvox"),
                                       std::string_view(), std::string_view()}) {
    header.put(about);
  }
  header.put(kPingFamily);
  header.put(kPing360);
  if (const auto written = recorder.file_.append(header.bytes()); !written) {
    ::unlink(path.c_str());
    return tl::unexpected(written.error());
  }
  return recorder;
}

Result<void> PingViewerRecorder::append(std::uint64_t time_ms, std::span<const std::uint8_t> bytes) {
  constexpr std::uint64_t kSecond_ms = 1000, kMinute_ms = 60 * kSecond_ms, kHour_ms = 60 * kMinute_ms;
  const std::uint64_t of_day = time_ms % kDay_ms;
  QtBytes record;
  record.put(fmt::format("{:02}:{:02}:{:02}.{:03}", of_day / kHour_ms, of_day % kHour_ms / kMinute_ms,
                         of_day % kMinute_ms / kSecond_ms, of_day % kSecond_ms));
  record.put(bytes);
  return file_.append(record.bytes());
}

}  // namespace pingvox
