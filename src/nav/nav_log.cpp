#include "pingvox/nav/nav_log.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "base/median.hpp"
#include "nav/depth_checks.hpp"
#include "nav/plausible_values.hpp"
#include "nav/source_steps.hpp"
#include "nav/time_checks.hpp"
#include "nav/turn_checks.hpp"
#include "nav/water_column.hpp"
#include "pingvox/nav/main_source.hpp"

namespace pingvox {
namespace {

constexpr std::array kNames = {std::pair{NavQuantity::kVelocity, std::string_view("velocity")},
                               std::pair{NavQuantity::kAttitude, std::string_view("attitude")},
                               std::pair{NavQuantity::kHeading, std::string_view("heading")},
                               std::pair{NavQuantity::kTurnRate, std::string_view("turn rate")},
                               std::pair{NavQuantity::kDepth, std::string_view("depth")},
                               std::pair{NavQuantity::kPosition, std::string_view("position")},
                               std::pair{NavQuantity::kFix, std::string_view("fix")},
                               std::pair{NavQuantity::kRange, std::string_view("range")},
                               std::pair{NavQuantity::kPressure, std::string_view("pressure")},
                               std::pair{NavQuantity::kTemperature, std::string_view("temperature")}};

std::size_t valid_samples(const NavSource& source) {
  return static_cast<std::size_t>(
      std::count_if(source.samples.begin(), source.samples.end(), [](const NavSample& s) { return s.valid; }));
}

/// Median of the first number of all valid samples.
std::optional<double> usual_value(const NavSource& source) {
  std::vector<double> values;
  for (const NavSample& sample : source.samples) {
    if (sample.valid) values.push_back(sample.value.x());
  }
  if (values.empty()) return std::nullopt;
  return median(std::move(values));
}

/// Samples of one time stay in their order. (std::stable_sort uses what libstdc++ itself has deprecated.)
void sort_by_time(std::vector<NavSample>& samples) {
  if (std::ranges::is_sorted(samples, {}, &NavSample::time_s)) return;
  std::vector<std::size_t> order(samples.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return std::pair(samples[i].time_s, i); });
  std::vector<NavSample> sorted;
  sorted.reserve(samples.size());
  for (const std::size_t i : order) sorted.push_back(samples[i]);
  samples = std::move(sorted);
}

}  // namespace

std::string_view name_of(NavQuantity quantity) {
  for (const auto& [known, name] : kNames) {
    if (known == quantity) return name;
  }
  assert(false);
  return {};
}

std::optional<NavQuantity> nav_quantity_of(std::string_view name) {
  for (const auto& [quantity, known] : kNames) {
    if (known == name) return quantity;
  }
  return std::nullopt;
}

int numbers_of(NavQuantity quantity) {
  switch (quantity) {
    case NavQuantity::kHeading:
    case NavQuantity::kDepth:
    case NavQuantity::kRange:
    case NavQuantity::kPressure:
    case NavQuantity::kTemperature:
      return 1;
    default:
      return 3;
  }
}

std::string_view name_of(NavClock clock) {
  switch (clock) {
    case NavClock::kUnix:
      return "unix";
    case NavClock::kBoot:
      return "boot";
    case NavClock::kUnknown:
      break;
  }
  return "unknown";
}

namespace {

/// Notes samples that are late, and a clock that was set back.
void put_in_order(NavSource& source) {
  if (std::ranges::is_sorted(source.samples, {}, &NavSample::time_s)) return;
  TimeOrder order;
  for (const NavSample& sample : source.samples) order.add(sample.time_s);
  source.late += order.late();
  if (const auto step = order.step_back()) source.step_back = step;
  sort_by_time(source.samples);
}

}  // namespace

Result<NavLog> NavLog::make(std::vector<NavSource> sources, NavClock clock) {
  std::erase_if(sources, [](const NavSource& source) { return source.samples.empty(); });
  judge_subjects(sources);
  for (NavSource& source : sources) {
    for (std::size_t i = 0; i < source.samples.size(); ++i) {
      const NavSample& sample = source.samples[i];
      if (std::isfinite(sample.time_s) && sample.value.allFinite()) continue;
      return fail(Error::Code::kCorrupt, fmt::format("{} of {}: sample {} has a number that is not finite",
                                                     name_of(source.quantity), source.name, i));
    }
    put_in_order(source);
    check_values(source);
    check_times(source);
  }
  compare_turns(sources);
  compare_depths(sources);
  leave_out_other_frames(sources);
  return NavLog(std::move(sources), clock);
}

