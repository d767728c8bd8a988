#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "io/bags/ros_message.hpp"
#include "io/bytes/json_events.hpp"

// Messages in JSON: their fields have the names of the message, so their layout is that of the first one.
namespace pingvox {
namespace {

using JsonKind = JsonEvent::Kind;

/// A number of a message, at the precision of either type.
struct JsonNumber {
  double number = std::numeric_limits<double>::quiet_NaN();
  float single = std::numeric_limits<float>::quiet_NaN();
};

template <class T>
T number_of_json(std::string_view text) {
  T number = std::numeric_limits<T>::quiet_NaN();
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc::result_out_of_range) return number;
  // Beyond the largest, or nearer to 0 than the smallest.
  const std::size_t exponent = std::min(text.find_first_of("eE"), text.size());
  const bool is_small = text.substr(exponent).find('-') != std::string_view::npos || text.find("0.") <= 1;
  const T size = is_small ? T{0} : std::numeric_limits<T>::infinity();
  return text.starts_with('-') ? -size : size;
}

/// A whole number as samples are, which both types hold; nullopt: it is another one.
std::optional<unsigned> small_number(std::string_view text) {
  constexpr std::size_t kMaxDigits = 7;
  if (text.size() > kMaxDigits) return std::nullopt;
  unsigned number = 0;
  for (const char c : text) {
    if (c < '0' || c > '9') return std::nullopt;
    number = 10 * number + static_cast<unsigned>(c - '0');
  }
  return number;
}

JsonNumber number_of(const JsonEvent& event) {
  if (event.kind == JsonKind::kTrue) return {1.0, 1.0F};
  if (event.kind == JsonKind::kFalse) return {0.0, 0.0F};
  if (event.kind != JsonKind::kNumber) return {};
  if (const auto number = small_number(event.text)) {
    return {static_cast<double>(*number), static_cast<float>(*number)};
  }
  return {number_of_json<double>(event.text), number_of_json<float>(event.text)};
}

}  // namespace

/// Walks through the fields of messages.
class JsonFields {
 public:
  /// Where a value of a message is.
  struct Place {
    std::string_view path;        ///< as in "header.stamp.sec"
    std::size_t arrays = 0;       ///< that it is in, itself not counted
    std::size_t element = 0;      ///< of the outermost of them
    bool is_array_value = false;  ///< it is in an array of such values
  };

  /// Calls `take(place, event)` for each number, truth, null, text and empty array. false: the text is no object.
  template <class Take>
  static bool walk(std::string_view message, Take take) {
    JsonEvents events(message);
    std::string path;
    std::vector<Level> levels;
    while (const auto event = events.next()) {
      if (levels.empty() && event->kind != JsonKind::kObject) return false;
      if (event->kind == JsonKind::kEnd) {
        const Level ended = levels.back();
        levels.pop_back();
        if (ended.is_array && ended.values == 0) {
          take(Place{path, arrays_of(levels), element_of(levels), true}, JsonEvent{JsonKind::kArray, {}, {}});
        }
        path.resize(ended.path_before);
        continue;
      }
      const std::size_t before = path.size();
      const bool is_in_array = !levels.empty() && levels.back().is_array;
      if (is_in_array) {
        ++levels.back().values;
      } else if (!levels.empty()) {
        if (!path.empty()) path.push_back('.');
        path += event->key;
      }
      if (event->kind == JsonKind::kObject || event->kind == JsonKind::kArray) {
        levels.push_back({event->kind == JsonKind::kArray, before, 0});
        continue;
      }
      const std::size_t outside = arrays_of(levels) - (is_in_array ? 1 : 0);
      take(Place{path, outside, element_of(levels), is_in_array}, *event);
      path.resize(before);
    }
    return events.is_whole();
  }

  static std::optional<RosLayout> layout_of(std::string_view message) {
    constexpr std::size_t kMaxFields = 4096, kMaxText = std::size_t{1} << 18;
    RosLayout layout;
    layout.encoding_ = RosEncoding::kJson;
    std::size_t text = 0;
    const bool is_whole = walk(message, [&](const Place& place, const JsonEvent& event) {
      if (layout.fields_.size() == kMaxFields || text > kMaxText) return;
      const auto [field, is_new] = layout.json_fields_.try_emplace(std::string(place.path), layout.fields_.size());
      if (!is_new) return;
      text += place.path.size();
      std::string type = event.kind == JsonKind::kText                                     ? "string"
                         : event.kind == JsonKind::kTrue || event.kind == JsonKind::kFalse ? "bool"
                                                                                           : "float64";
      for (std::size_t i = 0; i < place.arrays + (place.is_array_value ? 1 : 0); ++i) type += "[]";
      layout.fields_.push_back({std::string(place.path), std::move(type)});
    });
    if (!is_whole) return std::nullopt;
    return layout;
  }

