#pragma once

#include <streambuf>

namespace pingvox::bench {

/// liboctomap talks on standard error when it reads and writes. As long as this lives it is not heard, and its words
/// cost it no system call.
class SilentStderr {
 public:
  SilentStderr();
  SilentStderr(const SilentStderr&) = delete;
  SilentStderr& operator=(const SilentStderr&) = delete;
  ~SilentStderr();

 private:
  std::streambuf* stream_;  ///< of std::cerr
  int descriptor_;          ///< a second one of standard error, -1: none
};

}  // namespace pingvox::bench
