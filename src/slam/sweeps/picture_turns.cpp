#include "slam/internal/picture_turns.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "nav/internal/yaw_clock.hpp"
#include "slam/sweeps/level_head.hpp"

namespace pingvox {
namespace {

constexpr int kDirections = 180, kRanges = 64;
constexpr double kStep_rad = 2.0 * std::numbers::pi / kDirections;
constexpr int kWindow = 15, kMaxShift = 30;  ///< 30 and 60 degrees
constexpr double kBlanking_m = 0.75;

/// A sweep by direction and range, less what all directions hear at a range.
class TurnPicture {
 public:
  explicit TurnPicture(const Sweep& sweep) : time_s_(kDirections, 0.0), beams_(kDirections, 0.0), cells_(kDirections) {
    for (const Beam& beam : sweep.beams) range_m_ = std::max(range_m_, range_of(beam));
    for (const Beam& beam : sweep.beams) {
      const auto n = static_cast<std::size_t>(beam.bearing_rad / kStep_rad) % kDirections;
      time_s_[n] += beam.time_s;
      beams_[n] += 1.0;
      add(beam, cells_[n]);
    }
    Row mean{};
    float known = 0.0F;
    for (std::size_t n = 0; n < kDirections; ++n) {
      if (beams_[n] == 0.0) continue;
      time_s_[n] /= beams_[n];
      known += 1.0F;
      for (std::size_t i = 0; i < kRanges; ++i) {
        cells_[n][i] /= static_cast<float>(beams_[n]);
        mean[i] += cells_[n][i];
      }
    }
    for (std::size_t n = 0; n < kDirections; ++n) {
      for (std::size_t i = 0; i < kRanges && has(n); ++i) cells_[n][i] -= mean[i] / known;
    }
    for (std::size_t n = 0; n < kDirections; ++n) fill_behind(n);
    for (std::size_t n = 0; n < kDirections; ++n) {
      for (const float cell : cells_[n]) energies_[n] += cell * cell;
    }
  }

  double range_m() const { return range_m_; }
  bool has(std::size_t n) const { return beams_[n] > 0.0; }
  double time_s(std::size_t n) const { return time_s_[n]; }
  const std::array<float, kRanges>& row(std::size_t n) const { return cells_[n]; }
  /// The sum of the squares of its row.
  float energy(std::size_t n) const { return energies_[n]; }

  static std::size_t wrap(int n) { return static_cast<std::size_t>((n % kDirections + kDirections) % kDirections); }

  /// The mean time of a window of directions. nullopt: one of them is not known, or the head was elsewhere in between.
  std::optional<double> window_time_s(int first) const {
    double sum_s = 0.0, least_s = std::numeric_limits<double>::infinity(), most_s = -least_s;
    for (int i = 0; i < kWindow; ++i) {
      const std::size_t n = wrap(first + i);
      if (!has(n)) return std::nullopt;
      sum_s += time_s_[n];
      least_s = std::min(least_s, time_s_[n]);
      most_s = std::max(most_s, time_s_[n]);
    }
    const double ends_s = std::abs(time_s_[wrap(first + kWindow - 1)] - time_s_[wrap(first)]);
    if (most_s - least_s > ends_s * 1.01) return std::nullopt;
    return sum_s / kWindow;
  }

 private:
  using Row = std::array<float, kRanges>;

  static double range_of(const Beam& beam) { return static_cast<double>(beam.intensities.size()) * beam.bin_length_m; }

  /// Between the beams of a head with large steps: what is between their neighbours.
  void fill_behind(std::size_t n) {
    constexpr std::size_t kMaxEmpty = 3;
    std::size_t empty = 0;
    while (empty <= kMaxEmpty && !has((n + 1 + empty) % kDirections)) ++empty;
    if (!has(n) || empty == 0 || empty > kMaxEmpty) return;
    const std::size_t end = (n + 1 + empty) % kDirections;
    for (std::size_t i = 1; i <= empty; ++i) {
      const std::size_t at = (n + i) % kDirections;
      const double share = static_cast<double>(i) / static_cast<double>(empty + 1);
      time_s_[at] = time_s_[n] + share * (time_s_[end] - time_s_[n]);
      for (std::size_t r = 0; r < kRanges; ++r) {
        cells_[at][r] = cells_[n][r] + static_cast<float>(share) * (cells_[end][r] - cells_[n][r]);
      }
      beams_[at] = 1.0;
    }
  }

