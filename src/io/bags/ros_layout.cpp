#include "io/bags/ros_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <system_error>
#include <utility>

#include "io/bags/ros_common_types.hpp"
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

/// Lines may end with CR LF.
constexpr std::string_view kBlanks = " \t\r";

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

}  // namespace pingvox
