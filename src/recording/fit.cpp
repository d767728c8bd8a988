#include "pingvox/recording/fit.hpp"

#include <fmt/core.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "base/words.hpp"
#include "pingvox/geometry/degree.hpp"
#include "recording/recording_echoes.hpp"

namespace pingvox {
namespace {

/// One number that is searched.
struct FitAxis {
  double HeldOutOptions::* member;
  double middle, reach;  ///< searched are middle - reach .. middle + reach
  double sure;           ///< larger deviations tell nothing
};

std::vector<FitAxis> axes_of(FitParameter parameter) {
  constexpr double kSpeedReach = 0.05, kYawReach = 10.0 * kDegree_rad, kOffsetReach_s = 2.0, kPlaceReach_m = 0.6;
  constexpr double kSureSpeed = 0.01, kSureYaw = 2.0 * kDegree_rad, kSureOffset_s = 0.3, kSurePlace_m = 0.1;
  switch (parameter) {
    case FitParameter::kSoundSpeed:
      return {{&HeldOutOptions::range_factor, 1.0, kSpeedReach, kSureSpeed}};
    case FitParameter::kMountYaw:
      return {{&HeldOutOptions::mount_yaw_rad, 0.0, kYawReach, kSureYaw}};
    case FitParameter::kNavOffset:
      return {{&HeldOutOptions::nav_offset_s, 0.0, kOffsetReach_s, kSureOffset_s}};
    case FitParameter::kMountXy:
      return {{&HeldOutOptions::mount_x_m, 0.0, kPlaceReach_m, kSurePlace_m},
              {&HeldOutOptions::mount_y_m, 0.0, kPlaceReach_m, kSurePlace_m}};
  }
  return {};
}

/// Parts of a recording that are left out in turn.
constexpr std::size_t kJackknife = 10;

/// Scores of an echo, summed over each part of the recording.
struct PartScores {
  std::array<double, kJackknife> sums{}, echoes{};

  /// Mean over all parts but one; kJackknife: over all.
  double mean_without(std::size_t part) const {
    double sum = 0.0, count = 0.0;
    for (std::size_t i = 0; i < kJackknife; ++i) {
      if (i == part) continue;
      sum += sums[i];
      count += echoes[i];
    }
    return count > 0.0 ? sum / count : 0.0;
  }
  double mean() const { return mean_without(kJackknife); }
};

PartScores scores_of(const std::vector<JudgedEcho>& echoes, std::size_t sweeps, double tolerance_m) {
  PartScores scores;
  for (const JudgedEcho& echo : echoes) {
    const std::size_t part = std::min(kJackknife * echo.sweep / sweeps, kJackknife - 1);
    scores.echoes[part] += 1.0;
    if (echo.outcome == EchoOutcome::kPredicted) scores.sums[part] += 1.0 - 0.5 * std::abs(echo.error_m) / tolerance_m;
  }
  return scores;
}

/// Score by value along one axis.
using Curve = std::map<double, PartScores>;

/// Vertex of the parabola by least squares through the points of a curve about its best one. nullopt: that one is at
/// the end, or the points do not bend down.
/// @param part  that is left out; kJackknife: none
std::optional<double> best_of(const Curve& curve, std::size_t part) {
  const auto score = [&](const auto& point) { return point.second.mean_without(part); };
  const auto best = std::ranges::max_element(curve, {}, score);
  if (best == curve.begin() || best == std::prev(curve.end())) return std::nullopt;
  constexpr std::ptrdiff_t kBeside = 3;
  const auto first = std::prev(best, std::min(kBeside, std::distance(curve.begin(), best)));
  const auto last = std::next(best, 1 + std::min(kBeside, std::distance(std::next(best), curve.end())));
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  const double scale = std::max(std::prev(last)->first - best->first, best->first - first->first);
  for (auto point = first; point != last; ++point) {
    const double x = (point->first - best->first) / scale;
    const Eigen::Vector3d row(1.0, x, x * x);
    normal += row * row.transpose();
    right += row * score(*point);
  }
  const Eigen::Vector3d bend = normal.ldlt().solve(right);
  if (!(bend.z() < 0.0)) return std::nullopt;
  return best->first + scale * std::clamp(-0.5 * bend.y() / bend.z(), -1.0, 1.0);
}

/// Search of one parameter.
class Fitting {
 public:
  Fitting(const RecordingEchoes& read, const Trajectory& trajectory, FitParameter parameter,
          const std::function<void(double)>& progress)
      : echoes_(read.echoes), trajectory_(trajectory), map_(read.map), axes_(axes_of(parameter)), progress_(progress) {
    at_.folds = 2;
    at_.tolerance_m = read.tolerance_m();
    for (const FitAxis& axis : axes_) at_.*axis.member = axis.middle;
  }

