#include "toml_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "console.hpp"
#include "option_values.hpp"

namespace pingvox::app {
namespace {

std::string_view trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r"), last = text.find_last_not_of(" \t\r");
  return first == std::string_view::npos ? std::string_view() : text.substr(first, last - first + 1);
}

/// A basic string without escapes but \" and \\, or a bare word; a comment may follow. nullopt: neither.
std::optional<TomlValue> value_from(std::string_view text) {
  TomlValue value;
  std::string_view rest;
  if (text.starts_with('"')) {
    value.is_string = true;
    std::size_t i = 1;
    for (; i < text.size() && text[i] != '"'; ++i) {
      if (text[i] == '\\' && (++i == text.size() || (text[i] != '"' && text[i] != '\\'))) return std::nullopt;
      value.text += text[i];
    }
    if (i >= text.size()) return std::nullopt;
    rest = trim(text.substr(i + 1));
  } else {
    const std::size_t end = std::min(text.find('#'), text.size());
    value.text = trim(text.substr(0, end));
    rest = text.substr(end);
  }
  if (value.text.empty() || (!rest.empty() && !rest.starts_with('#'))) return std::nullopt;
  return value;
}

/// Of "[[name]]", which a comment may follow; nullopt: another line.
std::optional<std::string_view> section_name(std::string_view line) {
  const std::size_t end = line.find("]]");
  if (!line.starts_with("[[") || end == std::string_view::npos) return std::nullopt;
  const std::string_view rest = trim(line.substr(end + 2));
  if (!rest.empty() && !rest.starts_with('#')) return std::nullopt;
  return trim(line.substr(2, end - 2));
}

}  // namespace

tl::unexpected<Error> toml_error(const std::string& file, std::size_t line, std::string_view what) {
  return fail(Error::Code::kCorrupt, fmt::format("{}: line {}: {}", file, line, what));
}

Result<std::vector<TomlSection>> read_toml(const FileBytes& file) {
  std::vector<TomlSection> sections(1);
  std::string_view text(reinterpret_cast<const char*>(file.bytes.data()), file.bytes.size());
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trim(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.empty() || line.starts_with('#')) continue;
    if (const std::optional<std::string_view> name = section_name(line)) {
      sections.push_back({std::string(*name), number, {}});
      continue;
    }
    const std::size_t equals = line.find('=');
    std::optional<TomlValue> value;
    if (equals != std::string_view::npos) value = value_from(trim(line.substr(equals + 1)));
    if (!value) return toml_error(file.name, number, "is not 'name = number', 'name = \"text\"' or '[[name]]'");
    value->line = number;
    const std::string name(trim(line.substr(0, equals)));
    if (!sections.back().values.emplace(name, *value).second) {
      return toml_error(file.name, number, fmt::format("{}: is there twice", on_one_line(name)));
    }
  }
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

}  // namespace pingvox::app
