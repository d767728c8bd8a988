#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace pingvox {

/// Bytes as characters, without a copy.
std::string_view text_of(std::span<const std::uint8_t> bytes);

/// The lines of a text, one after the other, without their LF or CR LF. A UTF-8 mark at the start is left out, and the
/// last line needs no end.
class Lines {
 public:
  explicit Lines(std::string_view text);

  /// nullopt: there are no more.
  std::optional<std::string_view> next();
  /// The next one that is neither blank nor a comment (after blanks, `#`).
  std::optional<std::string_view> next_with_content();
  /// The number, from 1, of the line that next() gave last.
  std::size_t number() const { return number_; }
  /// Whether that line has its end (a CR counts); the last one of a text may not.
  bool has_end() const { return has_end_; }
  /// Characters behind that line.
  std::size_t left() const { return rest_.size(); }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
  bool has_end_ = false;
};

/// Without blanks and tabs at both ends.
std::string_view trimmed(std::string_view text);

/// Cuts the next field off the front of `rest`, up to the separator or the end, and trims it. nullopt: `rest` is used
/// up (its data() is null then), which an empty last field is not.
std::optional<std::string_view> cut_field(std::string_view& rest, char separator);

/// Cuts the next word off the front of `rest`: what stands between blanks, tabs and commas. nullopt: none is left.
std::optional<std::string_view> cut_word(std::string_view& rest);

/// The beginning of something from a file, for a message: nothing in it breaks the line or speaks to the terminal.
std::string printable(std::string_view text);

/// All of `text` as a finite decimal number, rounded once to the type, in any locale. nullopt: it is none.
std::optional<double> number_in(std::string_view text);
std::optional<float> float_in(std::string_view text);
/// All of `text` as a whole number without a sign. nullopt: it is none.
std::optional<std::uint64_t> count_in(std::string_view text);

}  // namespace pingvox
