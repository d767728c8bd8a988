#pragma once

#include <fmt/core.h>

#include <limits>
#include <optional>
#include <utility>

#include "pingvox/result.hpp"

namespace pingvox {

/// A recorder, if there is one, whose faults do not end what it records: the first one is kept to be reported.
template <class Recorder>
class GuardedRecorder {
 public:
  explicit GuardedRecorder(std::optional<Recorder> recorder) : recorder_(std::move(recorder)) {}

  /// Ends the recording, and begins another one. nullopt: none.
  void record_to(std::optional<Recorder> recorder) {
    recorder_ = std::move(recorder);
    error_.reset();
  }
  bool is_recording() const { return recorder_.has_value(); }

  /// What Recorder::append takes. It is not called again once it has failed.
  template <class... Record>
  void append(const Record&... record) {
    if (!recorder_) return;
    const Result<void> appended = recorder_->append(record...);
    if (appended) return;
    note({appended.error().code, fmt::format("{}: the recording ended", appended.error().message)});
    recorder_.reset();
  }

  void sync_if_due(double now_s) {
    if (!recorder_) return;
    if (const Result<void> synced = recorder_->sync_if_due(now_s); !synced) note(synced.error());
  }
  double sync_due_s() const { return recorder_ ? recorder_->sync_due_s() : std::numeric_limits<double>::infinity(); }

  /// The first fault.
  const std::optional<Error>& error() const { return error_; }

 private:
  void note(const Error& error) {
    if (!error_) error_ = error;
  }

  std::optional<Recorder> recorder_;
  std::optional<Error> error_;
};

}  // namespace pingvox
