#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/bytes/text.hpp"
#include "io/internal/frame_finder.hpp"
#include "io/nav/dvl_a50.hpp"
#include "io/nav/nav_readers.hpp"
#include "io/nav/nav_sources.hpp"

// Logs of Water Linked's DVLs (docs/formats.md): lines of JSON, of the serial protocol, or of a table.
namespace pingvox {
namespace {

/// A line with its place in the text.
struct Line {
  std::string_view text;
  std::size_t at;
  bool has_end;
};

/// The next line that is not blank; LF, CR or both end one. nullopt: there is none.
std::optional<Line> next_line(std::string_view text, std::size_t& from) {
  from = text.find_first_not_of("\r\n", from);
  if (from == std::string_view::npos) return std::nullopt;
  const std::size_t at = from;
  from = std::min(text.find_first_of("\r\n", at), text.size());
  return Line{text.substr(at, from - at), at, from < text.size()};
}

/// The names of a table's columns; nullopt: the line is none of ours.
std::optional<std::vector<std::string_view>> columns_in(std::string_view line) {
  std::vector<std::string_view> columns;
  constexpr std::size_t kMaxColumns = 256;
  while (const auto name = cut_field(line, ',')) {
    if (columns.size() == kMaxColumns) return std::nullopt;
    columns.push_back(*name);
  }
  const auto has = [&](std::string_view name) { return std::ranges::count(columns, name) == 1; };
  if (!has("vx") || !has("vy") || !has("vz") || !has("velocity_valid")) return std::nullopt;
  return columns;
}

A50Reading table_report(std::string_view line, const std::vector<std::string_view>& columns) {
  TextMembers members;
  for (const std::string_view name : columns) {
    const auto value = cut_field(line, ',');
    if (!value) return tl::unexpected(kNoReport);
    members.emplace_back(name, *value);
  }
  if (line.data() != nullptr) return tl::unexpected(kNoReport);
  return a50_report(members);
}

/// Loggers put text in front of the device's own.
A50Reading report_in(std::string_view line) {
  if (const std::size_t brace = line.find('{'); brace != std::string_view::npos) {
    const auto members = json_members(line.substr(brace));
    if (!members) return tl::unexpected(kNoReport);
    return a50_report(*members);
  }
  return a50_serial_report(trim(line));
}

bool is_velocity(const A50Report& report) {
  return report.kind == A50Report::Kind::kVelocity;
}

/// The host's clock may have been set while it recorded: puts its times on one clock, by that of the device.
/// @return where it was set
std::vector<ClockSetting> correct_host_clock(std::vector<A50Report>& reports) {
  std::vector<ReceivedMessage> messages;
  for (const A50Report& report : reports) {
    if (report.host_clock_s) messages.push_back({*report.host_clock_s, report.made_s});
  }
  ReceiverTimes times = receiver_times(messages);
  auto next = times.times_s.begin();
  for (A50Report& report : reports) {
    if (report.host_clock_s) report.host_clock_s = *next++;
  }
  return std::move(times.settings);
}

/// Puts reports on one clock: the host's where the log has it, else the device's, else the sum of the steps.
class ReportTimes {
 public:
  /// @param reports  of the whole log: where velocities have no times, those of positions are of another clock
  explicit ReportTimes(const std::vector<A50Report>& reports)
      : counts_steps_(std::ranges::any_of(reports, [](const A50Report& report) {
          return is_velocity(report) && !report.made_s && !report.host_clock_s;
        })) {}

  double time_of(const A50Report& report) {
    if (report.host_clock_s) return *report.host_clock_s - report.latency_s;
    if (report.made_s && (is_velocity(report) || !counts_steps_)) return *report.made_s;
    elapsed_s_ += report.step_s.value_or(0.0);
    return elapsed_s_;
  }

 private:
  bool counts_steps_;
  double elapsed_s_ = 0.0;
};

/// Devices send both forms of a velocity.
void leave_out_deprecated(std::vector<A50Report>& reports) {
  const auto is_new = [](const A50Report& report) { return is_velocity(report) && !report.is_deprecated; };
  if (std::ranges::any_of(reports, is_new))
    std::erase_if(reports, [](const A50Report& report) { return report.is_deprecated; });
}

}  // namespace

bool looks_like_a50(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kLookedAt = 16'384;
  constexpr int kLines = 10;
  const std::string_view text = text_of(bytes.first(std::min(bytes.size(), kLookedAt)));
  std::size_t from = 0;
  for (int i = 0; i < kLines; ++i) {
    const auto line = next_line(text, from);
    if (!line) return false;
    if (i == 0 && columns_in(line->text)) return true;
    const std::size_t brace = line->text.find('{');
    if (brace != std::string_view::npos) {
      const auto members = json_members(line->text.substr(brace));
      if (!members) continue;
      for (const auto& [name, value] : *members) {
        if (name == "velocity_valid" || (name == "format" && value.starts_with("json_v"))) return true;
      }
    } else if (line->text.starts_with("wr") && a50_serial_report(trim(line->text))) {
      return true;
    }
  }
  return false;
}

NavReading read_a50(std::span<const std::uint8_t> bytes) {
  NavReading reading;
  const std::string_view text = text_of(bytes);
  const std::string kName = "A50";
  std::vector<A50Report> reports;
  std::size_t from = 0;
  std::optional<std::vector<std::string_view>> columns;
  bool is_first = true;
  while (const auto line = next_line(text, from)) {
    if (std::exchange(is_first, false)) {
      columns = columns_in(line->text);
      if (columns) continue;
    }
    const A50Reading report = columns ? table_report(line->text, *columns) : report_in(line->text);
    if (!report) {
      add_damage(reading.damage, line->has_end ? report.error() : FrameFinder::kCutOff, line->at);
      continue;
    }
    ++reading.records;
    if (report->kind == A50Report::Kind::kOther) continue;
    if (report->host_clock_s) reading.clock = NavClock::kUnix;
    reports.push_back(*report);
  }
  leave_out_deprecated(reports);
  reading.settings = correct_host_clock(reports);
  NavSources sources;
  ReportTimes times(reports);
  for (const A50Report& report : reports) add_a50_report(sources, kName, times.time_of(report), report);
  reading.sources = sources.take();
  return reading;
}

}  // namespace pingvox
