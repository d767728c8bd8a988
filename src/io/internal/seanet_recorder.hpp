#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "io/internal/record_file.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Records the bytes of a SeaNet head as a capture of packets with their times (docs/formats.md), which `open_beams`
/// reads.
class SeanetRecorder {
 public:
  /// Creates the file. An existing one is an error (kIo): recordings are not overwritten.
  /// @param since_1970_ms  the date of time 0; 0: not known
  static Result<SeanetRecorder> create(const std::string& path, std::uint64_t since_1970_ms = 0);

  const std::string& path() const { return file_.path(); }

  /// Appends the bytes of one read. They are passed to the operating system first, and outlive this process.
  /// @param time_ms  since the start of the log
  /// @return kIo: the file ends with the last whole record
  Result<void> append(std::uint64_t time_ms, std::span<const std::uint8_t> bytes);

  /// As those of RecordFile.
  Result<void> sync_if_due(double now_s) { return file_.sync_if_due(now_s); }
  double sync_due_s() const { return file_.sync_due_s(); }

 private:
  SeanetRecorder(RecordFile file, std::uint64_t since_1970_ms)
      : file_(std::move(file)), since_1970_ms_(since_1970_ms) {}

  RecordFile file_;
  std::uint64_t since_1970_ms_;
};

}  // namespace pingvox
