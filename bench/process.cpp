#include "process.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace pingvox::bench {
namespace {

namespace fs = std::filesystem;

std::string all_of(int descriptor) {
  std::string all;
  std::array<char, 4096> part{};
  for (;;) {
    const ssize_t size = read(descriptor, part.data(), part.size());
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return all;
    all.append(part.data(), static_cast<std::size_t>(size));
  }
}

std::string last_line_of(std::string text) {
  text.erase(text.find_last_not_of(" \r\n") + 1);
  return text.substr(text.find_last_of("\r\n") + 1);
}

}  // namespace

Result<ProgramRun> run_program(const std::vector<std::string>& words) {
  std::vector<std::string> texts = words;
  std::vector<char*> argv;
  for (std::string& text : texts) argv.push_back(text.data());
  argv.push_back(nullptr);
  int ends[2] = {};
  if (pipe2(ends, O_CLOEXEC) != 0) return fail(Error::Code::kIo, fmt::format("pipe: {}", std::strerror(errno)));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  const auto started = std::chrono::steady_clock::now();
  // Not fork, which would copy our page tables on the account of the child.
  pid_t child = -1;
  const int refused = posix_spawnp(&child, argv.front(), &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (refused != 0) {
    close(ends[0]);
    return fail(Error::Code::kUnsupported, fmt::format("{}: {}", words.front(), std::strerror(refused)));
  }
  ProgramRun run;
  run.said = all_of(ends[0]);
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  run.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  run.status = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  return run;
}

Result<ProgramRun> run_or_fail(const std::vector<std::string>& words) {
  Result<ProgramRun> run = run_program(words);
  if (run && run->status != 0) {
    return fail(Error::Code::kCorrupt,
                fmt::format("{} ended with status {}: {}", words.front(), run->status, last_line_of(run->said)));
  }
  return run;
}

Result<std::string> pingvox_program() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path() / "pingvox";
  if (error || !fs::exists(program, error)) {
    return fail(Error::Code::kUnsupported, fmt::format("{} is not there: it is to be built, too", program.string()));
  }
  return program.string();
}

Result<Scratch> Scratch::make() {
  std::string path = (fs::temp_directory_path() / "pingvox-bench-XXXXXX").string();
  if (mkdtemp(path.data()) == nullptr) return fail(Error::Code::kIo, fmt::format("{}: {}", path, std::strerror(errno)));
  return Scratch(fs::path(path));
}

Scratch::~Scratch() {
  std::error_code ignored;
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

}  // namespace pingvox::bench
