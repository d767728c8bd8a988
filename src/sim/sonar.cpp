#include "pingvox/sim/sonar.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/option_errors.hpp"

namespace pingvox {
namespace {

using Eigen::Vector3d;

/// Amplitudes are rounded to 1 / kScale, and noise uses integers and square roots only, so that the last bit of exp()
/// or cos(), which differs between machines, does not change a byte.
constexpr double kScale = 256.0;

/// Amplitude (255: full scale) of a hypothetical wall of scatter 1 that fills the whole beam in one bin. Tuned, like
/// the ringing and the default options, to the paper's recording of a tank.
constexpr double kFullAmplitude = 150.0;
constexpr double kRingingAmplitude = 50.0;
/// Decay length of the ringing.
constexpr double kRingingDecay_m = 0.02;
constexpr double kPulse_bins = 1.5;  ///< standard deviation of the received pulse
/// Energies are collected in cells finer than bins, then convolved with the pulse.
constexpr int kCellsPerBin = 4;
constexpr double kNoiseBin_m = 0.0125;  ///< bin length that SonarOptions::noise refers to
constexpr int kMaxBounces = 3;
/// Angle of incidence at which the glint has fallen to 1 / e.
constexpr double kGlintWidth_rad = 0.17;
/// Rays weaker than this, relative to the beam's axis, are ignored.
constexpr double kMinGain = 1e-7;

/// Rays of the bundle to either side of the axis, past the first side lobe.
constexpr int kAcross = 14, kUp = 22;
constexpr double kAcrossEnd_widths = 2.25, kUpEnd_heights = 1.75, kUpEnd_rad = 1.45;

Vector3d direction_of(double bearing_rad, double elevation_rad) {
  return {std::cos(elevation_rad) * std::cos(bearing_rad), std::cos(elevation_rad) * std::sin(bearing_rad),
          std::sin(elevation_rad)};
}

/// One-way amplitude of a uniform transducer of half-power width `width`, at `off` from its axis: sin(u) / u.
double amplitude(double off_rad, double width_rad, double side_lobes) {
  constexpr double kHalfPower = 1.391557;  // sin(u) / u = sqrt(1 / 2)
  const double u = std::abs(kHalfPower * std::sin(off_rad) / std::sin(0.5 * width_rad));
  if (u < 1e-9) return 1.0;
  return std::sin(u) / u * (u > std::numbers::pi ? side_lobes : 1.0);
}

/// Two-way power.
double two_way(double one_way_amplitude) {
  const double power = one_way_amplitude * one_way_amplitude;
  return power * power;
}

double backscatter(const Material& material, double cosine) {
  const double off = std::acos(std::min(cosine, 1.0)) / kGlintWidth_rad;
  return material.scatter * cosine + material.glint * std::exp(-off * off);
}

/// Two-way transmission loss as a factor of amplitude, 1 at 1 m, before the receiver's gain.
double loss(const SonarOptions& o, double range_m) {
  const double range = std::max(range_m, 0.1);
  return std::pow(10.0, -2.0 * o.absorption_db_per_m * (range - 1.0) / 20.0) / range;
}

/// Spreads `energy` evenly from `from` to `to` [cells].
void add_evenly(double from, double to, double energy, std::vector<double>& cells) {
  const double end = static_cast<double>(cells.size());
  if (!(to > 0.0 && from < end)) return;
  const double per_cell = energy / (to - from);
  const double first = std::max(from, 0.0);
  const double last = std::min(to, end);
  for (auto cell = static_cast<std::size_t>(first); cell < cells.size(); ++cell) {
    const double low = static_cast<double>(cell);
    if (low >= last) break;
    cells[cell] += per_cell * (std::min(low + 1.0, last) - std::max(low, first));
  }
}

/// Convolves the cells with the pulse and samples them at the bins.
std::vector<double> sum_to_bins(const std::vector<double>& cells, std::size_t bins) {
  constexpr int kReach = static_cast<int>(4.0 * kPulse_bins * kCellsPerBin);
  std::vector<double> pulse;
  for (int off = -kReach; off <= kReach; ++off) {
    const double share = off / (kPulse_bins * kCellsPerBin);
    pulse.push_back(std::exp(-0.5 * share * share));
  }
  std::vector<double> energies(bins);
  for (std::size_t bin = 0; bin < bins; ++bin) {
    // The centre of a bin lies between two cells: take as many on either side.
    const std::ptrdiff_t middle = static_cast<std::ptrdiff_t>(bin) * kCellsPerBin + kCellsPerBin / 2;
    const std::ptrdiff_t first = middle - kReach;
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < pulse.size(); ++i) {
      const std::ptrdiff_t cell = first + static_cast<std::ptrdiff_t>(i);
      if (cell < 0 || cell >= static_cast<std::ptrdiff_t>(cells.size())) continue;
      sum += 0.5 * (pulse[i] + pulse[i + 1]) * cells[static_cast<std::size_t>(cell)];
    }
    energies[bin] = sum;
  }
  return energies;
}

/// Noise-free beam, bin by bin.
std::vector<std::uint32_t> clean_beam(const World& all_world, const Pose& map_from_sensor, double bearing_rad,
                                      const SonarOptions& o) {
  const double across_step = kAcrossEnd_widths * o.beam_width_rad / kAcross;
  const double up_step = std::min(kUpEnd_heights * o.beam_height_rad, kUpEnd_rad) / kUp;
  const double cell_m = o.bin_length_m / kCellsPerBin;
  // Echoes from behind the last bin still reach into it.
  std::vector<double> cells((o.bins + static_cast<std::size_t>(4.0 * kPulse_bins)) * kCellsPerBin);
  const double farthest_m = static_cast<double>(cells.size()) * cell_m;
  const World world = all_world.near(map_from_sensor.translation(), farthest_m);
  double all = 0.0;
  for (int up = -kUp; up <= kUp; ++up) {
    const double elevation = up * up_step;
    const double up_amplitude = amplitude(elevation, o.beam_height_rad, o.side_lobes);
    for (int across = -kAcross; across <= kAcross; ++across) {
      const double azimuth = across * across_step;
      const double gain =
          two_way(up_amplitude * amplitude(azimuth, o.beam_width_rad, o.side_lobes)) * std::cos(elevation);
      all += gain;
      if (gain < kMinGain) continue;
      const double bearing = bearing_rad + azimuth;
      // Steps of direction between neighbouring rays, sideways and upwards.
      Vector3d sideways = map_from_sensor.linear() * Vector3d(-std::sin(bearing), std::cos(bearing), 0.0) *
                          (across_step * std::cos(elevation));
      Vector3d upwards = map_from_sensor.linear() * direction_of(bearing, elevation + 0.5 * std::numbers::pi) * up_step;
      SoundRay ray{map_from_sensor.translation(), map_from_sensor.linear() * direction_of(bearing, elevation)};
      double way = 0.0;
      double share = gain;
      // The first surface, then those seen by mirroring. Sound returns on the path that it came.
      for (int bounce = 0; bounce < kMaxBounces && share >= kMinGain; ++bounce) {
        const auto hit = world.first(ray, farthest_m - way);
        if (!hit) break;
        way += hit->range_m;
        const Material& material = world.material(hit->surface);
        const double cosine = -hit->normal.dot(ray.direction);
        // The ray covers the patch half way to its neighbours, which a slanting surface spreads over range.
        const double slant = way / std::max(cosine, 0.01);
        const double spread =
            std::max((std::abs(hit->normal.dot(sideways)) + std::abs(hit->normal.dot(upwards))) * slant / cell_m, 1.0);
        const double middle = way / cell_m;
        const double loss_here = std::pow(loss(o, way), 1.0 - o.gain);
        add_evenly(middle - 0.5 * spread, middle + 0.5 * spread,
                   share * backscatter(material, cosine) * loss_here * loss_here, cells);
        share *= std::pow(material.mirror * o.multipath, 2.0);
        const auto mirror = [&hit](Vector3d& v) { v -= 2.0 * v.dot(hit->normal) * hit->normal; };
        ray.origin_m = ray.at(hit->range_m);
        mirror(ray.direction);
        mirror(sideways);
        mirror(upwards);
      }
    }
  }
  const std::vector<double> energies = sum_to_bins(cells, o.bins);
  std::vector<std::uint32_t> clean(o.bins);
  for (std::size_t bin = 0; bin < o.bins; ++bin) {
    const double heard_here = std::min(kFullAmplitude * std::sqrt(energies[bin] / all), 1e6);
    clean[bin] = static_cast<std::uint32_t>(std::lround(kScale * heard_here));
  }
  return clean;
}

}  // namespace

