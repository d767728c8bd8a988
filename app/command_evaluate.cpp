#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "evaluation_text.hpp"
#include "input_kinds.hpp"
#include "io/internal/json.hpp"
#include "map_report.hpp"
#include "open_recording.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/recording/evaluate.hpp"
#include "pingvox/recording/fit.hpp"
#include "pingvox/sonar/device_profile.hpp"
#include "progress.hpp"
#include "recording_report.hpp"
#include "recording_warnings.hpp"

namespace pingvox::app {
namespace {

double share_of(std::size_t part, std::size_t all) {
  return all == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(all);
}

std::string percent_text(std::size_t part, std::size_t all) {
  return all == 0 ? "-" : fmt::format("{:.1f}", 100.0 * share_of(part, all));
}

/// Refuses options that have no effect on beams, or on beams as rays.
Result<void> check_used(const EvaluateCommand& command) {
  std::vector<std::string> kinds = {std::string(kBeamLogs)};
  if (command.evaluation.build.model.shape == BeamShape::kRay) kinds.emplace_back(kRayBeams);
  return check_limited(command.limited, kinds).map_error([](const Error& error) {
    return Error{error.code, fmt::format("evaluate: {}", error.message)};
  });
}

/// Adds shares of the echoes that can be judged, and coverage.
void add_counts(const EchoCounts& counts, JsonObject& json) {
  json.add("within_cell", share_of(counts.within_cell, counts.judged))
      .add("within_10cm", share_of(counts.within_10cm, counts.judged))
      .add("too_early", share_of(counts.too_early, counts.judged))
      .add("from_free", share_of(counts.from_free, counts.judged))
      .add("unknown", share_of(counts.unknown(), counts.echoes))
      .add("coverage", counts.coverage());
}

std::vector<JsonObject> parts_json(const std::vector<Evaluation::Part>& parts, std::string_view unit) {
  std::vector<JsonObject> all;
  for (const Evaluation::Part& part : parts) {
    JsonObject json;
    json.add(fmt::format("from_{}", unit), part.from);
    const std::string to = fmt::format("to_{}", unit);
    std::isfinite(part.to) ? json.add(to, part.to) : json.add_null(to);
    json.add("echoes", part.counts.echoes);
    add_counts(part.counts, json);
    all.push_back(json);
  }
  return all;
}

/// What was fitted, in the units and by the options of the command line.
struct FitText {
  std::string parameter, unit;
  double factor = 1.0;  ///< from the unit of the library
  std::string advice;   ///< options to give
};

FitText text_of(const Fit& fit, FitParameter parameter, const Recording& recording, const VehiclePath& path,
                double sound_speed_m_s) {
  const double value = fit.values.front().value;
  const auto mount_advice = [&](const Eigen::Vector3d& moved_m, double yaw_rad) {
    const Pose& mount = recording.options().body_from_sonar;
    const Eigen::Vector3d at = mount.translation() + moved_m;
    const Eigen::Vector3d rpy_rad = rpy_of(mount.rotation());
    return fmt::format("--mount {:.3f},{:.3f},{:.3f},{:.2f},{:.2f},{:.2f}", at.x(), at.y(), at.z(),
                       rpy_rad.x() / kDegree_rad, rpy_rad.y() / kDegree_rad, (rpy_rad.z() + yaw_rad) / kDegree_rad);
  };
  switch (parameter) {
    case FitParameter::kSoundSpeed:
      return {"sound-speed", "m/s", sound_speed_m_s, fmt::format("--sound-speed {:.1f}", value * sound_speed_m_s)};
    case FitParameter::kMountYaw:
      return {"mount-yaw", "degrees", 1.0 / kDegree_rad, mount_advice(Eigen::Vector3d::Zero(), value)};
    case FitParameter::kNavOffset:
      return {"nav-offset", "s", 1.0,
              path.nav ? fmt::format("--nav-offset {:.3f}", recording.nav_offset()->offset_s + value)
                       : fmt::format("{:.3f} s added to the times of --poses", value)};
    case FitParameter::kMountXy:
      return {"mount-xy", "m", 1.0, mount_advice({value, fit.values.back().value, 0.0}, 0.0)};
  }
  return {};
}

JsonObject fit_json(const Fit& fit, const FitText& text) {
  JsonObject json;
  json.add("parameter", text.parameter);
  const Estimate &first = fit.values.front(), &last = fit.values.back();
  if (!fit.is_observable) {
    json.add_null("value").add_null("deviation");
  } else if (fit.values.size() == 1) {
    json.add("value", first.value * text.factor).add("deviation", first.deviation * text.factor);
  } else {
    json.add("value", Eigen::Vector3d(first.value, last.value, 0.0))
        .add("deviation", Eigen::Vector3d(first.deviation, last.deviation, 0.0));
  }
  return json.add("unit", text.unit)
      .add("score_before", fit.score_before)
      .add("score", fit.score)
      .add("options", fit.is_observable ? text.advice : "");
}

std::string fit_text(const Fit& fit, const FitText& text) {
  if (!fit.is_observable) {
    return report_line("fit", fmt::format("{}: not observable in this log: other values predict the echoes about as "
                                          "well",
                                          text.parameter));
  }
  std::string line = text.parameter;
  for (const Estimate& value : fit.values) {
    line += fmt::format("{} {:.4g} +- {:.2g}", &value == fit.values.data() ? "" : ",", value.value * text.factor,
                        value.deviation * text.factor);
  }
  return report_line("fit", fmt::format("{} {}; mean score of an echo {:.3f}, before {:.3f}", line, text.unit,
                                        fit.score, fit.score_before)) +
         report_line("", "as an option: " + text.advice);
}

std::string evaluation_json(const Evaluation& found, const std::optional<JsonObject>& fit) {
  JsonObject json;
  json.add("beams", found.beams).add("judged", share_of(found.all.judged, found.beams));
  add_counts(found.all, json);
  if (fit) json.add("fit", *fit);
  return json.add("verdict", verdict_text(found))
             .add("echoes", found.all.echoes)
             .add("tolerance_m", found.tolerance_m)
             .add("folds", found.folds)
             .add("sweeps", coverage_json(found.sweeps))
             .add("by_range", parts_json(found.by_range, "m"))
             .add("by_time", parts_json(found.by_time, "s"))
             .text() +
         "\n";
}

/// A line of a table of shares in percent.
std::string table_line(std::string_view label, std::string_view part, const EchoCounts& counts) {
  return report_line(
      label, fmt::format("{:<14}{:>8}{:>10}{:>10}{:>10}{:>11}{:>11}", part, counts.echoes,
                         percent_text(counts.judged, counts.echoes), percent_text(counts.within_cell, counts.judged),
                         percent_text(counts.within_10cm, counts.judged), percent_text(counts.too_early, counts.judged),
                         percent_text(counts.from_free, counts.judged)));
}

std::string range_text(const Evaluation::Part& part) {
  return std::isfinite(part.to) ? fmt::format("{:.6g}..{:.6g} m", part.from, part.to)
                                : fmt::format("from {:.6g} m", part.from);
}

std::string evaluation_text(const Evaluation& found, const EvaluateCommand& command) {
  const SweepCoverage& sweeps = found.sweeps;
  std::string text = fmt::format("{}\n", name_of_input(command.recording.logs.front()));
  text += report_line("verdict", verdict_text(found));
  text += report_line("sweeps", movement_text(sweeps));
  text += report_line("places", places_text(sweeps));
  text += report_line(
      "", fmt::format("{:<14}{:>8}{:>10}{:>10}{:>10}{:>11}{:>11}", "", "echoes", "judged %",
                      fmt::format("{:.6g} m %", found.resolution_m), "0.1 m %", "too early %", "from free %"));
  text += table_line("echoes", "all", found.all);
  for (const Evaluation::Part& part : found.by_range) text += table_line("", range_text(part), part.counts);
  const double start_s = found.by_time.empty() ? 0.0 : found.by_time.front().from;
  for (const Evaluation::Part& part : found.by_time) {
    text += table_line("", fmt::format("{:.0f}..{:.0f} s", part.from - start_s, part.to - start_s), part.counts);
  }
  return text;
}

}  // namespace

Result<int> run(const EvaluateCommand& command, Console& console) {
  if (const auto used = check_used(command); !used) return tl::unexpected(used.error());
  if (const auto ranges = check_ranges(command.evaluation.build); !ranges) return tl::unexpected(ranges.error());
  const Result<OpenedRecording> opened = open_with_path(command.recording);
  if (!opened) return tl::unexpected(opened.error());
  const auto& [recording, path] = *opened;
  for (const std::string& warning : warnings_of(recording, path)) console.say(warning);
  for (const InputFile& log : recording.logs()) {
    if (const std::string text = still_vehicle_text(log, recording.options()); !text.empty()) console.say(text);
  }
  ProgressBar bar(command.output_options);
  const Result<Evaluation> found = evaluate(recording, path, command.evaluation, [&](double share) {
    if (bar.is_due()) bar.draw(share, "evaluating");
  });
  bar.clear();
  if (!found) return tl::unexpected(found.error());
  std::optional<JsonObject> fitted_json;
  std::string fitted_text;
  if (command.fit) {
    const Result<Fit> fitted = fit(recording, path, *command.fit, command.evaluation, [&](double share) {
      if (bar.is_due()) bar.draw(share, "fitting");
    });
    bar.clear();
    if (!fitted) return tl::unexpected(fitted.error());
    const double ratio =
        recording.water() ? sound_speed_ratio(*recording.water()) : command.evaluation.build.sound_speed_ratio;
    const FitText text = text_of(*fitted, *command.fit, recording, path, ratio * kAssumedSoundSpeed_m_s);
    fitted_json = fit_json(*fitted, text);
    fitted_text = fit_text(*fitted, text);
  }
  const Result<void> printed = command.output_options.report == Report::kJson
                                   ? console.print(evaluation_json(*found, fitted_json))
                                   : console.summarise(evaluation_text(*found, command) + fitted_text, "");
  if (!printed) return tl::unexpected(printed.error());
  return 0;
}

}  // namespace pingvox::app
