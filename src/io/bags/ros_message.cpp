#include "io/bags/ros_message.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "io/bags/ros_common_types.hpp"
#include "io/bytes/byte_reader.hpp"
#include "io/bytes/text.hpp"

namespace pingvox {
namespace {

constexpr std::array<std::pair<std::string_view, RosNumber>, 15> kNumbers = {{{"bool", RosNumber::kU8},
                                                                              {"int8", RosNumber::kI8},
                                                                              {"uint8", RosNumber::kU8},
                                                                              {"byte", RosNumber::kU8},
                                                                              {"char", RosNumber::kU8},
                                                                              {"int16", RosNumber::kI16},
                                                                              {"uint16", RosNumber::kU16},
                                                                              {"int32", RosNumber::kI32},
                                                                              {"uint32", RosNumber::kU32},
                                                                              {"int64", RosNumber::kI64},
                                                                              {"uint64", RosNumber::kU64},
                                                                              {"float32", RosNumber::kF32},
                                                                              {"float64", RosNumber::kF64},
                                                                              {"double", RosNumber::kF64},
                                                                              {"string", RosNumber::kText}}};

std::size_t size_of(RosNumber type) {
  switch (type) {
    case RosNumber::kI8:
    case RosNumber::kU8:
    case RosNumber::kText:
      return 1;
    case RosNumber::kI16:
    case RosNumber::kU16:
      return 2;
    case RosNumber::kI32:
    case RosNumber::kU32:
    case RosNumber::kF32:
      return 4;
    default:
      return 8;
  }
}

/// Lines may end with CR LF.
constexpr std::string_view kBlanks = " \t\r";

std::size_t align(std::size_t offset, std::size_t alignment) {
  return (offset + alignment - 1) / alignment * alignment;
}

/// Cuts the first line off.
std::string_view cut_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return line;
}

/// Package and name of a type: "sensor_msgs" and "Imu", also of "sensor_msgs/msg/Imu".
std::pair<std::string_view, std::string_view> package_and_name(std::string_view type) {
  const std::size_t first = type.find('/'), last = type.rfind('/');
  if (first == std::string_view::npos) return {{}, type};
  return {type.substr(0, first), type.substr(last + 1)};
}

/// The text of one type.
struct Section {
  std::string_view package, name, text;
};

/// Splits a definition: the message's own text, then that of each message in it behind "MSG: package/Name".
void add_sections(std::string_view type, std::string_view definition, std::vector<Section>& sections) {
  const auto start = [&](std::string_view name, std::string_view rest) {
    const auto [package, last] = package_and_name(name);
    sections.push_back({package, last, rest.substr(0, 0)});
  };
  if (!type.empty()) start(type, definition);
  while (!definition.empty()) {
    const std::string_view line = trim(cut_line(definition), kBlanks);
    if (line.empty() || line.starts_with("===")) continue;
    if (line.starts_with("MSG:")) {
      start(trim(line.substr(4), kBlanks), definition);
    } else if (!sections.empty()) {
      Section& last = sections.back();
      const char* begin = last.text.empty() ? line.data() : last.text.data();
      last.text = {begin, static_cast<std::size_t>(line.data() + line.size() - begin)};
    }
  }
}

/// One line of a definition.
struct FieldLine {
  std::string_view type, name;
  bool is_array = false;
  std::optional<std::size_t> size;  ///< of a fixed array
};

/// nullopt: an empty line, a comment or a constant.
std::optional<FieldLine> field_in(std::string_view line) {
  line = trim(line.substr(0, line.find('#')), kBlanks);
  const std::size_t end = line.find_first_of(" \t");
  if (end == std::string_view::npos) return std::nullopt;
  FieldLine field;
  field.type = line.substr(0, end);
  const std::string_view rest = trim(line.substr(end), kBlanks);
  const std::size_t name_end = rest.find_first_of(" \t=");
  field.name = rest.substr(0, name_end);
  if (name_end != std::string_view::npos && trim(rest.substr(name_end), kBlanks).starts_with('=')) return std::nullopt;
  if (const std::size_t bracket = field.type.find('['); bracket != std::string_view::npos) {
    const std::string_view size = field.type.substr(bracket + 1);
    field.is_array = true;
    std::size_t number = 0;
    if (std::from_chars(size.data(), size.data() + size.size(), number).ec == std::errc{}) field.size = number;
    field.type = field.type.substr(0, bracket);
  }
  field.type = field.type.substr(0, field.type.find('<'));  // a bound, as in string<=10
  return field;
}

}  // namespace

/// Builds a layout from the text of a definition.
class LayoutMaker {
 public:
  LayoutMaker(std::string_view type, std::string_view definition, RosEncoding encoding) {
    layout_.encoding_ = encoding;
    if (!trim(definition, kBlanks).empty()) add_sections(type, definition, sections_);
    if (encoding == RosEncoding::kCdr) add_sections({}, kCommonRosTypes, sections_);
  }

  std::optional<RosLayout> make(std::string_view type) {
    const auto [package, name] = package_and_name(type);
    const Section* section = find(package, name, {});
    if (section == nullptr || !add_record(*section, {}, 0)) return std::nullopt;
    return std::move(layout_);
  }

 private:
  using Array = RosLayout::Array;

  /// Where a record is: what stands before the paths and behind the types of its fields.
  struct Outer {
    std::string prefix, arrays;
  };

  const Section* find(std::string_view package, std::string_view name, std::string_view inside) const {
    const auto in_package = [&](std::string_view wanted) {
      const auto found = std::ranges::find_if(
          sections_, [&](const Section& section) { return section.package == wanted && section.name == name; });
      return found == sections_.end() ? nullptr : &*found;
    };
    if (!package.empty()) return in_package(package);
    if (const Section* section = in_package(inside)) return section;
    return name == "Header" ? in_package("std_msgs") : nullptr;
  }

