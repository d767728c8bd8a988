#include "io/nav/dataflash.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <string>
#include <utility>

#include "io/bytes/byte_reader.hpp"
#include "io/bytes/text.hpp"
#include "io/internal/frame_finder.hpp"

namespace pingvox {
namespace {

constexpr std::uint8_t kMark1 = 0xa3, kMark2 = 0x95, kFormatType = 128;
constexpr std::size_t kHeader = 3, kFormatLength = 89;

/// Bytes of a field; 0: no such letter.
std::size_t bytes_of_letter(char letter) {
  switch (letter) {
    case 'b':
    case 'B':
    case 'M':
      return 1;
    case 'h':
    case 'H':
    case 'c':
    case 'C':
    case 'g':
      return 2;
    case 'i':
    case 'I':
    case 'e':
    case 'E':
    case 'L':
    case 'f':
    case 'n':
      return 4;
    case 'd':
    case 'q':
    case 'Q':
      return 8;
    case 'N':
      return 16;
    case 'a':
    case 'Z':
      return 64;
    default:
      return 0;
  }
}

/// The text of a field that is filled up with zeros.
std::string_view text_in(std::span<const std::uint8_t> bytes) {
  const std::string_view text = text_of(bytes);
  return text.substr(0, text.find('\0'));
}

/// The type that a record of type 128 defines. @param body  86 bytes
DataflashType type_in(std::span<const std::uint8_t> body) {
  DataflashType type;
  type.length = body[1];
  type.name = text_in(body.subspan(2, 4));
  std::string_view labels = text_in(body.subspan(22, 64));
  std::size_t offset = 0;
  for (const char letter : text_in(body.subspan(6, 16))) {
    const std::size_t bytes = bytes_of_letter(letter);
    type.fields.push_back({std::string(cut_field(labels, ',').value_or("")), letter, offset});
    offset += bytes;
    if (bytes == 0) offset = 256;
  }
  if (kHeader + offset != type.length) type.fields.clear();
  return type;
}

class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes), types_(256) {
    // Only this one is known beforehand; the definition of it in some logs is wrong.
    types_[kFormatType].name = "FMT";
    types_[kFormatType].length = kFormatLength;
  }

  std::size_t read(std::vector<DamageKind>& damage, const std::function<void(const DataflashRecord&)>& take) {
    std::size_t records = 0, at = 0;
    std::size_t stray_from = 0;  ///< the first of the bytes skipped just now
    bool is_stray = false, is_cut = false;
    while (at < bytes_.size()) {
      const std::size_t length = length_at(at);
      const bool is_known = length >= kHeader;
      const bool is_whole = is_known && length <= bytes_.size() - at;
      // Such bytes stand in texts and numbers too: behind a stray byte, the next record has to be one as well.
      if (!is_whole || (is_stray && !may_begin(at + length))) {
        if (!is_stray) {
          is_stray = true;
          stray_from = at;
          is_cut = (is_known && !is_whole) || bytes_.size() - at < kHeader;
        }
        ++at;
        continue;
      }
      if (is_stray) add_damage(damage, "bytes between records", stray_from);
      is_stray = false;
      const std::uint8_t number = bytes_[at + 2];
      const auto body = bytes_.subspan(at + kHeader, length - kHeader);
      if (number == kFormatType && body[0] != kFormatType) {
        types_[body[0]] = type_in(body);
        // A type without letters is right when its records are a header only (STRT of ArduCopter 3.1).
        const bool is_header_only = types_[body[0]].length == kHeader && text_in(body.subspan(6, 16)).empty();
        if (types_[body[0]].fields.empty() && !is_header_only) {
          add_damage(damage, "type whose fields do not fill its record", at);
        }
      }
      ++records;
      take({types_[number], number, body});
      at += length;
    }
    if (is_stray) add_damage(damage, is_cut ? "cut off at the end" : "bytes between records", stray_from);
    return records;
  }

 private:
  bool may_begin(std::size_t at) const {
    return at + 1 >= bytes_.size() || (bytes_[at] == kMark1 && bytes_[at + 1] == kMark2);
  }
  /// Of the record that begins here, or 0.
  std::size_t length_at(std::size_t at) const {
    if (bytes_.size() - at < kHeader || bytes_[at] != kMark1 || bytes_[at + 1] != kMark2) return 0;
    return types_[bytes_[at + 2]].length;
  }

  std::span<const std::uint8_t> bytes_;
  std::vector<DataflashType> types_;  ///< by their number; of length 0 when nothing defined them yet
};

}  // namespace

const DataflashType::Field* DataflashType::field(std::string_view label) const {
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.label == label; });
  return found != fields.end() ? &*found : nullptr;
}

std::optional<double> DataflashRecord::number_of(std::string_view label) const {
  const DataflashType::Field* const field = type.field(label);
  if (field == nullptr) return std::nullopt;
  const auto value = [&]<class T>(T /*kind*/) {
    return static_cast<double>(value_from<T>(body.subspan(field->offset, sizeof(T)), std::endian::little));
  };
  switch (field->letter) {
    case 'b':
      return value(std::int8_t{});
    case 'B':
    case 'M':
      return value(std::uint8_t{});
    case 'h':
      return value(std::int16_t{});
    case 'H':
      return value(std::uint16_t{});
    case 'i':
      return value(std::int32_t{});
    case 'I':
      return value(std::uint32_t{});
    case 'q':
      return value(std::int64_t{});
    case 'Q':
      return value(std::uint64_t{});
    case 'f':
      return value(float{});
    case 'd':
      return value(double{});
    case 'c':
      return value(std::int16_t{}) * 0.01;
    case 'C':
      return value(std::uint16_t{}) * 0.01;
    case 'e':
      return value(std::int32_t{}) * 0.01;
    case 'E':
      return value(std::uint32_t{}) * 0.01;
    case 'L':
      return value(std::int32_t{}) * 1e-7;
    default:
      return std::nullopt;
  }
}

std::size_t for_each_dataflash_record(std::span<const std::uint8_t> bytes, std::vector<DamageKind>& damage,
                                      const std::function<void(const DataflashRecord&)>& take) {
  return Reader(bytes).read(damage, take);
}

}  // namespace pingvox
