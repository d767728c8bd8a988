#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "pingvox/result.hpp"

namespace pingvox::bench {

/// Result of running a program.
struct ProgramRun {
  int status = 0;  ///< exit status, or 128 + signal
  double wall_s = 0.0;
  std::string said;  ///< on standard output and standard error
};

/// Runs a program from PATH and waits for its end. kUnsupported when it is not found.
Result<ProgramRun> run_program(const std::vector<std::string>& words);

/// The same; kCorrupt with its last line of output when its status is not 0.
Result<ProgramRun> run_or_fail(const std::vector<std::string>& words);

/// The program `pingvox` beside this one. kUnsupported when it is missing.
Result<std::string> pingvox_program();

/// A temporary folder, removed by the destructor.
class Scratch {
 public:
  static Result<Scratch> make();
  Scratch(Scratch&& other) noexcept : folder_(std::exchange(other.folder_, {})) {}
  Scratch& operator=(Scratch&& other) noexcept {
    std::swap(folder_, other.folder_);
    return *this;
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch();

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

 private:
  explicit Scratch(std::filesystem::path folder) : folder_(std::move(folder)) {}
  std::filesystem::path folder_;
};

}  // namespace pingvox::bench
