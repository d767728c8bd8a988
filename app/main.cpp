#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <string>
#include <variant>
#include <vector>

#include "base/without_exceptions.hpp"
#include "command_line.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "option_names.hpp"
#include "vectors.hpp"

namespace {

using namespace pingvox;

constexpr int kDone = 0, kFailed = 1, kInvalidUsage = 2;

Result<int> run_any(const app::Command& command) {
  return std::visit(
      [](const auto& c) -> Result<int> {
        app::Console console(c.output_options);
        if constexpr (std::is_same_v<std::decay_t<decltype(c)>, app::ShowText>) {
          if (const auto printed = console.print(c.text); !printed) return tl::unexpected(printed.error());
          return kDone;
        } else {
          return app::run(c, console);
        }
      },
      command);
}

Result<int> run_command_line(const std::vector<std::string>& args) {
  if (const auto limited = app::limit_vectors(); !limited) return tl::unexpected(limited.error());
  const Result<app::Command> command = app::parse_command_line(args);
  if (!command) return tl::unexpected(command.error());
  return run_any(*command);
}

int status_of(const Error& error, const std::vector<std::string>& args) {
  // For compare, 1 means different.
  const bool compares = !args.empty() && args.front() == "compare";
  return error.code == Error::Code::kBadOption || compares ? kInvalidUsage : kFailed;
}

/// Opens closed standard streams, so that no file gets their descriptor.
void keep_standard_streams() {
  for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; ++fd) {
    // In the wrong mode, so that using the stream still fails.
    if (::fcntl(fd, F_GETFD) == -1) ::open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  }
}

}  // namespace

int main(int argc, char** argv) {
  keep_standard_streams();
  // A closed pipe and a file too large are ordinary errors.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);

  std::vector<std::string> args;
  const Result<int> status = detail::without_exceptions([&] {
    args.assign(argv + (argc > 0 ? 1 : 0), argv + argc);
    return run_command_line(args);
  });
  if (status) return *status;
  app::print_error(app::with_option_names(status.error().message));
  return status_of(status.error(), args);
}