void add_samples(const NavSource& from, NavSource& to) {
  to.samples.insert(to.samples.end(), from.samples.begin(), from.samples.end());
  restore_other_frames(to);
  sort_by_time(to.samples);
  to.late += from.late;
  if (!to.step_back) to.step_back = from.step_back;
  if (to.fault.empty()) to.fault = from.fault;
  if (to.doubt.empty()) to.doubt = from.doubt;
  if (to.note.empty()) to.note = from.note;
}

std::size_t few_left_out(const NavSource& source) {
  constexpr std::size_t kOfSamples = 20;
  const auto left_out =
      static_cast<std::size_t>(std::ranges::count(source.samples, true, &NavSample::is_in_other_frame));
  return left_out * kOfSamples <= source.samples.size() ? left_out : 0;
}

void shift_times(NavSource& source, double offset_s) {
  for (NavSample& sample : source.samples) sample.time_s += offset_s;
  if (source.step_back) {
    source.step_back->from_s += offset_s;
    source.step_back->to_s += offset_s;
  }
  for (SourceStep& step : source.steps) {
    for (double* const time_s : {&step.from_s, &step.to_s, &step.left_from_s, &step.left_to_s}) *time_s += offset_s;
  }
}

bool is_usable(const NavSource& source) {
  return source.fault.empty() && std::ranges::any_of(source.samples, &NavSample::valid);
}

namespace {

Result<void> check_clock(const NavSource& source) {
  if (!source.step_back) return {};
  const auto& [from_s, to_s, late] = *source.step_back;
  return fail(Error::Code::kCorrupt,
              fmt::format("the clock of {} of {} runs back by {:.3f} s, from {:.3f} to {:.3f} s: which of its times "
                          "are right is ambiguous: cut the log there",
                          name_of(source.quantity), source.name, from_s - to_s, from_s, to_s));
}

/// Whether it may be used if it has samples.
bool is_taken(const NavSource& source) {
  return source.subject != NavSubject::kOther && source.fault.empty();
}

std::string fault_text(const NavSource& source) {
  return fmt::format("the {} of {} cannot be used: {}", name_of(source.quantity), source.name, source.fault);
}

bool is_one_of(NavQuantity quantity, std::span<const NavQuantity> quantities) {
  return std::ranges::find(quantities, quantity) != quantities.end();
}

/// Whether a usable source of these quantities tells the same as one with a fault.
bool has_another(const NavLog& log, NavQuantity quantity, std::span<const NavQuantity> quantities) {
  const bool is_turn = quantity == NavQuantity::kTurnRate || is_one_of(quantity, kHeadingQuantities);
  return std::ranges::any_of(log.sources(), [&](const NavSource& source) {
    const bool gives_turns = is_turn && is_one_of(source.quantity, kHeadingQuantities);
    return is_one_of(source.quantity, quantities) && (source.quantity == quantity || gives_turns) && is_taken(source) &&
           is_usable(source);
  });
}

}  // namespace

Result<void> check_source(const NavSource& source) {
  if (!source.fault.empty()) return fail(Error::Code::kCorrupt, fault_text(source));
  return check_clock(source);
}

Result<void> check_sources(const NavLog& log, std::span<const NavQuantity> quantities) {
  std::string faults;
  for (const NavSource& source : log.sources()) {
    if (!is_one_of(source.quantity, quantities) || source.subject == NavSubject::kOther) continue;
    if (const auto checked = check_clock(source); !checked) return checked;
    if (source.fault.empty() || has_another(log, source.quantity, quantities)) continue;
    faults += (faults.empty() ? "" : "; ") + fault_text(source);
  }
  if (faults.empty()) return {};
  return fail(Error::Code::kCorrupt, std::move(faults));
}

Result<void> check_sources(const NavLog& log) {
  std::array<NavQuantity, kNames.size()> all{};
  std::ranges::transform(kNames, all.begin(), [](const auto& named) { return named.first; });
  return check_sources(log, all);
}

std::string faults_text(const NavLog& log) {
  std::string text;
  for (const NavSource& source : log.sources()) {
    if (source.fault.empty() || source.subject == NavSubject::kOther) continue;
    text += (text.empty() ? "" : "; ") + fault_text(source);
  }
  return text;
}

