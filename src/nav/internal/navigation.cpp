#include "nav/internal/navigation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <set>
#include <span>
#include <utility>

#include "base/median.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/nav/main_source.hpp"

namespace pingvox {
namespace {

constexpr double kClip = 2.0;                ///< robust standard deviations
constexpr double kMinDeviation_m_s = 0.005;  ///< resolution of common logs
constexpr double kNoiseWindow_s = 30.0;
constexpr std::size_t kMaxDifferences = 2048;  ///< in a window; more are thinned out
/// Data sheets of DVLs give 1 to 2 mm/s, beside a share of the speed, that do not average out: the noise is not less
/// than what drifts as far as 2 mm/s in 100 s.
constexpr double kMinDensity = 0.002 * 10.0;
/// Errors of a compass, and for how long they stay alike; usual bias of a gyro.
constexpr double kCompass_rad = 3.0 * kDegree_rad, kCompassAlike_s = 10.0;
constexpr double kGyroBias_rad_s = 0.1 * kDegree_rad;
constexpr double kMaxGyroStep_s = 0.5;

/// Valid samples at rising times; of equal times the first counts.
std::vector<NavSample> usable(const NavSource& source) {
  std::vector<NavSample> samples;
  for (const NavSample& sample : source.samples) {
    if (sample.valid && (samples.empty() || sample.time_s > samples.back().time_s)) samples.push_back(sample);
  }
  return samples;
}

std::vector<double> times_of(std::span<const NavSample> samples) {
  std::vector<double> times_s(samples.size());
  std::ranges::transform(samples, times_s.begin(), &NavSample::time_s);
  return times_s;
}

/// Values held near the median of the window; marks those that were not.
std::vector<double> clip(std::span<const double> values, const OutlierWindow& window, std::vector<bool>& clipped) {
  std::vector<double> held(values.begin(), values.end());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t first = i - std::min(i, window.before), end = std::min(values.size(), i + window.after + 1);
    std::vector<double> around(values.begin() + static_cast<std::ptrdiff_t>(first),
                               values.begin() + static_cast<std::ptrdiff_t>(end));
    const double middle = median(around);
    for (double& value : around) value = std::abs(value - middle);
    const double most = kClip * std::max(kMadToDeviation * median(around), kMinDeviation_m_s);
    held[i] = std::clamp(values[i], middle - most, middle + most);
    if (held[i] != values[i]) clipped[i] = true;
  }
  return held;
}

/// Noise of the integral over time at each sample, from second differences: what moves smoothly has none.
std::vector<double> noise_density(const std::vector<double>& times_s, std::span<const double> ahead,
                                  std::span<const double> left) {
  const std::size_t count = times_s.size();
  std::vector<double> density(count), seconds;
  std::size_t first = 0, end = 0;
  for (std::size_t i = 0; i < count; ++i) {
    while (times_s[first] < times_s[i] - kNoiseWindow_s) ++first;
    while (end < count && times_s[end] <= times_s[i] + kNoiseWindow_s) ++end;
    seconds.clear();
    // Thinned evenly where there are many: all of them would take a time that grows with the square of their number.
    const std::size_t step = (end - first) / kMaxDifferences + 1;
    for (std::size_t j = first + 1; j + 1 < end; j += step) {
      for (const auto& axis : {ahead, left}) seconds.push_back(std::abs(axis[j - 1] - 2.0 * axis[j] + axis[j + 1]));
    }
    // Squares of the weights 1, -2 and 1 sum up to 6.
    const double noise = seconds.empty() ? 0.0 : kMadToDeviation * median(seconds) / std::sqrt(6.0);
    const double step_s =
        end - first > 1 ? (times_s[end - 1] - times_s[first]) / static_cast<double>(end - first - 1) : 1.0;
    density[i] = std::max(noise * std::sqrt(step_s), kMinDensity);
  }
  return density;
}

}  // namespace

Pose mount_of(const std::map<std::string, Pose>& body_from_source, const std::string& source) {
  const auto mount = body_from_source.find(source);
  return mount == body_from_source.end() ? Pose::Identity() : mount->second;
}

TimeSeries::TimeSeries(std::vector<double> times_s, std::vector<double> values, double gap_steps)
    : times_s_(std::move(times_s)), values_(std::move(values)) {
  assert(!times_s_.empty() && times_s_.size() == values_.size());
  if (times_s_.size() < 2) return;
  std::vector<double> steps_s(times_s_.size() - 1);
  for (std::size_t i = 0; i < steps_s.size(); ++i) steps_s[i] = times_s_[i + 1] - times_s_[i];
  usual_step_s_ = median(std::move(steps_s));
  usual_limit_s_ = std::max(gap_steps * usual_step_s_, 0.5);
}

