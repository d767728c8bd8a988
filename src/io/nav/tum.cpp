#include "pingvox/io/tum.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "base/without_exceptions.hpp"
#include "io/bytes/text.hpp"
#include "io/readers.hpp"

namespace pingvox {
namespace {

constexpr std::size_t kNumbers = 8;
constexpr std::string_view kLayout = "a pose is 't x y z qx qy qz qw'";

/// Parses a line; the error is the reason why it is invalid.
tl::expected<StampedPose, std::string> pose_in(std::string_view line) {
  std::array<double, kNumbers> n = {};
  std::size_t count = 0;
  for (; const auto word = cut_word(line); ++count) {
    if (count == kNumbers) return tl::unexpected(fmt::format("more than 8 numbers: {}", kLayout));
    const std::optional<double> number = number_in(*word);
    if (!number) return tl::unexpected(fmt::format("\"{}\" is not a finite number: {}", printable(*word), kLayout));
    n[count] = *number;
  }
  if (count < kNumbers) return tl::unexpected(fmt::format("{} numbers instead of 8: {}", count, kLayout));

  const Eigen::Quaterniond rotation(n[7], n[4], n[5], n[6]);
  const double norm = rotation.norm();
  if (!(std::fabs(norm - 1.0) <= 1e-3)) return tl::unexpected(fmt::format("its quaternion has length {:.6g}", norm));
  StampedPose pose;
  pose.time_s = n[0];
  pose.map_from_body.linear() = rotation.normalized().toRotationMatrix();
  pose.map_from_body.translation() = Eigen::Vector3d(n[1], n[2], n[3]);
  return pose;
}

/// A comment before the poses: it is followed by a time in seconds and kGapEnd.
constexpr std::string_view kGapBegin = "# steps of more than ", kGapEnd = " s are gaps";

/// How long a step is at the most that is no gap, by the comments before the poses.
double longest_step_in(std::string_view text) {
  while (text.starts_with('#')) {
    std::string_view line = text.substr(0, text.find_first_of("\r\n"));
    text.remove_prefix(std::min(text.size(), text.find('\n') == text.npos ? text.size() : text.find('\n') + 1));
    if (!line.starts_with(kGapBegin) || !line.ends_with(kGapEnd)) continue;
    line.remove_prefix(kGapBegin.size());
    line.remove_suffix(std::min(line.size(), kGapEnd.size()));
    if (const auto step_s = number_in(line); step_s && *step_s > 0.0) return *step_s;
  }
  return std::numeric_limits<double>::infinity();
}

/// Whether a comment before the poses names the columns of a quaternion with w first, as EuRoC's do.
bool names_w_first(std::string_view text) {
  Lines lines(text);
  for (auto line = lines.next(); line && line->starts_with('#'); line = lines.next()) {
    std::string letters;
    for (const char c : *line) {
      if (c != '_') letters += c;
    }
    const std::size_t w = letters.find("qw"), x = letters.find("qx");
    if (w < x && x != std::string::npos) return true;
  }
  return false;
}

/// With nine decimals, as usual, or more if needed to be read back exactly.
std::string time_text(double time_s) {
  std::string text = fmt::format("{:.9f}", time_s);
  return number_in(text) == time_s ? text : fmt::format("{}", time_s);
}

}  // namespace

bool looks_like_tum(std::span<const std::uint8_t> bytes) {
  Lines lines(text_of(bytes));
  std::string_view first = lines.next_with_content().value_or("");
  std::string_view rest = first;
  std::size_t count = 0;
  while (const auto word = cut_word(rest)) {
    if (++count > kNumbers + 1 || !number_in(*word)) return false;
  }
  // Accepts one column more or less as a damaged line. A cloud may have as many columns, but no unit quaternions.
  if (count + 1 < kNumbers) return false;
  std::optional<std::string_view> line = first;
  for (int looked_at = 0; line && looked_at < 10; ++looked_at, line = lines.next_with_content()) {
    if (pose_in(*line)) return true;
  }
  return false;
}

Result<Trajectory> read_tum(const FileBytes& file) {
  return detail::without_exceptions(file.name, [&]() -> Result<Trajectory> {
    Lines lines(text_of(file.view()));
    const auto corrupt = [&](std::string_view what) {
      return fail(Error::Code::kCorrupt, fmt::format("{}: line {}: {}", file.name, lines.number(), what));
    };
    if (names_w_first(text_of(file.view()))) {
      return fail(Error::Code::kCorrupt, fmt::format("{}: its header names qw before qx: {}", file.name, kLayout));
    }
    std::vector<StampedPose> poses;
    while (const auto line = lines.next_with_content()) {
      const tl::expected<StampedPose, std::string> pose = pose_in(*line);
      if (!pose) return corrupt(pose.error());
      if (!poses.empty() && !(pose->time_s > poses.back().time_s)) {
        return corrupt(
            fmt::format("time {} s does not come after {} s of the pose before it", pose->time_s, poses.back().time_s));
      }
      poses.push_back(*pose);
    }
    if (poses.empty()) return fail(Error::Code::kCorrupt, fmt::format("{}: holds no poses", file.name));
    if (poses.size() == 1) return Trajectory::still(poses.front().map_from_body, poses.front().time_s);
    return Trajectory::make(std::move(poses), longest_step_in(text_of(file.view())));
  });
}

Result<void> write_tum(const Trajectory& trajectory, std::ostream& out) {
  out << "# timestamp tx ty tz qx qy qz qw\n";
  if (trajectory.gaps() > trajectory.cuts().size())
    out << fmt::format("{}{}{}\n", kGapBegin, trajectory.longest_step_s(), kGapEnd);
  for (const StampedPose& pose : trajectory.poses()) {
    const Eigen::Vector3d at = pose.map_from_body.translation();
    const Eigen::Quaterniond q = Eigen::Quaterniond(pose.map_from_body.linear()).normalized();
    out << fmt::format("{} {} {} {} {} {} {} {}\n", time_text(pose.time_s), at.x(), at.y(), at.z(), q.x(), q.y(), q.z(),
                       q.w());
  }
  if (!out.flush()) return fail(Error::Code::kIo, "the trajectory could not be written");
  return {};
}

}  // namespace pingvox
