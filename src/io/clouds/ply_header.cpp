#include "io/clouds/ply_header.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <utility>

#include "io/bytes/text.hpp"

namespace pingvox {
namespace {

std::optional<Scalar> type_of(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, Scalar>, 16> kNames = {{{"char", Scalar::kInt8},
                                                                           {"int8", Scalar::kInt8},
                                                                           {"uchar", Scalar::kUint8},
                                                                           {"uint8", Scalar::kUint8},
                                                                           {"short", Scalar::kInt16},
                                                                           {"int16", Scalar::kInt16},
                                                                           {"ushort", Scalar::kUint16},
                                                                           {"uint16", Scalar::kUint16},
                                                                           {"int", Scalar::kInt32},
                                                                           {"int32", Scalar::kInt32},
                                                                           {"uint", Scalar::kUint32},
                                                                           {"uint32", Scalar::kUint32},
                                                                           {"float", Scalar::kFloat},
                                                                           {"float32", Scalar::kFloat},
                                                                           {"double", Scalar::kDouble},
                                                                           {"float64", Scalar::kDouble}}};
  for (const auto& [known, type] : kNames) {
    if (known == name) return type;
  }
  return std::nullopt;
}

}  // namespace

bool looks_like_ply(std::span<const std::uint8_t> bytes) {
  const std::string_view text = text_of(bytes);
  return text.starts_with("ply\n") || text.starts_with("ply\r\n");
}

Result<PlyHeader> read_ply_header(std::string_view file, std::span<const std::uint8_t> bytes) {
  const std::string_view text = text_of(bytes);
  const auto corrupt = [&](std::size_t line, std::string_view what) {
    return fail(Error::Code::kCorrupt, fmt::format("{}: line {}: {}", file, line, what));
  };
  PlyHeader header;
  while (header.size < text.size()) {
    const std::size_t end = text.find('\n', header.size);
    if (end == std::string_view::npos) break;
    std::string_view line = text.substr(header.size, end - header.size);
    if (line.ends_with('\r')) line.remove_suffix(1);
    header.size = end + 1;
    ++header.lines;
    const auto off = [&](std::string_view what) {
      return corrupt(header.lines, fmt::format("'{}': {}", printable(line), what));
    };
    std::string_view rest = line;
    const std::string_view word = cut_word(rest).value_or("");
    if (word == "end_header") {
      if (!header.format) return off("there is no format line");
      return header;
    }
    if (word == "format") {
      const std::string_view name = cut_word(rest).value_or("");
      if (name == "ascii") header.format = PlyFormat::kText;
      if (name == "binary_little_endian") header.format = PlyFormat::kLittle;
      if (name == "binary_big_endian") header.format = PlyFormat::kBig;
      if (!header.format) return off("an unknown format");
    } else if (word == "element") {
      const std::string_view name = cut_word(rest).value_or("");
      const auto count = count_in(cut_word(rest).value_or(""));
      if (name.empty() || !count) return off("an element needs a name and a number");
      header.elements.push_back({std::string(name), *count, {}});
    } else if (word == "property") {
      if (header.elements.empty()) return off("a property before any element");
      PlyProperty property;
      std::optional<Scalar> type;
      std::string_view type_name = cut_word(rest).value_or("");
      if (type_name == "list") {
        property.list_count = type_of(cut_word(rest).value_or(""));
        if (!property.list_count || !is_integer(*property.list_count)) {
          return off("a list needs a whole number for its length");
        }
        type_name = cut_word(rest).value_or("");
      }
      type = type_of(type_name);
      property.name = std::string(cut_word(rest).value_or(""));
      if (!type || property.name.empty()) return off("an unknown type, or no name");
      property.type = *type;
      header.elements.back().properties.push_back(std::move(property));
    }
  }
  return corrupt(header.lines, "the header has no end");
}

bool is_ply_with_faces(std::span<const std::uint8_t> bytes) {
  if (!looks_like_ply(bytes)) return false;
  const Result<PlyHeader> header = read_ply_header("", bytes);
  return header && std::any_of(header->elements.begin(), header->elements.end(),
                               [](const PlyElement& element) { return element.name == "face" && element.count > 0; });
}

}  // namespace pingvox
