#include "pingvox/io/folder_logs.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "io/internal/descriptor.hpp"
#include "pingvox/io/byte_stream.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/open_log.hpp"

namespace pingvox {
namespace {

namespace fs = std::filesystem;

std::optional<FormatKind> kind_of_file(const std::string& path) {
  const Result<Format> format =
      ByteStream::open(path).and_then([](ByteStream stream) { return identify_format(stream); });
  return format ? std::optional(kind_of(*format)) : std::nullopt;
}

}  // namespace

Result<FolderLogs> logs_in_folder(const std::string& folder) {
  std::vector<fs::path> files;
  std::error_code error, ignored;
  // Not by a range: its increment throws.
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const bool is_hidden = entry->path().filename().string().starts_with('.');
    if (!is_hidden && entry->is_regular_file(ignored)) files.push_back(entry->path());
  }
  if (error) return os_error(folder, error.value());
  std::ranges::sort(files);
  FolderLogs found;
  std::vector<std::string> scans;
  for (const fs::path& file : files) {
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
  return found;
}

}  // namespace pingvox
