#include "io/bags/bag_scans.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <deque>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

#include "io/bags/sonar_messages.hpp"
#include "io/bags/stamped_queue.hpp"
#include "io/bytes/byte_reader.hpp"
#include "io/bytes/scalar.hpp"
#include "io/bytes/text.hpp"
#include "io/internal/frame_finder.hpp"
#include "nav/internal/nav_frames.hpp"

namespace pingvox {
namespace {

using Scans = tl::expected<std::vector<PointScan>, Unusable>;

tl::unexpected<Unusable> no_scan(std::string_view kind, std::string why = {}) {
  return tl::unexpected(Unusable{kind, std::move(why)});
}

constexpr std::string_view kNoPlaces = "cloud without numbers x, y and z";

/// Of a message. Small numbers in overlapping columns would make points of much less than they take.
constexpr std::uint64_t kMaxPoints = 10'000'000;

/// Whether a direction has a point: sensors write NaN, an infinite or no distance where there was no echo.
bool is_point(const Eigen::Vector3d& point_m) {
  return point_m.allFinite() && !point_m.isZero(0.0);
}

/// From the axes of a frame to ours.
void turn_from(FrameAxes axes, std::vector<PointScan>& scans, bool is_fixed) {
  if (axes == FrameAxes::kNotNamed || axes == FrameAxes::kUp) return;
  const Eigen::Matrix3d from_optical = ours_from_optical();
  for (PointScan& scan : scans) {
    for (Eigen::Vector3d& point_m : scan.points_m) {
      if (axes == FrameAxes::kOptical) {
        point_m = from_optical * point_m;
      } else {
        point_m = is_fixed ? from_ned::world(point_m) : from_ned::body(point_m);
      }
    }
  }
}

/// How the points of a topic are read by the name of their frame; empty: as they are.
std::string note_of_frame(const std::string& topic, std::string_view frame) {
  if (is_fixed_frame(frame)) {
    return fmt::format(
        "the points of {} are in {}, which does not move with the sensor: they are mapped where they are", topic,
        frame);
  }
  if (axes_of(frame) != FrameAxes::kOptical) return {};
  return fmt::format("the points of {} are turned from {} (x right, y down, z ahead)", topic, frame);
}

/// A scan alone, without a copy of its points.
std::vector<PointScan> only(PointScan scan) {
  std::vector<PointScan> scans;
  scans.push_back(std::move(scan));
  return scans;
}

Scans cloud_scan(RosMessage& message, const KnownTopic& topic, std::span<const std::uint8_t>, double time_s) {
  const RosFields fields(message, topic.fields);
  PointScan scan;
  scan.time_s = time_s;
  if (fields.count(0) > kMaxPoints) return no_scan(kImpossible);
  for (std::size_t i = 0; i < fields.count(0); ++i) {
    const Eigen::Vector3d point_m(fields.number(0, i), fields.number(1, i), fields.number(2, i));
    if (is_point(point_m)) scan.points_m.push_back(point_m);
  }
  return only(std::move(scan));
}

/// Types of PointField, from 1.
constexpr std::array kFieldTypes = {Scalar::kInt8,  Scalar::kUint8,  Scalar::kInt16, Scalar::kUint16,
                                    Scalar::kInt32, Scalar::kUint32, Scalar::kFloat, Scalar::kDouble};

/// A number in each point of a PointCloud2.
struct CloudColumn {
  std::size_t offset = 0;
  Scalar type = Scalar::kFloat;
};

/// The columns x, y and z; nullopt: one is missing.
std::optional<std::array<CloudColumn, 3>> columns_of(RosMessage& message, const KnownTopic& topic,
                                                     std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kMaxFields = 256;
  constexpr std::array<std::string_view, 3> kNames = {"x", "y", "z"};
  std::array<std::optional<CloudColumn>, 3> found;
  for (std::size_t n = 0; n < kMaxFields && message.read(*topic.layout, bytes, n); ++n) {
    const RosFields field(message, topic.fields);
    if (field.count(1) == 0) break;
    const auto axis = static_cast<std::size_t>(std::ranges::find(kNames, field.text(0)) - kNames.begin());
    const auto offset = whole<std::uint32_t>(field.number(1)), type = whole<std::uint32_t>(field.number(2));
    if (axis < kNames.size() && offset && type && *type >= 1 && *type <= kFieldTypes.size()) {
      found[axis] = {*offset, kFieldTypes[*type - 1]};
    }
  }
  if (!found[0] || !found[1] || !found[2]) return std::nullopt;
  return std::array{*found[0], *found[1], *found[2]};
}

struct CloudRows {
  std::uint64_t height = 0, of_points = 0;  ///< number of rows, and bytes of the points of each
  std::uint64_t step = 0;                   ///< from row to row, as the message says
};

/// From row to row in data of this size; nullopt: they do not fit. Rows without bytes behind their points need no step:
/// some drivers get it wrong.
std::optional<std::uint64_t> bytes_of_row(const CloudRows& rows, std::uint64_t size) {
  constexpr std::uint64_t kMaxRow = std::uint64_t{1} << 40U;
  if (rows.of_points > kMaxRow / rows.height) return std::nullopt;
  if (size == rows.height * rows.of_points) return rows.of_points;
  const std::uint64_t last = rows.step * (rows.height - 1) + rows.of_points;  // without what is behind its points
  const bool fits = rows.step >= rows.of_points && size >= last && size <= rows.step * rows.height;
  return fits ? std::optional(rows.step) : std::nullopt;
}

Scans cloud2_scan(RosMessage& message, const KnownTopic& topic, std::span<const std::uint8_t> bytes, double time_s) {
  // The columns are looked up by walking through all but the data again and again.
  constexpr std::size_t kMaxDescription = 65'536;
  const RosFields fields(message, topic.fields);
  if (bytes.size() - message.byte_array(topic.fields[8]).size() > kMaxDescription) return no_scan(kImpossible);
  std::array<std::uint64_t, 4> sizes{};
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const auto size = whole<std::uint32_t>(fields.number(3 + i));
    if (!size) return no_scan(kImpossible);
    sizes[i] = *size;
  }
  const auto [height, width, point_step, row_step] = sizes;
  PointScan scan;
  scan.time_s = time_s;
  if (height == 0 || width == 0) return only(std::move(scan));  // nothing was seen
  const auto columns = columns_of(message, topic, bytes);
  if (!columns) return no_scan(kNoPlaces);
  const std::endian order = fields.number(7) != 0.0 ? std::endian::big : std::endian::little;
  const std::span<const std::uint8_t> data = message.byte_array(topic.fields[8]);
  const bool are_within = std::ranges::all_of(
      *columns, [&](const CloudColumn& column) { return column.offset + bytes_of(column.type) <= point_step; });
  // Products of numbers of 32 bits have no overflow.
  if (!are_within || height * width > kMaxPoints) return no_scan(kImpossible);
  const std::optional<std::uint64_t> row = bytes_of_row({height, width * point_step, row_step}, data.size());
  if (!row) {
    return no_scan(kContradiction,
                   fmt::format("{} bytes of data do not fit height {}, width {}, point_step {} and row_step {}",
                               data.size(), height, width, point_step, row_step));
  }
  for (std::uint64_t i = 0; i < height; ++i) {
    for (std::uint64_t j = 0; j < width; ++j) {
      const auto point = data.subspan(i * *row + j * point_step, point_step);
      Eigen::Vector3d point_m;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto& [offset, type] = (*columns)[axis];
        point_m[static_cast<Eigen::Index>(axis)] = with_scalar(type, [&]<class T>() {
          return static_cast<double>(value_from<T>(point.subspan(offset, sizeof(T)), order));
        });
      }
      if (is_point(point_m)) scan.points_m.push_back(point_m);
    }
  }
  return only(std::move(scan));
}

