#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "io/internal/json.hpp"

namespace pingvox::bench {

/// Value of a field. bool is not converted implicitly, see Row::add_truth.
using Value = std::variant<std::monostate, std::string, double, std::uint64_t, bool>;

/// One row of a result: names (keys in JSON, columns in the table) and values, in order.
class Row {
 public:
  Row& add(std::string name, std::string_view value);
  Row& add(std::string name, const char* value);
  Row& add(std::string name, double value);
  Row& add(std::string name, std::uint64_t value);
  Row& add(std::string name, int value);
  Row& add_truth(std::string name, bool value);
  Row& add_value(std::string name, const Value& value);  ///< of any type
  /// Not measured: null in JSON, a dash in the table.
  Row& add_nothing(std::string name);

  const std::vector<std::pair<std::string, Value>>& fields() const { return fields_; }
  JsonObject json() const;

 private:
  std::vector<std::pair<std::string, Value>> fields_;
};

/// The rows as an aligned table, with a header wherever the names change and numbers to four digits.
std::string table_of(const std::vector<Row>& rows);

/// The same as a table in Markdown.
std::string markdown_of(const std::vector<Row>& rows);

}  // namespace pingvox::bench
