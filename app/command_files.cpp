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

/// Where a path leads, also over links to a file that is not there yet.
fs::path end_of_path(const std::string& path) {
  constexpr int kMaxLinks = 40;
  std::error_code error;
  fs::path at = fs::absolute(path, error);
  for (int links = 0; links < kMaxLinks && fs::is_symlink(fs::symlink_status(at, error)); ++links) {
    at = at.parent_path() / fs::read_symlink(at, error);  // an absolute target replaces the folder
  }
  return fs::weakly_canonical(at, error);
}

bool is_same_file(const std::string& a, const std::string& b) {
  if (is_device_or_pipe(a) || is_device_or_pipe(b)) return false;
  std::error_code error;
  if (fs::equivalent(a, b, error)) return true;
  const fs::path at_a = end_of_path(a);
  return !at_a.empty() && at_a == end_of_path(b);
}

/// Whether a file is part of the bag in a folder.
bool is_in_bag(const std::string& file, const std::string& folder) {
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path& path = entry->path();
    const std::string suffix = path.extension().string();
    const bool is_part = suffix.starts_with(".db3") || suffix == ".mcap" || path.filename() == "metadata.yaml";
    if (is_part && is_same_file(file, path.string())) return true;
  }
  return false;
}

/// Whether writing `output` changes `input`.
bool is_overwritten(const std::string& input, const std::string& output) {
  std::error_code error;
  if (input == "-") return is_same_file(output, "/dev/stdin");
  return fs::is_directory(input, error) ? is_in_bag(output, input) : is_same_file(output, input);
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
    const auto is_read = [&](const NamedFile& input) { return is_overwritten(input.path, output->path); };
    auto other = std::find_if(inputs_.begin(), inputs_.end(), is_read);
    if (other == inputs_.end()) {
      other = std::find_if(outputs_.begin(), output, is_same);
      if (other == output) continue;
    }
    std::error_code error;
    return usage_error(fmt::format("{} {}: is {} {} {}", output->option, output->path,
                                   fs::is_directory(other->path, error) ? "a file of" : "the same file as",
                                   other->option, other->path));
  }
  return {};
}

GridFiles grid_files(const std::string& output) {
  return {fs::path(output).replace_extension(".pgm").string(), fs::path(output).replace_extension(".yaml").string()};
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
