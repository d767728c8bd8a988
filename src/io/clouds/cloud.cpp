#include "io/clouds/cloud.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "io/bytes/byte_reader.hpp"

namespace pingvox {
namespace {

/// "nan" in any case and with any sign.
bool is_nan(std::string_view word) {
  if (word.starts_with('-') || word.starts_with('+')) word.remove_prefix(1);
  constexpr std::string_view kNan = "nan";
  return word.size() == kNan.size() &&
         std::equal(word.begin(), word.end(), kNan.begin(), [](char c, char wanted) { return (c | 0x20) == wanted; });
}

/// Parses the coordinates of a line; NaN where invalid.
class PointLine {
 public:
  explicit PointLine(const std::array<TextCloud::Column, 3>& xyz)
      : xyz_(xyz), words_(std::max({xyz[0].word, xyz[1].word, xyz[2].word}) + 1) {}

  Eigen::Vector3d point_in(std::string_view line) {
    Eigen::Vector3d point = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    has_nan_ = false;
    for (std::size_t i = 0; i < words_; ++i) {
      const auto word = cut_word(line);
      if (!word) break;
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const auto& [place, type] = xyz_[static_cast<std::size_t>(axis)];
        if (place != i) continue;
        const auto value = type == Scalar::kFloat ? to_double(float_in(*word)) : number_in(*word);
        if (value) point[axis] = *value;
        has_nan_ = has_nan_ || is_nan(*word);
      }
    }
    return point;
  }
  /// Whether the last line contained "nan" as a coordinate.
  bool has_nan() const { return has_nan_; }

 private:
  static std::optional<double> to_double(std::optional<float> value) {
    return value ? std::optional<double>(*value) : std::nullopt;
  }

  std::array<TextCloud::Column, 3> xyz_;
  std::size_t words_;
  bool has_nan_ = false;
};

/// A source of one scan. Damaged points are skipped and counted.
class CloudSource : public ScanSource {
 public:
  CloudSource(std::string name, Damage damage, NanPoint nan, Eigen::Vector3d origin_m)
      : name_(std::move(name)), damage_(damage), nan_(nan), origin_m_(std::move(origin_m)) {}

  Result<std::optional<PointScan>> next() final {
    if (is_read_) return std::nullopt;
    is_read_ = true;
    PointScan scan;
    scan.origin_m = origin_m_;
    if (const auto read = read_points(scan.points_m); !read) return tl::unexpected(read.error());
    leave_out_zeros(scan.points_m);
    return scan;
  }
  std::size_t skipped() const final { return skipped_.count; }
  std::string first_damage() const final { return skipped_.first; }
  std::optional<double> share_read() const final { return is_read_ ? 1.0 : 0.0; }

 protected:
  virtual Result<void> read_points(std::vector<Eigen::Vector3d>& points_m) = 0;

  /// @param has_nan  a coordinate is NaN
  Result<void> skip_point(const std::string& place, bool has_nan) {
    const bool is_usual = has_nan && nan_ == NanPoint::kNoReturn;
    return handle_damage(is_usual ? Damage::kSkip : damage_, skipped_, name_, place,
                         "is not a point of three finite numbers");
  }
  Result<void> report_missing(std::uint64_t points, std::uint64_t wanted) {
    return handle_damage(damage_, skipped_, name_, "end", fmt::format("holds {} of {} points", points, wanted));
  }
  Result<void> report_surplus(std::uint64_t points, const std::string& what) {
    return handle_damage(damage_, skipped_, name_, "end", fmt::format("{} after its {} points", what, points));
  }

 private:
  /// Scanners write 0, 0, 0 for a beam without return; a single one may be a place.
  void leave_out_zeros(std::vector<Eigen::Vector3d>& points_m) {
    const auto is_zero = [](const Eigen::Vector3d& point_m) { return point_m.isZero(0.0); };
    const auto zeros = static_cast<std::size_t>(std::ranges::count_if(points_m, is_zero));
    if (zeros < 2 || zeros == points_m.size()) return;
    std::erase_if(points_m, is_zero);
    if (skipped_.count == 0) skipped_.first = fmt::format("{} points are 0, 0, 0: beams without return", zeros);
    skipped_.count += zeros;
  }

