#include "pingvox/recording/navigation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "base/words.hpp"
#include "io/internal/unknown_file.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/nav.hpp"
#include "pingvox/io/open_log.hpp"
#include "pingvox/nav/clock_offset.hpp"

namespace pingvox {
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

bool overlap_in_time(const NavSource& a, const NavSource& b) {
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

Result<NavPart> read_part(const InputFile& file, const NavigationOptions& reading) {
  Result<ByteStream> stream = file.open();
  if (!stream) return tl::unexpected(stream.error());
  const std::string shown = stream->name();
  const std::optional<std::string> unread = describe_unread_file(stream->beginning());
  const Result<Format> format = identify_format(*stream);
  if (!format) {
    if (format.error().code != Error::Code::kUnsupported) return tl::unexpected(format.error());
    const std::string_view what = stream->beginning().empty() ? "is empty" : "is not a navigation log";
    return fail(Error::Code::kUnsupported, fmt::format("{}: {}", shown, unread ? std::string_view(*unread) : what));
  }
  Result<BagContents> contents = read_contents(std::move(*stream), reading.damage, reading.fields);
  if (!contents && unread && contents.error().code == Error::Code::kUnsupported) {
    return fail(Error::Code::kUnsupported, fmt::format("{}: {}", shown, *unread));
  }
  if (!contents && kind_of(*format) == FormatKind::kTrajectory) {
    return fail(Error::Code::kUnsupported,
                fmt::format("{}: is {}, not a navigation log", shown, description_of(*format)));
  }
  if (!contents) return tl::unexpected(contents.error());
  return NavPart{file.name(), *std::move(contents)};
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
      if (own == NavClock::kBoot && overlap_in_time(*same, source)) {
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

/// To add to the times of a log that counts from a start to get dates: by the logs with dates, the pair that determines
/// it best.
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
      clock.by = aligned->by == NavClockOffset::By::kDevice ? NavLogClock::By::kDevice : NavLogClock::By::kTurns;
    } else if (own != first.log().clock() || own == NavClock::kUnknown) {
      clock.by = NavLogClock::By::kOneClock;
    } else {
      clock.by = own == NavClock::kUnix ? NavLogClock::By::kDates : NavLogClock::By::kSameStart;
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

Result<BagContents> bag_contents(ByteStream& stream, Damage damage, std::span<const NavFields> fields) {
  if (const std::optional<std::string> path = stream.path()) {
    Result<ByteStream> again = ByteStream::open(*path);
    if (!again) return tl::unexpected(again.error());
    return read_nav_log(std::move(*again), damage, fields);
  }
  if (const Result<void> held = stream.load_all(); !held) return tl::unexpected(held.error());
  return read_nav_log(ByteStream(stream.held()), damage, fields);
}

Result<NavFiles> read_navigation(std::span<const InputFile> files, const NavigationOptions& reading) {
  std::vector<NavPart> parts;
  std::vector<BagTopicSummary> topics;
  std::vector<NavFiles::Note> left_out;
  std::vector<std::string> names;
  std::size_t damaged = 0;
  for (auto file = files.begin(); file != files.end(); ++file) {
    const auto same = std::ranges::find(files.begin(), file, file->name(), &InputFile::name);
    if (same != file) return fail(Error::Code::kBadOption, fmt::format("{}: is given twice", file->name()));
  }
  for (const InputFile& file : files) {
    Result<NavPart> part = read_part(file, reading);
    if (!part) return tl::unexpected(part.error());
    names.push_back(part->name);
    topics.insert(topics.end(), part->contents.topics.begin(), part->contents.topics.end());
    damaged += damage_count(part->contents.nav.damage);
    for (std::string& note : part->contents.nav.notes) left_out.push_back({part->name, std::move(note)});
    parts.push_back(*std::move(part));
  }
  const auto known =
      std::ranges::find_if(parts, [](const NavPart& part) { return part.log().clock() != NavClock::kUnknown; });
  const NavClock clock = known == parts.end() ? NavClock::kUnknown : known->log().clock();
  if (const auto aligned = align(parts, clock); !aligned) return tl::unexpected(aligned.error());
  std::vector<const NavPart*> pointers;
  for (const NavPart& part : parts) pointers.push_back(&part);
  Result<NavLog> log = joined(pointers, clock);
  if (!log) return tl::unexpected(log.error());
  if (const auto there = check_contents(reading.fields, topics, fmt::format("{}", fmt::join(names, ", "))); !there) {
    return tl::unexpected(there.error());
  }
  NavFiles all{*std::move(log), damaged, std::move(left_out), {}, clocks_of(parts), {}};
  for (NavPart& part : parts) {
    for (std::string& note : part.contents.notes) all.not_joined.push_back({part.name, std::move(note)});
    all.bags.push_back({part.name, std::move(part.contents.topics)});
  }
  for (const BagTopicSummary& sonar : sonar_topics(all.bags, reading.log, reading.topic)) {
    log = sources_between(all.log, sonar.from_s, sonar.to_s);
    if (!log) return tl::unexpected(log.error());
    all.log = *std::move(log);
  }
  if (reading.chosen.empty()) return all;
  log = choose_sources(all.log, reading.chosen);
  if (!log) return fail(log.error().code, fmt::format("nav_sources: {}", log.error().message));
  all.log = *std::move(log);
  return all;
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

std::vector<OtherSource> other_sources(const NavLog& log, std::span<const NavQuantity> quantities,
                                       std::span<const std::string> used) {
  std::map<std::string, OtherSource> others;
  for (const NavSource& source : log.sources()) {
    if (std::ranges::find(quantities, source.quantity) == quantities.end()) continue;
    if (std::ranges::find(used, source.name) != used.end()) continue;
    const std::string note = source.subject == NavSubject::kOther ? source.note : "";
    OtherSource& other = others.try_emplace(source.name, OtherSource{source.name, source.frame, note, 0}).first->second;
    other.samples = std::max(other.samples, source.samples.size());
  }
  std::vector<OtherSource> list;
  for (auto& [name, other] : others) list.push_back(std::move(other));
  return list;
}

std::string text_of(std::span<const OtherSource> others) {
  constexpr std::size_t kShown = 8;
  std::string text;
  for (const OtherSource& other : others.first(std::min(kShown, others.size()))) {
    text += fmt::format("{}{} ({}", text.empty() ? "" : ", ", other.name, counted(other.samples, "sample"));
    if (!other.note.empty()) {
      text += ": " + other.note;
    } else if (!other.frame.empty()) {
      text += ", frame " + other.frame;
    }
    text += ")";
  }
  if (others.size() > kShown) text += fmt::format(", and {} more", others.size() - kShown);
  return on_one_line(text);
}

}  // namespace pingvox
