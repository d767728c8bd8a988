#include "nav_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "console.hpp"
#include "map_report.hpp"
#include "open_log.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/slam/clock_offset.hpp"
#include "step_report.hpp"
#include "unknown_file.hpp"

namespace pingvox::app {

std::size_t damaged_records(const NavFile& nav) {
  return damage_count(nav.damage);
}

namespace {

/// Any navigation log, with its topics if it is a bag.
Result<BagContents> read_contents(ByteStream stream, Damage damage, std::span<const NavFields> fields) {
  const std::optional<Format> format = streamed_format_of(stream.beginning());
  if (format && is_bag(*format)) return read_bag(std::move(stream), damage, fields);
  return read_nav(std::move(stream), damage).map([](NavFile nav) { return BagContents{{}, std::move(nav)}; });
}

/// Names what `fields` miss in the topics of bags; nothing is expected of other logs.
Result<void> check_contents(std::span<const NavFields> fields, const std::vector<BagTopicSummary>& topics,
                            const std::string& names) {
  if (topics.empty()) return {};
  const Result<void> there = check_topics(fields, topics);
  return there ? there : fail(there.error().code, fmt::format("{}: {}", names, there.error().message));
}

bool overlap(const NavSource& a, const NavSource& b) {
  return a.samples.front().time_s < b.samples.back().time_s && b.samples.front().time_s < a.samples.back().time_s;
}

/// One of several logs of a vehicle.
struct NavPart {
  std::string name;
  BagContents contents;
  double offset_s = 0.0;                                 ///< to add to its times to get those of the others
  std::optional<NavClockOffset> aligned = std::nullopt;  ///< nullopt: it did not have to be

