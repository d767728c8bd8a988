#include "pingvox/nav/main_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "nav/internal/nav_frames.hpp"
#include "nav/internal/source_names.hpp"
#include "pingvox/nav/time_span.hpp"

namespace pingvox {
namespace {

/// The estimates that an ArduPilot vehicle itself steers by, in its telemetry and in its own log.
constexpr std::array<std::string_view, 4> kMainEstimates = {"ATTITUDE", "ATT", "LOCAL_POSITION_NED",
                                                            "GLOBAL_POSITION_INT"};

/// A source that is known for less than this share of the longest time does not cover the log.
constexpr double kCovers = 0.5;
/// One that is known for more is as good as the one that is known longest.
constexpr double kCoversAll = 0.9;

/// When a source is known: between valid samples, but for its gaps.
std::vector<TimeSpan> stretches_of(const NavSource& source) {
  const double longest_step_s = summary_of(source).longest_step_s;
  std::vector<TimeSpan> stretches;
  for (const NavSample& sample : source.samples) {
    if (!sample.valid) continue;
    if (stretches.empty() || sample.time_s - stretches.back().to_s > longest_step_s) {
      stretches.push_back({sample.time_s, sample.time_s});
    }
    stretches.back().to_s = sample.time_s;
  }
  return stretches;
}

/// Puts together stretches that overlap.
std::vector<TimeSpan> united(std::vector<TimeSpan> stretches) {
  std::ranges::sort(stretches, {}, &TimeSpan::from_s);
  std::vector<TimeSpan> all;
  for (const TimeSpan& next : stretches) {
    if (all.empty() || next.from_s > all.back().to_s) all.push_back(next);
    all.back().to_s = std::max(all.back().to_s, next.to_s);
  }
  return all;
}

/// Seconds in which both are known; a little for a single time.
double common_s(const std::vector<TimeSpan>& a, const std::vector<TimeSpan>& b) {
  constexpr double kTouch_s = 1e-6;
  double sum_s = 0.0;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    const double from_s = std::max(a[i].from_s, b[j].from_s), to_s = std::min(a[i].to_s, b[j].to_s);
    if (from_s <= to_s) sum_s += to_s - from_s + kTouch_s;
    a[i].to_s < b[j].to_s ? ++i : ++j;
  }
  return sum_s;
}

/// Outliers are no reason to prefer another source.
std::size_t valid_samples_of(const NavSource& source) {
  return static_cast<std::size_t>(std::ranges::count(source.samples, true, &NavSample::valid)) + few_left_out(source);
}

bool never_changes(const NavSource& source) {
  return std::ranges::all_of(source.samples,
                             [&](const NavSample& sample) { return sample.value == source.samples.front().value; });
}

bool is_zero_throughout(const NavSource& source) {
  return std::ranges::all_of(source.samples, [](const NavSample& sample) { return sample.value.isZero(0.0); });
}

/// Yaw alone, that turns.
bool is_bearing(const NavSource& attitude) {
  constexpr double kLevel_rad = 1e-6;
  return !never_changes(attitude) && std::ranges::all_of(attitude.samples, [](const NavSample& sample) {
    return sample.value.head<2>().cwiseAbs().maxCoeff() <= kLevel_rad;
  });
}

bool is_candidate(const NavSource& source) {
  return source.subject != NavSubject::kOther && is_usable(source);
}

/// How well a source is suited, by what it is; less is better. What never changes its place may be no more than the
/// attitude of something.
int class_of(const NavSource& source) {
  enum : int { kVehicles, kOfTf, kInFixedFrame, kOfPart, kFixes, kStill, kElsewhere };
  if (is_of_vehicle(source.subject)) {
    if (source.quantity == NavQuantity::kFix) return kFixes;
    return is_on_vehicle(source.child) && !is_vehicle_frame(source.child) ? kOfPart : kVehicles;
  }
  const bool is_of_tf = source.subject == NavSubject::kTransforms;
  if (!is_of_tf && !is_fixed_frame(source.frame)) return kElsewhere;
  if (source.quantity == NavQuantity::kPosition && never_changes(source)) return kStill;
  return is_of_tf ? kOfTf : kInFixedFrame;
}

struct Candidate {
  const NavSource* source;
  std::vector<TimeSpan> known;
  double known_s = 0.0;  ///< alone, or together with others
};

std::vector<Candidate> candidates_in(const NavLog& log, std::span<const NavQuantity> quantities) {
  std::vector<Candidate> candidates;
  for (const NavSource& source : log.sources()) {
    if (std::ranges::find(quantities, source.quantity) == quantities.end() || !is_candidate(source)) continue;
    candidates.push_back({&source, stretches_of(source)});
    candidates.back().known_s = common_s(candidates.back().known, candidates.back().known);
  }
  return candidates;
}

double longest_of(const std::vector<Candidate>& candidates) {
  double longest_s = 0.0;
  for (const Candidate& candidate : candidates) longest_s = std::max(longest_s, candidate.known_s);
  return longest_s;
}

/// Less is better, whatever order the sources have.
auto in_doubt(const NavSource& source) {
  return std::tuple(-static_cast<std::ptrdiff_t>(valid_samples_of(source)), source.samples.front().time_s,
                    std::string_view(source.name));
}

/// Of those that cover the log. @param rank  of a candidate and whether it covers all; less is better
template <class Rank>
const NavSource* first_of(const std::vector<Candidate>& candidates, Rank rank) {
  const double longest_s = longest_of(candidates);
  const auto key = [&](const Candidate& candidate) {
    const bool covers = candidate.known_s >= kCovers * longest_s;
    return std::tuple_cat(std::tuple(!covers), rank(candidate, candidate.known_s >= kCoversAll * longest_s),
                          in_doubt(*candidate.source));
  };
  const auto first = std::ranges::min_element(candidates, {}, key);
  return first == candidates.end() ? nullptr : first->source;
}

bool is_main_estimate(const NavSource& source) {
  return std::ranges::find(kMainEstimates, source.name) != kMainEstimates.end();
}

/// Quantities that stand for each other.
NavQuantity group_of(NavQuantity quantity) {
  if (quantity == NavQuantity::kFix) return NavQuantity::kPosition;
  if (quantity == NavQuantity::kHeading) return NavQuantity::kAttitude;
  return quantity == NavQuantity::kPressure ? NavQuantity::kDepth : quantity;
}

bool is_named(const NavSource& source, const NamedSource& named) {
  return source.name == named.name && (!named.quantity || *named.quantity == source.quantity);
}

tl::unexpected<Error> no_such_source(const NavLog& log, const NamedSource& named) {
  std::map<std::string, std::string> quantities;  // of each name
  for (const NavSource& source : log.sources()) {
    std::string& text = quantities[source.name];
    text += fmt::format("{}{}", text.empty() ? "" : ", ", name_of(source.quantity));
  }
  std::vector<std::string> names;
  for (const auto& [name, text] : quantities) names.push_back(fmt::format("{} ({})", name, text));
  return fail(Error::Code::kBadOption,
              fmt::format("there is no source '{}'{}, but {}", named.name,
                          named.quantity ? fmt::format(" of {}", name_of(*named.quantity)) : std::string(),
                          names.empty() ? "none at all" : fmt::format("{}", fmt::join(names, ", "))));
}

}  // namespace

