#include "io/bags/ros_message.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

#include "io/bytes/byte_reader.hpp"
#include "io/bytes/text.hpp"

namespace pingvox {

/// Walks through the bytes of a message.
class RosMessage::Walk {
 public:
  Walk(const RosLayout& layout, RosMessage& message, std::size_t element)
      : layout_(layout), message_(message), element_(element) {}

  bool finish() {
    if (!read(layout_.records_.back(), true)) return false;
    const std::size_t left = message_.bytes_.size() - at_;
    return layout_.encoding() == RosEncoding::kRos1 ? left == 0 : left < 8;  // CDR may be padded at its end
  }

 private:
  using Array = RosLayout::Array;

  std::size_t left() const { return message_.bytes_.size() - at_; }

  bool align_to(std::size_t alignment) {
    if (layout_.encoding() == RosEncoding::kRos1) return true;
    const std::size_t to = align(at_, alignment);
    if (to > message_.bytes_.size()) return false;
    at_ = to;
    return true;
  }

  std::optional<std::size_t> read_count() {
    if (!align_to(4) || left() < 4) return std::nullopt;
    const auto count = value_from<std::uint32_t>(message_.bytes_.subspan(at_, 4), message_.order_);
    at_ += 4;
    return count;
  }

  bool read(const RosLayout::Record& record, bool has_values) {
    if (is_fixed_here(record)) return read_fixed(record, 1, has_values);
    for (const RosLayout::Member& member : record.members) {
      std::size_t count = member.size;
      if (member.array == Array::kVariable) {
        const std::optional<std::size_t> found = read_count();
        if (!found) return false;
        count = *found;
      }
      if (!read_member(member, count, has_values)) return false;
    }
    return true;
  }

  bool is_fixed_here(const RosLayout::Record& record) const {
    return record.is_fixed || (record.is_fixed_if_aligned && align(at_, record.alignment) == at_);
  }

  bool read_member(const RosLayout::Member& member, std::size_t count, bool has_values) {
    if (count == 0) return true;
    if (!member.record) return read_numbers(member, count, has_values);
    const RosLayout::Record& record = layout_.records_[*member.record];
    if (is_fixed_here(record)) return read_fixed(record, count, has_values);
    const std::size_t with_values = member.array == Array::kNone ? 0 : element_;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t before = at_;
      if (!read(record, has_values && i == with_values)) return false;
      if (at_ == before) return true;  // so are all others
    }
    return true;
  }

  bool read_numbers(const RosLayout::Member& member, std::size_t count, bool has_values) {
    if (member.type == RosNumber::kText) {
      for (std::size_t i = 0; i < count; ++i) {
        const std::optional<std::size_t> length = read_count();
        if (!length || *length > left()) return false;
        // The text of CDR has a zero at its end.
        const std::size_t zero = layout_.encoding() == RosEncoding::kCdr && *length > 0 ? 1 : 0;
        if (has_values && i == 0) message_.values_[member.field] = {RosNumber::kText, at_, *length - zero, 1};
        at_ += *length;
      }
      return true;
    }
    const std::size_t size = size_of(member.type);
    if (!align_to(size) || count > left() / size) return false;
    if (has_values) message_.values_[member.field] = {member.type, at_, count, size};
    at_ += count * size;
    return true;
  }

  bool read_fixed(const RosLayout::Record& record, std::size_t count, bool has_values) {
    if (record.size == 0) return true;
    const std::size_t stride = align(record.size, record.alignment);
    if (!align_to(record.alignment) || left() < record.size || count - 1 > (left() - record.size) / stride) {
      return false;
    }
    if (has_values) {
      for (const RosLayout::Place& place : record.places) {
        const bool is_array = place.count > 1;
        message_.values_[place.field] = {place.type, at_ + place.offset, is_array ? place.count : count,
                                         is_array ? size_of(place.type) : stride};
      }
    }
    at_ += (count - 1) * stride + record.size;
    return true;
  }

