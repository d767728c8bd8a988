#include "evaluation_text.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/words.hpp"
#include "map_report.hpp"
#include "pingvox/geometry/degree.hpp"
#include "stopwatch.hpp"

namespace pingvox::app {
namespace {

double percent(std::size_t part, std::size_t all) {
  return all == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(all);
}

/// Whether the head did not move: by assumption, or by its path.
bool is_still(const SweepCoverage& sweeps) {
  return sweeps.moved_m == 0.0 && sweeps.turned_rad == 0.0;
}

/// "92 % of the places were seen in one sweep only, one sweep takes 90 s while the vehicle moves 17 m"
std::string why_not_judged(const Evaluation& evaluation) {
  const SweepCoverage& sweeps = evaluation.sweeps;
  if (sweeps.echoes == 0) return "there are no echoes";
  const std::string movement =
      is_still(sweeps) ? fmt::format("takes {:.3g} s, and the vehicle is assumed not to move", sweeps.sweep_s)
                       : fmt::format("takes {:.3g} s while the vehicle moves {:.2g} m", sweeps.sweep_s, sweeps.moved_m);
  if (sweeps.sweeps < 2) {
    return fmt::format("there is one sweep only, and no other to compare with; it {}", movement);
  }
  const EchoCounts& all = evaluation.all;
  // So many of them can be judged that there are too few in all.
  if (2 * all.judged >= all.echoes)
    return fmt::format("only {} can be judged, too few for a verdict", counted(all.judged, "echo"));
  constexpr double kHalf = 50.0;
  if (const double once = percent(sweeps.places_heard_once, sweeps.places); once >= kHalf) {
    return fmt::format("{:.0f} % of the places were seen in one sweep only, one sweep {}", once, movement);
  }
  return fmt::format("only {} of {} are from places known to a map of the other sweeps, one sweep {}", all.judged,
                     counted(all.echoes, "echo"), movement);
}

/// The main reason why many echoes are not predicted; empty: few are not.
std::string why_low(const Evaluation& evaluation) {
  constexpr double kHalf = 50.0;
  const EchoCounts& all = evaluation.all;
  if (percent(all.predicted, all.judged) >= kHalf) return {};
  const bool are_early = all.too_early > all.from_free;
  std::string text =
      fmt::format("; {:.0f} % {}", percent(are_early ? all.too_early : all.from_free, all.judged),
                  are_early ? "come from behind occupied cells: walls are thick, or there are false objects"
                            : "come from where the map is free");
  if (is_still(evaluation.sweeps)) {
    text += "; did the vehicle move (--nav, --poses)?";
  } else if (!are_early) {
    text += ": are path, mount and clock right?";
  }
  return text;
}

/// What makes a head hear each place more often.
std::string what_would_help(const SweepCoverage& sweeps) {
  constexpr double kMuchOfSweep = 0.2;
  const double all_s = sweeps.sweep_s * static_cast<double>(sweeps.sweeps);
  std::string text = "a slower vehicle, a shorter range or a narrower sector of the head";
  if (sweeps.pauses.total_s < kMuchOfSweep * all_s) return text;
  const double without_s = sweeps.sweep_s * std::max(0.0, 1.0 - sweeps.pauses.total_s / all_s);
  return fmt::format("a head without pauses (it made {}; without them a sweep takes {:.3g} s), {}",
                     pauses_text(sweeps.pauses), without_s, text);
}

}  // namespace

std::string verdict_text(const Evaluation& evaluation) {
  if (!evaluation.is_judged()) return "cannot be judged: " + why_not_judged(evaluation);
  const EchoCounts& all = evaluation.all;
  return fmt::format("predicts {:.0f} % of the echoes it can judge ({:.0f} % of all) within {:.6g} m{}",
                     percent(all.predicted, all.judged), percent(all.predicted, all.echoes), evaluation.tolerance_m,
                     why_low(evaluation));
}

std::string movement_text(const SweepCoverage& sweeps) {
  if (is_still(sweeps)) {
    return fmt::format("{} of {:.3g} s (median); the vehicle does not move, or its path is unknown",
                       counted(sweeps.sweeps, "sweep"), sweeps.sweep_s);
  }
  return fmt::format("{} of {:.3g} s, in which the vehicle moves {:.2g} m and turns by {:.3g} degrees (medians)",
                     counted(sweeps.sweeps, "sweep"), sweeps.sweep_s, sweeps.moved_m, sweeps.turned_rad / kDegree_rad);
}

std::string pauses_text(const BeamPauses& pauses) {
  return fmt::format("{} of {:.3g} s (median), {:.3g} s in all", pauses.count, pauses.median_s, pauses.total_s);
}

JsonObject pauses_json(const BeamPauses& pauses) {
  JsonObject json;
  return json.add("count", pauses.count)
      .add("total_s", round_to_us(pauses.total_s))
      .add("longest_s", round_to_us(pauses.longest_s));
}

std::string places_text(const SweepCoverage& sweeps) {
  return fmt::format("{}, seen in {:.3g} {} each (median), {:.1f} % in one only", sweeps.places,
                     sweeps.sweeps_per_place, sweeps.sweeps_per_place == 1.0 ? "sweep" : "sweeps",
                     percent(sweeps.places_heard_once, sweeps.places));
}

JsonObject coverage_json(const SweepCoverage& sweeps) {
  JsonObject json;
  return json.add("coverage", sweeps.share_heard_again())
      .add("places", sweeps.places)
      .add("places_in_one_sweep", sweeps.places_heard_once)
      .add("sweeps_per_place", sweeps.sweeps_per_place)
      .add("sweeps", sweeps.sweeps)
      .add("sweep_s", sweeps.sweep_s)
      .add("moved_m", sweeps.moved_m)
      .add("turned_deg", rounded_degrees(sweeps.turned_rad))
      .add("beam_width_m", sweeps.beam_width_m)
      .add("pauses", pauses_json(sweeps.pauses))
      .add("warnings", coverage_warnings(sweeps));
}

std::vector<std::string> coverage_warnings(const SweepCoverage& sweeps) {
  constexpr std::size_t kFewBeams = 100;
  constexpr double kFewEchoes = 10.0, kManyHeardOnce = 75.0;
  std::vector<std::string> warnings;
  if (const double echoes = percent(sweeps.echoes, sweeps.beams); sweeps.beams >= kFewBeams && echoes < kFewEchoes) {
    warnings.push_back(
        fmt::format("only {:.1f} % of the beams have an echo, so the map is mostly empty (see --threshold, --min-range "
                    "and --max-range)",
                    echoes));
  }
  const double once = percent(sweeps.places_heard_once, sweeps.places);
  if (once >= kManyHeardOnce && sweeps.moved_m > sweeps.beam_width_m && sweeps.beam_width_m > 0.0) {
    warnings.push_back(
        fmt::format("the map cannot be sharp: one sweep takes {:.3g} s while the vehicle moves {:.2g} m, and {:.0f} % "
                    "of the places were seen in one sweep only, so errors of the poses smear it; {} would help",
                    sweeps.sweep_s, sweeps.moved_m, once, what_would_help(sweeps)));
  }
  return warnings;
}

}  // namespace pingvox::app