void judge_subjects(std::vector<NavSource>& sources) {
  std::set<std::string_view> positions;
  for (const NavSource& source : sources) {
    if (source.quantity == NavQuantity::kPosition) positions.insert(source.name);
  }
  for (NavSource& source : sources) {
    if (source.subject == NavSubject::kChosen || source.subject == NavSubject::kOther) continue;
    const std::string_view reason = other_by_name(source, !positions.contains(source.name));
    if (reason.empty()) continue;
    source.subject = NavSubject::kOther;
    source.note = reason;
  }
  std::map<std::string_view, const NavSource*> places;
  for (const NavSource& source : sources) {
    if (source.subject == NavSubject::kUncertain && source.quantity == NavQuantity::kPosition) {
      places[source.name] = &source;
    }
  }
  std::set<const NavSource*> bearings;
  for (const NavSource& source : sources) {
    if (source.subject != NavSubject::kUncertain || source.quantity != NavQuantity::kAttitude) continue;
    const auto place = places.find(source.name);
    if (place != places.end() && is_zero_throughout(*place->second) && is_bearing(source)) {
      bearings.insert({&source, place->second});
    }
  }
  for (NavSource& source : sources) {
    if (source.subject == NavSubject::kChosen || source.subject == NavSubject::kOther) continue;
    const std::string reason =
        bearings.contains(&source) ? "a heading without a place, as of a head" : reason_against_frames(source);
    if (reason.empty()) continue;
    source.subject = NavSubject::kOther;
    source.note = reason;
  }
}

