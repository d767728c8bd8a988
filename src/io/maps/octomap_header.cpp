#include "io/maps/octomap_header.hpp"

#include <fmt/core.h>

#include <optional>

#include "io/bytes/text.hpp"
#include "io/maps/map_files.hpp"

namespace pingvox {
namespace {

constexpr std::string_view kEastNorthComment = "# x east, y north";
constexpr std::string_view kWhitespace = " \t\r\n\v\f";

/// Words and lines of the header, which precedes binary data.
class HeaderWords {
 public:
  explicit HeaderWords(std::string_view text) : text_(text) {}

  std::size_t position() const { return at_; }

  /// Empty at the end.
  std::string_view next() {
    at_ = std::min(text_.find_first_not_of(kWhitespace, at_), text_.size());
    const std::size_t end = std::min(text_.find_first_of(kWhitespace, at_), text_.size());
    const std::string_view word = text_.substr(at_, end - at_);
    at_ = end;
    return word;
  }

  void skip_line() {
    const std::size_t end = text_.find('\n', at_);
    at_ = end == std::string_view::npos ? text_.size() : end + 1;
  }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

Result<OctomapHeader> read_octomap_header(const FileBytes& file, std::string_view first_line) {
  const std::string_view text = text_of(file.view());
  if (!text.starts_with(first_line))
    return damage_error(file, 0, fmt::format("the first line is not '{}'", first_line));
  HeaderWords words(text);
  words.skip_line();
  OctomapHeader header;
  std::optional<std::uint64_t> nodes;
  std::optional<double> resolution_m;
  while (true) {
    const std::string_view word = words.next();
    const std::size_t at = words.position() - word.size();
    if (word.empty()) return damage_error(file, text.size(), "the header does not end with 'data'");
    if (word == "id") {
      header.id = words.next();
    } else if (word == "size") {
      nodes = count_in(words.next());
      if (!nodes) return damage_error(file, at, "size is not a number of nodes");
    } else if (word == "res") {
      resolution_m = number_in(words.next());
      if (!resolution_m) return damage_error(file, at, "res is not a number");
    } else {
      words.skip_line();
      if (word == "data") break;
    }
  }
  const std::size_t end = words.position();
  if (header.id.empty()) return damage_error(file, end, "the header names no id");
  if (!nodes) return damage_error(file, end, "the header names no size");
  if (!resolution_m) return damage_error(file, end, "the header names no res");
  header.nodes = *nodes;
  header.resolution_m = *resolution_m;
  header.tree_at = end;
  return header;
}

MapAxes octomap_axes(const FileBytes& file) {
  Lines lines(text_of(file.view()));
  while (const std::optional<std::string_view> line = lines.next()) {
    if (*line == kEastNorthComment) return MapAxes::kEastNorth;
    if (*line == "data") break;
  }
  return MapAxes::kUnknown;
}

std::string octomap_header(std::string_view first_line, std::uint64_t nodes, double resolution_m, MapAxes axes) {
  std::string resolution = fmt::format("{:g}", resolution_m);
  if (number_in(resolution) != resolution_m) resolution = fmt::format("{}", resolution_m);
  return fmt::format(
      "{}\n# (feel free to add / change comments, but leave the first line as it is!)\n#\n{}id OcTree\nsize {}\nres "
      "{}\n"
      "data\n",
      first_line, axes == MapAxes::kEastNorth ? fmt::format("{}\n", kEastNorthComment) : "", nodes, resolution);
}

Result<OccupancyMap> empty_octomap(const FileBytes& file, double resolution_m, std::size_t memory_limit_bytes) {
  auto map = OccupancyMap::make(
      {.resolution_m = resolution_m, .depth = kOctomapDepth, .memory_limit_bytes = memory_limit_bytes});
  if (!map) return fail(Error::Code::kCorrupt, fmt::format("{}: header: {}", file.name, map.error().message));
  return map;
}

}  // namespace pingvox