OptionErrors SonarOptions::errors() const {
  using enum Limits::Ends;
  OptionErrors errors;
  errors.require("beams_per_turn", beams_per_turn, {4.0, 6400.0});
  errors.require("bins", bins, {1.0, 10'000.0});
  errors.require("bin_length_m", bin_length_m, {1e-6, 1.0});
  errors.require(beams_per_s > 0.0 && std::isfinite(beams_per_s), "beams_per_s", "> 0", beams_per_s);
  errors.require("beam_width_rad", beam_width_rad, {0.0, 1.0, kLowOut});
  errors.require("beam_height_rad", beam_height_rad, {0.0, 2.0, kLowOut});
  errors.require("side_lobes", side_lobes, {0.0, 1.0});
  errors.require("bearing_step_rad", bearing_step_rad, {0.0, 1.0});
  errors.require("ringing_m", ringing_m, {0.0, 10'000.0});
  errors.require("gain", gain, {0.0, 1.0});
  errors.require("compression", compression, {0.1, 1.0});
  errors.require("absorption_db_per_m", absorption_db_per_m, {0.0, 10.0});
  errors.require("speckle", speckle, {0.0, 1.0});
  errors.require("noise", noise, {0.0, 255.0});
  errors.require("multipath", multipath, {0.0, 1.0});
  errors.require("silent", silent, {0.0, 1.0});
  errors.require("lost", lost, {0.0, 1.0, kHighOut});
  return errors;
}

Result<void> SonarOptions::validate() const {
  return errors().result("sonar");
}

TrueRange true_range(const World& all_world, const Pose& map_from_sensor, double bearing_rad,
                     const SonarOptions& options) {
  const World world = all_world.near(map_from_sensor.translation(), options.range_m());
  const double half_width = 0.5 * options.beam_width_rad;
  const double half_height = 0.5 * options.beam_height_rad;
  double nearest = options.range_m();
  bool is_met = false;
  // A point of the unit disc as a direction within the cone. `nearest` is the limit of the ray.
  const auto look = [&](double x, double y) {
    const Vector3d direction = direction_of(bearing_rad + x * half_width, y * half_height);
    const auto hit = world.first({map_from_sensor.translation(), map_from_sensor.linear() * direction}, nearest);
    if (!hit) return false;
    const bool is_nearer = !is_met || hit->range_m < nearest;
    nearest = hit->range_m;
    is_met = true;
    return is_nearer;
  };
  TrueRange range;
  if (look(0.0, 0.0)) range.axis_m = nearest;
  constexpr int kRings = 10, kAround = 48;
  double best_x = 0.0;
  double best_y = 0.0;
  for (int ring = 1; ring <= kRings; ++ring) {
    for (int around = 0; around < kAround; ++around) {
      const double angle = 2.0 * std::numbers::pi * around / kAround;
      const double x = std::cos(angle) * ring / kRings;
      const double y = std::sin(angle) * ring / kRings;
      if (look(x, y)) {
        best_x = x;
        best_y = y;
      }
    }
  }
  // Descent from the best of them with decreasing steps.
  for (double step = 0.5 / kRings; step > 1e-4;) {
    bool is_better = false;
    for (const auto& [dx, dy] : {std::pair{1.0, 0.0}, {-1.0, 0.0}, {0.0, 1.0}, {0.0, -1.0}}) {
      double x = best_x + dx * step;
      double y = best_y + dy * step;
      const double off = std::max(1.0, std::hypot(x, y));
      x /= off;
      y /= off;
      if (is_met && look(x, y)) {
        best_x = x;
        best_y = y;
        is_better = true;
      }
    }
    if (!is_better) step *= 0.5;
  }
  if (is_met) range.cone_m = nearest;
  return range;
}

SonarSimulator::SonarSimulator(World world, Trajectory map_from_body, const SonarOptions& options, std::size_t turns)
    : world_(std::move(world)),
      map_from_body_(std::move(map_from_body)),
      options_(options),
      beams_(turns * options.beams_per_turn),
      clean_(options.beams_per_turn),
      noise_(options.seed),
      dropouts_(~options.seed) {
  assert(options.validate());
  for (int intensity = 1; intensity <= 255; ++intensity) {
    const double amplitude = 255.0 * std::pow(intensity / 255.0, 1.0 / options.compression);
    levels_.push_back(static_cast<std::uint32_t>(std::lround(kScale * amplitude)));
  }
  for (std::size_t bin = 0; bin < options.bins; ++bin) {
    const double middle_m = (static_cast<double>(bin) + 0.5) * options.bin_length_m;
    const double ringing = kRingingAmplitude * std::exp(-std::max(middle_m - options.ringing_m, 0.0) / kRingingDecay_m);
    ringing_.push_back(static_cast<std::uint32_t>(std::lround(options.ringing_m > 0.0 ? kScale * ringing : 0.0)));
    // Noise arises before and after the gain. Longer pulses need less bandwidth, so noise falls as the length of a bin
    // grows.
    const double growth = (1.0 + std::pow(loss(options, middle_m), -options.gain)) * kNoiseBin_m / options.bin_length_m;
    background_.push_back(static_cast<std::uint32_t>(std::lround(kScale * std::min(options.noise * growth, 255.0))));
  }
}

Result<std::optional<Beam>> SonarSimulator::next() {
  for (; sent_ < beams_; ++sent_) {
    const double time = map_from_body_.poses().front().time_s + static_cast<double>(sent_) / options_.beams_per_s;
    const std::optional<Pose> body = map_from_body_.at(time);
    if (!body) break;
    const Pose pose = *body * options_.body_from_sensor;
    const bool is_lost = dropouts_.uniform() < options_.lost;
    const bool is_silent = dropouts_.uniform() < options_.silent;
    if (is_lost) continue;

    const std::size_t direction = sent_ % options_.beams_per_turn;
    const double turned =
        2.0 * std::numbers::pi * static_cast<double>(direction) / static_cast<double>(options_.beams_per_turn);
    ping_ = {time, pose, wrap_bearing(-turned)};
    const double step = options_.bearing_step_rad;
    Beam beam{.time_s = time,
              .bearing_rad = step > 0.0 ? wrap_bearing(std::round(ping_.bearing_rad / step) * step) : ping_.bearing_rad,
              .bin_length_m = options_.bin_length_m,
              .intensities = {}};
    Clean& clean = clean_[direction];
    if (clean.intensities.empty() || clean.map_from_sensor.matrix() != pose.matrix()) {
      clean = {pose, clean_beam(world_, pose, ping_.bearing_rad, options_)};
    }
    beam.intensities.reserve(options_.bins);
    for (std::size_t bin = 0; bin < options_.bins; ++bin) {
      const double fading = 1.0 + options_.speckle * (noise_.rayleigh() - 1.0);
      const double noise = noise_.rayleigh() * background_[bin];
      const double echo = ringing_[bin] + (is_silent ? 0.0 : static_cast<double>(clean.intensities[bin]));
      const auto highest = std::upper_bound(levels_.begin(), levels_.end(), echo * fading + noise);
      beam.intensities.push_back(static_cast<std::uint8_t>(highest - levels_.begin()));
    }
    ++sent_;
    return beam;
  }
  return std::nullopt;
}

}  // namespace pingvox