const NavSource* main_source(const NavLog& log, NavQuantity quantity) {
  return first_of(candidates_in(log, std::array{quantity}), [](const Candidate&, bool) { return std::tuple(); });
}

PathSources path_sources(const NavLog& log) {
  constexpr std::array kPlaces = {NavQuantity::kPosition, NavQuantity::kFix};
  std::vector<Candidate> positions = candidates_in(log, kPlaces);
  std::vector<Candidate> attitudes = candidates_in(log, std::array{NavQuantity::kAttitude});
  if (!attitudes.empty()) {
    std::vector<TimeSpan> turns;
    for (const Candidate& attitude : attitudes) std::ranges::copy(attitude.known, std::back_inserter(turns));
    turns = united(std::move(turns));
    for (Candidate& position : positions) position.known_s = common_s(position.known, turns);
  }
  PathSources path;
  path.position = first_of(positions, [](const Candidate& candidate, bool covers_all) {
    const NavSource& source = *candidate.source;
    return std::tuple(class_of(source), !covers_all, !is_main_estimate(source));
  });
  if (path.position == nullptr) {
    path.attitude = main_source(log, NavQuantity::kAttitude);
    return path;
  }
  const std::vector<TimeSpan> places = stretches_of(*path.position);
  for (Candidate& attitude : attitudes) attitude.known_s = common_s(attitude.known, places);
  // A source of both has them in one frame, which need not be that of others.
  path.attitude = first_of(attitudes, [&](const Candidate& candidate, bool covers_all) {
    const NavSource& source = *candidate.source;
    return std::tuple(source.name != path.position->name, class_of(source), !covers_all, !is_main_estimate(source));
  });
  return path;
}

std::vector<const NavSource*> covering_sources(const NavLog& log, std::span<const NavQuantity> quantities,
                                               const NavSource* other) {
  std::vector<Candidate> candidates = candidates_in(log, quantities);
  if (other != nullptr) {
    const std::vector<TimeSpan> known = stretches_of(*other);
    for (Candidate& candidate : candidates) candidate.known_s = common_s(candidate.known, known);
  }
  const double longest_s = longest_of(candidates);
  std::vector<const NavSource*> covering;
  for (const Candidate& candidate : candidates) {
    if (candidate.known_s >= kCovers * longest_s) covering.push_back(candidate.source);
  }
  std::ranges::sort(covering, {}, [](const NavSource* source) { return in_doubt(*source); });
  return covering;
}

Result<NavLog> sources_between(const NavLog& log, double from_s, double to_s) {
  const std::vector<TimeSpan> wanted = {{from_s, to_s}};
  std::vector<NavSource> sources = log.sources();
  std::vector<double> known_s(sources.size(), 0.0);
  std::map<NavQuantity, double> longest_s;  // of each group
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (!is_candidate(sources[i])) continue;
    known_s[i] = common_s(stretches_of(sources[i]), wanted);
    double& longest = longest_s[group_of(sources[i].quantity)];
    longest = std::max(longest, known_s[i]);
  }
  for (std::size_t i = 0; i < sources.size(); ++i) {
    NavSource& source = sources[i];
    // What is wrong with a source is said, however long it is known.
    if (source.subject == NavSubject::kOther || !source.fault.empty()) continue;
    if (known_s[i] >= kCovers * longest_s[group_of(source.quantity)]) continue;
    source.subject = NavSubject::kOther;
    source.note = "not known for most of the sonar's log";
  }
  return NavLog::make(std::move(sources), log.clock());
}

Result<NavLog> choose_sources(const NavLog& log, std::span<const NamedSource> named) {
  std::vector<NavSource> sources = log.sources();
  std::vector<NavQuantity> groups;
  for (const NamedSource& one : named) {
    bool is_there = false;
    for (const NavSource& source : sources) {
      if (!is_named(source, one)) continue;
      is_there = true;
      groups.push_back(group_of(source.quantity));
    }
    if (!is_there) return no_such_source(log, one);
  }
  for (NavSource& source : sources) {
    if (std::ranges::find(groups, group_of(source.quantity)) == groups.end()) continue;
    const bool is_chosen = std::ranges::any_of(named, [&](const NamedSource& one) { return is_named(source, one); });
    source.subject = is_chosen ? NavSubject::kChosen : NavSubject::kOther;
    source.doubt.clear();
  }
  return NavLog::make(std::move(sources), log.clock());
}

}  // namespace pingvox
