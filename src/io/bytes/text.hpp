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

/// The lines of a text, one after the other, without their LF or CR LF. Skips a UTF-8 byte order mark; the last line
/// needs no terminator.
class Lines {
 public:
  explicit Lines(std::string_view text);

  /// nullopt at the end.
  std::optional<std::string_view> next();
  /// The next line that is neither blank nor a comment (`#` after blanks).
  std::optional<std::string_view> next_with_content();
  /// Number of the last line, from 1.
  std::size_t number() const { return number_; }
  /// Whether the last line was terminated (a CR counts).
  bool has_end() const { return has_end_; }
  /// Characters after that line.
  std::size_t left() const { return rest_.size(); }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
  bool has_end_ = false;
};

/// Removes blanks and tabs, or other characters, at both ends.
std::string_view trim(std::string_view text, std::string_view blanks = " \t");

/// Cuts the next field off the front of `rest`, up to the separator or the end, and trims it. nullopt: no field is left
/// (rest.data() is null; an empty last field is one).
std::optional<std::string_view> cut_field(std::string_view& rest, char separator);

/// Cuts the next word, between blanks, tabs and commas, off the front of `rest`. nullopt: none is left.
std::optional<std::string_view> cut_word(std::string_view& rest);

/// Text from a file, for messages: anything but printable ASCII becomes ?.
std::string in_ascii(std::string_view text);
/// Its first characters.
std::string printable(std::string_view text);

/// Parses all of `text` as a finite decimal number, independent of the locale, rounded once. nullopt: invalid.
std::optional<double> number_in(std::string_view text);
std::optional<float> float_in(std::string_view text);
/// Parses all of `text` as an unsigned integer. nullopt: invalid.
std::optional<std::uint64_t> count_in(std::string_view text);
/// Parses two hexadecimal digits. nullopt: invalid.
std::optional<unsigned> hex_byte_in(std::string_view text);

}  // namespace pingvox