  Result<Fit> find() {
    const Result<PartScores> before = score();
    if (!before) return tl::unexpected(before.error());
    Fit found;
    found.values.resize(axes_.size());
    found.score_before = before->mean();
    found.is_told = true;
    // Two axes depend on each other little, so they are searched in turn.
    const std::size_t rounds = axes_.size() == 1 ? 1 : 2;
    evaluations_ = 1 + static_cast<double>(rounds * axes_.size()) * (kCoarse + kFine);
    for (std::size_t round = 0; round < rounds; ++round) {
      for (std::size_t i = 0; i < axes_.size(); ++i) {
        const bool is_last = round + 1 == rounds;
        Result<std::optional<Estimate>> value = search(axes_[i]);
        if (!value) return tl::unexpected(value.error());
        if (*value) found.values[i] = **value;
        if (is_last && (!*value || (*value)->deviation > axes_[i].sure)) found.is_told = false;
      }
    }
    const Result<PartScores> after = score();
    if (!after) return tl::unexpected(after.error());
    found.score = after->mean();
    return found;
  }

 private:
  static constexpr int kCoarse = 9, kFineOfSide = 3, kFine = 2 * kFineOfSide;

  Result<PartScores> score() {
    return echoes_.judge(trajectory_, map_, at_).map([&](const JudgedEchoes& judged) {
      if (progress_) progress_(std::min(1.0, ++done_ / std::max(1.0, evaluations_)));
      return scores_of(judged.echoes, echoes_.sweeps(), at_.tolerance_m);
    });
  }

  /// Values all over the axis, then some about the best one. nullopt: the recording does not tell.
  Result<std::optional<Estimate>> search(const FitAxis& axis) {
    Curve curve;
    const double before = at_.*axis.member;
    const auto try_value = [&](double value) -> Result<void> {
      if (curve.contains(value)) return {};
      at_.*axis.member = value;
      return score().map([&](const PartScores& scores) { curve.emplace(value, scores); });
    };
    const double step = 2.0 * axis.reach / (kCoarse - 1);
    for (int i = 0; i < kCoarse; ++i) {
      if (const auto tried = try_value(axis.middle - axis.reach + step * i); !tried)
        return tl::unexpected(tried.error());
    }
    const auto mean = [](const auto& point) { return point.second.mean(); };
    const auto highest = std::ranges::max_element(curve, {}, mean);
    const double coarse = highest->first;
    const double contrast = mean(*highest) - std::max(mean(*curve.begin()), mean(*std::prev(curve.end())));
    for (int i = 1; i <= kFineOfSide; ++i) {
      for (const double side : {-1.0, 1.0}) {
        const double value = coarse + side * step * i / (kFineOfSide + 1);
        if (const auto tried = try_value(value); !tried) return tl::unexpected(tried.error());
      }
    }
    constexpr double kFlat = 0.01;
    const std::optional<double> best = best_of(curve, kJackknife);
    at_.*axis.member = best.value_or(before);
    if (!best || contrast < kFlat) return std::nullopt;
    double squares = 0.0;
    for (std::size_t part = 0; part < kJackknife; ++part) {
      const std::optional<double> without = best_of(curve, part);
      if (!without) return std::nullopt;
      squares += (*without - *best) * (*without - *best);
    }
    // Values closer than the fine steps are not told apart.
    constexpr double kParts = kJackknife;
    const double finest = step / (kFineOfSide + 1) / std::sqrt(12.0);
    return Estimate{*best, std::hypot(std::sqrt((kParts - 1.0) / kParts * squares), 0.5 * finest)};
  }

  const HeldOutEchoes& echoes_;
  const Trajectory& trajectory_;
  const MapOptions& map_;
  std::vector<FitAxis> axes_;
  const std::function<void(double)>& progress_;
  HeldOutOptions at_;
  double evaluations_ = 1.0, done_ = 0.0;
};

}  // namespace

Result<Fit> fit(const Recording& recording, const VehiclePath& path, FitParameter parameter,
                const EvaluateOptions& options, const std::function<void(double)>& progress) {
  if (const auto valid = options.validate(); !valid) return tl::unexpected(valid.error());
  const Result<RecordingEchoes> read = recording_echoes(recording, path, options.map, options.build);
  if (!read) return tl::unexpected(read.error());
  constexpr std::size_t kFewSweeps = 4;
  if (read->echoes.sweeps() < kFewSweeps) {
    return fail(Error::Code::kUnsupported,
                fmt::format("{}: {} are too few to fit anything, {} are needed", recording.logs().front().name(),
                            counted(read->echoes.sweeps(), "sweep"), kFewSweeps));
  }
  return Fitting(*read, path.trajectory, parameter, progress).find();
}

}  // namespace pingvox
