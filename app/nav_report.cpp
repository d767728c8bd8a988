#include "nav_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "console.hpp"
#include "map_report.hpp"
#include "open_log.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/slam/clock_offset.hpp"
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

}  // namespace

Result<BagContents> read_nav_log(ByteStream stream, Damage damage, std::span<const NavFields> fields) {
  const std::string name = stream.name();
  Result<BagContents> contents = read_contents(std::move(stream), damage, fields);
  if (!contents) return contents;
  if (const auto there = check_contents(fields, contents->topics, name); !there) return tl::unexpected(there.error());
  return contents;
}

Result<NavFiles> read_navs(const std::vector<std::string>& names, Damage damage, std::span<const NavFields> fields) {
  std::vector<BagTopicSummary> topics;
  std::vector<NavSource> sources;
  std::optional<NavClock> clock;
  Result<std::vector<YawChange>> first_turns;
  std::size_t damaged = 0;
  for (const std::string& name : names) {
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
    const Result<BagContents> contents = read_contents(std::move(*stream), damage, fields);
    if (!contents && unread && contents.error().code == Error::Code::kUnsupported) {
      return fail(Error::Code::kUnsupported, fmt::format("{}: {}", shown, *unread));
    }
    if (!contents && kind_of(*format) == FormatKind::kTrajectory) {
      return fail(Error::Code::kUnsupported, fmt::format("{}: is {}, not a navigation log: 'map' and 'render' take it "
                                                         "by --poses, 'locate' by --odometry",
                                                         shown, description_of(*format)));
    }
    if (!contents) return tl::unexpected(contents.error());
    topics.insert(topics.end(), contents->topics.begin(), contents->topics.end());
    const NavLog& log = contents->nav.log;
    damaged += damaged_records(contents->nav);
    const NavClock own = log.clock();
    clock = clock.value_or(own);
    double offset_s = 0.0;
    if (own != *clock && own != NavClock::kUnknown && *clock != NavClock::kUnknown) {
      const Result<ClockOffset> offset =
          first_turns.and_then([&](const std::vector<YawChange>& turns) { return clock_offset(turns, log); });
      if (!offset) {
        return fail(offset.error().code,
                    fmt::format("{}: the offset between its clock and that of {} cannot be found: {}", name,
                                names.front(), offset.error().message));
      }
      offset_s = offset->offset_s;
    }
    if (names.size() > 1 && sources.empty()) first_turns = yaw_changes(log);
    for (NavSource source : log.sources()) {
      for (NavSample& sample : source.samples) sample.time_s += offset_s;
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
                                name, names.front(), source.name, name_of(source.quantity)));
      }
      add_samples(source, *same);
    }
  }
  const auto there = check_contents(fields, topics, fmt::format("{}", fmt::join(names, ", ")));
  if (!there) return tl::unexpected(there.error());
  return NavLog::make(std::move(sources), clock.value_or(NavClock::kUnknown)).map([&](NavLog log) {
    return NavFiles{std::move(log), damaged};
  });
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
    sources.emplace_back()
        .add("name", source.name)
        .add("quantity", name_of(source.quantity))
        .add("samples", summary.samples)
        .add("invalid", summary.invalid)
        .add("rate_hz", summary.rate_hz)
        .add("gaps", summary.gaps)
        .add("from_s", summary.from_s)
        .add("to_s", summary.to_s)
        .add("late", source.step_back ? source.step_back->late : 0);
  }
  json.add("clock", name_of(nav.log.clock()))
      .add("records", nav.records)
      .add("sources", sources)
      .add("skipped", damaged_records(nav));
}

std::string nav_text(const NavFile& nav) {
  std::string text = report_line("records", fmt::format("{}", nav.records)) +
                     report_line("clock", std::string(name_of(nav.log.clock())));
  std::size_t widest = 6;
  for (const NavSource& source : nav.log.sources()) widest = std::max(widest, on_one_line(source.name).size());
  text += fmt::format("  {:<{}}  {:<11} {:>8} {:>8} {:>8} {:>5} {:>17} {:>17}\n", "source", widest, "quantity",
                      "samples", "invalid", "rate Hz", "gaps", "from s", "to s");
  for (const NavSource& source : nav.log.sources()) {
    const NavSummary summary = summary_of(source);
    text += fmt::format("  {:<{}}  {:<11} {:>8} {:>8} {:>8.2f} {:>5} {:>17.3f} {:>17.3f}\n", on_one_line(source.name),
                        widest, name_of(source.quantity), summary.samples, summary.invalid, summary.rate_hz,
                        summary.gaps, summary.from_s, summary.to_s);
  }
  for (const NavSource& source : nav.log.sources()) {
    if (!source.step_back) continue;
    const auto& [step_from_s, step_to_s, late] = *source.step_back;
    text += report_line("clock back",
                        fmt::format("{} of {} by {:.3f} s, from {:.3f} to {:.3f} s; {} late", name_of(source.quantity),
                                    on_one_line(source.name), step_from_s - step_to_s, step_from_s, step_to_s,
                                    counted(late, "sample")));
  }
  if (damaged_records(nav) > 0) text += report_line("skipped", counted(damaged_records(nav), "damaged record"));
  return text;
}

}  // namespace pingvox::app
