#include "evaluation_text.hpp"

#include <fmt/format.h>

#include "base/words.hpp"
#include "map_report.hpp"
#include "pingvox/geometry/degree.hpp"

namespace pingvox::app {
namespace {

double percent(std::size_t part, std::size_t all) {
  return all == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(all);
}

/// "92 % of the places were seen in one sweep only, one turn takes 90 s while the vehicle makes 17 m"
std::string why_not_judged(const Evaluation& evaluation) {
  const SweepCoverage& sweeps = evaluation.sweeps;
  if (sweeps.echoes == 0) return "there are no echoes";
  const std::string movement =
      fmt::format("takes {:.3g} s while the vehicle makes {:.2g} m", sweeps.sweep_s, sweeps.moved_m);
  if (sweeps.sweeps < 2) {
    return fmt::format("there is one sweep only, and no other to compare it with; it {}", movement);
  }
  constexpr double kHalf = 50.0;
  if (const double once = percent(sweeps.places_heard_once, sweeps.places); once >= kHalf) {
    return fmt::format("{:.0f} % of the places were seen in one sweep only, one sweep {}", once, movement);
  }
  const EchoCounts& all = evaluation.all;
  return fmt::format("{} of {} came from places that a map of the other sweeps knows, one sweep {}", all.judged,
                     counted(all.echoes, "echo"), movement);
}

}  // namespace

std::string verdict_text(const Evaluation& evaluation) {
  if (!evaluation.is_judged()) return "cannot be judged: " + why_not_judged(evaluation);
  const EchoCounts& all = evaluation.all;
  return fmt::format("predicts {:.0f} % of the echoes it can judge ({:.0f} % of all) within {:.6g} m",
                     percent(all.predicted, all.judged), percent(all.predicted, all.echoes), evaluation.tolerance_m);
}

std::string movement_text(const SweepCoverage& sweeps) {
  return fmt::format("{} of {:.3g} s, in which the vehicle makes {:.2g} m and turns by {:.3g} degrees (medians)",
                     counted(sweeps.sweeps, "sweep"), sweeps.sweep_s, sweeps.moved_m, sweeps.turned_rad / kDegree_rad);
}

std::string places_text(const SweepCoverage& sweeps) {
  return fmt::format("{}, heard by {:.3g} sweeps each (median), {:.1f} % by one only", sweeps.places,
                     sweeps.sweeps_per_place, percent(sweeps.places_heard_once, sweeps.places));
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
      .add("beam_width_m", sweeps.beam_width_m);
}

std::vector<std::string> coverage_warnings(const SweepCoverage& sweeps) {
  constexpr std::size_t kFewBeams = 100;
  constexpr double kFewEchoes = 10.0, kMostPlaces = 75.0;
  std::vector<std::string> warnings;
  if (const double echoes = percent(sweeps.echoes, sweeps.beams); sweeps.beams >= kFewBeams && echoes < kFewEchoes) {
    warnings.push_back(
        fmt::format("only {:.1f} % of the beams have an echo, so the map is mostly empty (see --threshold, --min-range "
                    "and --max-range)",
                    echoes));
  }
  const double once = percent(sweeps.places_heard_once, sweeps.places);
  if (once >= kMostPlaces && sweeps.moved_m > sweeps.beam_width_m && sweeps.beam_width_m > 0.0) {
    warnings.push_back(
        fmt::format("the map cannot be sharp: one sweep takes {:.3g} s while the vehicle makes {:.2g} m, and {:.0f} % "
                    "of the places were seen in one sweep only, so errors of the poses smear it; a slower vehicle, a "
                    "shorter range or a narrower sector of the head would help",
                    sweeps.sweep_s, sweeps.moved_m, once));
  }
  return warnings;
}

}  // namespace pingvox::app
