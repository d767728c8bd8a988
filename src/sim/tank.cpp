#include "pingvox/sim/tank.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <string_view>

namespace pingvox {
namespace {

/// Clean intensities are kept in whole steps of 1 / kScale and the noise is made of whole numbers and square roots, so
/// that the last bit of a machine's exp() or cos() does not decide about a byte.
constexpr double kScale = 256.0;

constexpr double kWallIntensity = 165.0;
constexpr double kRingingIntensity = 150.0;
constexpr double kPulse_bins = 1.5;  ///< standard deviation of the received pulse

/// A ray in the tank's frame: origin in the middle of the square, axes along its walls.
struct Ray {
  double x, y;
  double dx, dy;
};

struct Hit {
  double range_m;
  double cosine;  ///< of the angle of incidence
  bool floater;
};

Ray ray_at(const TankOptions& o, double bearing_rad) {
  const double angle = o.sensor_yaw_rad + bearing_rad;
  return {o.sensor_x_m, o.sensor_y_m, std::cos(angle), std::sin(angle)};
}

/// Along one axis: how far until the wall at +half or -half.
double wall_distance(double from, double direction, double half) {
  if (direction == 0.0) return std::numeric_limits<double>::infinity();
  return ((direction > 0.0 ? half : -half) - from) / direction;
}

std::optional<Hit> floater_hit(const TankOptions& o, const Ray& ray) {
  if (o.floater_radius_m == 0.0) return std::nullopt;
  const Ray axis = ray_at(o, o.floater_bearing_rad);
  const double to_x = axis.x + o.floater_range_m * axis.dx - ray.x;
  const double to_y = axis.y + o.floater_range_m * axis.dy - ray.y;
  const double along = to_x * ray.dx + to_y * ray.dy;
  const double across = to_x * ray.dy - to_y * ray.dx;
  const double chord_squared = o.floater_radius_m * o.floater_radius_m - across * across;
  if (along <= 0.0 || chord_squared < 0.0) return std::nullopt;
  const double half_chord = std::sqrt(chord_squared);
  return Hit{along - half_chord, half_chord / o.floater_radius_m, true};
}

Hit first_hit(const TankOptions& o, const Ray& ray) {
  const double x = wall_distance(ray.x, ray.dx, 0.5 * o.side_m);
  const double y = wall_distance(ray.y, ray.dy, 0.5 * o.side_m);
  const Hit wall = x < y ? Hit{x, std::abs(ray.dx), false} : Hit{y, std::abs(ray.dy), false};
  const std::optional<Hit> floater = floater_hit(o, ray);
  return floater && floater->range_m < wall.range_m ? *floater : wall;
}

/// What the walls mirror: the ray goes on from the wall that it met.
Ray mirrored(const TankOptions& o, const Ray& ray) {
  const double x = wall_distance(ray.x, ray.dx, 0.5 * o.side_m);
  const double y = wall_distance(ray.y, ray.dy, 0.5 * o.side_m);
  const double range = std::min(x, y);
  Ray out{ray.x + range * ray.dx, ray.y + range * ray.dy, ray.dx, ray.dy};
  (x < y ? out.dx : out.dy) *= -1.0;
  return out;
}

/// Two-way gain of a beam that is `width` wide at half power one way, `off` its axis.
double two_way_gain(double off_rad, double width_rad) {
  const double share = off_rad / width_rad;
  return std::exp(-2.0 * 4.0 * std::numbers::ln2 * share * share);
}

void add_pulse(const TankOptions& o, double range_m, double energy, std::vector<double>& energies) {
  const double middle = range_m / o.bin_length_m - 0.5;
  const double reach = 4.0 * kPulse_bins;
  if (!(middle - reach < static_cast<double>(o.bins))) return;
  const auto first = static_cast<std::size_t>(std::max(0.0, std::ceil(middle - reach)));
  const auto end = static_cast<std::size_t>(std::clamp(middle + reach + 1.0, 0.0, static_cast<double>(o.bins)));
  for (std::size_t bin = first; bin < end; ++bin) {
    const double off = (static_cast<double>(bin) - middle) / kPulse_bins;
    energies[bin] += energy * std::exp(-0.5 * off * off);
  }
}

/// What comes back along one bearing, bin by bin.
std::vector<std::uint32_t> clean_beam(const TankOptions& o, double bearing_rad) {
  constexpr int kAcross = 12;  // directions to either side, out to twice the width
  constexpr int kUp = 10;
  std::vector<double> energies(o.bins);
  double all = 0.0;
  for (int across = -kAcross; across <= kAcross; ++across) {
    const double azimuth = 2.0 * o.beam_width_rad * across / kAcross;
    // Each direction's way through the tank: what it meets first, and what the walls mirror into it after that.
    struct Return {
      double range_m, energy;
    };
    std::array<Return, 3> returns{};
    Ray ray = ray_at(o, bearing_rad + azimuth);
    double way = 0.0;
    double share = 1.0;
    for (Return& r : returns) {
      const Hit hit = first_hit(o, ray);
      way += hit.range_m;
      r = {way, share * (0.3 + 0.7 * hit.cosine)};
      share *= o.second_echo * o.second_echo;
      if (hit.floater || share == 0.0) break;
      ray = mirrored(o, ray);
    }
    for (int up = 0; up <= kUp; ++up) {
      const double elevation = 1.2 * o.beam_height_rad * up / kUp;
      // Above and below the plane the same comes back.
      const double gain =
          (up == 0 ? 1.0 : 2.0) * two_way_gain(azimuth, o.beam_width_rad) * two_way_gain(elevation, o.beam_height_rad);
      all += gain;
      const double slant = std::cos(elevation);
      if (!(slant > 0.05)) continue;
      for (const Return& r : returns) {
        if (r.energy > 0.0) add_pulse(o, r.range_m / slant, gain * r.energy, energies);
      }
    }
  }
  std::vector<std::uint32_t> clean(o.bins);
  for (std::size_t bin = 0; bin < o.bins; ++bin) {
    // Amplitude, as the receiver shows it. Spreading is taken to be made up for by its gain.
    double intensity = kWallIntensity * 1.3 * std::sqrt(energies[bin] / all);
    const double middle_m = (static_cast<double>(bin) + 0.5) * o.bin_length_m;
    if (middle_m < o.ringing_m) intensity += kRingingIntensity;
    clean[bin] = static_cast<std::uint32_t>(std::lround(kScale * std::min(intensity, 255.0)));
  }
  return clean;
}

/// SplitMix64 (Steele, Lea, Flood 2014): the next 64 random bits.
std::uint64_t next_random(std::uint64_t& state) {
  state += 0x9e3779b97f4a7c15U;
  std::uint64_t z = state;
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
  return z ^ (z >> 31U);
}

/// Nearly a standard normal number, in steps of 1 / 65536: the sum of twelve uniform ones in steps of 16 bits.
double next_normal(std::uint64_t& state) {
  std::int64_t sum = 0;
  for (int word = 0; word < 3; ++word) {
    const std::uint64_t bits = next_random(state);
    for (unsigned part = 0; part < 64; part += 16) sum += static_cast<std::int64_t>((bits >> part) & 0xffffU);
  }
  return static_cast<double>(sum - std::int64_t{6} * 65535) / 65536.0;
}

/// A Rayleigh number of mean 1: the amplitude of many small echoes that add up at random.
double next_rayleigh(std::uint64_t& state) {
  const double a = next_normal(state);
  const double b = next_normal(state);
  return 0.7978845608028654 * std::sqrt(a * a + b * b);  // sqrt(2 / pi)
}

}  // namespace

Result<void> TankOptions::validate() const {
  std::string bad;
  const auto check = [&bad](bool good, std::string_view name, std::string_view rule, auto value) {
    if (!good) bad += fmt::format(" {} must be {}, is {};", name, rule, value);
  };
  const auto within = [](double value, double low, double high) { return value >= low && value <= high; };
  const double half = 0.5 * side_m;
  check(turns >= 1 && turns <= 10'000, "turns", "1..10000", turns);
  check(side_m > 0.0 && side_m <= 1000.0, "side_m", "> 0 and at most 1000", side_m);
  check(std::abs(sensor_x_m) < half, "sensor_x_m", "inside the tank", sensor_x_m);
  check(std::abs(sensor_y_m) < half, "sensor_y_m", "inside the tank", sensor_y_m);
  check(std::isfinite(sensor_yaw_rad), "sensor_yaw_rad", "finite", sensor_yaw_rad);
  check(std::isfinite(floater_bearing_rad), "floater_bearing_rad", "finite", floater_bearing_rad);
  check(within(floater_radius_m, 0.0, 1000.0), "floater_radius_m", ">= 0 and at most 1000", floater_radius_m);
  check(floater_range_m > floater_radius_m && floater_range_m <= 2000.0, "floater_range_m",
        "greater than its radius and at most 2000", floater_range_m);
  check(beams_per_turn >= 4 && beams_per_turn <= 6400, "beams_per_turn", "4..6400", beams_per_turn);
  check(bins >= 1 && bins <= 10'000, "bins", "1..10000", bins);
  check(bin_length_m > 0.0 && bin_length_m <= 1.0, "bin_length_m", "> 0 and at most 1", bin_length_m);
  check(beams_per_s > 0.0 && std::isfinite(beams_per_s), "beams_per_s", "> 0", beams_per_s);
  check(beam_width_rad > 0.0 && beam_width_rad <= 1.0, "beam_width_rad", "> 0 and at most 1", beam_width_rad);
  check(beam_height_rad > 0.0 && beam_height_rad <= 2.0, "beam_height_rad", "> 0 and at most 2", beam_height_rad);
  check(within(ringing_m, 0.0, 10'000.0), "ringing_m", ">= 0 and at most 10000", ringing_m);
  check(within(speckle, 0.0, 1.0), "speckle", "0..1", speckle);
  check(within(noise, 0.0, 255.0), "noise", "0..255", noise);
  check(second_echo >= 0.0 && second_echo < 1.0, "second_echo", "0 or more and less than 1", second_echo);
  if (bad.empty()) return {};
  bad.pop_back();
  return fail(Error::Code::kBadOption, "tank:" + bad);
}

double true_range_m(const TankOptions& options, double bearing_rad) {
  return first_hit(options, ray_at(options, bearing_rad)).range_m;
}

TankSimulator::TankSimulator(const TankOptions& options) : options_(options), random_(options.seed) {
  assert(options.validate());
  background_.reserve(options.bins);
  for (std::size_t bin = 0; bin < options.bins; ++bin) {
    const double growth = 1.0 + static_cast<double>(bin) * options.bin_length_m;
    background_.push_back(static_cast<std::uint32_t>(std::lround(kScale * std::min(options.noise * growth, 255.0))));
  }
}

Result<std::optional<Beam>> TankSimulator::next() {
  if (sent_ == options_.turns * options_.beams_per_turn) return std::nullopt;
  const std::size_t direction = sent_ % options_.beams_per_turn;
  const double turned =
      2.0 * std::numbers::pi * static_cast<double>(direction) / static_cast<double>(options_.beams_per_turn);
  Beam beam{.time_s = static_cast<double>(sent_) / options_.beams_per_s,
            .bearing_rad = wrapped_bearing(-turned),
            .bin_length_m = options_.bin_length_m,
            .intensities = {}};
  if (direction == clean_.size()) clean_.push_back(clean_beam(options_, beam.bearing_rad));
  beam.intensities.reserve(options_.bins);
  for (std::size_t bin = 0; bin < options_.bins; ++bin) {
    const double fading = 1.0 + options_.speckle * (next_rayleigh(random_) - 1.0);
    const double noise = next_rayleigh(random_) * background_[bin];
    const double intensity = (clean_[direction][bin] * fading + noise) / kScale;
    beam.intensities.push_back(static_cast<std::uint8_t>(std::min(intensity, 255.0)));
  }
  ++sent_;
  return beam;
}

}  // namespace pingvox
