#include "report.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace pingvox::bench {
namespace {

std::string text_of(const Value& value) {
  return std::visit(
      [](const auto& v) -> std::string {
        using V = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<V, std::monostate>) {
          return "-";
        } else if constexpr (std::is_same_v<V, bool>) {
          return v ? "yes" : "NO";
        } else if constexpr (std::is_same_v<V, double>) {
          return std::isfinite(v) ? fmt::format("{:.4g}", v) : "-";  // null in JSON
        } else {
          return fmt::format("{}", v);
        }
      },
      value);
}

bool is_text(const Value& value) {
  return std::holds_alternative<std::string>(value);
}

bool same_names(const Row& a, const Row& b) {
  return std::equal(a.fields().begin(), a.fields().end(), b.fields().begin(), b.fields().end(),
                    [](const auto& x, const auto& y) { return x.first == y.first; });
}

/// Calls f(first, last) for each range of rows with the same names.
template <class F>
void for_each_stretch(const std::vector<Row>& rows, F&& f) {
  for (std::size_t first = 0; first < rows.size();) {
    std::size_t last = first + 1;
    while (last < rows.size() && same_names(rows[first], rows[last])) ++last;
    f(first, last);
    first = last;
  }
}

}  // namespace

// Not in the header: inlined, g++ 12 takes the other alternatives of the variant for uninitialized.
Row& Row::add(std::string name, std::string_view value) {
  fields_.emplace_back(std::move(name), std::string(value));
  return *this;
}
Row& Row::add(std::string name, const char* value) {
  return add(std::move(name), std::string_view(value));
}
Row& Row::add(std::string name, double value) {
  fields_.emplace_back(std::move(name), value);
  return *this;
}
Row& Row::add(std::string name, std::uint64_t value) {
  fields_.emplace_back(std::move(name), value);
  return *this;
}
Row& Row::add(std::string name, int value) {
  return add(std::move(name), static_cast<double>(value));
}
Row& Row::add_truth(std::string name, bool value) {
  fields_.emplace_back(std::move(name), value);
  return *this;
}
Row& Row::add_value(std::string name, const Value& value) {
  fields_.emplace_back(std::move(name), value);
  return *this;
}
Row& Row::add_nothing(std::string name) {
  fields_.emplace_back(std::move(name), std::monostate());
  return *this;
}

JsonObject Row::json() const {
  JsonObject object;
  for (const auto& [name, value] : fields_) {
    const auto& key = name;
    std::visit(
        [&](const auto& v) {
          using V = std::decay_t<decltype(v)>;
          if constexpr (std::is_same_v<V, std::monostate>) {
            object.add_null(key);
          } else if constexpr (std::is_same_v<V, bool>) {
            object.add_truth(key, v);
          } else {
            object.add(key, v);
          }
        },
        value);
  }
  return object;
}

std::string table_of(const std::vector<Row>& rows) {
  std::string out;
  for_each_stretch(rows, [&](std::size_t first, std::size_t last) {
    const std::size_t columns = rows[first].fields().size();
    std::vector<std::size_t> width(columns);
    for (std::size_t c = 0; c < columns; ++c) {
      width[c] = rows[first].fields()[c].first.size();
      for (std::size_t r = first; r < last; ++r) {
        width[c] = std::max(width[c], text_of(rows[r].fields()[c].second).size());
      }
    }
    if (!out.empty()) out += '\n';
    const auto put = [&](std::size_t column, const std::string& text, bool left) {
      const std::string padding(width[column] - text.size(), ' ');
      out += (column > 0 ? "  " : "") + (left ? text + padding : padding + text);
    };
    const auto end_line = [&] {
      out.erase(out.find_last_not_of(' ') + 1);
      out += '\n';
    };
    for (std::size_t c = 0; c < columns; ++c) {
      put(c, rows[first].fields()[c].first, is_text(rows[first].fields()[c].second));
    }
    end_line();
    for (std::size_t r = first; r < last; ++r) {
      for (std::size_t c = 0; c < columns; ++c) {
        put(c, text_of(rows[r].fields()[c].second), is_text(rows[first].fields()[c].second));
      }
      end_line();
    }
  });
  return out;
}

std::string markdown_of(const std::vector<Row>& rows) {
  std::string out;
  for_each_stretch(rows, [&](std::size_t first, std::size_t last) {
    if (!out.empty()) out += '\n';
    std::string names = "|", rule = "|";
    for (const auto& [name, value] : rows[first].fields()) {
      names += fmt::format(" {} |", name);
      rule += is_text(value) ? " --- |" : " ---: |";
    }
    out += names + "\n" + rule + "\n";
    for (std::size_t r = first; r < last; ++r) {
      out += "|";
      for (const auto& [name, value] : rows[r].fields()) out += fmt::format(" {} |", text_of(value));
      out += '\n';
    }
  });
  return out;
}

}  // namespace pingvox::bench
