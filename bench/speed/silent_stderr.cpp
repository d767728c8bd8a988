#include "silent_stderr.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <iostream>

namespace pingvox::bench {

// liboctomap uses both std::cerr and stderr.
SilentStderr::SilentStderr() : stream_(std::cerr.rdbuf(nullptr)), descriptor_(dup(STDERR_FILENO)) {
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere < 0) return;
  dup2(nowhere, STDERR_FILENO);
  close(nowhere);
}

SilentStderr::~SilentStderr() {
  std::cerr.rdbuf(stream_);
  if (descriptor_ < 0) return;
  dup2(descriptor_, STDERR_FILENO);
  close(descriptor_);
}

}  // namespace pingvox::bench
