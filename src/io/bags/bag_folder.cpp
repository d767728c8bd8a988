#include "io/bags/bag_folder.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>

#include "io/bytes/text.hpp"
#include "io/internal/descriptor.hpp"
#include "pingvox/io/byte_stream.hpp"
#include "pingvox/io/file.hpp"

namespace pingvox {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMetadata = "metadata.yaml", kPackedSuffix = ".zstd";

bool is_bag_name(const fs::path& name) {
  return name.extension() == ".db3" || name.extension() == ".mcap";
}

/// What is in a folder, by name.
struct Folder {
  std::vector<std::string> bags;    ///< in order of their names
  std::vector<std::string> packed;  ///< of rosbag2's compression mode FILE
  bool has_metadata = false, has_others = false;
};

Result<Folder> list_folder(const std::string& folder) {
  Folder found;
  std::error_code error, ignored;
  // Not by a range: its increment throws.
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path name = entry->path().filename();
    const std::string suffix = name.extension().string();
    if (is_bag_name(name)) {
      found.bags.push_back(name.string());
    } else if (name == kMetadata && entry->is_regular_file(ignored)) {
      found.has_metadata = true;
    } else if (suffix == kPackedSuffix && is_bag_name(name.stem())) {
      found.packed.push_back(name.string());
    } else if (!name.string().starts_with('.') && !suffix.starts_with(".db3-")) {  // of SQLite beside its file
      found.has_others = true;
    }
  }
  if (error) return os_error(folder, error.value());
  std::ranges::sort(found.bags);
  std::ranges::sort(found.packed);
  return found;
}

/// A name as metadata.yaml has it: a path of the recorder, maybe in quotes, or that of a file which was unpacked since.
std::string file_name_in(std::string_view item) {
  const fs::path path = trim(item, " \t\"'");
  return (path.extension() == kPackedSuffix ? path.stem() : path.filename()).string();
}

/// The files that a metadata.yaml lists as `relative_file_paths`, a line or a word in brackets each.
std::vector<std::string> listed_in(std::string_view yaml) {
  constexpr std::string_view kKey = "relative_file_paths:";
  std::vector<std::string> names;
  Lines lines(yaml);
  std::optional<std::string_view> line = lines.next();
  while (line && !trim(*line).starts_with(kKey)) line = lines.next();
  if (!line) return names;
  std::string_view words = trim(trim(*line).substr(kKey.size()), " \t[]");
  while (const auto word = cut_field(words, ',')) names.push_back(file_name_in(*word));
  for (line = lines.next_with_content(); line && trim(*line).starts_with("- "); line = lines.next_with_content()) {
    names.push_back(file_name_in(trim(*line).substr(2)));
  }
  return names;
}

/// The number of "dive_12.db3"; nullopt: there is none.
std::optional<std::uint64_t> number_in_series(const std::string& name) {
  const std::string stem = fs::path(name).stem().string();
  const std::size_t mark = stem.rfind('_');
  return mark == std::string::npos ? std::nullopt : count_in(std::string_view(stem).substr(mark + 1));
}

/// All bags of a folder in the order of their numbers; nullopt: they are not one series without a gap.
std::optional<std::vector<std::string>> as_series(std::vector<std::string> names) {
  const auto rest_of = [](const std::string& name) {
    const fs::path path(name);
    return path.stem().string().substr(0, path.stem().string().rfind('_')) + path.extension().string();
  };
  for (const std::string& name : names) {
    if (!number_in_series(name) || rest_of(name) != rest_of(names.front())) return std::nullopt;
  }
  std::ranges::sort(names, {}, [](const std::string& name) { return *number_in_series(name); });
  const auto skips = [](const std::string& a, const std::string& b) {
    return *number_in_series(a) + 1 != *number_in_series(b);
  };
  if (std::ranges::adjacent_find(names, skips) != names.end()) return std::nullopt;
  return names;
}

/// Those of `found` that make the bag.
Result<std::vector<std::string>> choose(const std::string& folder, const Folder& found) {
  const auto refuse = [&](const std::string& what) {
    return fail(Error::Code::kIo, fmt::format("{}: {}", folder, what));
  };
  const auto is_there = [&](const std::string& name) {
    return std::ranges::find(found.bags, name) != found.bags.end();
  };
  std::vector<std::string> listed;
  if (found.has_metadata) {
    const Result<FileBytes> metadata = read_file((fs::path(folder) / kMetadata).string());
    if (!metadata) return tl::unexpected(metadata.error());
    listed = listed_in(text_of(metadata->view()));
  }
  const auto missing = std::ranges::find_if_not(listed, is_there);
  if (!listed.empty() && missing == listed.end()) return listed;
  if (found.bags.empty() && !found.packed.empty()) {
    return refuse(
        fmt::format("holds a bag whose files are compressed as a whole ({}): unpack them first", found.packed.front()));
  }
  if (found.bags.empty()) return refuse("is a folder without a bag of ROS 2: name the files in it");
  // As many files with other names were renamed since.
  if (found.bags.size() < listed.size()) {
    return refuse(fmt::format("lacks {}, which its metadata.yaml lists: name the files to read", *missing));
  }
  if (!found.has_metadata && found.has_others) {
    return refuse("is a folder of a bag and other files: name those to read");
  }
  if (found.bags.size() == 1) return found.bags;
  if (auto series = as_series(found.bags)) return *std::move(series);
  return refuse(fmt::format("is a folder of {} bags: name them one by one", found.bags.size()));
}

}  // namespace

Result<std::vector<std::string>> bag_files_in(const std::string& folder) {
  return list_folder(folder)
      .and_then([&](const Folder& found) { return choose(folder, found); })
      .map([&](std::vector<std::string> names) {
        for (std::string& name : names) name = (fs::path(folder) / name).string();
        return names;
      });
}

}  // namespace pingvox
