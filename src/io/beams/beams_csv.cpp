#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "io/beams/angle_units.hpp"
#include "io/bytes/text.hpp"
#include "io/readers.hpp"
#include "pingvox/geometry/degree.hpp"

// Beams as text: a header line with the columns, then a beam in each line (docs/formats.md).
namespace pingvox {
namespace {

enum class Column { kTime, kBearingRad, kBearingDeg, kBearingClockwiseDeg, kBinLength, kIntensities, kOther };

Column column_of(std::string_view name) {
  if (name == "time_s") return Column::kTime;
  if (name == "bearing_rad") return Column::kBearingRad;
  if (name == "bearing_deg") return Column::kBearingDeg;
  if (name == "bearing_cw_deg") return Column::kBearingClockwiseDeg;
  if (name == "bin_length_m") return Column::kBinLength;
  if (name == "intensities" || name == "intensities...") return Column::kIntensities;
  return Column::kOther;
}

bool is_bearing(Column c) {
  return c == Column::kBearingRad || c == Column::kBearingDeg || c == Column::kBearingClockwiseDeg;
}

/// Separator of a file: spreadsheets write commas or semicolons, depending on the locale.
char separator_of(std::string_view header) {
  return header.find(';') == std::string_view::npos ? ',' : ';';
}

std::vector<Column> columns_in(std::string_view header) {
  std::vector<Column> columns;
  const char separator = separator_of(header);
  while (const auto name = cut_field(header, separator)) {
    // Limits the work on a line of commas.
    if (columns.size() == 64) break;
    columns.push_back(column_of(*name));
  }
  return columns;
}

/// Error of a header; empty if it is valid.
std::string_view problem_of(const std::vector<Column>& columns) {
  const auto count = [&columns](auto matches) {
    std::size_t n = 0;
    for (const Column c : columns) n += matches(c) ? 1 : 0;
    return n;
  };
  const auto count_of = [&count](Column wanted) { return count([wanted](Column c) { return c == wanted; }); };
  if (count_of(Column::kTime) != 1) return "the header needs one column time_s";
  if (count(is_bearing) > 1) return "the header has two of the columns bearing_rad, bearing_deg, bearing_cw_deg";
  if (count(is_bearing) != 1) return "the header needs one of the columns bearing_rad, bearing_deg, bearing_cw_deg";
  if (count_of(Column::kBinLength) != 1) return "the header needs one column bin_length_m";
  if (count_of(Column::kIntensities) != 1 || columns.back() != Column::kIntensities) {
    return "the header needs the column intensities as its last one";
  }
  return {};
}

double bearing_of(Column column, double number) {
  if (column == Column::kBearingDeg) number *= kDegree_rad;
  if (column == Column::kBearingClockwiseDeg) number *= -kDegree_rad;
  // Valid bearings are kept as they are, so that written files are read back exactly.
  return number >= 0.0 && number < 2.0 * std::numbers::pi ? number : wrap_bearing(number);
}

AngleUnit unit_of(Column column) {
  return column == Column::kBearingRad ? AngleUnit::kRadian : AngleUnit::kDegree;
}

/// The numbers in the column of bearings, of as many beams as tell their unit. REQUIRES such a column.
AngleUnits first_bearings(Lines lines, const std::vector<Column>& columns, char separator) {
  const auto column = std::ranges::find_if(columns, is_bearing);
  AngleUnits bearings(unit_of(*column));
  for (std::size_t n = 0; n < AngleUnits::kMaxAngles && !bearings.are_enough(); ++n) {
    std::optional<std::string_view> line = lines.next_with_content();
    if (!line) break;
    for (auto c = columns.begin(); c != column; ++c) cut_field(*line, separator);
    const auto field = cut_field(*line, separator);
    const std::optional<double> number = field ? number_in(*field) : std::nullopt;
    if (number) bearings.add(*number);
  }
  return bearings;
}

/// What is wrong with the unit of bearings; empty: nothing.
std::string problem_of(Column column, const AngleUnits& bearings) {
  const std::optional<AngleUnit> unit = bearings.unit();
  if (unit == unit_of(column)) return {};
  if (column != Column::kBearingRad) {
    return "the column of bearings in degrees " + bearings.problem_text();
  }
  if (unit == AngleUnit::kGradian) {
    return fmt::format("the column bearing_rad holds gradians, it seems: its numbers go {}: multiply them by pi/200",
                       bearings.range_text());
  }
  return fmt::format(
      "the column bearing_rad holds degrees, it seems: its numbers go {}: name it bearing_deg, or "
      "bearing_cw_deg if they count clockwise",
      bearings.range_text());
}

std::optional<std::uint8_t> intensity_in(std::string_view field) {
  const std::optional<double> number = number_in(field);
  if (!number || *number < 0.0 || *number > 255.0 || *number != std::floor(*number)) return std::nullopt;
  return static_cast<std::uint8_t>(*number);
}

/// Parses a line; the error is the reason why it is invalid.
tl::expected<Beam, std::string> beam_in(std::string_view line, const std::vector<Column>& columns, char separator) {
  Beam beam;
  for (const Column column : columns) {
    if (column == Column::kIntensities) break;
    const auto field = cut_field(line, separator);
    if (!field) return tl::unexpected(std::string("has too few columns"));
    if (column == Column::kOther) continue;
    const std::optional<double> number = number_in(*field);
    if (!number) return tl::unexpected(fmt::format("\"{}\" is not a finite number", printable(*field)));
    if (column == Column::kTime) beam.time_s = *number;
    if (column == Column::kBinLength) beam.bin_length_m = *number;
    if (is_bearing(column)) beam.bearing_rad = bearing_of(column, *number);
  }
  while (const auto field = cut_field(line, separator)) {
    const std::optional<std::uint8_t> intensity = intensity_in(*field);
    if (!intensity) {
      return tl::unexpected(fmt::format("intensity {}, \"{}\", is not a whole number in 0..255",
                                        beam.intensities.size(), printable(*field)));
    }
    beam.intensities.push_back(*intensity);
  }
  if (const Result<void> valid = validate(beam); !valid) return tl::unexpected(valid.error().message);
  return beam;
}

class CsvSource : public BeamSource {
 public:
  CsvSource(FileBytes file, Damage damage, Lines lines, std::vector<Column> columns, char separator)
      : file_(std::move(file)), damage_(damage), lines_(lines), columns_(std::move(columns)), separator_(separator) {}

