#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "io/bytes/text.hpp"
#include "io/clouds/scans.hpp"
#include "io/readers.hpp"

// OctoMap's scan graph as text: `NODE x y z roll pitch yaw`, then the scan's points `x y z`, one in a line
// (docs/formats.md).
namespace pingvox {
namespace {

constexpr std::string_view kNode = "NODE";

enum class LineKind { kNothing, kScan, kPoint, kIndented };

LineKind kind_of_line(std::string_view line) {
  if (trim(line).empty() || line.starts_with('#')) return LineKind::kNothing;
  if (line.starts_with(kNode)) return LineKind::kScan;
  // log2graph takes lines with a leading blank for comments.
  return line.starts_with(' ') ? LineKind::kIndented : LineKind::kPoint;
}

/// The first N numbers of a line; further columns (an intensity, say) are ignored.
template <std::size_t N>
std::optional<std::array<float, N>> numbers_in(std::string_view text) {
  std::array<float, N> numbers;
  for (float& number : numbers) {
    text = trim(text);
    const std::string_view word = text.substr(0, text.find_first_of(" \t"));
    text.remove_prefix(word.size());
    const std::optional<float> value = float_in(word);
    if (!value) return std::nullopt;
    number = *value;
  }
  return numbers;
}

std::optional<OctomapPose> pose_in(std::string_view node_line) {
  const std::size_t end_of_word = node_line.find_first_of(" \t");
  if (end_of_word == std::string_view::npos) return std::nullopt;
  const auto n = numbers_in<6>(node_line.substr(end_of_word));
  if (!n) return std::nullopt;
  return OctomapPose::from_rpy({(*n)[0], (*n)[1], (*n)[2]}, (*n)[3], (*n)[4], (*n)[5]);
}

/// What is wrong with the angles of a log's scans; empty: nothing. Single ones may be damaged.
std::string problem_of_angles(std::string_view text) {
  constexpr float kMaxAngle_rad = 4.0F * std::numbers::pi_v<float>;  // some count past a turn
  constexpr std::size_t kOneOf = 10;
  std::size_t scans = 0, beyond = 0;
  float first_rad = 0.0F;
  Lines lines(text);
  while (const auto line = lines.next()) {
    if (kind_of_line(*line) != LineKind::kScan) continue;
    ++scans;
    const auto n = numbers_in<6>(line->substr(kNode.size()));
    if (!n) continue;
    const float largest_rad = std::max({std::fabs((*n)[3]), std::fabs((*n)[4]), std::fabs((*n)[5])});
    if (!(largest_rad > kMaxAngle_rad) || !std::isfinite(largest_rad)) continue;
    if (beyond++ == 0) first_rad = largest_rad;
  }
  if (beyond == 0 || beyond * kOneOf < scans) return {};
  return fmt::format("an angle of {:.6g} rad after NODE is beyond two turns: are they in degrees?", first_rad);
}

class ScanLogSource : public ScanSource {
 public:
  ScanLogSource(FileBytes file, Damage damage)
      : file_(std::move(file)), damage_(damage), lines_(text_of(file_.view())) {
    advance();
  }

  Result<std::optional<PointScan>> next() override {
    // Points before the first scan are damage.
    std::optional<ScanBuilder> scan;
    while (line_ && !scan) {
      std::string_view reason = "a point before the first scan that can be used";
      if (kind_of_line(*line_) == LineKind::kScan) {
        if (const auto pose = pose_in(*line_)) scan.emplace(*pose, scans_);
        ++scans_;
        if (scan && !scan->origin_is_finite()) scan.reset();
        reason = "NODE must be followed by six finite numbers: x y z roll pitch yaw";
      }
      if (!scan) {
        if (const auto damaged = report_line(reason); !damaged) return tl::unexpected(damaged.error());
      }
      advance();
    }
    if (!scan) return std::nullopt;

    while (line_ && kind_of_line(*line_) != LineKind::kScan) {
      std::string_view reason;
      if (kind_of_line(*line_) == LineKind::kIndented) {
        reason = "begins with a blank, so that OctoMap takes it for a comment";
      } else if (const auto point = numbers_in<3>(*line_); !point) {
        reason = "is not a point of three finite numbers";
      } else if (!scan->add(*point)) {
        reason = "is a point that is not finite in the frame of the map";
      }
      if (!reason.empty()) {
        if (const auto damaged = report_line(reason); !damaged) return tl::unexpected(damaged.error());
      }
      advance();
    }
    return std::move(*scan).finish();
  }

  std::size_t skipped() const override { return skipped_.count; }
  std::string first_damage() const override { return skipped_.first; }
  std::optional<double> share_read() const override { return read_share(lines_.left(), file_.bytes.size()); }

 private:
  /// Moves to the next line that is neither empty nor a comment.
  void advance() {
    do {
      line_ = lines_.next();
    } while (line_ && kind_of_line(*line_) == LineKind::kNothing);
  }

  Result<void> report_line(std::string_view reason) {
    return handle_damage(damage_, skipped_, file_.name, fmt::format("line {}", lines_.number()), std::string(reason));
  }

  FileBytes file_;
  Damage damage_;
  Lines lines_;
  std::optional<std::string_view> line_;
  std::size_t scans_ = 0;  ///< begun, damaged ones as well
  SkippedRecords skipped_;
};

}  // namespace

bool looks_like_scan_log(std::span<const std::uint8_t> bytes) {
  Lines lines(text_of(bytes));
  while (const auto line = lines.next()) {
    if (kind_of_line(*line) != LineKind::kNothing) {
      return *line == kNode || line->starts_with("NODE ") || line->starts_with("NODE\t");
    }
  }
  return false;
}

Result<std::unique_ptr<ScanSource>> open_scan_log(FileBytes file, Damage damage) {
  if (const std::string problem = problem_of_angles(text_of(file.view())); !problem.empty()) {
    return fail(Error::Code::kCorrupt, fmt::format("{}: {}", file.name, problem));
  }
  return std::make_unique<ScanLogSource>(std::move(file), damage);
}

}  // namespace pingvox
