#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

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
  return text_cloud(std::move(file), start.points, cloud, damage, origin_m.value_or(Eigen::Vector3d::Zero()));
}

}  // namespace pingvox