double TimeSeries::at(double time_s) const {
  const auto after = std::ranges::upper_bound(times_s_, time_s);
  if (after == times_s_.begin()) return values_.front();
  if (after == times_s_.end()) return values_.back();
  const auto i = static_cast<std::size_t>(after - times_s_.begin());
  const double share = (time_s - times_s_[i - 1]) / (times_s_[i] - times_s_[i - 1]);
  return values_[i - 1] + share * (values_[i] - values_[i - 1]);
}

std::vector<TimeSpan> TimeSeries::gaps(double from_s, double to_s) const {
  std::vector<TimeSpan> found;
  if (from_s < times_s_.front()) found.push_back({from_s, times_s_.front()});
  auto next = std::ranges::upper_bound(times_s_, from_s);
  if (next == times_s_.begin()) ++next;
  for (; next != times_s_.end() && *(next - 1) < to_s; ++next) {
    if (*next - *(next - 1) > usual_limit_s_) found.push_back({*(next - 1), *next});
  }
  if (to_s > times_s_.back()) found.push_back({times_s_.back(), to_s});
  return found;
}

double TimeSeries::gap_s(double from_s, double to_s) const {
  double sum_s = 0.0;
  for (const TimeSpan& gap : gaps(from_s, to_s)) sum_s += gap.within(from_s, to_s);
  return sum_s;
}

double TimeSeries::longest_step_s() const {
  double longest_s = 0.0;
  for (std::size_t i = 1; i < times_s_.size(); ++i) longest_s = std::max(longest_s, times_s_[i] - times_s_[i - 1]);
  return longest_s;
}

void add_yaw(double yaw_rad, std::vector<double>& yaws_rad) {
  const double before_rad = yaws_rad.empty() ? yaw_rad : yaws_rad.back();
  yaws_rad.push_back(before_rad + std::remainder(yaw_rad - before_rad, 2.0 * std::numbers::pi));
}

std::optional<HeadingSource> heading_source(const NavSource& source, const Pose& body_from_source) {
  const std::vector<NavSample> samples = usable(source);
  if (samples.empty()) return std::nullopt;
  const bool is_attitude = source.quantity == NavQuantity::kAttitude;
  std::vector<double> roll, pitch, yaw;
  for (const NavSample& sample : samples) {
    const Eigen::Vector3d rpy = is_attitude ? sample.value : Eigen::Vector3d(0.0, 0.0, sample.value.x());
    const Pose world_from_source = pose_from_rpy(Eigen::Vector3d::Zero(), rpy.x(), rpy.y(), rpy.z());
    const Eigen::Vector3d turned = rpy_of((world_from_source * body_from_source.inverse()).rotation());
    roll.push_back(turned.x());
    pitch.push_back(turned.y());
    add_yaw(turned.z(), yaw);
  }
  const std::vector<double> times_s = times_of(samples);
  HeadingSource heading{source.name, TimeSeries(times_s, std::move(yaw)), std::nullopt, std::nullopt};
  heading.left_out = few_left_out(source);
  if (is_attitude) {
    heading.roll_rad.emplace(times_s, std::move(roll));
    heading.pitch_rad.emplace(times_s, std::move(pitch));
  }
  return heading;
}

std::optional<HeadingSource> turned_heading(const NavSource& source, const Pose& body_from_source) {
  const std::vector<NavSample> samples = usable(source);
  if (samples.size() < 2) return std::nullopt;
  const auto rate = [&](const NavSample& sample) { return (body_from_source.rotation() * sample.value).z(); };
  std::vector<double> yaw = {0.0};
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double step_s = samples[i].time_s - samples[i - 1].time_s;
    yaw.push_back(yaw.back() + 0.5 * step_s * (rate(samples[i - 1]) + rate(samples[i])));
  }
  return HeadingSource{source.name, TimeSeries(times_of(samples), std::move(yaw)), std::nullopt, std::nullopt, true};
}

