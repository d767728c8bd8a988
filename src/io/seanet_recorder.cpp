#include "pingvox/io/seanet_recorder.hpp"

#include <fmt/core.h>

#include <chrono>
#include <iterator>

namespace pingvox {

Result<SeanetRecorder> SeanetRecorder::create(const std::string& path) {
  return RecordFile::create(path).map([](RecordFile file) { return SeanetRecorder(std::move(file)); });
}

Result<void> SeanetRecorder::append(std::uint64_t time_ms, std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return {};
  using std::chrono::days;
  const std::chrono::milliseconds since(time_ms);
  const std::chrono::year_month_day date{std::chrono::sys_days(std::chrono::floor<days>(since))};
  const std::chrono::hh_mm_ss time(since - std::chrono::floor<days>(since));
  std::string line =
      fmt::format("{:04}.{:02}.{:02} {:02}.{:02}.{:02}.{:03};0.0.0.0;0;", static_cast<int>(date.year()),
                  static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()), time.hours().count(),
                  time.minutes().count(), time.seconds().count(), time.subseconds().count());
  for (const std::uint8_t byte : bytes) fmt::format_to(std::back_inserter(line), "{:02X} ", byte);
  line.back() = '\n';
  return file_.append({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()});
}

}  // namespace pingvox
