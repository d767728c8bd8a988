#include "io/internal/tlog_recorder.hpp"

#include <vector>

namespace pingvox {

Result<TlogRecorder> TlogRecorder::create(const std::string& path) {
  return RecordFile::create(path).map([](RecordFile file) { return TlogRecorder(std::move(file)); });
}

Result<void> TlogRecorder::append(std::uint64_t time_us, std::span<const std::uint8_t> frame) {
  std::vector<std::uint8_t> record;
  for (unsigned shift = 64; shift > 0; shift -= 8) {
    record.push_back(static_cast<std::uint8_t>((time_us >> (shift - 8)) & 0xffU));
  }
  record.insert(record.end(), frame.begin(), frame.end());
  return file_.append(record);
}

}  // namespace pingvox