  Result<std::optional<Beam>> next() override {
    while (const auto line = lines_.next_with_content()) {
      tl::expected<Beam, std::string> beam = beam_in(*line, columns_, separator_);
      if (beam && !lines_.has_end() && beam->intensities.size() < bins_before_) {
        beam =
            tl::unexpected(fmt::format("ends after {} intensities, without an end of the line (the beam before has {})",
                                       beam->intensities.size(), bins_before_));
      }
      if (beam) {
        bins_before_ = beam->intensities.size();
        return std::move(*beam);
      }
      const auto damaged =
          handle_damage(damage_, skipped_, file_.name, fmt::format("line {}", lines_.number()), beam.error());
      if (!damaged) return tl::unexpected(damaged.error());
    }
    return std::nullopt;
  }

  std::size_t skipped() const override { return skipped_.count; }
  std::string first_damage() const override { return skipped_.first; }
  std::optional<double> share_read() const override { return read_share(lines_.left(), file_.bytes.size()); }

 private:
  FileBytes file_;
  Damage damage_;
  Lines lines_;  ///< view of file_, whose bytes do not move with it
  std::vector<Column> columns_;
  char separator_;
  SkippedRecords skipped_;
  std::size_t bins_before_ = 0;  ///< of the previous beam
};

}  // namespace

bool looks_like_csv(std::span<const std::uint8_t> bytes) {
  Lines lines(text_of(bytes));
  const auto header = lines.next_with_content();
  if (!header) return false;
  // One known column is enough: open_csv then reports errors in the others.
  for (const Column column : columns_in(*header)) {
    if (column != Column::kOther) return true;
  }
  return false;
}

Result<std::unique_ptr<BeamSource>> open_csv(FileBytes file, Damage damage) {
  Lines lines(text_of(file.view()));
  const auto header = lines.next_with_content();
  if (!header) return fail(Error::Code::kCorrupt, fmt::format("{}: holds no line that names the columns", file.name));
  std::vector<Column> columns = columns_in(*header);
  if (const std::string_view problem = problem_of(columns); !problem.empty()) {
    return fail(Error::Code::kCorrupt, fmt::format("{}: line {}: {}", file.name, lines.number(), problem));
  }
  const char separator = separator_of(*header);
  const Column bearing = *std::ranges::find_if(columns, is_bearing);
  const std::string problem = problem_of(bearing, first_bearings(lines, columns, separator));
  if (!problem.empty()) return fail(Error::Code::kCorrupt, fmt::format("{}: {}", file.name, problem));
  return std::make_unique<CsvSource>(std::move(file), damage, lines, std::move(columns), separator);
}

Result<std::size_t> write_csv(BeamSource& beams, std::ostream& out) {
  out << "time_s,bearing_rad,bin_length_m,intensities\n";
  std::string line;
  for (std::size_t count = 0;; ++count) {
    const Result<std::optional<Beam>> beam = beams.next();
    if (!beam) return tl::unexpected(beam.error());
    if (!*beam) {
      if (!out.flush()) return fail(Error::Code::kIo, "the beams could not be written");
      return count;
    }
    line.clear();
    auto to = std::back_inserter(line);
    fmt::format_to(to, "{},{},{}", (*beam)->time_s, (*beam)->bearing_rad, (*beam)->bin_length_m);
    for (const std::uint8_t intensity : (*beam)->intensities) fmt::format_to(to, ",{}", unsigned{intensity});
    line.push_back('\n');
    // Stops early when the disk is full.
    if (!out.write(line.data(), static_cast<std::streamsize>(line.size()))) {
      return fail(Error::Code::kIo, "the beams could not be written");
    }
  }
}

}  // namespace pingvox
