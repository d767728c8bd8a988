#include "command_files.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "option_values.hpp"

namespace pingvox::app {
namespace {

namespace fs = std::filesystem;

bool is_device_or_pipe(const std::string& path) {
  std::error_code error;
  return path == "-" || fs::is_other(fs::status(path, error));
}

bool is_same_file(const std::string& a, const std::string& b) {
  if (is_device_or_pipe(a) || is_device_or_pipe(b)) return false;
  std::error_code error;
  if (fs::equivalent(a, b, error)) return true;
  // Files that are not there yet.
  const fs::path at_a = fs::weakly_canonical(fs::absolute(a, error), error);
  if (error) return false;
  const fs::path at_b = fs::weakly_canonical(fs::absolute(b, error), error);
  return !error && at_a == at_b;
}

}  // namespace

void CommandFiles::read(const std::string& option, const std::string& path) {
  if (!path.empty()) inputs_.push_back({option, path});
}

void CommandFiles::read(const std::string& option, const Paths& paths) {
  for (const std::string& path : paths) read(option, path);
}

void CommandFiles::write(const std::string& option, const std::string& path) {
  if (!path.empty()) outputs_.push_back({option, path});
}

Result<void> CommandFiles::check() const {
  const auto is_stream = [](const NamedFile& file) { return file.path == "-"; };
  if (std::ranges::count_if(inputs_, is_stream) > 1) {
    return usage_error("'-' given twice: standard input can be read only once");
  }
  if (std::ranges::count_if(outputs_, is_stream) > 1) {
    return usage_error("-: only one output can be standard output");
  }
  for (auto output = outputs_.begin(); output != outputs_.end(); ++output) {
    const auto is_same = [&](const NamedFile& other) { return is_same_file(output->path, other.path); };
    auto other = std::find_if(inputs_.begin(), inputs_.end(), is_same);
    if (other == inputs_.end()) {
      other = std::find_if(outputs_.begin(), output, is_same);
      if (other == output) continue;
    }
    return usage_error(
        fmt::format("{} {}: is the same file as {} {}", output->option, output->path, other->option, other->path));
  }
  return {};
}

Result<void> check_folder_of(const std::string& path) {
  if (path == "-") return {};
  fs::path folder = fs::path(path).parent_path();
  if (folder.empty()) folder = ".";
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    return fail(Error::Code::kIo, fmt::format("{}: no such folder '{}'", path, folder.string()));
  }
  const auto status = fs::symlink_status(path, error);
  if (fs::is_directory(path, error)) {
    return fail(Error::Code::kIo, fmt::format("{}: is a folder, not a file", path));
  }
  // Devices and pipes are written in place, and links lead to another folder; other files are created.
  const bool is_made = !fs::exists(status) || fs::is_regular_file(status);
  if (is_made && ::access(folder.c_str(), W_OK) != 0) {
    const std::string reason = std::system_category().message(errno);
    return fail(Error::Code::kIo, fmt::format("{}: {} in the folder '{}'", path, reason, folder.string()));
  }
  return {};
}

}  // namespace pingvox::app
