#include "nav_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "console.hpp"
#include "map_report.hpp"
#include "nav_clock.hpp"
#include "open_log.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/nav/clock_offset.hpp"
#include "step_report.hpp"

namespace pingvox::app {

std::size_t damaged_records(const NavFile& nav) {
  return damage_count(nav.damage);
}

std::string nav_sources_text(const VehiclePath::Nav& nav) {
  std::string sources = on_one_line(nav.attitude.empty() ? nav.position : nav.attitude);
  if (!nav.velocity.empty()) {
    sources += fmt::format(" and dead reckoning by {}: errors accumulate", on_one_line(nav.velocity));
  } else if (nav.attitude.empty()) {
    sources += ", not turned: no attitude is known";
  } else if (nav.attitude != nav.position) {
    sources += " and " + on_one_line(nav.position);
  }
  if (!nav.depth.empty()) sources += ", depth by " + on_one_line(nav.depth);
  return sources;
}

std::string others_line(std::span<const OtherSource> others) {
  const std::string text = pingvox::text_of(others);
  return text.empty() ? "" : report_line("nav others", text);
}

std::string mount_line(const RecordingArgs& args) {
  if (args.has_mount) return {};
  return report_line("mount", "not given: the head is assumed at the origin of the vehicle, upright, looking ahead");
}

std::vector<JsonObject> json_of(std::span<const OtherSource> others) {
  std::vector<JsonObject> json;
  for (const OtherSource& other : others) {
    json.emplace_back()
        .add("name", other.name)
        .add("samples", other.samples)
        .add("frame", other.frame)
        .add("note", other.note);
  }
  return json;
}

std::string water_text(const Water& water) {
  return fmt::format("{:.1f} degrees C at {:.1f} m by --nav, salinity {:.6g}: sound {:.1f} m/s", water.temperature_c,
                     water.depth_m, water.salinity, sound_speed_m_s(water));
}

void add_nav(JsonObject& json, const NavFile& nav) {
  std::vector<JsonObject> sources;
  for (const NavSource& source : nav.log.sources()) {
    const NavSummary summary = summary_of(source);
    JsonObject& json_of_source = sources.emplace_back();
    json_of_source.add("name", source.name)
        .add("quantity", name_of(source.quantity))
        .add("samples", summary.samples)
        .add("invalid", summary.invalid)
        .add("rate_hz", summary.rate_hz)
        .add("gaps", summary.gaps)
        .add("from_s", summary.from_s)
        .add("to_s", summary.to_s)
        .add("late", source.late)
        .add("left_out", left_out(source.steps))
        .add("frame", source.frame)
        .add("note", source.note);
    if (!source.steps.empty()) json_of_source.add("steps", steps_json(source.steps));
    if (!source.fault.empty()) json_of_source.add("fault", source.fault);
    if (!source.doubt.empty()) json_of_source.add("doubt", source.doubt);
  }
  json.add("clock", name_of(nav.log.clock()))
      .add("records", nav.records)
      .add("sources", sources)
      .add("clock_set", json_of(nav.settings))
      .add("skipped", damaged_records(nav));
  if (!nav.notes.empty()) json.add("notes", fmt::format("{}", fmt::join(nav.notes, "; ")));
}

namespace {

/// ", 2023-05-04 17:22:21 to 2023-05-04 17:55:02 UTC" where the clock has dates.
std::string dates_text(const NavLog& log) {
  if (log.clock() != NavClock::kUnix || log.sources().empty()) return "";
  double from_s = std::numeric_limits<double>::infinity(), to_s = -from_s;
  for (const NavSource& source : log.sources()) {
    from_s = std::min(from_s, source.samples.front().time_s);
    to_s = std::max(to_s, source.samples.back().time_s);
  }
  if (to_s < kFirstDate_s) {
    return fmt::format(", {:.3f} to {:.3f} s since 1970: the clock of the computer was not set", from_s, to_s);
  }
  const std::string from = date_text(from_s), to = date_text(to_s);
  if (from_s < kFirstDate_s) {
    return fmt::format(", {:.3f} s since 1970 to {} UTC: the clock was not set all the time", from_s, to);
  }
  return from.empty() || to.empty() ? "" : fmt::format(", {} to {} UTC", from, to);
}

/// Samples that were put in order, and clocks that were set.
std::string order_text(const NavFile& nav) {
  std::string text;
  for (const ClockSetting& setting : nav.settings) text += report_line("clock set", app::text_of(setting));
  for (const NavSource& source : nav.log.sources()) {
    const std::string name = fmt::format("{} of {}", name_of(source.quantity), on_one_line(source.name));
    if (source.step_back) {
      const auto& [step_from_s, step_to_s, late] = *source.step_back;
      text += report_line("clock back",
                          fmt::format("{} by {:.3f} s, from {:.3f} to {:.3f} s; {} late", name, step_from_s - step_to_s,
                                      step_from_s, step_to_s, counted(late, "sample")));
    } else if (source.late > 0) {
      text += report_line(
          "late", fmt::format("{} of {}, put in order: messages were swapped", counted(source.late, "sample"), name));
    }
  }
  return text;
}

}  // namespace

std::string nav_text(const NavFile& nav) {
  std::string text = report_line("records", fmt::format("{}", nav.records)) +
                     report_line("clock", std::string(name_of(nav.log.clock())) + dates_text(nav.log));
  const bool is_empty = nav.log.sources().empty();
  if (is_empty) text += report_line("samples", "none: no record is of a supported kind");
  std::size_t widest = 6;
  for (const NavSource& source : nav.log.sources()) widest = std::max(widest, on_one_line(source.name).size());
  if (!is_empty) {
    text += fmt::format("  {:<{}}  {:<11} {:>8} {:>8} {:>8} {:>5} {:>17} {:>17}\n", "source", widest, "quantity",
                        "samples", "invalid", "rate Hz", "gaps", "from s", "to s");
  }
  for (const NavSource& source : nav.log.sources()) {
    const NavSummary summary = summary_of(source);
    text += fmt::format("  {:<{}}  {:<11} {:>8} {:>8} {:>8.2f} {:>5} {:>17.3f} {:>17.3f}\n", on_one_line(source.name),
                        widest, name_of(source.quantity), summary.samples, summary.invalid, summary.rate_hz,
                        summary.gaps, summary.from_s, summary.to_s);
  }
  for (const NavSource& source : nav.log.sources()) {
    if (source.fault.empty()) continue;
    text += report_line("not used",
                        on_one_line(fmt::format("{} of {}: {}", name_of(source.quantity), source.name, source.fault)));
  }
  for (const std::string& doubt : doubt_texts(nav.log)) text += report_line("doubtful", on_one_line(doubt));
  text += order_text(nav);
  for (const std::string& note : nav.notes) text += report_line("note", note);
  for (const std::string& step : step_texts(nav.log)) text += report_line("step", step);
  std::set<std::string> noted;  // once for all quantities of a source
  for (const NavSource& source : nav.log.sources()) {
    const std::string note = on_one_line(fmt::format("{}: {}", source.name, source.note));
    if (source.note.empty() || !noted.insert(note).second) continue;
    text += report_line(source.subject == NavSubject::kOther ? "not taken" : "note", note);
  }
  if (damaged_records(nav) > 0) text += report_line("skipped", counted(damaged_records(nav), "damaged record"));
  return text;
}

}  // namespace pingvox::app
