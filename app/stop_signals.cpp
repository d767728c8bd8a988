#include "stop_signals.hpp"

#include <sys/signalfd.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

namespace pingvox::app {

Result<StopSignals> StopSignals::make() {
  sigset_t signals;
  ::sigemptyset(&signals);
  ::sigaddset(&signals, SIGINT);
  ::sigaddset(&signals, SIGTERM);
  Descriptor file(::signalfd(-1, &signals, SFD_NONBLOCK | SFD_CLOEXEC));
  if (!file.valid() || ::pthread_sigmask(SIG_BLOCK, &signals, nullptr) != 0) return os_error("signals", errno);
  return StopSignals(signals, std::move(file));
}

bool StopSignals::has_arrived() {
  signalfd_siginfo signal = {};
  if (::read(file_.get(), &signal, sizeof signal) != sizeof signal) return false;
  // GNU timeout signals a process and then its group: what comes within a second means the same.
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGTERM, SIG_IGN);
  std::signal(SIGALRM, [](int) {
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
  });
  ::alarm(1);
  ::pthread_sigmask(SIG_UNBLOCK, &signals_, nullptr);
  return true;
}

}  // namespace pingvox::app