  void add(const Beam& beam, Row& row) const {
    const double per_cell_m = (range_m_ - kBlanking_m) / kRanges;
    Row strongest{};
    for (std::size_t i = 0; i < beam.intensities.size(); ++i) {
      const double place = ((static_cast<double>(i) + 0.5) * beam.bin_length_m - kBlanking_m) / per_cell_m;
      if (!(place >= 0.0 && place < kRanges)) continue;
      float& cell = strongest[static_cast<std::size_t>(place)];
      cell = std::max(cell, static_cast<float>(beam.intensities[i]));
    }
    for (std::size_t i = 0; i < kRanges; ++i) row[i] += strongest[i];
  }

  double range_m_ = 0.0;
  std::vector<double> time_s_, beams_;  ///< by direction
  std::vector<Row> cells_;
  std::array<float, kDirections> energies_{};
};

/// Normalised correlation of two windows of directions; 0 where nothing is heard.
double correlation(const TurnPicture& a, int first_a, const TurnPicture& b, int first_b) {
  double ab = 0.0, aa = 0.0, bb = 0.0;
  for (int i = 0; i < kWindow; ++i) {
    const std::size_t in_a = TurnPicture::wrap(first_a + i), in_b = TurnPicture::wrap(first_b + i);
    float row_ab = 0.0F;
    for (std::size_t r = 0; r < kRanges; ++r) row_ab += a.row(in_a)[r] * b.row(in_b)[r];
    ab += static_cast<double>(row_ab);
    aa += static_cast<double>(a.energy(in_a));
    bb += static_cast<double>(b.energy(in_b));
  }
  const double scale = std::sqrt(aa * bb);
  return scale > 0.0 ? ab / scale : 0.0;
}

/// Where a window of the first picture is in the second.
std::optional<YawChange> change_of(const TurnPicture& before, const TurnPicture& after, int first) {
  constexpr double kAlike = 0.6, kClearer = 0.2, kNone = -2.0;
  const auto from_s = before.window_time_s(first);
  if (!from_s) return std::nullopt;
  std::array<double, 2 * kMaxShift + 1> alike{};
  alike.fill(kNone);
  std::vector<double> known;
  for (int shift = -kMaxShift; shift <= kMaxShift; ++shift) {
    if (!after.window_time_s(first + shift)) continue;
    const double value = correlation(before, first, after, first + shift);
    alike[static_cast<std::size_t>(shift + kMaxShift)] = value;
    known.push_back(value);
  }
  const auto best = static_cast<std::size_t>(std::ranges::max_element(alike) - alike.begin());
  const bool is_inside = best > 0 && best + 1 < alike.size() && alike[best - 1] > kNone && alike[best + 1] > kNone;
  if (!is_inside) return std::nullopt;
  std::ranges::nth_element(known, known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2));
  if (alike[best] < kAlike || alike[best] - known[known.size() / 2] < kClearer) return std::nullopt;
  // The top of the parabola through the best and its neighbours.
  const double bend = alike[best - 1] - 2.0 * alike[best] + alike[best + 1];
  const double part = bend < 0.0 ? 0.5 * (alike[best - 1] - alike[best + 1]) / bend : 0.0;
  const int shift = static_cast<int>(best) - kMaxShift;
  const double to_s = *after.window_time_s(first + shift), next_s = *after.window_time_s(first + shift + 1);
  const double spread_s =
      std::abs(before.time_s(TurnPicture::wrap(first + kWindow - 1)) - before.time_s(TurnPicture::wrap(first)));
  return YawChange{*from_s, to_s + part * (next_s - to_s), -(shift + part) * kStep_rad, spread_s};
}

}  // namespace

PictureTurns::PictureTurns(const Pose& body_from_sonar)
    : sense_(!is_level(body_from_sonar)        ? 0.0
             : is_upside_down(body_from_sonar) ? -1.0
                                               : 1.0) {}

void PictureTurns::add(Beam beam) {
  if (sense_ == 0.0) return;
  if (last_s_ && beam.time_s - *last_s_ >= kMinPause_s) pauses_.push_back({*last_s_, beam.time_s});
  last_s_ = beam.time_s;
  if (auto sweep = assembler_.add(std::move(beam))) compare(*std::move(sweep));
}

std::vector<YawChange> PictureTurns::finish() {
  if (auto sweep = assembler_.finish()) compare(*std::move(sweep));
  return std::move(changes_);
}

void PictureTurns::compare(Sweep sweep) {
  constexpr double kSameRange = 0.01;
  if (!before_.beams.empty()) {
    const TurnPicture before(before_), after(sweep);
    const bool same_range = std::abs(before.range_m() - after.range_m()) <= kSameRange * after.range_m();
    for (int first = 0; first < kDirections && same_range && after.range_m() > kBlanking_m; first += kWindow) {
      auto change = change_of(before, after, first);
      if (!change) continue;
      change->by_rad *= sense_;
      changes_.push_back(*change);
    }
  }
  before_ = std::move(sweep);
}

}  // namespace pingvox