  const NavLog& log() const { return contents.nav.log; }
};

Result<NavPart> read_part(const std::string& name, Damage damage, std::span<const NavFields> fields) {
  Result<ByteStream> stream = ByteStream::open(name);
  if (!stream) return tl::unexpected(stream.error());
  const std::string shown = stream->name();
  const std::optional<std::string> unread = describe_unread_file(stream->beginning());
  const Result<Format> format = identify_format(*stream);
  if (!format) {
    if (format.error().code != Error::Code::kUnsupported) return tl::unexpected(format.error());
    const std::string_view what = stream->beginning().empty() ? "is empty" : "is not a navigation log";
    return fail(Error::Code::kUnsupported, fmt::format("{}: {}", shown, unread ? std::string_view(*unread) : what));
  }
  Result<BagContents> contents = read_contents(std::move(*stream), damage, fields);
  if (!contents && unread && contents.error().code == Error::Code::kUnsupported) {
    return fail(Error::Code::kUnsupported, fmt::format("{}: {}", shown, *unread));
  }
  if (!contents && kind_of(*format) == FormatKind::kTrajectory) {
    return fail(Error::Code::kUnsupported, fmt::format("{}: is {}, not a navigation log: 'map' and 'render' take it "
                                                       "by --poses, 'locate' by --odometry",
                                                       shown, description_of(*format)));
  }
  if (!contents) return tl::unexpected(contents.error());
  return NavPart{name, *std::move(contents)};
}

/// Parts whose offsets are known as one log.
Result<NavLog> joined(const std::vector<const NavPart*>& parts, NavClock clock) {
  std::vector<NavSource> sources;
  for (const NavPart* part : parts) {
    const NavClock own = part->log().clock();
    for (NavSource source : part->log().sources()) {
      shift_times(source, part->offset_s);
      const auto same = std::ranges::find_if(
          sources, [&](const NavSource& s) { return s.name == source.name && s.quantity == source.quantity; });
      if (same == sources.end()) {
        sources.push_back(std::move(source));
        continue;
      }
      if (own == NavClock::kBoot && overlap(*same, source)) {
        return fail(Error::Code::kUnsupported,
                    fmt::format("{}: its times count from another start of the device than those of {}: {} ({}) has "
                                "the same times in both",
                                part->name, parts.front()->name, source.name, name_of(source.quantity)));
      }
      add_samples(source, *same);
    }
  }
  return NavLog::make(std::move(sources), clock);
}

std::string names_of(const std::vector<const NavPart*>& parts) {
  std::string names;
  for (const NavPart* part : parts) names += (names.empty() ? "" : ", ") + part->name;
  return names;
}

/// To add to the times of a log that counts from a start to get dates: by the logs with dates, the pair that tells it
/// best.
Result<NavClockOffset> date_offset(const std::vector<const NavPart*>& dated,
                                   const std::vector<const NavPart*>& from_start) {
  using By = NavClockOffset::By;
  Result<NavClockOffset> best = fail(Error::Code::kUnsupported, "the vehicle turns too little");
  for (const NavPart* with_dates : dated) {
    for (const NavPart* without : from_start) {
      const Result<NavClockOffset> offset =
          nav_clock_offset(with_dates->log(), with_dates->contents.nav.runs, without->log());
      const auto is_better = [&] {
        return offset->by != best->by ? offset->by == By::kDevice : offset->deviation_s < best->deviation_s;
      };
      if (!best || (offset && is_better())) best = offset;
    }
  }
  return best;
}

/// Whether it counts from 1970 by a clock that was set.
bool has_dates(const NavPart& part) {
  return part.log().clock() == NavClock::kUnix &&
         std::ranges::any_of(part.log().sources(),
                             [](const NavSource& source) { return source.samples.back().time_s >= kFirstDate_s; });
}

/// Finds the offsets of the parts on another clock than `clock`, of which there is a part.
Result<void> align(std::vector<NavPart>& parts, NavClock clock) {
  // Where none was set, the clock of a computer is as good as one with dates.
  const bool are_dated = std::ranges::any_of(parts, has_dates);
  const auto is_dated = [&](const NavPart& part) {
    return part.log().clock() == NavClock::kUnix && (!are_dated || has_dates(part));
  };
  std::vector<const NavPart*> dated, from_boot;
  for (const NavPart& part : parts) {
    if (is_dated(part)) dated.push_back(&part);
    if (part.log().clock() == NavClock::kBoot) from_boot.push_back(&part);
  }
  if (dated.empty()) return {};
  const auto refuse = [](const Error& error, const std::vector<const NavPart*>& its,
                         const std::vector<const NavPart*>& others) {
    return fail(error.code, fmt::format("{}: the offset between its clock and that of {} cannot be found: {}",
                                        names_of(its), names_of(others), error.message));
  };
  double zero_s = 0.0;  // date of the common clock's
  if (clock == NavClock::kBoot) {
    const Result<NavClockOffset> offset = date_offset(dated, from_boot);
    if (!offset) return refuse(offset.error(), dated, from_boot);
    zero_s = offset->offset_s;
    for (NavPart& part : parts) {
      if (!is_dated(part)) continue;
      part.aligned = *offset;
      part.offset_s = -zero_s;
    }
  }
  for (NavPart& part : parts) {  // each from a start of its own
    if (part.log().clock() == NavClock::kUnknown || is_dated(part)) continue;
    if (clock == NavClock::kBoot && part.log().clock() == NavClock::kBoot) continue;
    const Result<NavClockOffset> offset = date_offset(dated, {&part});
    if (!offset) return refuse(offset.error(), {&part}, dated);
    part.aligned = *offset;
    part.offset_s = offset->offset_s - zero_s;
  }
  return {};
}

/// How the clocks of parts are joined, once they are aligned.
std::vector<NavLogClock> clocks_of(const std::vector<NavPart>& parts) {
  std::vector<NavLogClock> clocks;
  for (const NavPart& part : parts) {
    NavLogClock& clock = clocks.emplace_back();
    clock.name = part.name;
    clock.settings = part.contents.nav.settings;
    if (clocks.size() == 1) continue;
    const NavPart& first = parts.front();
    clock.offset_s = part.offset_s - first.offset_s;
    const NavClock own = part.log().clock();
    if (const std::optional<NavClockOffset>& aligned = part.aligned ? part.aligned : first.aligned) {
      clock.deviation_s = aligned->deviation_s;
      clock.from = aligned->by == NavClockOffset::By::kDevice ? "the clock of the autopilot" : "how the vehicle turns";
    } else if (own != first.log().clock() || own == NavClock::kUnknown) {
      clock.from = "taken as one clock";
    } else {
      clock.from = own == NavClock::kUnix ? "both have dates" : "both count from the start of the device";
    }
  }
  return clocks;
}

}  // namespace

Result<BagContents> read_nav_log(ByteStream stream, Damage damage, std::span<const NavFields> fields) {
  const std::string name = stream.name();
  Result<BagContents> contents = read_contents(std::move(stream), damage, fields);
  if (!contents) return contents;
  if (const auto there = check_contents(fields, contents->topics, name); !there) return tl::unexpected(there.error());
  return contents;
}

namespace {

/// Sources with a fault, and steps that no vehicle makes, of all but those that are not taken.
void add_warnings(const std::string& names, NavFiles& files) {
  if (const std::string faults = faults_text(files.log); !faults.empty()) {
    files.warnings.push_back(fmt::format("{}: {}", names, faults));
  }
  for (const std::string& step : step_texts(files.log)) files.warnings.push_back(fmt::format("{}: {}", names, step));
}

}  // namespace

Result<NavFiles> read_navs(const std::vector<std::string>& names, Damage damage, std::span<const NavFields> fields,
                           const WantedNav& wanted) {
  std::vector<NavPart> parts;
  std::vector<BagTopicSummary> topics;
  std::size_t damaged = 0;
  std::vector<std::string> warnings;
  for (const std::string& name : names) {
    Result<NavPart> part = read_part(name, damage, fields);
    if (!part) return tl::unexpected(part.error());
    topics.insert(topics.end(), part->contents.topics.begin(), part->contents.topics.end());
    damaged += damaged_records(part->contents.nav);
    for (const std::string& note : part->contents.nav.notes) warnings.push_back(fmt::format("{}: {}", name, note));
    parts.push_back(*std::move(part));
  }
  const auto known =
      std::ranges::find_if(parts, [](const NavPart& part) { return part.log().clock() != NavClock::kUnknown; });
  const NavClock clock = known == parts.end() ? NavClock::kUnknown : known->log().clock();
  if (const auto aligned = align(parts, clock); !aligned) return tl::unexpected(aligned.error());
  std::vector<const NavPart*> all;
  for (const NavPart& part : parts) all.push_back(&part);
  Result<NavLog> log = joined(all, clock);
  if (!log) return tl::unexpected(log.error());
  const std::string all_names = fmt::format("{}", fmt::join(names, ", "));
  if (const auto there = check_contents(fields, topics, all_names); !there) return tl::unexpected(there.error());
  NavFiles files{*std::move(log), damaged, std::move(warnings), clocks_of(parts), {}, {}};
  for (NavPart& part : parts) {
    for (const std::string& note : part.contents.notes) files.notes.push_back(fmt::format("{}: {}", part.name, note));
    files.bags.push_back({part.name, std::move(part.contents.topics)});
  }
  for (const BagTopicSummary& sonar : sonar_topics(files.bags, wanted.log, wanted.topic)) {
    log = sources_between(files.log, sonar.from_s, sonar.to_s);
    if (!log) return tl::unexpected(log.error());
    files.log = *std::move(log);
  }
  if (!wanted.chosen.empty()) {
    log = choose_named(files.log, wanted.chosen);
    if (!log) return tl::unexpected(log.error());
    files.log = *std::move(log);
  }
  add_warnings(all_names, files);
  return files;
}

Result<NavLog> choose_named(const NavLog& log, std::span<const NamedSource> chosen) {
  return choose_sources(log, chosen).map_error([](const Error& error) {
    return Error{error.code, fmt::format("--nav-source: {}", error.message)};
  });
}

NavOthers::NavOthers(const NavLog& log, std::span<const NavQuantity> quantities, std::span<const std::string> used) {
  std::map<std::string, Other> others;
  for (const NavSource& source : log.sources()) {
    if (std::ranges::find(quantities, source.quantity) == quantities.end()) continue;
    if (std::ranges::find(used, source.name) != used.end()) continue;
    const std::string note = source.subject == NavSubject::kOther ? source.note : "";
    Other& other = others.try_emplace(source.name, Other{source.name, source.frame, note, 0}).first->second;
    other.samples = std::max(other.samples, source.samples.size());
  }
  for (auto& [name, other] : others) others_.push_back(std::move(other));
}

std::string NavOthers::text() const {
  constexpr std::size_t kShown = 8;
  std::string text;
  for (const Other& other : std::span(others_).first(std::min(kShown, others_.size()))) {
    text += fmt::format("{}{} ({}", text.empty() ? "" : ", ", other.name, counted(other.samples, "sample"));
    if (!other.note.empty()) {
      text += ": " + other.note;
    } else if (!other.frame.empty()) {
      text += ", frame " + other.frame;
    }
    text += ")";
  }
  if (others_.size() > kShown) text += fmt::format(", and {} more", others_.size() - kShown);
  return on_one_line(text);
}

std::string others_line(const NavOthers& others) {
  const std::string text = others.text();
  return text.empty() ? "" : report_line("nav others", text);
}

std::vector<BagTopicSummary> sonar_topics(std::span<const NavFiles::Topics> bags, const std::string& log,
                                          const std::string& topic) {
  using Use = BagTopicSummary::Use;
  std::vector<BagTopicSummary> found;
  for (const auto& [file, topics] : bags) {
    if (file != log) continue;
    const bool has_beams = std::ranges::any_of(
        topics, [](const BagTopicSummary& one) { return one.use == Use::kBeams && one.messages > 0; });
    for (const BagTopicSummary& one : topics) {
      const bool is_it = topic.empty() ? one.use == (has_beams ? Use::kBeams : Use::kScans) : one.name == topic;
      if (is_it && one.messages > 0) found.push_back(one);
    }
  }
  return found;
}

std::string mount_hint(std::span<const NavFiles::Topics> bags, const std::string& log, const std::string& topic) {
  constexpr double kSame = 1e-3;
  for (const BagTopicSummary& sonar : sonar_topics(bags, log, topic)) {
    if (!sonar.mount || sonar.mount->body_from_sensor.isApprox(Pose::Identity(), kSame)) continue;
    const Pose& pose = sonar.mount->body_from_sensor;
    // 0 instead of -0.
    const Eigen::Vector3d at = pose.translation() + Eigen::Vector3d::Zero(), rpy = rpy_of(pose.rotation());
    return on_one_line(
        fmt::format("{}: {} has the sonar's frame {} on {}, which is not used: --mount "
                    "{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}",
                    log, sonar.mount->topic, sonar.frame, sonar.mount->vehicle, at.x(), at.y(), at.z(),
                    rounded_degrees(rpy.x()) + 0.0, rounded_degrees(rpy.y()) + 0.0, rounded_degrees(rpy.z()) + 0.0));
  }
  return {};
}

std::vector<JsonObject> NavOthers::json() const {
  std::vector<JsonObject> json;
  for (const Other& other : others_) {
    json.emplace_back()
        .add("name", other.name)
        .add("samples", other.samples)
        .add("frame", other.frame)
        .add("note", other.note);
  }
  return json;
}

Result<Water> water_of(const std::optional<WaterAround>& around, double salinity) {
  if (!around) {
    return fail(Error::Code::kUnsupported, "--water nav,S: --nav tells no temperature of water: give it as T,S");
  }
  const Water water{around->temperature_c, salinity, around->depth_m};
  if (const auto valid = water.validate(); !valid) return tl::unexpected(valid.error());
  return water;
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
  for (const ClockSetting& setting : nav.settings) text += report_line("clock set", text_of(setting));
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
  if (is_empty) text += report_line("samples", "none: no record is of a kind that is read");
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
