#include "io/nav/nav_fields.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "io/bytes/text.hpp"
#include "pingvox/geometry/pose.hpp"

namespace pingvox {
namespace {

using Frame = NavFields::Frame;

/// Least and greatest number of fields of a quantity.
std::pair<std::size_t, std::size_t> fields_of(NavQuantity quantity) {
  switch (quantity) {
    case NavQuantity::kVelocity:
    case NavQuantity::kPosition:
    case NavQuantity::kFix:
      return {2, 3};
    case NavQuantity::kAttitude:
      return {3, 4};
    default:
      const auto count = static_cast<std::size_t>(numbers_of(quantity));
      return {count, count};
  }
}

/// "sensors/msg/DVL" -> "sensors/DVL"
std::string without_folder(std::string_view type) {
  const std::size_t first = type.find('/'), last = type.rfind('/');
  if (first == last) return std::string(type);
  return fmt::format("{}{}", type.substr(0, first), type.substr(last));
}

Eigen::Vector3d in_our_frame(NavQuantity quantity, const Eigen::Vector3d& ned) {
  switch (quantity) {
    case NavQuantity::kVelocity:
    case NavQuantity::kTurnRate:
      return from_ned::body(ned);
    case NavQuantity::kAttitude:
      return from_ned::attitude(ned);
    case NavQuantity::kHeading:
      return {from_ned::yaw(ned.x()), 0.0, 0.0};
    case NavQuantity::kPosition:
      return from_ned::world(ned);
    default:
      return ned;
  }
}

bool holds(double a, std::string_view comparison, double b) {
  if (comparison == ">=") return a >= b;
  if (comparison == "<=") return a <= b;
  if (comparison == ">") return a > b;
  if (comparison == "<") return a < b;
  if (comparison == "==") return a == b;
  return a < b || a > b;  // !=, but nothing is known of NaN
}

/// What the names of fields say against their order; empty: nothing.
std::string fault_of_order(const NavFields& fields) {
  if (fields.quantity != NavQuantity::kAttitude) return {};
  const std::string &first = fields.values.front(), &last = fields.values.back();
  if (fields.values.size() == 4 && first.ends_with('w') && !last.ends_with('w')) {
    return fmt::format("the fields of a quaternion must be in the order x, y, z, w: '{}' is the first", first);
  }
  const auto names = [](const std::string& field, std::string_view angle) { return field.find(angle) != field.npos; };
  if (fields.values.size() == 3 && names(first, "yaw") && names(last, "roll")) {
    return fmt::format("the fields of an attitude must be in the order roll, pitch, yaw: '{}' is the first", first);
  }
  return {};
}

}  // namespace

bool has_frame(NavQuantity quantity) {
  switch (quantity) {
    case NavQuantity::kVelocity:
    case NavQuantity::kTurnRate:
    case NavQuantity::kAttitude:
    case NavQuantity::kHeading:
    case NavQuantity::kPosition:
      return true;
    default:
      return false;
  }
}

Result<void> NavFields::validate() const {
  const auto bad = [](const std::string& what) { return fail(Error::Code::kBadOption, what); };
  if (topic.empty() && type.empty()) return bad("neither a topic nor a type is named");
  const auto [least, most] = fields_of(quantity);
  if (values.size() < least || values.size() > most) {
    return bad(fmt::format("{} must be of {} fields, not of {}", name_of(quantity),
                           least == most ? fmt::format("{}", least) : fmt::format("{} or {}", least, most),
                           values.size()));
  }
  if (const std::string order = fault_of_order(*this); !order.empty()) return bad(order);
  const std::size_t numbers = std::min<std::size_t>(values.size(), 3);
  if (spread.size() > 1 && spread.size() != numbers) {
    return bad(fmt::format("deviations must be of 1 or {} fields, not of {}", numbers, spread.size()));
  }
  if (!spread.empty() && quantity == NavQuantity::kFix) return bad("deviations of a fix are not read");
  if (!(unit > 0.0) || !std::isfinite(unit)) return bad("the unit must be above 0");
  if (!(time_unit_s > 0.0) || !std::isfinite(time_unit_s)) return bad("the unit of the time must be above 0");
  return {};
}

std::optional<Eigen::Quaterniond> rotation_of_quaternion(const Eigen::Vector4d& xyzw) {
  const Eigen::Quaterniond q(xyzw);
  constexpr double kTolerance = 1e-2;
  if (!(std::fabs(q.norm() - 1.0) <= kTolerance)) return std::nullopt;
  return q.normalized();
}

std::optional<Eigen::Vector3d> rpy_of_quaternion(const Eigen::Vector4d& xyzw) {
  const auto rotation = rotation_of_quaternion(xyzw);
  return rotation ? std::optional(rpy_of(rotation->toRotationMatrix())) : std::nullopt;
}

bool is_of(const NavFields& fields, std::string_view topic, std::string_view type) {
  return (fields.topic.empty() || fields.topic == topic) &&
         (fields.type.empty() || without_folder(fields.type) == without_folder(type));
}

/// Finds fields by their paths.
class NavReader::Finder {
 public:
  Finder(const NavFields& wanted, const RosLayout& layout) : wanted_(wanted), layout_(layout) {}

