#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/bytes/text.hpp"
#include "io/internal/frame_finder.hpp"
#include "io/nav/nav_readers.hpp"
#include "io/nav/nav_sources.hpp"
#include "nav/internal/pressure_unit.hpp"

// Navigation as text: a first line that names the columns, then a sample in each line (docs/formats.md).
namespace pingvox {
namespace {

constexpr std::string_view kClockLine = "# clock: ";
constexpr std::array<std::string_view, 10> kColumns = {"time_s", "source", "quantity", "x",    "y",
                                                       "z",      "sd_x",   "sd_y",     "sd_z", "valid"};
constexpr std::array kQuantities = {NavQuantity::kVelocity,   NavQuantity::kAttitude, NavQuantity::kHeading,
                                    NavQuantity::kTurnRate,   NavQuantity::kDepth,    NavQuantity::kPosition,
                                    NavQuantity::kFix,        NavQuantity::kRange,    NavQuantity::kPressure,
                                    NavQuantity::kTemperature};
enum NavColumn : std::size_t { kTime, kSource, kQuantity, kX, kY, kZ, kSdX, kSdY, kSdZ, kValid };
constexpr std::size_t kNone = kColumns.size();

std::vector<std::size_t> csv_columns_in(std::string_view header) {
  std::vector<std::size_t> columns;
  while (const auto name = cut_field(header, ',')) {
    // No file of ours has more; a line of nothing but commas is no header.
    if (columns.size() == 64) break;
    columns.push_back(static_cast<std::size_t>(std::find(kColumns.begin(), kColumns.end(), *name) - kColumns.begin()));
  }
  return columns;
}

bool has(const std::vector<std::size_t>& columns, std::size_t column) {
  return std::count(columns.begin(), columns.end(), column) == 1;
}

/// What the comments above the names of the columns say; spreadsheets fill them up with commas.
NavClock clock_in(std::string_view text) {
  NavClock clock = NavClock::kUnknown;
  Lines lines(text);
  for (auto line = lines.next(); line && (trim(*line).empty() || line->starts_with('#')); line = lines.next()) {
    if (!line->starts_with(kClockLine)) continue;
    const std::string_view name = trim(line->substr(kClockLine.size()), " \t,");
    if (name == name_of(NavClock::kUnix)) clock = NavClock::kUnix;
    if (name == name_of(NavClock::kBoot)) clock = NavClock::kBoot;
  }
  return clock;
}

struct NamedSample {
  std::string source;
  NavQuantity quantity;
  NavSample sample;
};

constexpr std::string_view kNoSample = "line that is not a sample", kNotValid = "line whose valid is neither 0 nor 1";

struct NoSample {
  std::string_view kind;  ///< of damage
  std::string what;       ///< "quantity 'orientation' is not one of velocity, attitude ..."
};

tl::unexpected<NoSample> no_sample(std::string what, std::string_view kind = kNoSample) {
  return tl::unexpected(NoSample{kind, std::move(what)});
}

tl::unexpected<NoSample> not_a_number(std::string_view column, std::string_view text) {
  return no_sample(fmt::format("{} '{}' is not a finite number{}", column, printable(text),
                               column == kColumns[kTime] ? " of seconds" : ""));
}

/// As name_of has it, or "Turn_Rate".
std::optional<NavQuantity> quantity_in(std::string_view text) {
  std::string name;
  for (const char c : text) name += c == '_' ? ' ' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return nav_quantity_of(name);
}

std::string names_of_quantities() {
  std::string names;
  for (const NavQuantity quantity : kQuantities)
    names += fmt::format("{}{}", names.empty() ? "" : ", ", name_of(quantity));
  return names;
}

tl::expected<NamedSample, NoSample> sample_in(std::string_view line, const std::vector<std::size_t>& columns) {
  std::array<std::string_view, kColumns.size()> fields;
  for (const std::size_t column : columns) {
    const auto field = cut_field(line, ',');
    if (!field) return no_sample("it has fewer columns than the first line");
    if (column != kNone) fields[column] = *field;
  }
  if (!line.empty()) return no_sample("it has more columns than the first line");
  NamedSample named;
  const auto time_s = number_in(fields[kTime]);
  if (!time_s) return not_a_number(kColumns[kTime], fields[kTime]);
  const auto quantity = quantity_in(fields[kQuantity]);
  if (!quantity) {
    return no_sample(
        fmt::format("quantity '{}' is not one of {}", printable(fields[kQuantity]), names_of_quantities()));
  }
  if (fields[kSource].empty()) return no_sample("source is empty");
  named.source = fields[kSource];
  named.quantity = *quantity;
  named.sample.time_s = *time_s;
  for (int i = 0; i < numbers_of(*quantity); ++i) {
    const std::size_t x = kX + static_cast<std::size_t>(i), sd_x = kSdX + static_cast<std::size_t>(i);
    const auto value = number_in(fields[x]);
    if (!value) return not_a_number(kColumns[x], fields[x]);
    named.sample.value[i] = *value;
    if (fields[sd_x].empty()) continue;
    const auto number = number_in(fields[sd_x]);
    if (!number) return not_a_number(kColumns[sd_x], fields[sd_x]);
    // Below 0 stands for "not known", as ROS has it.
    if (*number >= 0.0) named.sample.deviation[i] = *number;
  }
  if (fields[kValid] != "" && fields[kValid] != "0" && fields[kValid] != "1") {
    return no_sample(fmt::format("valid '{}' is neither 0 nor 1", printable(fields[kValid])), kNotValid);
  }
  named.sample.valid = fields[kValid] != "0";
  return named;
}

/// A name that is one field of one line.
std::string as_field(std::string name) {
  for (char& c : name) {
    if (c < ' ' || c > '~' || c == ',' || c == '#') c = '_';
  }
  if (name.find_first_not_of(' ') == std::string::npos) return "_";
  return name;
}

}  // namespace

bool looks_like_nav_csv(std::span<const std::uint8_t> bytes) {
  Lines lines(text_of(bytes));
  const auto columns = csv_columns_in(lines.next_with_content().value_or(""));
  return has(columns, kTime) && has(columns, kSource) && has(columns, kQuantity) && has(columns, kX);
}

NavReading read_nav_csv(std::span<const std::uint8_t> bytes) {
  NavReading reading;
  const std::string_view text = text_of(bytes);
  reading.clock = clock_in(text);
  Lines lines(text);
  const auto columns = csv_columns_in(lines.next_with_content().value_or(""));
  NavSources sources;
  std::size_t skipped = 0;
  std::string first_skipped;
  for (std::size_t at = text.size() - lines.left(); const auto line = lines.next_with_content();
       at = text.size() - lines.left()) {
    const auto named = sample_in(*line, columns);
    if (!named) {
      add_damage(reading.damage, named.error().kind, at);
      if (++skipped == 1) first_skipped = fmt::format("line {}: {}", lines.number(), named.error().what);
      continue;
    }
    sources.add(named->source, named->quantity, named->sample);
    ++reading.records;
  }
  constexpr std::size_t kMany = 10;  // not a damaged line, but another notation
  if (skipped * kMany >= skipped + reading.records && skipped > 0) {
    reading.notes.push_back(fmt::format("{} of {} lines are not samples, the first: {}", skipped,
                                        skipped + reading.records, first_skipped));
  }
  reading.sources = sources.take();
  tell_pressures(reading.sources);
  return reading;
}

Result<std::size_t> write_nav_csv(const NavLog& log, std::ostream& out) {
  out << kClockLine << name_of(log.clock()) << '\n' << fmt::format("{}\n", fmt::join(kColumns, ","));
  std::size_t samples = 0;
  for (const NavSource& source : log.sources()) {
    const int used = numbers_of(source.quantity);
    const std::string name = as_field(source.name);
    for (const NavSample& sample : source.samples) {
      std::string line = fmt::format("{},{},{}", sample.time_s, name, name_of(source.quantity));
      for (int i = 0; i < 3; ++i) line += i < used ? fmt::format(",{}", sample.value[i]) : ",";
      for (int i = 0; i < 3; ++i) {
        line += i < used && std::isfinite(sample.deviation[i]) ? fmt::format(",{}", sample.deviation[i]) : ",";
      }
      out << line << (sample.valid ? ",1\n" : ",0\n");
      ++samples;
    }
  }
  if (!out.flush()) return fail(Error::Code::kIo, "the navigation could not be written");
  return samples;
}

}  // namespace pingvox
