#include "io/internal/seanet_recorder.hpp"

#include <fmt/core.h>

#include <iterator>

#include "io/bytes/date.hpp"

namespace pingvox {

Result<SeanetRecorder> SeanetRecorder::create(const std::string& path, std::uint64_t since_1970_ms) {
  return RecordFile::create(path).map([&](RecordFile file) { return SeanetRecorder(std::move(file), since_1970_ms); });
}

Result<void> SeanetRecorder::append(std::uint64_t time_ms, std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return {};
  std::string line = date_time_text(since_1970_ms_ + time_ms) + ";0.0.0.0;0;";
  for (const std::uint8_t byte : bytes) fmt::format_to(std::back_inserter(line), "{:02X} ", byte);
  line.back() = '\n';
  return file_.append({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()});
}

}  // namespace pingvox