  /// @return its number; nullopt as make()
  std::optional<std::size_t> add_record(const Section& section, const Outer& outer, int depth) {
    constexpr int kMaxDepth = 16;
    if (depth > kMaxDepth) return std::nullopt;
    RosLayout::Record record;
    std::string_view text = section.text;
    while (!text.empty()) {
      const std::optional<FieldLine> line = field_in(cut_line(text));
      if (!line) continue;
      const std::optional<RosLayout::Member> member = member_of(*line, section.package, outer, depth);
      if (!member) return std::nullopt;
      record.members.push_back(*member);
    }
    set_places(record);
    layout_.records_.push_back(std::move(record));
    return layout_.records_.size() - 1;
  }

  std::optional<RosLayout::Member> member_of(const FieldLine& line, std::string_view package, const Outer& outer,
                                             int depth) {
    // Messages in messages multiply both.
    constexpr std::size_t kMaxMembers = 4096, kMaxText = std::size_t{1} << 18;
    text_ += outer.prefix.size() + line.name.size() + line.type.size() + outer.arrays.size();
    if (++members_ > kMaxMembers || text_ > kMaxText) return std::nullopt;
    RosLayout::Member member;
    if (line.is_array) member.array = line.size ? Array::kFixed : Array::kVariable;
    member.size = line.size.value_or(1);
    const std::string path = outer.prefix + std::string(line.name);
    std::string arrays = outer.arrays;
    if (line.is_array) arrays += line.size ? fmt::format("[{}]", *line.size) : "[]";
    const auto number = std::ranges::find(kNumbers, line.type, [](const auto& known) { return known.first; });
    if (number != kNumbers.end()) {
      member.type = number->second;
      member.field = layout_.fields_.size();
      layout_.fields_.push_back(
          {path, std::string(line.type) + arrays, outer.arrays.empty() ? line.size : std::nullopt});
      return member;
    }
    if (layout_.encoding_ == RosEncoding::kRos1 && (line.type == "time" || line.type == "duration")) {
      const bool is_time = line.type == "time";
      member.record = add_record({"", line.type, is_time ? "uint32 sec\nuint32 nanosec" : "int32 sec\nint32 nanosec"},
                                 {path + ".", arrays}, depth + 1);
      return member;
    }
    const auto [named, name] = package_and_name(line.type);
    const Section* section = find(named, name, package);
    if (section == nullptr) return std::nullopt;
    member.record = add_record(*section, {path + ".", arrays}, depth + 1);
    if (!member.record) return std::nullopt;
    return member;
  }

  std::size_t alignment_of(RosNumber type) const { return layout_.encoding_ == RosEncoding::kRos1 ? 1 : size_of(type); }

  /// Finds whether a record has a fixed size, and where its numbers are. With what is aligned most at its beginning, it
  /// has the same gaps wherever it is.
  void set_places(RosLayout::Record& record) const {
    if (record.members.empty()) {
      record.is_fixed = record.is_fixed_if_aligned = true;
      record.size = layout_.encoding_ == RosEncoding::kCdr ? 1 : 0;  // CDR has no empty records
      return;
    }
    std::optional<std::size_t> first_alignment;
    for (const RosLayout::Member& member : record.members) {
      if (member.array == Array::kVariable || (!member.record && member.type == RosNumber::kText)) return;
      const std::size_t before = record.alignment;
      if (member.record) {
        const RosLayout::Record& inner = layout_.records_[*member.record];
        if (!inner.is_fixed || member.array != Array::kNone) return;
        record.alignment = std::max(before, inner.alignment);
        first_alignment = first_alignment.value_or(inner.alignment);
        record.size = align(record.size, inner.alignment);
        for (RosLayout::Place place : inner.places) {
          place.offset += record.size;
          record.places.push_back(place);
        }
        record.size += inner.size;
      } else {
        const std::size_t alignment = alignment_of(member.type), size = size_of(member.type);
        if (member.size == 0 || member.size > kMaxFixed / size) return;
        record.alignment = std::max(before, alignment);
        first_alignment = first_alignment.value_or(alignment);
        record.size = align(record.size, alignment);
        record.places.push_back({member.field, record.size, member.size, member.type});
        record.size += member.size * size;
      }
      if (record.size > kMaxFixed) return;
    }
    record.is_fixed = first_alignment == record.alignment;
    record.is_fixed_if_aligned = record.is_fixed || record.size % record.alignment == 0;
  }

  static constexpr std::size_t kMaxFixed = std::size_t{1} << 30;

  RosLayout layout_;
  std::vector<Section> sections_;
  std::size_t members_ = 0, text_ = 0;
};

std::optional<RosLayout> RosLayout::make(std::string_view type, std::string_view definition, RosEncoding encoding) {
  return LayoutMaker(type, definition, encoding).make(type);
}

std::shared_ptr<const RosLayout> shared_layout(std::string_view type, std::string_view definition,
                                               RosEncoding encoding) {
  std::optional<RosLayout> layout = RosLayout::make(type, definition, encoding);
  return layout ? std::make_shared<const RosLayout>(*std::move(layout)) : nullptr;
}

std::optional<std::size_t> RosLayout::field(std::string_view path) const {
  const auto found = std::ranges::find(fields_, path, &RosField::path);
  if (found == fields_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - fields_.begin());
}

std::string fields_text(const RosLayout& layout) {
  std::string text;
  for (const RosField& field : layout.fields()) {
    if (field.is_text() || field.path.starts_with("header.")) continue;
    if (!text.empty()) text += ", ";
    text += field.path + " " + field.type;
  }
  return text;
}

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
