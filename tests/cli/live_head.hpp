#pragma once

// What the tests of `pingvox live` share.

#include <sys/types.h>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "call.hpp"

namespace pingvox::test {

/// Waits until something holds, at most a minute.
template <class Holds>
bool wait_until(const Holds& holds) {
  for (int i = 0; i < 6000; ++i) {
    if (holds()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

/// An emulated head, which runs as long as it is in scope.
class Head {
 public:
  explicit Head(std::vector<std::string> options = {}, const char* pings_per_s = "1000",
                const std::string& device = "ping360", const char* line = "udp://127.0.0.1:0");
  Head(const Head&) = delete;
  Head& operator=(const Head&) = delete;
  ~Head();
  const std::string& address() const { return address_; }

 private:
  Workplace place_;
  pid_t child_ = -1;
  std::string address_;
};

/// A named pipe that is full and that nobody reads.
class FullPipe {
 public:
  explicit FullPipe(const std::string& path);
  FullPipe(const FullPipe&) = delete;
  FullPipe& operator=(const FullPipe&) = delete;
  ~FullPipe();

 private:
  int file_;
};

/// Exit status of a program, or 128 + signal; one that does not end within a minute is killed.
int status_in_time(pid_t child);

/// A `live` with a small and quick picture: 20 beams a turn.
std::vector<std::string> live(const std::string& device, std::vector<std::string> options);

}  // namespace pingvox::test
