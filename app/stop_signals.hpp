#pragma once

#include <csignal>

#include "pingvox/io/descriptor.hpp"
#include "pingvox/result.hpp"

namespace pingvox::app {

/// SIGINT and SIGTERM as something to wait for, so that a command ends in good order. Threads are started after it.
class StopSignals {
 public:
  /// Blocks the signals.
  static Result<StopSignals> make();

  /// For poll().
  int descriptor() const { return file_.get(); }
  /// Whether a signal has arrived. A second after that, another one ends the process at once.
  bool has_arrived();

 private:
  StopSignals(const sigset_t& signals, Descriptor file) : signals_(signals), file_(std::move(file)) {}

  sigset_t signals_;
  Descriptor file_;
};

}  // namespace pingvox::app
