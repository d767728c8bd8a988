#pragma once

#include <memory>
#include <thread>

#include "pingvox/result.hpp"

namespace pingvox::app {

/// SIGINT, SIGTERM, and SIGHUP unless it is ignored (nohup), as something to wait for, so that a command ends in good
/// order. Another SIGINT or SIGTERM, at least a second after the first signal, ends the process at once, also where the
/// command waits for something else. Threads are started after it.
class StopSignals {
 public:
  /// Blocks the signals, and starts a thread that waits for them.
  static Result<StopSignals> make();
  StopSignals(StopSignals&&) noexcept;
  StopSignals& operator=(StopSignals&&) = delete;
  ~StopSignals();

  /// For poll(): readable once a signal has arrived.
  int descriptor() const;
  bool has_arrived() const;

 private:
  struct Files;
  explicit StopSignals(std::unique_ptr<Files> files);
  std::unique_ptr<Files> files_;
  std::thread thread_;
};

}  // namespace pingvox::app