  const RosLayout& layout_;
  RosMessage& message_;
  std::size_t element_, at_ = 0;
};

bool RosMessage::read(const RosLayout& layout, std::span<const std::uint8_t> bytes, std::size_t element) {
  values_.assign(layout.fields().size(), RosValues{});
  order_ = std::endian::little;
  if (layout.encoding() == RosEncoding::kJson) return read_json(layout, text_of(bytes), element);
  if (layout.encoding() == RosEncoding::kCdr) {
    // Plain CDR; others have tags or other rules of alignment.
    constexpr std::size_t kEncapsulation = 4;
    if (bytes.size() < kEncapsulation || bytes[0] != 0 || bytes[1] > 1) return false;
    order_ = bytes[1] == 1 ? std::endian::little : std::endian::big;
    bytes = bytes.subspan(kEncapsulation);
  }
  bytes_ = bytes;
  return Walk(layout, *this, element).finish();
}

namespace {

/// Calls `with` with a value of the type.
template <class With>
void with_type(RosNumber type, With with) {
  switch (type) {
    case RosNumber::kI8:
      return with(std::int8_t{});
    case RosNumber::kU8:
    case RosNumber::kText:
      return with(std::uint8_t{});
    case RosNumber::kI16:
      return with(std::int16_t{});
    case RosNumber::kU16:
      return with(std::uint16_t{});
    case RosNumber::kI32:
      return with(std::int32_t{});
    case RosNumber::kU32:
      return with(std::uint32_t{});
    case RosNumber::kI64:
      return with(std::int64_t{});
    case RosNumber::kU64:
      return with(std::uint64_t{});
    case RosNumber::kF32:
      return with(float{});
    case RosNumber::kF64:
      return with(double{});
  }
}

}  // namespace

double RosMessage::number(std::size_t field, std::size_t i) const {
  const RosValues& values = values_[field];
  double number = std::numeric_limits<double>::quiet_NaN();
  if (i >= values.count) return number;
  with_type(values.type, [&]<class T>(T) {
    number = static_cast<double>(value_from<T>(bytes_.subspan(values.first + i * values.stride, sizeof(T)), order_));
  });
  return number;
}

float RosMessage::single(std::size_t field) const {
  const RosValues& values = values_[field];
  const bool is_of_text = values.type == RosNumber::kF64 && values.stride == kJsonNumber && values.count == 1;
  if (!is_of_text) return static_cast<float>(number(field));
  return value_from<float>(bytes_.subspan(values.first + sizeof(double), sizeof(float)), order_);
}

std::string_view RosMessage::text(std::size_t field) const {
  const RosValues& values = values_[field];
  if (values.type != RosNumber::kText) return {};
  return {reinterpret_cast<const char*>(bytes_.data()) + values.first, values.count};
}

std::span<const std::uint8_t> RosMessage::byte_array(std::size_t field) const {
  const RosValues& values = values_[field];
  if (values.type != RosNumber::kU8 || values.stride != 1) return {};
  return bytes_.subspan(values.first, values.count);
}

std::vector<std::uint8_t> RosMessage::bytes(std::size_t field) const {
  const RosValues& values = values_[field];
  std::vector<std::uint8_t> bytes(values.count);
  with_type(values.type, [&]<class T>(T) {
    for (std::size_t i = 0; i < values.count; ++i) {
      const T value = value_from<T>(bytes_.subspan(values.first + i * values.stride, sizeof(T)), order_);
      if constexpr (std::is_same_v<T, std::uint8_t>) {
        bytes[i] = value;
      } else if constexpr (std::is_integral_v<T>) {
        const int within = std::cmp_less(value, 0) ? 0 : std::cmp_less(value, 255) ? static_cast<int>(value) : 255;
        bytes[i] = static_cast<std::uint8_t>(within);
      } else {
        bytes[i] = static_cast<std::uint8_t>(value >= T{0} ? std::round(std::min(value, T{255})) : T{0});
      }
    }
  });
  return bytes;
}

}  // namespace pingvox
