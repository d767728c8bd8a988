#include "pingvox/sonar/beam.hpp"

#include <fmt/core.h>

#include <cmath>
#include <numbers>
#include <utility>

namespace pingvox {

Result<void> validate(const Beam& beam) {
  const auto corrupt = [](std::string what) { return fail(Error::Code::kCorrupt, std::move(what)); };
  if (!std::isfinite(beam.time_s)) return corrupt("time is not a finite number");
  if (!(beam.bearing_rad >= 0.0 && beam.bearing_rad < 2.0 * std::numbers::pi)) {
    return corrupt(fmt::format("bearing {} rad is not in [0, 2 pi)", beam.bearing_rad));
  }
  if (!(beam.bin_length_m > 0.0)) return corrupt(fmt::format("bin length {} m is not > 0", beam.bin_length_m));
  const double range_m = static_cast<double>(beam.intensities.size()) * beam.bin_length_m;
  if (!(range_m <= kMaxBeamRange_m)) {
    return corrupt(fmt::format("a range of {:.6g} m is too long for a scanning sonar", range_m));
  }
  return {};
}

double wrap_bearing(double angle_rad) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const double wrapped = angle_rad - kTurn * std::floor(angle_rad / kTurn);
  // A tiny negative angle rounds up to a whole turn; -0 becomes 0.
  return wrapped > 0.0 && wrapped < kTurn ? wrapped : 0.0;
}

std::string first_damage_text(const DamageKind& kind) {
  return kind.first_byte ? fmt::format("byte {}: {}", *kind.first_byte, kind.what) : std::string(kind.what);
}

std::size_t damage_count(std::span<const DamageKind> kinds) {
  std::size_t count = 0;
  for (const DamageKind& kind : kinds) count += kind.count;
  return count;
}

std::size_t BeamSource::skipped() const {
  return damage_count(damage());
}

std::string BeamSource::first_damage() const {
  const std::vector<DamageKind> kinds = damage();
  return kinds.empty() ? "" : first_damage_text(kinds.front());
}

Result<std::optional<Beam>> BeamsInMemory::next() {
  if (next_ == beams_.size()) return std::nullopt;
  return std::move(beams_[next_++]);
}

Result<std::vector<Beam>> read_all(BeamSource& source) {
  std::vector<Beam> beams;
  for (;;) {
    Result<std::optional<Beam>> beam = source.next();
    if (!beam) return tl::unexpected(beam.error());
    if (!*beam) return beams;
    beams.push_back(std::move(**beam));
  }
}

}  // namespace pingvox