/// What is wrong with the angles of a LaserScan; empty: nothing.
std::string problem_of_angles(double first_rad, double last_rad, double step_rad, std::size_t count) {
  constexpr double kMaxAngle_rad = 2.1 * std::numbers::pi, kMaxOff = 1.5, kMaxOffShare = 0.01;
  if (!(std::fabs(first_rad) <= kMaxAngle_rad && std::fabs(last_rad) <= kMaxAngle_rad)) {
    return fmt::format("angle_min {:.6g} and angle_max {:.6g} are not both within 2 pi", first_rad, last_rad);
  }
  // Whether the last direction is counted depends on the driver, and steps are rounded.
  const double expected = (last_rad - first_rad) / step_rad + 1.0;
  const double off = std::fabs(expected - static_cast<double>(count));
  if (std::isfinite(expected) && off <= kMaxOff + kMaxOffShare * expected) return {};
  return fmt::format("{} range{} not fit angle_min {:.6g}, angle_max {:.6g} and angle_increment {:.6g}", count,
                     count == 1 ? " does" : "s do", first_rad, last_rad, step_rad);
}

/// Directions in which a sensor looked one after the other are of several scans, so that a moving vehicle does not
/// smear them.
Scans laser_scans(RosMessage& message, const KnownTopic& topic, std::span<const std::uint8_t>, double time_s) {
  constexpr double kLongest_s = 0.02, kMaxStep_s = 60.0;
  constexpr std::size_t kMaxCount = 100'000;
  const RosFields fields(message, topic.fields);
  const double first_rad = fields.number(0), step_rad = fields.number(2), step_s = fields.number(3);
  const double nearest_m = fields.number(4), farthest_m = fields.number(5);
  const std::size_t count = fields.count(6);
  if (count == 0) return std::vector<PointScan>{};
  if (const std::string problem = problem_of_angles(first_rad, fields.number(1), step_rad, count); !problem.empty()) {
    return no_scan(kContradiction, problem);
  }
  if (!(std::fabs(step_s) <= kMaxStep_s) || count > kMaxCount) return no_scan(kImpossible);
  // Whether the way back counts depends on the driver.
  constexpr double kLongerTimes = 2.5;
  const double scan_s = fields.number(7), taken_s = std::fabs(step_s) * static_cast<double>(count);
  if (scan_s > 0.0 && taken_s > kLongerTimes * scan_s) {
    return no_scan(kContradiction, fmt::format("{} ranges every {:.6g} s (time_increment) do not fit scan_time {:.6g}",
                                               count, std::fabs(step_s), scan_s));
  }
  std::vector<PointScan> scans;
  for (std::size_t i = 0; i < count; ++i) {
    const double at_s = time_s + step_s * static_cast<double>(i);
    if (scans.empty() || std::fabs(at_s - *scans.back().time_s) > kLongest_s) {
      scans.emplace_back();
      scans.back().time_s = at_s;
    }
    const double range_m = fields.number(6, i), angle_rad = first_rad + step_rad * static_cast<double>(i);
    if (!(range_m > 0.0 && range_m >= nearest_m && range_m <= farthest_m && std::isfinite(range_m))) continue;
    scans.back().points_m.emplace_back(range_m * std::cos(angle_rad), range_m * std::sin(angle_rad), 0.0);
  }
  return scans;
}

