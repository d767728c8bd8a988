#include "pingvox/viewer/side_by_side.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "viewer/axis.hpp"
#include "viewer/colours.hpp"
#include "viewer/label.hpp"

namespace pingvox {
namespace {

constexpr std::size_t kEdge = 24, kBetween = 16;
/// Maximum width of a row: wider ones would be unreadable on a screen.
constexpr std::size_t kMaxWidth = 2600;
constexpr std::size_t kLine = static_cast<std::size_t>(kTextScale * kLetterHeight) + 6;

/// Wraps text to `width` pixels, between words, or within words longer than a line.
std::vector<std::string> lines_of(std::string_view text, std::size_t width) {
  const std::size_t most = std::max<std::size_t>(width / static_cast<std::size_t>(kTextScale * kLetterWidth), 1);
  std::vector<std::string> lines;
  while (!text.empty()) {
    std::size_t length = std::min(most, text.size());
    if (length < text.size() && text[length] != ' ') {
      const std::size_t space = text.substr(0, length).rfind(' ');
      if (space != std::string_view::npos && space > 0) length = space;
    }
    lines.emplace_back(text.substr(0, length));
    text.remove_prefix(length);
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  }
  return lines;
}

/// Width of text below or above a picture of this width.
std::size_t text_width(std::size_t width) {
  return width > 2 * kEdge ? width - 2 * kEdge : 1;
}

struct Row {
  std::size_t first, last;            ///< range of panels
  std::size_t width = 0;              ///< of all, with the gaps between
  std::size_t height = 0, lines = 0;  ///< of the highest picture; of the longest caption
};

Row row_of(std::span<const Panel> panels, std::size_t first, std::size_t last) {
  Row row{first, last};
  for (std::size_t i = first; i < last; ++i) {
    const Panel& panel = panels[i];
    row.width += panel.picture.width() + (i > first ? kBetween : 0);
    row.height = std::max(row.height, panel.picture.height());
    row.lines = std::max(row.lines, lines_of(panel.caption, text_width(panel.picture.width())).size());
  }
  return row;
}

/// Layout of the panels in a number of rows.
struct Layout {
  std::vector<Row> rows;
  std::vector<std::string> heading;
  std::size_t width = 0, height = 0;
};

std::size_t height_of(const Row& row) {
  return row.height + (row.lines > 0 ? row.lines * kLine + kBetween : 0);
}

Layout layout_of(std::span<const Panel> panels, std::string_view title, std::size_t rows) {
  Layout layout;
  for (std::size_t r = 0; r < rows; ++r) {
    layout.rows.push_back(row_of(panels, r * panels.size() / rows, (r + 1) * panels.size() / rows));
    layout.width = std::max(layout.width, layout.rows.back().width);
    layout.height += height_of(layout.rows.back());
  }
  layout.heading = lines_of(title, text_width(layout.width));
  if (!layout.heading.empty()) layout.height += kEdge + layout.heading.size() * kLine;
  return layout;
}

Picture draw_panels(std::span<const Panel> panels, const Layout& layout) {
  Picture picture(layout.width, layout.height, kPaper);
  const auto write = [&](const std::vector<std::string>& lines, std::size_t x, std::size_t top) {
    for (const std::string& line : lines) {
      draw_label(picture, static_cast<std::ptrdiff_t>(x), static_cast<std::ptrdiff_t>(top), line, kTextScale, kInk);
      top += kLine;
    }
  };
  std::size_t y = 0;
  if (!layout.heading.empty()) {
    write(layout.heading, kEdge, kEdge);
    y = kEdge + layout.heading.size() * kLine;
  }
  for (const Row& row : layout.rows) {
    std::size_t x = 0;
    for (std::size_t i = row.first; i < row.last; ++i) {
      const Panel& panel = panels[i];
      paste(picture, panel.picture, static_cast<std::ptrdiff_t>(x), static_cast<std::ptrdiff_t>(y));
      write(lines_of(panel.caption, text_width(panel.picture.width())), x + kEdge, y + row.height);
      x += panel.picture.width() + kBetween;
    }
    y += height_of(row);
  }
  return picture;
}

}  // namespace

Result<Picture> side_by_side(std::span<const Panel> panels, std::string_view title) {
  if (panels.empty()) return fail(Error::Code::kBadOption, "side by side: no pictures given");
  std::optional<Layout> chosen;
  for (std::size_t count = 1; count <= panels.size(); ++count) {
    Layout layout = layout_of(panels, title, count);
    if (layout.width > Picture::kMaxSide || layout.height > Picture::kMaxSide) continue;
    const bool is_readable = layout.width <= kMaxWidth;
    if (!chosen || is_readable) chosen = std::move(layout);
    if (is_readable) break;
  }
  if (chosen) return draw_panels(panels, *chosen);
  return fail(Error::Code::kLimit,
              fmt::format("{} pictures side by side need more than {} pixels: make them smaller, or draw fewer",
                          panels.size(), Picture::kMaxSide));
}

}  // namespace pingvox
