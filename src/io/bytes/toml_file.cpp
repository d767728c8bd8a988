#include "io/internal/toml_file.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/option_text.hpp"
#include "base/words.hpp"

namespace pingvox {
namespace {

std::size_t line_of_node(const toml::node& node) {
  return node.source().begin.line;
}

/// nullopt: dates, tables and lists in lists, which no file of ours has.
std::optional<TomlValue> toml_value_from(const toml::node& node) {
  TomlValue value;
  value.line = line_of_node(node);
  if (const toml::array* list = node.as_array()) {
    for (const toml::node& item : *list) {
      const auto text = item.is_array() ? std::nullopt : toml_value_from(item);
      if (!text) return std::nullopt;
      value.items.push_back(text->text);
    }
    value.text = fmt::format("{}", fmt::join(value.items, ","));
    return value;
  }
  if (const auto* text = node.as_string()) {
    value.is_string = true;
    value.text = text->get();
  } else if (const auto* whole = node.as_integer()) {
    value.text = fmt::format("{}", whole->get());
  } else if (const auto* real = node.as_floating_point()) {
    value.text = fmt::format("{}", real->get());
  } else if (const auto* truth = node.as_boolean()) {
    value.text = truth->get() ? "true" : "false";
  } else {
    return std::nullopt;
  }
  value.items = {value.text};
  return value;
}

Result<TomlSection> section_from(const std::string& file, std::string_view name, const toml::table& table) {
  TomlSection section;
  section.name = name;
  section.line = std::max<std::size_t>(line_of_node(table), 1);
  for (const auto& [key, node] : table) {
    const bool is_section = name.empty() && (node.is_table() || node.is_array_of_tables());
    if (is_section) continue;
    const std::optional<TomlValue> value = toml_value_from(node);
    if (!value) {
      return toml_error(
          file, line_of_node(node),
          fmt::format("{}: must be a number, a text, true or false, or a list of these", on_one_line(key.str())));
    }
    section.values.emplace(key.str(), *value);
  }
  return section;
}

}  // namespace

tl::unexpected<Error> toml_error(const std::string& file, std::size_t line, std::string_view what) {
  return fail(Error::Code::kCorrupt, fmt::format("{}: line {}: {}", file, line, what));
}

Result<std::vector<TomlSection>> read_toml(const FileBytes& file) {
  toml::table top;
  try {
    top = toml::parse(std::string_view(reinterpret_cast<const char*>(file.bytes.data()), file.bytes.size()));
  } catch (const toml::parse_error& error) {
    return toml_error(file.name, error.source().begin.line, on_one_line(error.description()));
  }
  std::vector<TomlSection> sections;
  const auto add = [&](std::string_view name, const toml::table& table) -> Result<void> {
    return section_from(file.name, name, table).map([&](TomlSection section) {
      sections.push_back(std::move(section));
    });
  };
  if (const auto added = add("", top); !added) return tl::unexpected(added.error());
  for (const auto& [key, node] : top) {
    if (const toml::table* table = node.as_table()) {
      if (const auto added = add(key.str(), *table); !added) return tl::unexpected(added.error());
    } else if (node.is_array_of_tables()) {
      for (const toml::node& table_of_list : *node.as_array()) {
        if (const auto added = add(key.str(), *table_of_list.as_table()); !added) return tl::unexpected(added.error());
      }
    }
  }
  std::ranges::sort(sections.begin() + 1, sections.end(), {}, &TomlSection::line);
  return sections;
}

TomlKeys::TomlKeys(std::string file, TomlSection section) : file_(std::move(file)), section_(std::move(section)) {}

std::size_t TomlKeys::line_of(std::string_view name) const {
  const auto found = section_.values.find(name);
  return found == section_.values.end() ? section_.line : found->second.line;
}

std::optional<TomlValue> TomlKeys::take(std::string_view name) {
  const auto found = section_.values.find(name);
  if (found == section_.values.end()) {
    const std::string in = section_.name.empty() ? "" : fmt::format(" in this [[{}]]", section_.name);
    refuse(section_.line, name, "is missing" + in);
    return std::nullopt;
  }
  TomlValue value = std::move(found->second);
  section_.values.erase(found);
  return value;
}

std::string TomlKeys::text(std::string_view name) {
  const std::optional<TomlValue> value = take(name);
  if (value && !value->is_string) refuse(value->line, name, "must be a text in quotation marks");
  return value ? value->text : std::string();
}

double TomlKeys::number(std::string_view name) {
  const std::optional<TomlValue> value = take(name);
  if (!value) return 0.0;
  const Result<double> number = number_from<double>(value->text);
  if (value->is_string || !number || !std::isfinite(*number)) {
    refuse(value->line, name, fmt::format("'{}' is not a finite number", on_one_line(value->text)));
    return 0.0;
  }
  return *number;
}

void TomlKeys::refuse(std::size_t line, std::string_view name, std::string_view what) {
  if (!error_) error_ = toml_error(file_, line, fmt::format("{}: {}", name, what)).value();
}

Result<void> TomlKeys::finish() {
  for (const auto& [name, value] : section_.values) refuse(value.line, on_one_line(name), "is unknown");
  return error_ ? Result<void>(tl::unexpected(*error_)) : Result<void>();
}

}  // namespace pingvox
