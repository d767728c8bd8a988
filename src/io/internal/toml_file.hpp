#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pingvox/io/bytes.hpp"
#include "pingvox/result.hpp"

/// TOML files of keys and of tables, none within another.
namespace pingvox {

struct TomlValue {
  std::string text;  ///< numbers and truth values as TOML writes them, lists with commas between their items
  std::vector<std::string> items;  ///< of a list; else `text` alone
  bool is_string = false;
  std::size_t line = 0;
};

/// The keys of a [[name]] (or [name]), or those before the first.
struct TomlSection {
  std::string name;
  std::size_t line = 1;
  std::map<std::string, TomlValue, std::less<>> values;
};

/// @return the keys before the first [[name]], then those under each, in the order of the file; kCorrupt naming the
///         line
Result<std::vector<TomlSection>> read_toml(const FileBytes& file);

/// kCorrupt: "FILE: line N: what"
tl::unexpected<Error> toml_error(const std::string& file, std::size_t line, std::string_view what);

/// Takes the keys of a section; the first error counts.
class TomlKeys {
 public:
  TomlKeys(std::string file, TomlSection section);

  bool has(std::string_view name) const { return section_.values.contains(name); }
  /// Of a key, or of the section where it lacks the key.
  std::size_t line_of(std::string_view name) const;
  /// Empty or 0 where there is none, which is an error.
  std::string text(std::string_view name);
  double number(std::string_view name);
  void refuse(std::size_t line, std::string_view name, std::string_view what);
  /// The first error, if any; a key that is left is one.
  Result<void> finish();

 private:
  std::optional<TomlValue> take(std::string_view name);

  std::string file_;
  TomlSection section_;
  std::optional<Error> error_;
};

}  // namespace pingvox
