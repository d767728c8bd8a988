#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "io/bytes/text.hpp"
#include "io/clouds/cloud.hpp"
#include "io/readers.hpp"

// Points as text: `x y z` and optional further columns, one point a line (docs/formats.md).
namespace pingvox {
namespace {

/// Whether a line names its first columns x, y and z, as "//X Y Z R G B" of CloudCompare.
bool names_xyz(std::string_view line) {
  if (trim(line).starts_with("//")) line = trim(line).substr(2);
  constexpr std::array<std::string_view, 3> kNames = {"x", "y", "z"};
  return std::ranges::all_of(kNames, [&](std::string_view name) {
    const auto word = cut_word(line);
    return word && word->size() == 1 && (word->front() | 0x20) == name.front();
  });
}

std::vector<std::string> words_of(std::string_view line) {
  std::vector<std::string> words;
  constexpr std::size_t kMaxWords = 64;
  while (const auto word = cut_word(line)) {
    if (words.size() == kMaxWords) break;
    std::string& lower = words.emplace_back(*word);
    std::ranges::transform(lower, lower.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c | 0x20) : c; });
  }
  return words;
}

/// The names of the columns in the last comment before the first point: as many as that has numbers, of which the
/// first three are known. Empty: there is none.
std::vector<std::string> column_names_of(std::string_view text) {
  constexpr auto kKnown =
      std::to_array<std::string_view>({"x", "y", "z", "time", "timestamp", "t", "lon", "longitude", "lat", "latitude",
                                       "easting", "northing", "east", "north", "depth", "range", "bearing"});
  Lines lines(text);
  std::vector<std::string> names;
  for (auto line = lines.next(); line; line = lines.next()) {
    const std::string_view content = trim(*line);
    if (content.empty()) continue;
    if (!content.starts_with('#')) {
      if (words_of(content).size() != names.size()) names.clear();
      break;
    }
    names = words_of(trim(content, "# \t"));
  }
  const auto is_known = [&](const std::string& name) { return std::ranges::find(kKnown, name) != kKnown.end(); };
  const bool are_names = names.size() >= 3 && std::all_of(names.begin(), names.begin() + 3, is_known);
  return are_names ? names : std::vector<std::string>();
}

/// A line of one whole number, as PTS begins: how many points follow.
std::optional<std::uint64_t> count_of_points(std::string_view line) {
  const auto count = cut_word(line);
  return count && !cut_word(line) ? count_in(*count) : std::nullopt;
}

/// Where the points begin.
struct XyzStart {
  Lines points;
  std::optional<std::uint64_t> announced;
};

XyzStart start_of(std::string_view text) {
  Lines lines(text);
  Lines behind = lines;
  const auto first = behind.next_with_content();
  if (!first) return {lines, std::nullopt};
  const std::optional<std::uint64_t> announced = count_of_points(*first);
  return {announced || names_xyz(*first) ? behind : lines, announced};
}

/// A number with a comma within, as "1,50" or "2,500.25", in a line whose numbers are separated by blanks; empty: there
/// is none.
std::string_view word_with_comma(std::string_view line) {
  constexpr std::string_view kBlanks = " \t";
  std::string_view found;
  std::size_t words = 0;
  for (line = trim(line); !line.empty() && words < 3; line = trim(line), ++words) {
    const std::string_view word = line.substr(0, line.find_first_of(kBlanks));
    line.remove_prefix(word.size());
    const std::string_view within = trim(word, ",");
    if (found.empty() && within.find(',') != std::string_view::npos) found = word;
  }
  return words == 3 ? found : std::string_view();
}

/// Such a number in one of the first lines.
std::string_view word_with_comma(Lines lines) {
  constexpr int kLines = 10;
  for (int looked_at = 0; looked_at < kLines; ++looked_at) {
    const auto line = lines.next_with_content();
    if (!line) break;
    if (const std::string_view word = word_with_comma(*line); !word.empty()) return word;
  }
  return {};
}

}  // namespace

bool looks_like_xyz(std::span<const std::uint8_t> bytes) {
  // Longer lines are beams without a header.
  constexpr std::size_t kMaxWords = 16;
  constexpr int kLines = 10;
  Lines lines = start_of(text_of(bytes)).points;
  for (int looked_at = 0; looked_at < kLines; ++looked_at) {
    auto line = lines.next_with_content();
    if (!line) return looked_at > 0;
    std::size_t count = 0;
    while (const auto word = cut_word(*line)) {
      if (++count > kMaxWords || (looked_at == 0 && !number_in(*word))) return false;
    }
    if (looked_at == 0 && count < 3) return false;
  }
  return true;
}

Result<std::unique_ptr<ScanSource>> open_xyz(FileBytes file, Damage damage, const CloudOrigin& origin_m) {
  TextCloud cloud;
  for (std::size_t axis = 0; axis < 3; ++axis) cloud.xyz[axis].word = axis;
  const XyzStart start = start_of(text_of(file.view()));
  cloud.announced = start.announced;
  if (const std::string_view word = word_with_comma(start.points); !word.empty()) {
    return fail(Error::Code::kCorrupt,
                fmt::format("{}: \"{}\" has a comma between blanks: commas of decimals and of thousands are not read, "
                            "only points",
                            file.name, printable(word)));
  }
  if (const std::vector<std::string> names = column_names_of(text_of(file.view())); !names.empty()) {
    constexpr std::array<std::string_view, 3> kAxes = {"x", "y", "z"};
    for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
      const auto named = std::ranges::find(names, kAxes[axis]);
      if (named == names.end()) {
        return fail(Error::Code::kUnsupported,
                    fmt::format("{}: its columns are {} by its comment: only x, y and z in metres are read, z up",
                                file.name, printable(fmt::format("{}", fmt::join(names, ", ")))));
      }
      cloud.xyz[axis].word = static_cast<std::size_t>(named - names.begin());
    }
  }
  return text_cloud(std::move(file), start.points, cloud, damage, origin_m.value_or(Eigen::Vector3d::Zero()));
}

}  // namespace pingvox
