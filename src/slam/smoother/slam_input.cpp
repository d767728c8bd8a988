#include "slam/smoother/slam_input.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "pingvox/geometry/pose2.hpp"
#include "slam/odometry/sonar_odometry.hpp"

namespace pingvox {
namespace {

/// The time that is common to all that is needed.
Result<TimeSpan> common_span(std::span<const double> beam_times_s, const Navigation& navigation) {
  const TimeSpan beams{beam_times_s.front(), beam_times_s.back()};
  TimeSpan span = beams;
  const auto cut = [&](const TimeSeries& series, const std::string& what) -> Result<void> {
    if (!overlap(span, series)) return no_overlap(beams, series, what);
    span = {std::max(span.from_s, series.from_s()), std::min(span.to_s, series.to_s())};
    return {};
  };
  if (const auto done = cut(navigation.velocity.ahead, "velocity of " + navigation.velocity.name); !done) {
    return tl::unexpected(done.error());
  }
  const HeadingSource& main = navigation.headings.front();
  if (const auto done = cut(main.yaw_rad, "heading of " + main.name); !done) return tl::unexpected(done.error());
  return span;
}

}  // namespace

Eigen::Vector3d place_of_velocity(const VelocitySource& velocity, const SlamOptions& options) {
  if (velocity.by_sonar) return Eigen::Vector3d::Zero();
  return mount_of(options.body_from_source, velocity.name).translation();
}

Pose2 velocity_from_sonar(const VelocitySource& velocity, const SlamOptions& options) {
  const Eigen::Translation3d source_from_body(-place_of_velocity(velocity, options));
  return pose2_of(Pose(source_from_body) * options.body_from_sonar);
}

NavSource& source_in(std::vector<NavSource>& sources, std::string_view name, NavQuantity quantity) {
  const auto known =
      std::ranges::find_if(sources, [&](const NavSource& s) { return s.quantity == quantity && s.name == name; });
  return known != sources.end() ? *known : sources.emplace_back(NavSource{std::string(name), quantity, {}});
}

Result<void> add_sample(std::string_view source, NavQuantity quantity, const NavSample& sample, double offset_s,
                        std::vector<NavSource>& sources) {
  if (!std::isfinite(sample.time_s) || !sample.value.allFinite()) {
    return fail(Error::Code::kCorrupt,
                fmt::format("{} of {}: a sample has a number that is not finite", name_of(quantity), source));
  }
  NavSource& to = source_in(sources, source, quantity);
  NavSample added = sample;
  added.time_s += offset_s;
  // A late one goes to its place.
  const auto place = std::ranges::upper_bound(to.samples, added.time_s, {}, &NavSample::time_s);
  to.samples.insert(place, added);
  return {};
}

std::optional<VelocitySource> velocity_of(const NavLog& log, const SlamOptions& options, const OutlierWindow& window) {
  const NavSource* fastest = log.best(NavQuantity::kVelocity);
  if (fastest == nullptr) return std::nullopt;
  return velocity_source(*fastest, mount_of(options.body_from_source, fastest->name), window);
}

std::vector<HeadingSource> headings_of(const NavLog& log, const SlamOptions& options, const NavSource* by_sonar) {
  std::vector<HeadingSource> headings, turns;
  if (auto heading = by_sonar != nullptr ? heading_source(*by_sonar, Pose::Identity()) : std::nullopt) {
    heading->drifts = heading->by_sonar = true;
    headings.push_back(*std::move(heading));
  }
  for (const NavSource& source : log.sources()) {
    if (source.subject == NavSubject::kOther || !is_usable(source)) continue;
    const Pose mount = mount_of(options.body_from_source, source.name);
    if (source.quantity == NavQuantity::kHeading || source.quantity == NavQuantity::kAttitude) {
      if (auto heading = heading_source(source, mount)) headings.push_back(*std::move(heading));
    } else if (source.quantity == NavQuantity::kTurnRate) {
      if (auto heading = turned_heading(source, mount)) turns.push_back(*std::move(heading));
    }
  }
  if (headings.empty()) headings = std::move(turns);
  std::ranges::sort(headings, [](const HeadingSource& a, const HeadingSource& b) {
    return std::tuple(b.samples(), a.name) < std::tuple(a.samples(), b.name);
  });
  return headings;
}

Result<Navigation> navigation_of(MotionSources sources, const SlamOptions& options, const OutlierWindow& window) {
  const Result<NavLog> made = NavLog::make(std::move(sources.measured), NavClock::kUnknown);
  if (!made) return tl::unexpected(made.error());
  const NavLog& log = *made;
  if (const auto known = check_mounts(log, options.body_from_source); !known) return tl::unexpected(known.error());
  const std::optional<SonarSources>& by_sonar = sources.by_sonar;
  std::optional<VelocitySource> velocity =
      by_sonar ? sonar_velocity(by_sonar->velocity) : velocity_of(log, options, window);
  std::vector<HeadingSource> headings =
      headings_of(log, options, by_sonar && by_sonar->heading ? &*by_sonar->heading : nullptr);
  if (!velocity || headings.empty()) {
    if (const auto checked = check_sources(log, kReckoningQuantities); !checked) return tl::unexpected(checked.error());
    return fail(Error::Code::kUnsupported,
                fmt::format("the navigation has no valid {}", !velocity && headings.empty() ? "velocity and no heading"
                                                              : !velocity                   ? "velocity over ground"
                                                                                            : "heading or attitude"));
  }
  if (options.calibration && options.calibration->velocity != velocity->name) {
    return fail(Error::Code::kBadOption, fmt::format("the calibration is of the velocity of {}, not of {}",
                                                     options.calibration->velocity, velocity->name));
  }
  Navigation navigation{*std::move(velocity), std::move(headings), std::nullopt};
  if (const auto depth = depth_source(log)) {
    if (const auto checked = check_source(*depth); !checked) return tl::unexpected(checked.error());
    navigation.depth = number_source(*depth);
  }
  return navigation;
}

bool overlap(const TimeSpan& span, const TimeSeries& series) {
  return series.from_s() < span.to_s && series.to_s() > span.from_s;
}

Result<void> check_headings(std::span<const HeadingSource> headings, std::span<const double> beam_times_s) {
  // Over a longer time the turns of a vehicle are no more than a guess.
  constexpr double kLongest_s = 30.0;
  const TimeSeries& main = headings.front().yaw_rad;
  for (const TimeSpan& gap : main.gaps(main.from_s(), main.to_s())) {
    const bool is_known = std::ranges::any_of(headings, [&](const HeadingSource& heading) {
      return heading.yaw_rad.gap_s(gap.from_s, gap.to_s) <= kLongest_s;
    });
    const auto beams =
        std::ranges::upper_bound(beam_times_s, gap.to_s) - std::ranges::lower_bound(beam_times_s, gap.from_s);
    if (is_known || beams == 0) continue;
    return fail(
        Error::Code::kUnsupported,
        fmt::format("no heading is known from {:.3f} to {:.3f} s, where there are {} beams: did the clock of {} "
                    "jump?",
                    gap.from_s, gap.to_s, beams, headings.front().name));
  }
  return {};
}

tl::unexpected<Error> no_overlap(const TimeSpan& beams, const TimeSeries& series, const std::string& what) {
  return fail(Error::Code::kUnsupported,
              fmt::format("beams and navigation do not overlap in time: the beams are from {:.3f} to {:.3f} s, the "
                          "{} is from {:.3f} to {:.3f} s",
                          beams.from_s, beams.to_s, what, series.from_s(), series.to_s()));
}

Result<SlamInput> slam_input_of(std::span<const double> beam_times_s, std::span<const SweepEchoes> sweeps,
                                Navigation navigation) {
  const Result<TimeSpan> span = common_span(beam_times_s, navigation);
  if (!span) return tl::unexpected(span.error());
  return SlamInput{beam_times_s, sweeps, std::move(navigation), *span};
}

Result<SlamInput> slam_input_of(std::span<const double> beam_times_s, std::span<const SweepEchoes> sweeps,
                                MotionSources sources, const SlamOptions& options) {
  Result<Navigation> navigation = navigation_of(std::move(sources), options);
  if (!navigation) return tl::unexpected(navigation.error());
  return slam_input_of(beam_times_s, sweeps, *std::move(navigation));
}

Result<std::vector<double>> knot_times(const TimeSpan& span, std::span<const SweepEchoes> sweeps, std::size_t beams) {
  const double step_s = sweep_duration_s(sweeps) / kKnotsOfSweep;
  if (!(step_s > 0.0)) return fail(Error::Code::kUnsupported, "all beams have the same time");
  const double steps = std::max(1.0, std::ceil((span.to_s - span.from_s) / step_s));
  if (!(steps <= static_cast<double>(beams) + kKnotsOfSweep)) {
    return fail(Error::Code::kCorrupt,
                fmt::format("{} beams over {:.6g} s: their times jump", beams, span.to_s - span.from_s));
  }
  std::vector<double> times_s;
  for (double i = 0.0; i < steps; i += 1.0) times_s.push_back(span.from_s + (span.to_s - span.from_s) * i / steps);
  times_s.push_back(span.to_s);
  return times_s;
}

SlamSolver solver_of(SlamProblem problem, const SlamInput& recording, const SlamOptions& options, Unknowns start,
                     Before before) {
  const Pose2 mount = velocity_from_sonar(recording.navigation.velocity, options);
  return SlamSolver(std::move(problem), mount, recording.sweeps, options.seed, std::move(start), std::move(before));
}

}  // namespace pingvox