  /// @param key  what the field is, for messages
  Result<Number> number(std::string_view key, std::string_view text) const {
    Number number;
    std::string_view path = trim(text);
    if (path.starts_with('-')) {
      number.sign = -1.0;
      path = trim(path.substr(1));
    }
    std::optional<std::size_t> i;
    if (const std::size_t bracket = path.find('['); bracket != std::string_view::npos && path.ends_with(']')) {
      const std::optional<std::uint64_t> index = count_in(path.substr(bracket + 1, path.size() - bracket - 2));
      if (!index) return bad(key, fmt::format("'{}' must be as in x[0]", path));
      i = index;
      path = path.substr(0, bracket);
    }
    const std::optional<std::size_t> field = layout_.field(path);
    if (!field) return bad(key, fmt::format("there is no field '{}', but {}", path, fields_text(layout_)));
    const RosField& found = layout_.fields()[*field];
    if (found.is_text()) return bad(key, fmt::format("'{}' is text: numbers are {}", path, fields_text(layout_)));
    if (i && !found.is_array()) return bad(key, fmt::format("'{}' is one {}, not an array", path, found.type));
    if (!i && found.is_array())
      return bad(key, fmt::format("'{}' is {}: say which, as in {}[0]", path, found.type, path));
    if (i && found.size && *i >= *found.size)
      return bad(key, fmt::format("'{}' is {}: {} is too much", path, found.type, *i));
    number.field = *field;
    number.i = i.value_or(0);
    return number;
  }

  Result<std::vector<Number>> numbers(std::string_view key, std::span<const std::string> paths) const {
    std::vector<Number> found;
    for (const std::string& path : paths) {
      const Result<Number> one = number(key, path);
      if (!one) return tl::unexpected(one.error());
      found.push_back(*one);
    }
    return found;
  }

  /// "PATH", or "PATH >= 1"
  Result<Condition> condition(std::string_view key, std::string_view text) const {
    static constexpr std::array<std::string_view, 6> kComparisons = {">=", "<=", "==", "!=", ">", "<"};
    Condition condition{{}, "!=", 0.0};
    const std::size_t at = std::min(text.find_first_of("<>=!"), text.size());
    if (at < text.size()) {
      const auto* const is = std::ranges::find_if(
          kComparisons, [&](std::string_view comparison) { return text.substr(at).starts_with(comparison); });
      const std::optional<double> with =
          is == kComparisons.end() ? std::nullopt : number_in(trim(text.substr(at + is->size())));
      if (!with) return bad(key, fmt::format("'{}' must be a field, or as in 'status >= 1'", text));
      condition.comparison = *is;
      condition.with = *with;
    }
    return number(key, text.substr(0, at)).map([&](const Number& found) {
      condition.number = found;
      return condition;
    });
  }

  /// Of a time its seconds and nanoseconds.
  Result<std::vector<Number>> time(std::string_view key, const std::string& path) const {
    for (const char* const nanoseconds : {".nanosec", ".nsec"}) {
      const std::string parts[] = {path + ".sec", path + nanoseconds};
      if (layout_.field(parts[0]) && layout_.field(parts[1])) return numbers(key, parts);
    }
    return numbers(key, {&path, 1});
  }

