#include "live_head.hpp"

#include <gtest/gtest.h>

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

std::vector<std::string> live(const std::string& device, std::vector<std::string> options) {
  options.insert(options.begin(), {"live", device, "-o", "live.bt", "--record", "dive.bin", "--range", "4", "--step",
                                   "18", "--timeout", "0.2", "--resolution", "0.1"});
  return options;
}

}  // namespace pingvox::test