std::vector<std::string> doubt_texts(const NavLog& log) {
  std::vector<std::string> texts;
  for (const NavSource& source : log.sources()) {
    if (source.doubt.empty() || !is_taken(source)) continue;
    texts.push_back(fmt::format("{} of {}: {}", name_of(source.quantity), source.name, source.doubt));
  }
  return texts;
}

const NavSource* NavLog::best(NavQuantity quantity) const {
  return main_source(*this, quantity);
}

std::optional<NavSource> depth_source(const NavLog& log) {
  if (const NavSource* depth = log.best(NavQuantity::kDepth)) return *depth;
  const NavSource* chosen = nullptr;
  double highest_pa = kMaxInAir_pa;
  for (const NavSource& source : log.sources()) {
    if (source.quantity != NavQuantity::kPressure || !is_taken(source)) continue;
    for (const NavSample& sample : source.samples) {
      if (!sample.valid || sample.value.x() <= highest_pa) continue;
      highest_pa = sample.value.x();
      chosen = &source;
    }
  }
  if (chosen == nullptr) return std::nullopt;
  NavSource depth = *chosen;
  depth.quantity = NavQuantity::kDepth;
  for (NavSample& sample : depth.samples) {
    sample.value.x() = depth_of_pressure(sample.value.x());
    sample.deviation.x() /= kPascalsPerMetre;
  }
  return depth;
}

std::optional<WaterAround> water_around(const NavLog& log) {
  constexpr double kNone_c = 0.0, kWarmest_c = 35.0;
  std::optional<double> coldest_c;
  for (const NavSource& source : log.sources()) {
    if (source.quantity != NavQuantity::kTemperature || !is_taken(source)) continue;
    const std::optional<double> usual_c = usual_value(source);
    if (!usual_c || *usual_c <= kNone_c || *usual_c > kWarmest_c) continue;
    coldest_c = std::min(*usual_c, coldest_c.value_or(*usual_c));
  }
  if (!coldest_c) return std::nullopt;
  const std::optional<NavSource> depth = depth_source(log);
  const double depth_m = depth ? usual_value(*depth).value_or(0.0) : 0.0;
  return WaterAround{*coldest_c, std::max(depth_m, 0.0)};
}

NavSummary summary_of(const NavSource& source) {
  assert(!source.samples.empty());
  NavSummary summary;
  summary.samples = source.samples.size();
  summary.invalid = summary.samples - valid_samples(source);
  summary.from_s = source.samples.front().time_s;
  summary.to_s = source.samples.back().time_s;
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < source.samples.size(); ++i) {
    const double step_s = source.samples[i].time_s - source.samples[i - 1].time_s;
    // Logs repeat samples, and a repetition is no step.
    if (step_s > 0.0) steps_s.push_back(step_s);
  }
  if (steps_s.empty()) return summary;
  const double usual_s = median(steps_s);
  summary.rate_hz = 1.0 / usual_s;
  summary.longest_step_s = std::max(5.0 * usual_s, 0.5);
  summary.gaps = static_cast<std::size_t>(
      std::count_if(steps_s.begin(), steps_s.end(), [&](double step_s) { return step_s > summary.longest_step_s; }));
  return summary;
}

namespace from_ned {

Eigen::Vector3d body(const Eigen::Vector3d& forward_right_down) {
  return {forward_right_down.x(), -forward_right_down.y(), -forward_right_down.z()};
}

Eigen::Vector3d world(const Eigen::Vector3d& north_east_down) {
  return {north_east_down.y(), north_east_down.x(), -north_east_down.z()};
}

double yaw(double heading_rad) {
  if (!is_possible(NavQuantity::kHeading, {heading_rad, 0.0, 0.0})) return std::numbers::pi / 2.0 - heading_rad;
  const double yaw_rad = std::remainder(std::numbers::pi / 2.0 - heading_rad, 2.0 * std::numbers::pi);
  return yaw_rad > -std::numbers::pi ? yaw_rad : std::numbers::pi;
}

Eigen::Vector3d attitude(const Eigen::Vector3d& roll_pitch_yaw_rad) {
  return {roll_pitch_yaw_rad.x(), -roll_pitch_yaw_rad.y(), yaw(roll_pitch_yaw_rad.z())};
}

}  // namespace from_ned
}  // namespace pingvox
