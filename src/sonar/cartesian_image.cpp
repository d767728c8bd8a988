#include "pingvox/sonar/cartesian_image.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/option_errors.hpp"
#include "pingvox/geometry/degree.hpp"

namespace pingvox {
namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi;

struct Axis {
  double bearing_rad;
  std::size_t beam;
};

std::vector<Axis> axes_of(const Sweep& sweep) {
  std::vector<Axis> axes;
  axes.reserve(sweep.beams.size());
  for (std::size_t n = 0; n < sweep.beams.size(); ++n) axes.push_back({wrap_bearing(sweep.beams[n].bearing_rad), n});
  std::ranges::sort(axes, {}, [](const Axis& axis) { return std::pair(axis.bearing_rad, axis.beam); });
  return axes;
}

void dot_axes(const PolarImage& image, const Sweep& sweep, CartesianImage& out) {
  const double half = 0.5 * static_cast<double>(out.size_px);
  const auto last = static_cast<double>(out.size_px - 1);
  for (std::size_t n = 0; n < image.rows(); ++n) {
    const Beam& beam = sweep.beams[n];
    const double ahead = std::cos(beam.bearing_rad), left = std::sin(beam.bearing_rad);
    for (std::size_t i = 0; i < image.bins_in(n); ++i) {
      // Divide first: the inverse of a tiny pixel is infinite.
      const double range_px = (static_cast<double>(i) + 0.5) * beam.bin_length_m / out.pixel_m;
      const auto row = static_cast<std::size_t>(std::clamp(half - range_px * ahead, 0.0, last));
      const auto column = static_cast<std::size_t>(std::clamp(half - range_px * left, 0.0, last));
      std::uint8_t& pixel = out.pixels[row * out.size_px + column];
      pixel = std::max(pixel, image.row(n)[i]);
    }
  }
}

/// Weighted mean of the beams that reach a point.
class Interpolation {
 public:
  Interpolation(const PolarImage& image, const Sweep& sweep, double beam_width_rad)
      : image_(image), sweep_(sweep), axes_(axes_of(sweep)), reach_rad_(drawn_reach_rad(sweep, beam_width_rad)) {}

  std::uint8_t at(double x_m, double y_m) const {
    const double range_m = std::hypot(x_m, y_m);
    const double bearing_rad = wrap_bearing(std::atan2(y_m, x_m));
    Sum sum;
    add(bearing_rad, range_m, sum);
    // The same bearing plus a whole turn.
    if (bearing_rad < reach_rad_) add(bearing_rad + kTurn_rad, range_m, sum);
    if (bearing_rad > kTurn_rad - reach_rad_) add(bearing_rad - kTurn_rad, range_m, sum);
    if (sum.weights == 0.0) return 0;
    return static_cast<std::uint8_t>(std::lround(sum.intensities / sum.weights));
  }

 private:
  struct Sum {
    double intensities = 0.0;
    double weights = 0.0;
  };

  void add(double bearing_rad, double range_m, Sum& sum) const {
    const auto first = std::ranges::lower_bound(axes_, bearing_rad - reach_rad_, {}, &Axis::bearing_rad);
    for (auto axis = first; axis != axes_.end() && axis->bearing_rad < bearing_rad + reach_rad_; ++axis) {
      const double bin = range_m / sweep_.beams[axis->beam].bin_length_m;
      if (!(bin < static_cast<double>(image_.bins_in(axis->beam)))) continue;
      const double weight = 1.0 - std::abs(axis->bearing_rad - bearing_rad) / reach_rad_;
      if (!(weight > 0.0)) continue;
      sum.intensities += weight * image_.row(axis->beam)[static_cast<std::size_t>(bin)];
      sum.weights += weight;
    }
  }

  const PolarImage& image_;
  const Sweep& sweep_;
  std::vector<Axis> axes_;
  double reach_rad_;
};

}  // namespace

Result<void> CartesianOptions::validate() const {
  OptionErrors errors;
  errors.require_within("size_px", size_px, 16, 8192);
  errors.require(beam_width_rad > 0.0 && beam_width_rad <= kTurn_rad, "beam_width_rad", "> 0 and at most 2 pi",
                 beam_width_rad);
  return errors.result("cartesian image");
}

double drawn_reach_rad(const Sweep& sweep, double beam_width_rad) {
  constexpr double kCoarsest_rad = 12.0 * kDegree_rad;
  const double half = 0.5 * beam_width_rad;
  const std::vector<Axis> axes = axes_of(sweep);
  std::vector<double> steps_rad;
  for (std::size_t n = 1; n < axes.size(); ++n) {
    const double step_rad = axes[n].bearing_rad - axes[n - 1].bearing_rad;
    if (step_rad > 0.0) steps_rad.push_back(step_rad);
  }
  if (steps_rad.empty()) return half;
  const auto middle = steps_rad.begin() + static_cast<std::ptrdiff_t>(steps_rad.size() / 2);
  std::ranges::nth_element(steps_rad, middle);
  return *middle > kCoarsest_rad ? half : std::max(half, *middle);
}

CartesianImage cartesian_image(const PolarImage& image, const Sweep& sweep, const CartesianOptions& options) {
  assert(options.validate());
  assert(image.rows() == sweep.beams.size());
  double range_m = 0.0;
  for (std::size_t n = 0; n < image.rows(); ++n) {
    range_m = std::max(range_m, static_cast<double>(image.bins_in(n)) * sweep.beams[n].bin_length_m);
  }
  CartesianImage out{options.size_px, 2.0 * range_m / static_cast<double>(options.size_px), {}};
  out.pixels.resize(options.size_px * options.size_px);
  if (out.pixel_m == 0.0) return out;  // no bins, or too short for numbers
  if (options.between == BetweenBeams::kNothing) {
    dot_axes(image, sweep, out);
    return out;
  }
  const Interpolation interpolation(image, sweep, options.beam_width_rad);
  for (std::size_t row = 0; row < options.size_px; ++row) {
    for (std::size_t column = 0; column < options.size_px; ++column) {
      out.pixels[row * options.size_px + column] = interpolation.at(out.x_m(row), out.y_m(column));
    }
  }
  return out;
}

}  // namespace pingvox
