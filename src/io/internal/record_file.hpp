#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>

#include "io/internal/descriptor.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Time of a record [s], to the last bit as readers of recordings without a date give it.
/// @param time_ms  since the start of the recording
double recorded_time_s(std::uint64_t time_ms);

/// A file that a recording is appended to, record by record.
class RecordFile {
 public:
  /// Creates the file, so that it is there also after a power cut. An existing one is an error (kIo): recordings are
  /// not overwritten.
  static Result<RecordFile> create(const std::string& path);

  const std::string& path() const { return path_; }
  /// Appends a record. It is passed to the operating system before this returns, and outlives this process.
  /// @return kIo: the file ends with the last whole record
  Result<void> append(std::span<const std::uint8_t> record);
  /// Starts to flush the file to the disk, without waiting for it, and checks that it is still where it was created,
  /// unless it did so less than a second ago.
  /// @param now_s  seconds of a clock that never goes back
  /// @return kIo: the file was removed, moved or replaced. What is appended goes to the same file all the same.
  Result<void> sync_if_due(double now_s);
  /// When `sync_if_due` does so next.
  double sync_due_s() const { return sync_due_s_; }

 private:
  Result<void> check_place() const;
  RecordFile(std::string path, Descriptor file) : path_(std::move(path)), file_(std::move(file)) {}

  std::string path_;
  Descriptor file_;
  std::uint64_t size_ = 0;  ///< of whole records [bytes]
  double sync_due_s_ = -std::numeric_limits<double>::infinity();
};

}  // namespace pingvox
