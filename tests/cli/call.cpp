#include "call.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>

namespace pingvox::test {
namespace {

namespace fs = std::filesystem;

fs::path fresh_folder() {
  std::string path = (fs::temp_directory_path() / "pingvox-cli-XXXXXX").string();
  if (!::mkdtemp(path.data())) ADD_FAILURE() << "no folder for the test: " << path;
  return path;
}

std::string content_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void put(const fs::path& path, const std::string& content) {
  std::ofstream out(path, std::ios::binary);
  out << content;
}

/// In the child: makes `fd` lead to a file. Nothing but system calls may happen here.
void redirect(const char* path, int flags, int fd) {
  const int opened = ::open(path, flags, 0600);
  if (opened < 0 || ::dup2(opened, fd) < 0) ::_exit(125);
  ::close(opened);
}

}  // namespace

std::string tested_program() {
  const char* const other = std::getenv("PINGVOX_PROGRAM");
  return other != nullptr ? other : PINGVOX_PROGRAM;
}

Workplace::Workplace() : folder_(fresh_folder()), streams_(fresh_folder()) {}

Workplace::~Workplace() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
  fs::remove_all(streams_, ignored);
}

pid_t Workplace::start(const std::vector<std::string>& words, const Streams& streams) const {
  put(streams_ / "in", streams.in);
  std::vector<std::string> texts = {tested_program()};
  texts.insert(texts.end(), words.begin(), words.end());
  std::vector<char*> argv;
  for (std::string& text : texts) argv.push_back(text.data());
  argv.push_back(nullptr);
  const std::string in = streams_ / "in", out = streams.out_path.value_or(streams_ / "out"),
                    err = streams.err_path.value_or(streams_ / "err");

  const pid_t child = ::fork();
  if (child != 0) return child;
  redirect(in.c_str(), O_RDONLY, STDIN_FILENO);
  redirect(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, STDOUT_FILENO);
  redirect(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, STDERR_FILENO);
  if (streams.out_is_broken_pipe) {
    std::array<int, 2> ends = {-1, -1};
    if (::pipe(ends.data()) != 0 || ::dup2(ends[1], STDOUT_FILENO) < 0) ::_exit(125);
    ::close(ends[0]);
    ::close(ends[1]);
  }
  if (streams.out_is_closed) ::close(STDOUT_FILENO);
  if (streams.file_bytes) {
    const rlimit limit{*streams.file_bytes, *streams.file_bytes};
    if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) ::_exit(125);
  }
  // The tests themselves may run under nohup.
  std::signal(SIGHUP, streams.ignores_hangup ? SIG_IGN : SIG_DFL);
  if (::chdir(folder_.c_str()) != 0) ::_exit(125);
  ::execv(argv.front(), argv.data());
  ::_exit(126);
}

Outcome Workplace::call(const std::vector<std::string>& words, const Streams& streams) const {
  Outcome outcome;
  outcome.status = status_of(start(words, streams));
  if (!streams.out_path) outcome.out = content_of(streams_ / "out");
  if (!streams.err_path) outcome.err = content_of(streams_ / "err");
  return outcome;
}

void Workplace::write(const std::string& name, const std::string& content) const {
  put(folder_ / name, content);
}

std::string Workplace::read(const std::string& name) const {
  return content_of(folder_ / name);
}

std::vector<std::string> Workplace::files() const {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_)) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

void Workplace::simulate_tank() const {
  const Outcome made = call({"simulate", "tank", "-o", "tank.csv", "--turns", "2", "--quiet"});
  ASSERT_EQ(made.status, 0) << made.err;
}

int status_of(pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return -1;
  }
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

void expect_error(const Outcome& outcome, int status, const std::vector<std::string>& texts) {
  EXPECT_EQ(outcome.status, status) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_TRUE(outcome.err.starts_with("pingvox: ")) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_TRUE(outcome.err.ends_with("\n")) << outcome.err;
  for (const std::string& text : texts) {
    EXPECT_NE(outcome.err.find(text), std::string::npos) << "'" << text << "' is not in: " << outcome.err;
  }
}

}  // namespace pingvox::test
