#include "step_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "console.hpp"
#include "map_report.hpp"
#include "step_text.hpp"

namespace pingvox::app {
namespace {

/// The one that the most samples are left out for, the largest of equals.
const SourceStep& main_step(const std::vector<SourceStep>& steps) {
  return *std::ranges::max_element(
      steps, {}, [](const SourceStep& step) { return std::pair(step.left_out, step.moved_m + step.turned_rad); });
}

/// " (and 3 more times)"
std::string others_text(std::size_t steps) {
  return steps > 1 ? fmt::format(" (and {} more)", counted(steps - 1, "time")) : "";
}

}  // namespace

std::size_t left_out(const std::vector<SourceStep>& steps) {
  std::size_t sum = 0;
  for (const SourceStep& step : steps) sum += step.left_out;
  return sum;
}

std::vector<std::string> step_texts(const NavLog& log) {
  std::vector<std::string> texts;
  for (const NavSource& source : log.sources()) {
    if (source.steps.empty() || source.subject == NavSubject::kOther) continue;
    const SourceStep& step = main_step(source.steps);
    std::string text =
        fmt::format("{} of {} {} at {:.3f} s{}: {} of {} are dropped", name_of(source.quantity),
                    on_one_line(source.name), step_text(step), step.to_s, others_text(source.steps.size()),
                    left_out(source.steps), counted(source.samples.size(), "sample"));
    if (source.steps.size() == 1 && step.left_out > 1) {
      text += fmt::format(", those from {:.3f} to {:.3f} s", step.left_from_s, step.left_to_s);
    }
    texts.push_back(std::move(text));
  }
  return texts;
}

std::vector<std::string> step_texts(const std::vector<SourceStep>& steps, std::size_t poses) {
  std::vector<std::string> texts;
  std::vector<SourceStep> cuts, outliers;
  for (const SourceStep& step : steps) (step.left_out > 0 ? outliers : cuts).push_back(step);
  if (!cuts.empty()) {
    const SourceStep& step = main_step(cuts);
    texts.push_back(fmt::format("its path {} at {:.3f} s{}: no pose is assumed in between", step_text(step), step.to_s,
                                others_text(cuts.size())));
  }
  if (!outliers.empty()) {
    const SourceStep& step = main_step(outliers);
    const std::size_t count = left_out(outliers);
    texts.push_back(fmt::format("its path {} at {:.3f} s{}: {} of {} are dropped", step_text(step), step.to_s,
                                others_text(outliers.size()), count, counted(poses, "pose")));
  }
  return texts;
}

std::vector<JsonObject> steps_json(const std::vector<SourceStep>& steps) {
  constexpr std::size_t kMaxSteps = 20;
  std::vector<JsonObject> list;
  for (const SourceStep& step : steps) {
    if (list.size() == kMaxSteps) break;
    list.emplace_back()
        .add("from_s", step.from_s)
        .add("to_s", step.to_s)
        .add("moved_m", step.moved_m)
        .add("turned_deg", rounded_degrees(step.turned_rad))
        .add("left_out", step.left_out);
  }
  return list;
}

}  // namespace pingvox::app
