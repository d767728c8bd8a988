#include "open_browser.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>

namespace pingvox::app {
namespace {

bool has_screen() {
  for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY"}) {
    const char* const value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nobody sets variables
    if (value != nullptr && *value != '\0') return true;
  }
  return false;
}

}  // namespace

void open_browser(const std::string& url) {
  if (!has_screen()) return;
  std::string program = "xdg-open", address = url;
  const std::array<char*, 3> words = {program.data(), address.data(), nullptr};
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  ::posix_spawn_file_actions_init(&files);
  ::posix_spawnattr_init(&attributes);
  // Standard output has the address as its first line, and the browser writes what it likes.
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    ::posix_spawn_file_actions_addopen(&files, descriptor, "/dev/null", O_RDWR, 0);
  }
  // Ctrl-C ends this program, not the browser; and signals that we block are not blocked there.
  sigset_t none, ignored;
  ::sigemptyset(&none);
  ::sigemptyset(&ignored);
  ::sigaddset(&ignored, SIGPIPE);
  ::sigaddset(&ignored, SIGXFSZ);
  ::posix_spawnattr_setsigmask(&attributes, &none);
  ::posix_spawnattr_setsigdefault(&attributes, &ignored);
  ::posix_spawnattr_setpgroup(&attributes, 0);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  pid_t child = 0;
  static_cast<void>(::posix_spawnp(&child, program.c_str(), &files, &attributes, words.data(), environ));
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&files);
}

Result<web::Page> page_of_build(std::string_view command) {
  if (const std::optional<web::Page> page = web::built_in_page()) return *page;
  return fail(Error::Code::kUnsupported,
              fmt::format("{}: this build has no page: 'tools/packages view' installs what it is made of, then build "
                          "again",
                          command));
}

}  // namespace pingvox::app