  static bool read(const RosLayout& layout, std::string_view text, std::size_t element, RosMessage& message) {
    struct Value {
      std::size_t field;
      JsonNumber number;
    };
    std::vector<Value> numbers;
    std::vector<RosValues>& values = message.values_;
    std::vector<std::uint8_t>& decoded = message.decoded_;
    decoded.clear();
    auto found = layout.json_fields_.end();
    const bool is_whole = walk(text, [&](const Place& place, const JsonEvent& event) {
      // Most values are samples in one array.
      const bool is_again = found != layout.json_fields_.end() && found->first == place.path;
      if (!is_again) found = layout.json_fields_.find(place.path);
      const bool is_other = place.arrays > 0 && element > 0 && place.element != element;
      if (found == layout.json_fields_.end() || is_other || event.kind == JsonKind::kArray) return;
      const std::size_t field = found->second;
      const bool is_text = layout.fields_[field].is_text();
      if (is_text != (event.kind == JsonKind::kText)) return;
      if (!is_text) {
        numbers.push_back({field, number_of(event)});
        ++values[field].count;
      } else if (values[field].type != RosNumber::kText) {
        const std::string plain = unescaped(event.text);
        values[field] = {RosNumber::kText, decoded.size(), plain.size(), 1};
        decoded.insert(decoded.end(), plain.begin(), plain.end());
      }
    });
    if (!is_whole) return false;
    // Samples are whole numbers of a byte, and taken as such.
    std::vector<bool> are_bytes(values.size(), true);
    for (const Value& value : numbers) {
      const double number = value.number.number;
      constexpr double kMaxByte = 255.0;
      if (!(number >= 0.0 && number <= kMaxByte && number == std::floor(number))) are_bytes[value.field] = false;
    }
    for (std::size_t field = 0; field < values.size(); ++field) {
      RosValues& at = values[field];
      if (at.type == RosNumber::kText || at.count == 0) continue;
      const bool is_array = layout.fields_[field].is_array();
      at.type = is_array && are_bytes[field] ? RosNumber::kU8 : RosNumber::kF64;
      at.stride = at.type == RosNumber::kU8 ? 1 : is_array ? sizeof(double) : RosMessage::kJsonNumber;
      at.first = decoded.size();
      decoded.resize(decoded.size() + at.count * at.stride);
    }
    std::vector<std::size_t> filled(values.size(), 0);
    for (const auto& [field, number] : numbers) {
      const RosValues& at = values[field];
      std::uint8_t* const to = decoded.data() + at.first + filled[field]++ * at.stride;
      if (at.type == RosNumber::kU8) {
        *to = static_cast<std::uint8_t>(number.number);
        continue;
      }
      std::memcpy(to, &number.number, sizeof(double));
      if (at.stride == RosMessage::kJsonNumber) std::memcpy(to + sizeof(double), &number.single, sizeof(float));
    }
    message.order_ = std::endian::native;
    message.bytes_ = decoded;
    return true;
  }

 private:
  /// An object or array that is open.
  struct Level {
    bool is_array = false;
    std::size_t path_before = 0;  ///< length of the path without its key
    std::size_t values = 0;       ///< of an array, so far
  };

  static std::size_t arrays_of(const std::vector<Level>& levels) {
    return static_cast<std::size_t>(std::ranges::count(levels, true, &Level::is_array));
  }
  static std::size_t element_of(const std::vector<Level>& levels) {
    const auto outermost = std::ranges::find(levels, true, &Level::is_array);
    return outermost == levels.end() || outermost->values == 0 ? 0 : outermost->values - 1;
  }
};

std::optional<RosLayout> RosLayout::of_json(std::string_view message) {
  return JsonFields::layout_of(message);
}

bool RosMessage::read_json(const RosLayout& layout, std::string_view message, std::size_t element) {
  return JsonFields::read(layout, message, element, *this);
}

}  // namespace pingvox