  std::string name_;
  Damage damage_;
  NanPoint nan_;
  Eigen::Vector3d origin_m_;
  bool is_read_ = false;
  SkippedRecords skipped_;
};

class TextCloudSource : public CloudSource {
 public:
  TextCloudSource(FileBytes file, Lines lines, const TextCloud& cloud, Damage damage, const Eigen::Vector3d& origin_m)
      : CloudSource(file.name, damage, cloud.nan, origin_m), file_(std::move(file)), lines_(lines), cloud_(cloud) {}

 private:
  Result<void> read_points(std::vector<Eigen::Vector3d>& points_m) override {
    PointLine reader(cloud_.xyz);
    std::uint64_t count = 0;
    for (; !cloud_.points || count < *cloud_.points; ++count) {
      const auto line = lines_.next_with_content();
      if (!line) break;
      const Eigen::Vector3d point = reader.point_in(*line);
      if (point.allFinite()) {
        points_m.push_back(point);
        continue;
      }
      const auto counted = skip_point(fmt::format("line {}", lines_.number()), reader.has_nan());
      if (!counted) return counted;
    }
    const std::uint64_t wanted = cloud_.points.value_or(cloud_.announced.value_or(0));
    if (count < wanted) return report_missing(count, wanted);
    std::uint64_t further = 0;
    while (cloud_.is_last && lines_.next_with_content()) ++further;
    return further > 0 ? report_surplus(count, fmt::format("{} further lines are", further)) : Result<void>{};
  }

  FileBytes file_;  ///< viewed by `lines_`; moving a vector does not move its bytes
  Lines lines_;
  TextCloud cloud_;
};

class ByteCloudSource : public CloudSource {
 public:
  ByteCloudSource(std::string name, std::vector<std::uint8_t> bytes, const ByteCloud& cloud, Damage damage,
                  const Eigen::Vector3d& origin_m)
      : CloudSource(std::move(name), damage, cloud.nan, origin_m), bytes_(std::move(bytes)), cloud_(cloud) {}

 private:
  Result<void> read_points(std::vector<Eigen::Vector3d>& points_m) override {
    points_m.reserve(cloud_.points);
    for (std::size_t n = 0; n < cloud_.points; ++n) {
      const Eigen::Vector3d point(value(0, n), value(1, n), value(2, n));
      if (point.allFinite()) {
        points_m.push_back(point);
        continue;
      }
      const auto counted = skip_point(fmt::format("point {}", n), point.hasNaN());
      if (!counted) return counted;
    }
    if (cloud_.bytes_behind == 0) return {};
    return report_surplus(cloud_.points, fmt::format("{} further bytes are", cloud_.bytes_behind));
  }

  double value(std::size_t axis, std::size_t n) const {
    const auto& [first, step, type] = cloud_.xyz[axis];
    const auto bytes = std::span(bytes_).subspan(first + n * step);
    return with_scalar(type, [&]<class T>() { return static_cast<double>(value_from<T>(bytes, cloud_.order)); });
  }

  std::vector<std::uint8_t> bytes_;
  ByteCloud cloud_;
};

}  // namespace

std::unique_ptr<ScanSource> text_cloud(FileBytes file, Lines lines, const TextCloud& cloud, Damage damage,
                                       const Eigen::Vector3d& origin_m) {
  return std::make_unique<TextCloudSource>(std::move(file), lines, cloud, damage, origin_m);
}

std::uint64_t bytes_like_points(std::span<const std::uint8_t> behind, std::uint64_t point_bytes) {
  const bool has_more =
      behind.size() >= point_bytes && std::ranges::any_of(behind, [](std::uint8_t byte) { return byte != 0; });
  return has_more ? behind.size() : 0;
}

std::unique_ptr<ScanSource> byte_cloud(std::string name, std::vector<std::uint8_t> bytes, const ByteCloud& cloud,
                                       Damage damage, const Eigen::Vector3d& origin_m) {
  return std::make_unique<ByteCloudSource>(std::move(name), std::move(bytes), cloud, damage, origin_m);
}

}  // namespace pingvox
