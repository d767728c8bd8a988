#include <fmt/core.h>

#include <array>
#include <cmath>
#include <deque>
#include <optional>
#include <utility>

#include "io/beams/angle_units.hpp"
#include "io/beams/mat5.hpp"
#include "io/readers.hpp"
#include "pingvox/geometry/degree.hpp"

// Beams in a MATLAB file: an array of structs parsedData(k) with the fields time [s], angle [deg, clockwise from
// ahead], step_dist [m] and intensities (docs/formats.md).
namespace pingvox {
namespace {

constexpr std::string_view kVariable = "parsedData";
enum Field : std::size_t { kTime, kAngle, kStepDist, kIntensities, kFieldCount };
constexpr std::array<std::string_view, kFieldCount> kFieldNames = {"time", "angle", "step_dist", "intensities"};

/// Converts a record; the error is the reason why it is invalid.
tl::expected<Beam, std::string> beam_in(const std::array<std::optional<mat5::NumericArray>, kFieldCount>& fields) {
  std::array<double, kIntensities> numbers = {};
  for (std::size_t i = 0; i < kFieldCount; ++i) {
    if (!fields[i] || fields[i]->size() == 0) {
      return tl::unexpected(fmt::format("{} is missing, empty or no array of numbers", kFieldNames[i]));
    }
    if (i == kIntensities) continue;
    if (fields[i]->size() != 1) return tl::unexpected(fmt::format("{} is more than one number", kFieldNames[i]));
    numbers[i] = fields[i]->at(0);
    if (!std::isfinite(numbers[i])) return tl::unexpected(fmt::format("{} is not a finite number", kFieldNames[i]));
  }

  Beam beam;
  beam.time_s = numbers[kTime];
  beam.bearing_rad = wrap_bearing(-numbers[kAngle] * kDegree_rad);
  beam.bin_length_m = numbers[kStepDist];
  const mat5::NumericArray& intensities = *fields[kIntensities];
  beam.intensities.reserve(intensities.size());
  for (std::size_t i = 0; i < intensities.size(); ++i) {
    // Averaged recordings have fractions.
    const double intensity = std::round(intensities.at(i));
    if (!(intensity >= 0.0 && intensity <= 255.0)) {
      return tl::unexpected(fmt::format("intensity {} is not in 0..255", i));
    }
    beam.intensities.push_back(static_cast<std::uint8_t>(intensity));
  }
  if (const Result<void> valid = validate(beam); !valid) return tl::unexpected(valid.error().message);
  return beam;
}

class MatSource : public BeamSource {
 public:
  MatSource(std::string name, Damage damage, mat5::StructArray records, std::array<std::size_t, kFieldCount> places)
      : name_(std::move(name)),
        damage_(damage),
        records_(std::move(records)),
        beams_(records_.elements_left()),
        places_(places) {}

  /// Reads the first beams, as many as tell the unit of their angles.
  Result<void> look_ahead() {
    AngleUnits angles(AngleUnit::kDegree);
    while (ahead_.size() < AngleUnits::kMaxAngles && !angles.are_enough()) {
      ahead_.push_back(read());
      if (!ahead_.back() || !*ahead_.back()) break;
      angles.add(angle_deg_);
    }
    const std::string problem = angles.problem_text();
    if (problem.empty()) return {};
    return fail(Error::Code::kCorrupt,
                fmt::format("{}: the field {}, in degrees, {}", name_, kFieldNames[kAngle], problem));
  }

  Result<std::optional<Beam>> next() override {
    if (ahead_.empty()) return read();
    Result<std::optional<Beam>> beam = std::move(ahead_.front());
    ahead_.pop_front();
    return beam;
  }

  std::size_t skipped() const override { return skipped_.count; }
  std::string first_damage() const override { return skipped_.first; }
  std::optional<double> share_read() const override { return read_share(records_.elements_left(), beams_); }

 private:
  Result<std::optional<Beam>> read() {
    while (const auto record = records_.next()) {
      ++record_;
      std::array<std::optional<mat5::NumericArray>, kFieldCount> fields;
      for (std::size_t i = 0; i < kFieldCount; ++i) fields[i] = (*record)[places_[i]];
      tl::expected<Beam, std::string> beam = beam_in(fields);
      if (beam) {
        angle_deg_ = fields[kAngle]->at(0);
        return std::move(*beam);
      }
      const auto damaged =
          handle_damage(damage_, skipped_, name_, fmt::format("{}({})", kVariable, record_), beam.error());
      if (!damaged) return tl::unexpected(damaged.error());
    }
    return std::nullopt;
  }

  std::string name_;
  Damage damage_;
  mat5::StructArray records_;
  std::uint64_t beams_;  ///< number of records
  std::array<std::size_t, kFieldCount> places_;
  std::size_t record_ = 0;  ///< from 1, as MATLAB counts
  SkippedRecords skipped_;
  std::deque<Result<std::optional<Beam>>> ahead_;
  double angle_deg_ = 0.0;  ///< of the last beam, as it is in the file
};

}  // namespace

bool looks_like_mat(std::span<const std::uint8_t> bytes) {
  return mat5::looks_like_matlab(bytes);
}

Result<std::unique_ptr<BeamSource>> open_mat(FileBytes file, Damage damage) {
  const std::string name = file.name;
  Result<mat5::StructArray> records = mat5::StructArray::open(std::move(file), kVariable);
  if (!records) return tl::unexpected(records.error());
  std::array<std::size_t, kFieldCount> places = {};
  for (std::size_t i = 0; i < kFieldCount; ++i) {
    const std::optional<std::size_t> place = records->field(kFieldNames[i]);
    if (!place) {
      return fail(Error::Code::kUnsupported, fmt::format("{}: {} has no field {}", name, kVariable, kFieldNames[i]));
    }
    places[i] = *place;
  }
  auto source = std::make_unique<MatSource>(name, damage, std::move(*records), places);
  if (const Result<void> known = source->look_ahead(); !known) return tl::unexpected(known.error());
  return source;
}

}  // namespace pingvox
