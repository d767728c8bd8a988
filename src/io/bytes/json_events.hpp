#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace pingvox {

/// A part of a JSON text.
struct JsonEvent {
  enum class Kind : std::uint8_t { kObject, kArray, kEnd, kNumber, kText, kTrue, kFalse, kNull };
  Kind kind = Kind::kNull;  ///< kObject and kArray begin one, kEnd ends it
  std::string_view key;     ///< of a member of an object, escapes unchanged
  std::string_view text;    ///< of a number, and of a text without its quotation marks, escapes unchanged
};

/// Reads JSON (RFC 8259) from front to back, without making a tree of it. Of JSON5 it takes what the recorder of BlueOS
/// writes: NaN and Infinity as numbers.
class JsonEvents {
 public:
  /// The text must outlive the events.
  explicit JsonEvents(std::string_view text) : rest_(text) {}

  /// nullopt: the end, or the text is no JSON.
  std::optional<JsonEvent> next();
  /// Whether a whole value was read, and nothing is behind it.
  bool is_whole() const { return at_end_; }
  /// How many objects and arrays are open. After one began, it is counted.
  std::size_t depth() const { return open_.size(); }
  /// Passes over the rest of the innermost object or array. false: the text is no JSON.
  bool skip();

 private:
  void skip_blanks();
  bool eat(char c);
  std::optional<std::string_view> string();
  std::optional<JsonEvent> part();
  std::optional<JsonEvent> value(std::string_view key);
  std::optional<JsonEvent> word(std::string_view key);

  std::string_view rest_;
  std::string open_;  ///< the brackets that end what is open
  bool needs_comma_ = false;
  bool at_end_ = false;
};

/// A text with its escapes replaced. Halves of surrogate pairs become U+FFFD.
std::string unescaped(std::string_view text);

}  // namespace pingvox
