#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "commands.hpp"

namespace pingvox::app {

Result<int> run(const BenchCommand& command, Console&) {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string program = (self.parent_path() / "pingvox-bench").string();
  if (error || !std::filesystem::exists(program, error)) {
    return fail(
        Error::Code::kUnsupported,
        "bench: there is no pingvox-bench beside the program: it is built where OctoMap is installed (liboctomap-dev)");
  }
  std::vector<std::string> args = {program};
  args.insert(args.end(), command.args.begin(), command.args.end());
  std::vector<char*> argv;
  for (std::string& word : args) argv.push_back(word.data());
  argv.push_back(nullptr);
  // Ignored signals would stay ignored in the new program.
  std::signal(SIGPIPE, SIG_DFL);
  std::signal(SIGXFSZ, SIG_DFL);
  ::execv(program.c_str(), argv.data());
  return fail(Error::Code::kIo, fmt::format("{}: {}", program, std::strerror(errno)));
}

}  // namespace pingvox::app
