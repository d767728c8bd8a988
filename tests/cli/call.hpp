#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pingvox::test {

/// What a call of the program came to.
struct Outcome {
  int status = -1;  ///< exit status, or 128 + the signal that ended it
  std::string out, err;
};

/// Where the streams of a call lead to, and the limits that it runs under.
struct Streams {
  std::string in = {};                                   ///< what standard input says
  std::optional<std::string> out_path = std::nullopt;    ///< a file for standard output instead of Outcome::out
  std::optional<std::string> err_path = std::nullopt;    ///< the same for standard error
  bool out_is_broken_pipe = false;                       ///< standard output is a pipe that nobody reads
  bool out_is_closed = false;                            ///< there is no standard output
  std::optional<std::size_t> file_bytes = std::nullopt;  ///< no file may grow beyond
  bool ignores_hangup = false;                           ///< as under nohup
};

/// The program that is tested: that of this build, or the one that the environment names in PINGVOX_PROGRAM, as
/// `./check` does with one that the sanitizers watch.
std::string tested_program();
/// For a test that would take too long with that one, and that others beside it cover.
#define PINGVOX_SKIP_WITH_OTHER_PROGRAM() \
  if (tested_program() != PINGVOX_PROGRAM) GTEST_SKIP() << "too slow with another program, and covered beside it"

/// A folder of its own for one test, in which the program is called. Gone when the test is over.
class Workplace {
 public:
  Workplace();
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;
  ~Workplace();

  const std::filesystem::path& folder() const { return folder_; }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// Calls `pingvox` with these words and waits for its end.
  Outcome call(const std::vector<std::string>& words, const Streams& streams = {}) const;
  /// Starts it and returns at once.
  pid_t start(const std::vector<std::string>& words, const Streams& streams = {}) const;

  void write(const std::string& name, const std::string& content) const;
  std::string read(const std::string& name) const;
  bool has(const std::string& name) const { return std::filesystem::exists(folder_ / name); }
  /// Names of all files in the folder, those of the streams apart, in order.
  std::vector<std::string> files() const;

  /// A small log of a simulated tank, as tank.csv.
  void simulate_tank() const;

 private:
  std::filesystem::path folder_;   ///< for the test
  std::filesystem::path streams_;  ///< for what the streams say
};

/// Waits for a started program: exit status, or 128 + signal.
int status_of(pid_t child);

/// A call that could not be done: this status, nothing on standard output, and exactly one line on standard error that
/// begins with "pingvox: " and holds each of these texts.
void expect_error(const Outcome& outcome, int status, const std::vector<std::string>& texts);

}  // namespace pingvox::test
