#include "pingvox/io/folder_logs.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "io/internal/descriptor.hpp"
#include "io/readers.hpp"
#include "pingvox/io/byte_stream.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/open_log.hpp"

namespace pingvox {
namespace {

namespace fs = std::filesystem;

Result<Format> format_of_path(const std::string& path) {
  return ByteStream::open(path).and_then([](ByteStream stream) { return identify_format(stream); });
}

/// nullopt: no known format, or a bag without anything of a sonar.
std::optional<FormatKind> kind_of_file(const std::string& path) {
  const Result<Format> format = format_of_path(path);
  if (!format) return std::nullopt;
  if (is_bag(*format)) {
    const Result<Log> log =
        ByteStream::open(path).and_then([](ByteStream stream) { return open_log(std::move(stream)); });
    if (!log && log.error().code == Error::Code::kUnsupported) return std::nullopt;
  }
  return kind_of(*format);
}

bool is_hidden(const fs::path& path) {
  return path.filename().string().starts_with('.');
}

void sort_in(const std::string& path, FolderTree& tree) {
  const Result<Format> format = format_of_path(path);
  if (!format) {
    const bool is_unknown = format.error().code == Error::Code::kUnsupported;
    is_unknown ? tree.unknown.push_back(path) : tree.unreadable.push_back({path, format.error().message});
    return;
  }
  const FormatKind kind = kind_of(*format);
  if (is_bag(*format)) {
    tree.bags.push_back(path);
  } else if (kind == FormatKind::kBeams || kind == FormatKind::kScans) {
    tree.logs.push_back(path);
  } else if (kind == FormatKind::kNav) {
    tree.nav.push_back(path);
  }
}

/// The files and folders in a folder, in the order of their names.
Result<std::vector<fs::path>> paths_in(const fs::path& folder) {
  std::vector<fs::path> paths;
  std::error_code error;
  // Not by a range: its increment throws.
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (!is_hidden(entry->path())) paths.push_back(entry->path());
  }
  if (error) return os_error(folder.string(), error.value());
  std::ranges::sort(paths);
  return paths;
}

void sort_in_folder(const std::vector<fs::path>& paths, FolderTree& tree) {
  std::error_code ignored;
  for (const fs::path& path : paths) {
    if (fs::is_regular_file(path, ignored)) sort_in(path.string(), tree);
    if (!fs::is_directory(fs::symlink_status(path, ignored))) continue;
    if (ByteStream::open(path.string())) {
      tree.bags.push_back(path.string());
      continue;
    }
    const Result<std::vector<fs::path>> inside = paths_in(path);
    inside ? sort_in_folder(*inside, tree) : tree.unreadable.push_back({path.string(), inside.error().message});
  }
}

}  // namespace

Result<FolderLogs> logs_in_folder(const std::string& folder) {
  const Result<std::vector<fs::path>> files = paths_in(folder);
  if (!files) return tl::unexpected(files.error());
  FolderLogs found;
  std::vector<std::string> scans;
  std::error_code ignored;
  for (const fs::path& file : *files) {
    if (fs::is_directory(file, ignored)) found.folders.push_back(file.filename().string());
    if (!fs::is_regular_file(file, ignored)) continue;
    const std::optional<FormatKind> kind = kind_of_file(file.string());
    if (kind == FormatKind::kBeams) {
      found.logs.push_back(file.string());
    } else if (kind == FormatKind::kScans) {
      scans.push_back(file.string());
    } else if (kind == FormatKind::kNav) {
      found.nav.push_back(file.string());
    } else {
      found.others.push_back(file.filename().string());
    }
  }
  if (found.logs.empty()) {
    found.logs = std::move(scans);
  } else {
    for (const std::string& scan : scans) found.others.push_back(fs::path(scan).filename().string());
  }
  for (const std::string& log : found.logs) {
    for (const std::string& file : files_beside_log(log)) std::erase(found.others, fs::path(file).filename().string());
  }
  return found;
}

std::vector<std::string> files_beside_log(const std::string& log) {
  const Result<Format> format = format_of_path(log);
  return format && *format == Format::kBeamHits ? times_beside_hits(log) : std::vector<std::string>();
}

Result<FolderTree> logs_below_folder(const std::string& folder) {
  return paths_in(folder).map([](const std::vector<fs::path>& paths) {
    FolderTree tree;
    sort_in_folder(paths, tree);
    for (const std::string& log : tree.logs) {
      for (const std::string& file : files_beside_log(log)) std::erase(tree.unknown, file);
    }
    return tree;
  });
}

}  // namespace pingvox