struct ScanType {
  RosType type;
  Scans (*scans_in)(RosMessage& message, const KnownTopic& topic, std::span<const std::uint8_t> bytes, double time_s);
  bool may_be_beams = false;  ///< a message that looks in one direction is a beam
};

constexpr std::array kScanTypes = {
    ScanType{{"PointCloud2",
              {"fields.name", "fields.offset", "fields.datatype", "height", "width", "point_step", "row_step",
               "is_bigendian", "data"}},
             cloud2_scan},
    ScanType{{"PointCloud", {"points.x", "points.y", "points.z"}}, cloud_scan},
    ScanType{{"LaserScan",
              {"angle_min", "angle_max", "angle_increment", "time_increment", "range_min", "range_max", "ranges",
               "scan_time"}},
             laser_scans,
             true},
};

/// Whether a message is no beam, which looks in one direction.
bool looks_around(const KnownTopic& topic, const RosMessage& message) {
  if (!kScanTypes[topic.type].may_be_beams) return true;
  const RosFields fields(message, topic.fields);
  return fields.number(0) != fields.number(1);
}

class BagScans final : public ScanSource {
 public:
  BagScans(std::unique_ptr<Bag> bag, Damage damage, std::string wanted)
      : bag_(std::move(bag)), damage_(damage), wanted_(std::move(wanted)) {}

  /// Reads the first scan. An error also when there is none.
  Result<void> start(const std::optional<BagMessage>& at_hand) {
    if (at_hand) {
      if (const auto added = add(*at_hand); !added) return added;
    }
    if (const auto read = fill(); !read) return read;
    if (!scans_.empty()) return {};
    const std::string of_topic = wanted_.empty() ? "" : " in the topic " + wanted_;
    if (skipped() == 0) {
      return fail(Error::Code::kUnsupported, fmt::format("{}: has no scans of points{}", bag_->name(), of_topic));
    }
    return fail(Error::Code::kCorrupt, fmt::format("{}: has no scans of points{} that can be read: {}", bag_->name(),
                                                   of_topic, first_damage()));
  }

