#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "app/json.hpp"

namespace pingvox::bench {

/// What stands in one field of a row. The truth value has no implicit way in, see Row::add_truth.
using Value = std::variant<std::monostate, std::string, double, std::uint64_t, bool>;

/// One line of a result: names and values, in order. The names are keys in JSON and columns in the table.
class Row {
 public:
  Row& add(std::string name, std::string_view value);
  Row& add(std::string name, const char* value);
  Row& add(std::string name, double value);
  Row& add(std::string name, std::uint64_t value);
  Row& add(std::string name, int value);
  Row& add_truth(std::string name, bool value);
  Row& add_value(std::string name, const Value& value);  ///< whatever it holds
  /// Not measured here: null in JSON, a dash in the table.
  Row& add_nothing(std::string name);

  const std::vector<std::pair<std::string, Value>>& fields() const { return fields_; }
  app::JsonObject json() const;

 private:
  std::vector<std::pair<std::string, Value>> fields_;
};

/// The rows as a table for people: a header wherever the names change, numbers to four digits, aligned.
std::string table_of(const std::vector<Row>& rows);

/// The same as a table in Markdown.
std::string markdown_of(const std::vector<Row>& rows);

}  // namespace pingvox::bench