std::optional<HeadingSource> gyro_heading(const NavSource& rate, const Pose& body_from_source,
                                          const HeadingSource& heading) {
  std::optional<HeadingSource> turned = turned_heading(rate, body_from_source);
  if (!turned) return std::nullopt;
  const TimeSeries& compass = heading.yaw_rad;
  const double from_s = compass.from_s(), to_s = compass.to_s();
  if (turned->yaw_rad.from_s() > from_s + kMaxGyroStep_s || turned->yaw_rad.to_s() < to_s - kMaxGyroStep_s ||
      turned->yaw_rad.longest_step_s() > kMaxGyroStep_s) {
    return std::nullopt;
  }
  // Least squares of the compass's drift against the gyro, and of what is usual.
  double mean_s = 0.0, mean_rad = 0.0;
  const auto count = static_cast<double>(compass.size());
  for (const double time_s : compass.times_s()) {
    mean_s += time_s / count;
    mean_rad += (compass.at(time_s) - turned->yaw_rad.at(time_s)) / count;
  }
  double squares = 0.0, products = 0.0;
  for (const double time_s : compass.times_s()) {
    squares += std::pow(time_s - mean_s, 2);
    products += (time_s - mean_s) * (compass.at(time_s) - turned->yaw_rad.at(time_s) - mean_rad);
  }
  // Its errors stay the same for some time.
  const double alike = std::max(1.0, count * kCompassAlike_s / std::max(to_s - from_s, kCompassAlike_s));
  const double believed = alike * std::pow(kCompass_rad / kGyroBias_rad_s, 2);
  const double drift_rad_s = products / (squares + believed);
  std::vector<double> yaw_rad = turned->yaw_rad.values();
  for (std::size_t i = 0; i < yaw_rad.size(); ++i) {
    yaw_rad[i] += mean_rad + drift_rad_s * (turned->yaw_rad.times_s()[i] - mean_s);
  }
  turned->yaw_rad = TimeSeries(turned->yaw_rad.times_s(), std::move(yaw_rad));
  turned->name = rate.name + " turn rate";
  turned->roll_rad = heading.roll_rad;
  turned->pitch_rad = heading.pitch_rad;
  return turned;
}

Result<void> check_mounts(const NavLog& log, const std::map<std::string, Pose>& body_from_source) {
  std::set<std::string> known;
  for (const NavSource& source : log.sources()) known.insert(source.name);
  for (const auto& [name, mount] : body_from_source) {
    if (known.contains(name)) continue;
    return fail(Error::Code::kBadOption,
                fmt::format("a mount of '{}': the sources of the navigation are {}", name, fmt::join(known, ", ")));
  }
  return {};
}

std::optional<HeadingSource> best_heading(const NavLog& log, const std::map<std::string, Pose>& body_from_source,
                                          const NavSource* velocity) {
  std::optional<HeadingSource> best;
  for (const NavSource* source : covering_sources(log, kHeadingQuantities, velocity)) {
    auto heading = heading_source(*source, mount_of(body_from_source, source->name));
    if (heading && (!best || heading->samples() > best->samples())) best = *std::move(heading);
  }
  return best;
}

std::optional<VelocitySource> velocity_source(const NavSource& source, const Pose& body_from_source,
                                              const OutlierWindow& window) {
  const std::vector<NavSample> samples = usable(source);
  if (samples.size() < 2) return std::nullopt;
  std::vector<bool> outliers(samples.size(), false);
  std::array<std::vector<double>, 2> axes;  // in the frame of the device, whose noise it is
  for (std::size_t axis = 0; axis < 2; ++axis) {
    std::vector<double> values;
    for (const NavSample& sample : samples) values.push_back(sample.value[static_cast<Eigen::Index>(axis)]);
    axes[axis] = clip(values, window, outliers);
  }
  std::vector<double> times_s = times_of(samples);
  std::vector<double> density = noise_density(times_s, axes[0], axes[1]);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Eigen::Vector3d turned =
        body_from_source.rotation() * Eigen::Vector3d(axes[0][i], axes[1][i], samples[i].value.z());
    axes[0][i] = turned.x();
    axes[1][i] = turned.y();
  }
  return VelocitySource{source.name, TimeSeries(times_s, std::move(axes[0])), TimeSeries(times_s, std::move(axes[1])),
                        TimeSeries(times_s, std::move(density)),
                        static_cast<std::size_t>(std::ranges::count(outliers, true))};
}

std::optional<TimeSeries> number_source(const NavSource& source) {
  const std::vector<NavSample> samples = usable(source);
  if (samples.empty()) return std::nullopt;
  std::vector<double> values(samples.size());
  std::ranges::transform(samples, values.begin(), [](const NavSample& sample) { return sample.value.x(); });
  return TimeSeries(times_of(samples), std::move(values));
}

}  // namespace pingvox
