#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "pingvox/io/record_file.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Records what a Ping360 sends as a log of Ping Viewer (docs/formats.md), which `open_beams` reads.
class PingViewerRecorder {
 public:
  /// Creates the file. An existing one is an error (kIo): recordings are not overwritten.
  static Result<PingViewerRecorder> create(const std::string& path);

  const std::string& path() const { return file_.path(); }

  /// Appends the bytes of one read. They are with the operating system when it returns and outlive this process.
  /// @param time_ms  since the start of the log
  /// @return kIo: the file ends with the last whole record
  Result<void> append(std::uint64_t time_ms, std::span<const std::uint8_t> bytes);

  /// Starts to write to the disk what is not there yet, without waiting for it.
  void start_sync() { file_.start_sync(); }

 private:
  explicit PingViewerRecorder(RecordFile file) : file_(std::move(file)) {}

  RecordFile file_;
};

}  // namespace pingvox
