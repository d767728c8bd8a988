#include "live_head.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>

namespace pingvox::test {

Head::Head(std::vector<std::string> options, const char* pings_per_s, const std::string& device, const char* line) {
  options.insert(options.begin(), {"emulate", device, "--listen", line, "--rate", pings_per_s});
  child_ = place_.start(options, {.out_path = place_.path("address")});
  const bool listens =
      wait_until([&] { return place_.has("address") && place_.read("address").find('\n') != std::string::npos; });
  if (!listens) ADD_FAILURE() << "the emulator says no address";
  address_ = place_.read("address");
  address_ = device + ":" + address_.substr(0, address_.find('\n'));
}

Head::~Head() {
  ::kill(child_, SIGKILL);
  status_of(child_);
}

FullPipe::FullPipe(const std::string& path) : file_(-1) {
  if (::mkfifo(path.c_str(), 0600) == 0) file_ = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (file_ < 0) ADD_FAILURE() << path << ": no pipe";
  const std::array<char, 4096> filler = {};
  while (::write(file_, filler.data(), filler.size()) > 0) continue;
}

FullPipe::~FullPipe() {
  ::close(file_);
}

int status_in_time(pid_t child) {
  int status = 0;
  if (!wait_until([&] { return ::waitpid(child, &status, WNOHANG) == child; })) {
    ::kill(child, SIGKILL);
    return status_of(child);
  }
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

std::vector<std::string> live(const std::string& device, std::vector<std::string> options) {
  options.insert(options.begin(), {"live", device, "-o", "live.bt", "--record", "dive.bin", "--range", "4", "--step",
                                   "18", "--timeout", "0.2", "--resolution", "0.1"});
  return options;
}

}  // namespace pingvox::test
