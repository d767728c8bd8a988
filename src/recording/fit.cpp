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
  double middle, reach;     ///< searched are middle - reach .. middle + reach
  double sure;              ///< with larger deviations not observable
  double systematic = 0.0;  ///< deviation that all parts of a recording share
};

std::vector<FitAxis> axes_of(FitParameter parameter, double beam_width_rad) {
  // A slanting wall returns its echo to the edge of the beam, nearer than on the axis by half the width times the
  // tangent of the slant: as all ranges of a room would be by another speed of sound. Here for a slant of 30 degrees.
  constexpr double kTangent = 0.577;
  const double systematic_speed = 0.5 * beam_width_rad * kTangent;
  constexpr double kSpeedReach = 0.05, kYawReach = 10.0 * kDegree_rad, kOffsetReach_s = 2.0, kPlaceReach_m = 0.6;
  constexpr double kSureSpeed = 0.02, kSureYaw = 2.0 * kDegree_rad, kSureOffset_s = 0.3, kSurePlace_m = 0.1;
  switch (parameter) {
    case FitParameter::kSoundSpeed:
      return {{&HeldOutOptions::range_factor, 1.0, kSpeedReach, kSureSpeed, systematic_speed}};
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

/// Vertex of the parabola by least squares through the points of a curve near its best one. nullopt: that one is at the
/// end, or the points do not bend down.
/// @param near  how far from the best point
/// @param part  that is left out; kJackknife: none
std::optional<double> best_of(const Curve& curve, double near, std::size_t part) {
  const auto score = [&](const auto& point) { return point.second.mean_without(part); };
  const auto best = std::ranges::max_element(curve, {}, score);
  if (best == curve.begin() || best == std::prev(curve.end())) return std::nullopt;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const auto& point : curve) {
    const double x = (point.first - best->first) / near;
    constexpr double kRounding = 1e-6;
    if (std::abs(x) > 1.0 + kRounding) continue;
    const Eigen::Vector3d row(1.0, x, x * x);
    normal += row * row.transpose();
    right += row * score(point);
  }
  const Eigen::Vector3d bend = normal.ldlt().solve(right);
  if (!(bend.z() < 0.0)) return std::nullopt;
  return best->first + near * std::clamp(-0.5 * bend.y() / bend.z(), -1.0, 1.0);
}

/// Search of one parameter.
class Fitting {
 public:
  Fitting(const RecordingEchoes& read, const Trajectory& trajectory, FitParameter parameter,
          const std::function<void(double)>& progress)
      : echoes_(read.echoes),
        trajectory_(trajectory),
        map_(read.map),
        axes_(axes_of(parameter, read.beam_width_rad)),
        progress_(progress) {
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
    found.is_observable = true;
    const bool are_two = axes_.size() == 2;
    const std::size_t rounds = are_two ? 2 : 1;
    evaluations_ =
        1 + static_cast<double>(rounds * axes_.size()) * (kCoarse + kFine) + (are_two ? kCoarse * kCoarse : 0);
    // From far away, each of two alone would be led astray by the other.
    if (are_two) {
      if (const auto started = start_of_two(before->mean()); !started) return tl::unexpected(started.error());
    }
    for (std::size_t round = 0; round < rounds; ++round) {
      for (std::size_t i = 0; i < axes_.size(); ++i) {
        const bool is_last = round + 1 == rounds;
        Result<std::optional<Estimate>> value = search(axes_[i]);
        if (!value) return tl::unexpected(value.error());
        if (*value) found.values[i] = **value;
        if (is_last && (!*value || (*value)->deviation > axes_[i].sure)) found.is_observable = false;
      }
    }
    const Result<PartScores> after = score();
    if (!after) return tl::unexpected(after.error());
    found.score = after->mean();
    if (found.score < found.score_before) found.is_observable = false;
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

  static double coarse_step(const FitAxis& axis) { return 2.0 * axis.reach / (kCoarse - 1); }
  static double coarse_value(const FitAxis& axis, int i) { return axis.middle - axis.reach + coarse_step(axis) * i; }

  /// Sets the best of all pairs of coarse values, where one is better than what is set.
  Result<void> start_of_two(double best) {
    double &x = at_.*axes_[0].member, &y = at_.*axes_[1].member;
    double best_x = x, best_y = y;
    for (int i = 0; i < kCoarse * kCoarse; ++i) {
      x = coarse_value(axes_[0], i / kCoarse);
      y = coarse_value(axes_[1], i % kCoarse);
      const Result<PartScores> tried = score();
      if (!tried) return tl::unexpected(tried.error());
      if (tried->mean() <= best) continue;
      best = tried->mean();
      best_x = x;
      best_y = y;
    }
    x = best_x;
    y = best_y;
    return {};
  }

  /// Values all over the axis, then some about the best one. nullopt: not observable.
  Result<std::optional<Estimate>> search(const FitAxis& axis) {
    Curve curve;
    const double before = at_.*axis.member;
    const auto try_value = [&](double value) -> Result<void> {
      if (curve.contains(value)) return {};
      at_.*axis.member = value;
      return score().map([&](const PartScores& scores) { curve.emplace(value, scores); });
    };
    const double step = coarse_step(axis);
    for (int i = 0; i < kCoarse; ++i) {
      if (const auto tried = try_value(coarse_value(axis, i)); !tried) return tl::unexpected(tried.error());
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
    const std::optional<double> best = best_of(curve, step, kJackknife);
    at_.*axis.member = best.value_or(before);
    if (!best || contrast < kFlat) return std::nullopt;
    double squares = 0.0;
    for (std::size_t part = 0; part < kJackknife; ++part) {
      const std::optional<double> without = best_of(curve, step, part);
      if (!without) return std::nullopt;
      squares += (*without - *best) * (*without - *best);
    }
    // Values closer than the fine steps cannot be distinguished.
    constexpr double kParts = kJackknife;
    const double finest = step / (kFineOfSide + 1) / std::sqrt(12.0);
    return Estimate{*best, std::hypot(std::sqrt((kParts - 1.0) / kParts * squares), 0.5 * finest, axis.systematic)};
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
  // Along the axes of the beams: the arcs of wide beams thicken walls towards the head, and the values that hide that
  // predict more echoes than the true ones.
  BuildOptions build = options.build;
  build.model.shape = BeamShape::kRay;
  const Result<RecordingEchoes> read = recording_echoes(recording, path, options.map, build);
  if (!read) return tl::unexpected(read.error());
  constexpr std::size_t kFewSweeps = 4;
  if (read->echoes.sweeps() < kFewSweeps) {
    return fail(Error::Code::kUnsupported,
                fmt::format("{}: {}, too few to fit anything: {} are needed", recording.logs().front().name(),
                            counted(read->echoes.sweeps(), "sweep"), kFewSweeps));
  }
  return Fitting(*read, path.trajectory, parameter, progress).find();
}

}  // namespace pingvox
