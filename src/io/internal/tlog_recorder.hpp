#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "io/internal/record_file.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Records frames of MAVLink as ground stations do, as a .tlog (docs/formats.md), which `read_nav` reads.
class TlogRecorder {
 public:
  /// Creates the file. An existing one is an error (kIo): recordings are not overwritten.
  static Result<TlogRecorder> create(const std::string& path);

  const std::string& path() const { return file_.path(); }

  /// Appends a frame. It is passed to the operating system before this returns, and outlives this process.
  /// @param time_us  when it was received, since 1970
  /// @return kIo: the file ends with the last whole record
  Result<void> append(std::uint64_t time_us, std::span<const std::uint8_t> frame);

  /// As those of RecordFile.
  Result<void> sync_if_due(double now_s) { return file_.sync_if_due(now_s); }
  double sync_due_s() const { return file_.sync_due_s(); }

 private:
  explicit TlogRecorder(RecordFile file) : file_(std::move(file)) {}

  RecordFile file_;
};

}  // namespace pingvox
