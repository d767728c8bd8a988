#pragma once

#include <streambuf>

namespace pingvox::bench {

/// Discards standard error during its lifetime: liboctomap prints there when it reads and writes files.
class SilentStderr {
 public:
  SilentStderr();
  SilentStderr(const SilentStderr&) = delete;
  SilentStderr& operator=(const SilentStderr&) = delete;
  ~SilentStderr();

 private:
  std::streambuf* stream_;  ///< of std::cerr
  int descriptor_;          ///< duplicate of standard error, -1: none
};

}  // namespace pingvox::bench