 private:
  tl::unexpected<Error> bad(std::string_view key, std::string_view what) const {
    const std::string where = wanted_.stated_in.empty() ? "" : wanted_.stated_in + ": ";
    return fail(Error::Code::kBadOption, fmt::format("{}{}: {}", where, key, what));
  }

  const NavFields& wanted_;
  const RosLayout& layout_;
};

Result<NavReader> NavReader::make(const NavFields& fields, const RosLayout& layout) {
  const Finder find(fields, layout);
  NavReader reader;
  reader.quantity_ = fields.quantity;
  reader.frame_ = fields.frame;
  reader.spread_is_ = fields.spread_is;
  reader.unit_ = fields.unit;
  reader.time_unit_s_ = fields.time_unit_s;
  reader.is_received_ = fields.time == NavFields::kReceived;
  auto values = find.numbers("fields", fields.values);
  if (!values) return tl::unexpected(values.error());
  reader.values_ = *std::move(values);
  auto spread = find.numbers(fields.spread_is == NavFields::Spread::kVariance ? "variance" : "sd", fields.spread);
  if (!spread) return tl::unexpected(spread.error());
  reader.spread_ = *std::move(spread);
  if (!fields.valid.empty()) {
    const Result<Condition> valid = find.condition("valid", fields.valid);
    if (!valid) return tl::unexpected(valid.error());
    reader.valid_ = *valid;
  }
  if (!fields.time.empty() && !reader.is_received_) {
    auto time = find.time("time", fields.time);
    if (!time) return tl::unexpected(time.error());
    reader.time_ = *std::move(time);
  }
  return reader;
}

Eigen::Vector3d NavReader::value_in(const RosMessage& message) const {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  if (quantity_ == NavQuantity::kAttitude && values_.size() == 4) {
    Eigen::Vector4d xyzw;
    for (Eigen::Index i = 0; i < 4; ++i) xyzw[i] = values_[static_cast<std::size_t>(i)].in(message);
    value = rpy_of_quaternion(xyzw).value_or(Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
  } else {
    for (std::size_t i = 0; i < values_.size(); ++i) {
      // The third number of a fix is its altitude.
      const double unit = quantity_ == NavQuantity::kFix && i == 2 ? 1.0 : unit_;
      value[static_cast<Eigen::Index>(i)] = unit * values_[i].in(message);
    }
  }
  return frame_ == Frame::kNed ? in_our_frame(quantity_, value) : value;
}

Eigen::Vector3d NavReader::deviation_in(const RosMessage& message) const {
  Eigen::Vector3d deviation = NavSample{}.deviation;
  if (spread_.empty()) return deviation;
  const std::size_t numbers = std::min<std::size_t>(values_.size(), 3);
  for (std::size_t i = 0; i < numbers; ++i) {
    const double number = spread_[spread_.size() == 1 ? 0 : i].in(message);
    if (!(number > 0.0)) continue;  // drivers that do not know send 0 or -1
    const bool is_variance = spread_is_ == NavFields::Spread::kVariance;
    deviation[static_cast<Eigen::Index>(i)] = (is_variance ? std::sqrt(number) : number) * unit_;
  }
  // North and east become east and north.
  if (frame_ == Frame::kNed && quantity_ == NavQuantity::kPosition) std::swap(deviation.x(), deviation.y());
  return deviation;
}

bool NavReader::is_valid(const RosMessage& message) const {
  return !valid_ || holds(valid_->number.in(message), valid_->comparison, valid_->with);
}

void NavReader::add(const RosMessage& message, const KnownTopic& topic, double recorded_s, const std::string& source,
                    NavSources& sources, const NavOrigin& origin) const {
  NavSample sample;
  if (time_.size() == 2) {
    sample.time_s = time_[0].in(message) + time_[1].in(message) * 1e-9;
  } else if (time_.size() == 1) {
    sample.time_s = time_[0].in(message)*time_unit_s_;
  } else {
    sample.time_s = is_received_ ? recorded_s : topic.time_of(message, recorded_s);
  }
  sample.value = value_in(message);
  sample.deviation = deviation_in(message);
  sample.valid = is_valid(message);
  sources.add(source, quantity_, sample, frame_ == Frame::kByName ? origin : NavOrigin{NavSubject::kChosen, {}, {}});
}

}  // namespace pingvox
