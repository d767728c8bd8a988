#include "stop_signals.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <optional>
#include <system_error>
#include <utility>

#include "io/internal/descriptor.hpp"

namespace pingvox::app {
namespace {

using Clock = std::chrono::steady_clock;

void set_event(const Descriptor& event) {
  constexpr std::uint64_t kOne = 1;
  // It fails only where the event is set already.
  static_cast<void>(::write(event.get(), &kOne, sizeof kOne));
}

/// Ends the process as the signal does by default, also where a shell had it ignored, as of a command in the
/// background.
void end_by(int signal) {
  ::signal(signal, SIG_DFL);
  sigset_t one;
  ::sigemptyset(&one);
  ::sigaddset(&one, signal);
  ::pthread_sigmask(SIG_UNBLOCK, &one, nullptr);
  ::kill(::getpid(), signal);
}

/// As nohup leaves SIGHUP.
bool is_ignored(int signal) {
  struct sigaction action = {};
  return ::sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

}  // namespace

struct StopSignals::Files {
  Descriptor signals;
  Descriptor arrived;  ///< event: a signal has arrived
  Descriptor ends;     ///< event: nobody waits for signals any more

  void watch() const {
    std::optional<Clock::time_point> first;
    for (;;) {
      std::array<pollfd, 2> files = {pollfd{signals.get(), POLLIN, 0}, pollfd{ends.get(), POLLIN, 0}};
      if (::poll(files.data(), files.size(), -1) < 0) continue;
      if (files[1].revents != 0) return;
      signalfd_siginfo signal = {};
      if (::read(signals.get(), &signal, sizeof signal) != sizeof signal) continue;
      // GNU timeout signals a process and then its group: what comes within a second means the same.
      // A terminal that is closed may signal several times, by its shell and by the system: that says nothing new.
      const bool is_repeated = first && Clock::now() - *first >= std::chrono::seconds(1);
      if (is_repeated && signal.ssi_signo != SIGHUP) end_by(static_cast<int>(signal.ssi_signo));
      if (!first) first = Clock::now();
      set_event(arrived);
    }
  }
};

Result<StopSignals> StopSignals::make() {
  sigset_t signals;
  ::sigemptyset(&signals);
  ::sigaddset(&signals, SIGINT);
  ::sigaddset(&signals, SIGTERM);
  if (!is_ignored(SIGHUP)) ::sigaddset(&signals, SIGHUP);
  auto files = std::make_unique<Files>(Files{Descriptor(::signalfd(-1, &signals, SFD_NONBLOCK | SFD_CLOEXEC)),
                                             Descriptor(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)),
                                             Descriptor(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC))});
  const bool are_open = files->signals.valid() && files->arrived.valid() && files->ends.valid();
  if (!are_open || ::pthread_sigmask(SIG_BLOCK, &signals, nullptr) != 0) return os_error("signals", errno);
  try {
    return StopSignals(std::move(files));
  } catch (const std::system_error& error) {
    return os_error("signals", error.code().value());
  }
}

StopSignals::StopSignals(std::unique_ptr<Files> files)
    : files_(std::move(files)), thread_([watched = files_.get()] { watched->watch(); }) {}

StopSignals::StopSignals(StopSignals&&) noexcept = default;

StopSignals::~StopSignals() {
  if (!files_) return;
  set_event(files_->ends);
  thread_.join();
}

int StopSignals::descriptor() const {
  return files_->arrived.get();
}

bool StopSignals::has_arrived() const {
  pollfd file = {descriptor(), POLLIN, 0};
  return ::poll(&file, 1, 0) == 1;
}

}  // namespace pingvox::app
