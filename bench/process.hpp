#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "pingvox/result.hpp"

namespace pingvox::bench {

/// What a program that was run to its end came to.
struct ProgramRun {
  int status = 0;  ///< exit status, or 128 + the signal that ended it
  double wall_s = 0.0;
  std::string said;  ///< on standard output and standard error
};

/// Runs a program, looked for as a shell does, and waits for its end. kUnsupported when there is none of that name.
Result<ProgramRun> run_program(const std::vector<std::string>& words);

/// The same; kCorrupt with the last line that it said when its status is not 0.
Result<ProgramRun> run_well(const std::vector<std::string>& words);

/// The program `pingvox` beside this one. kUnsupported when it is not there.
Result<std::string> pingvox_program();

/// A folder of its own, gone when this is.
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