  Result<std::optional<PointScan>> next() override {
    if (const auto read = fill(); !read) return tl::unexpected(read.error());
    if (scans_.empty()) return std::nullopt;
    PointScan scan = std::move(scans_.front());
    scans_.pop_front();
    scan.number = given_++;
    return scan;
  }
  std::size_t skipped() const override { return damage_count(damage_of(*bag_, unusable_)); }
  std::string first_damage() const override { return first_damage_of(*bag_, unusable_); }
  std::string note() const override {
    return joined_notes(note_, queue_.stamps_stand_still() ? note_of_stamps(chosen_) : "");
  }
  std::optional<double> share_read() const override { return bag_->share_read(); }

 private:
  /// Reads until there is a scan, or to the end.
  Result<void> fill() {
    while (scans_.empty()) {
      const Result<std::optional<BagMessage>> message = bag_->next();
      if (!message) return tl::unexpected(message.error());
      if (*message) {
        if (const auto added = add(**message); !added) return added;
      }
      if (damage_ == Damage::kFail && skipped() > 0) {
        return fail(Error::Code::kCorrupt, fmt::format("{}: {}", bag_->name(), first_damage()));
      }
      if (!*message) {
        queue_.end();
        take_known();
        return {};
      }
    }
    return {};
  }

  Result<void> add(const BagMessage& message) {
    while (topics_.size() <= message.topic) topics_.push_back(scan_topic(bag_->topics()[topics_.size()]));
    const std::optional<KnownTopic>& topic = topics_[message.topic];
    const std::string& name = bag_->topics()[message.topic].name;
    if (!topic || (!wanted_.empty() && name != wanted_)) return {};
    if (!message_.read(*topic->layout, message.bytes)) {
      unusable_.add({kNoFit}, message.file_byte);
      return {};
    }
    if (!looks_around(*topic, message_)) return {};
    const double time_s = topic->time_of(message_, message.time_s);
    const std::string frame = in_ascii(topic->frame_of(message_));
    Scans scans = kScanTypes[topic->type].scans_in(message_, *topic, message.bytes, time_s);
    if (!scans) {
      unusable_.add(scans.error(), message.file_byte);
      return {};
    }
    if (chosen_.empty()) chosen_ = name;
    if (name != chosen_) return several_topics(*bag_, "scans", may_have_scans);
    if (note_.empty()) note_ = note_of_frame(in_ascii(name), frame);
    const bool is_fixed = is_fixed_frame(frame);
    turn_from(axes_of(frame), *scans, is_fixed);
    for (PointScan& scan : *scans) scan.has_points_in_map = is_fixed;
    queue_.add(*std::move(scans), {time_s, message.time_s});
    take_known();
    return {};
  }

  /// Takes the scans whose times are known.
  void take_known() {
    while (auto known = queue_.take()) {
      auto& [scans, later_s] = *known;
      for (PointScan& scan : scans) {
        *scan.time_s += later_s;
        scans_.push_back(std::move(scan));
      }
    }
  }

  std::unique_ptr<Bag> bag_;
  Damage damage_;
  std::string wanted_, chosen_, note_;
  std::vector<std::optional<KnownTopic>> topics_;
  RosMessage message_;
  StampedQueue<std::vector<PointScan>> queue_;
  std::deque<PointScan> scans_;
  std::size_t given_ = 0;
  UnusableMessages unusable_;
};

}  // namespace

std::optional<KnownTopic> scan_topic(const BagTopic& topic) {
  std::optional<KnownTopic> known = known_topic(topic, kScanTypes);
  if (known && is_sonar(topic) && !kScanTypes[known->type].may_be_beams) return std::nullopt;
  return known;
}

bool may_have_scans(const BagTopic& topic) {
  return scan_topic(topic).has_value();
}

bool is_scan(const KnownTopic& topic, const BagMessage& message) {
  RosMessage read;
  return !kScanTypes[topic.type].may_be_beams || (read.read(*topic.layout, message.bytes) && looks_around(topic, read));
}

Result<std::unique_ptr<ScanSource>> bag_scans(std::unique_ptr<Bag> bag, Damage damage, const std::string& wanted,
                                              const std::optional<BagMessage>& at_hand) {
  auto scans = std::make_unique<BagScans>(std::move(bag), damage, wanted);
  if (const Result<void> started = scans->start(at_hand); !started) return tl::unexpected(started.error());
  return scans;
}

}  // namespace pingvox
