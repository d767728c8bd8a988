#include "pingvox/sonar/mosaic.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/option_errors.hpp"
#include "base/without_exceptions.hpp"
#include "pingvox/geometry/degree.hpp"
#include "sonar/internal/option_limits.hpp"

namespace pingvox {
namespace {

/// Edge of a tile in pixels, as a power of two.
constexpr int kTileBits = 6;
constexpr std::int64_t kTileEdge = std::int64_t{1} << kTileBits;
/// Numbers of pixels that fit into the name of a tile.
constexpr double kFarthestPixel = static_cast<double>(std::int64_t{1} << (31 + kTileBits));

constexpr float kNotHeard = std::numeric_limits<float>::quiet_NaN();

/// Towards where a beam is drawn.
struct GroundDirection {
  Eigen::Vector2d along;    ///< a unit vector
  double ground_per_slant;  ///< metres on the ground in one of range
};

/// Of the direction within the height of the beam that is nearest to the horizontal. nullopt: straight up or down.
std::optional<GroundDirection> ground_direction(const Eigen::Matrix3d& map_from_head, double bearing_rad,
                                                double height_rad) {
  const Eigen::Vector3d axis(std::cos(bearing_rad), std::sin(bearing_rad), 0.0);
  const double up_of_axis = map_from_head.row(2) * axis, up_of_z = map_from_head(2, 2);
  const double level_rad = std::atan2(-std::copysign(1.0, up_of_z) * up_of_axis, std::abs(up_of_z));
  const double elevation_rad = std::clamp(level_rad, -0.5 * height_rad, 0.5 * height_rad);
  const Eigen::Vector3d direction =
      map_from_head * (std::cos(elevation_rad) * axis + std::sin(elevation_rad) * Eigen::Vector3d::UnitZ());
  const double ground = direction.head<2>().norm();
  constexpr double kVertical = 1e-6;
  if (ground < kVertical) return std::nullopt;
  return GroundDirection{direction.head<2>() / ground, ground};
}

std::int64_t first_centre_from(double at) {
  return static_cast<std::int64_t>(std::ceil(at - 0.5));
}
std::int64_t last_centre_to(double at) {
  return static_cast<std::int64_t>(std::floor(at - 0.5));
}

}  // namespace

/// A beam on the ground, in pixels.
struct Mosaic::Wedge {
  /// Half the width of a beam near the head: a bit more than half the diagonal of a pixel, so that each bin has one.
  static constexpr double kMinHalfWidth = 0.75;

  Eigen::Vector2d head, along;
  double half_width_per_range;
  double step;  ///< from one intensity to the next
  std::vector<float> intensities;

  double range() const { return step * static_cast<double>(intensities.size()); }

  /// A convex area around it.
  std::array<Eigen::Vector2d, 4> corners() const {
    const Eigen::Vector2d across(-along.y(), along.x()), end = head + range() * along;
    const double end_half = std::max(kMinHalfWidth, half_width_per_range * range());
    return {head - kMinHalfWidth * across, end - end_half * across, end + end_half * across,
            head + kMinHalfWidth * across};
  }

  /// The intensity at the centre of a pixel, and a weight that falls from 1 on the axis to 0. A weight of 0: outside.
  Pixel at(const Eigen::Vector2d& centre) const {
    const Eigen::Vector2d from_head = centre - head;
    const double ahead = from_head.dot(along);
    const double beside = std::abs(from_head.y() * along.x() - from_head.x() * along.y());
    const double weight = 1.0 - beside / std::max(kMinHalfWidth, half_width_per_range * ahead);
    const double place = from_head.norm() / step;
    if (ahead < 0.0 || weight <= 0.0 || !(place < static_cast<double>(intensities.size()))) return {};
    const float intensity = intensities[static_cast<std::size_t>(place)];
    return std::isnan(intensity) ? Pixel{} : Pixel{intensity, static_cast<float>(weight)};
  }
};

Result<void> MosaicOptions::validate() const {
  OptionErrors errors;
  errors.require("resolution_m", resolution_m, kResolutions_m);
  errors.require("min_range_m", min_range_m, kNearestRanges_m);
  errors.require("max_range_m", max_range_m, kFarthestRanges_m);
  if (!(max_range_m > min_range_m)) {
    errors.add(fmt::format("max_range_m must exceed min_range_m ({}), is {}", min_range_m, max_range_m));
  }
  return errors.result("mosaic");
}

void Mosaic::PixelRange::add(std::int64_t pixel) {
  min = std::min(min, pixel);
  max = std::max(max, pixel);
}

Result<Mosaic> Mosaic::make(const MosaicOptions& options) {
  if (const auto valid = options.validate(); !valid) return tl::unexpected(valid.error());
  return Mosaic(options);
}

Result<void> Mosaic::add(const Pose& map_from_head, const Beam& beam, const BeamExtent& extent) {
  return detail::without_exceptions([&]() -> Result<void> {
    const auto direction = ground_direction(map_from_head.linear(), beam.bearing_rad, extent.height_rad);
    if (!direction) return {};
    // A mean weighs neighbours by their distance, so they may overlap; a maximum would widen what they show. A bit more
    // than half leaves nothing between them.
    const double of_step = options_.blend == Blend::kMean ? 1.0 : 0.51;
    constexpr double kWidest_rad = 60.0 * kDegree_rad;
    const double reach_rad =
        std::min(std::max(0.5 * extent.width_rad, of_step * extent.step_rad.value_or(0.0)), kWidest_rad);
    const double step_m = std::max(beam.bin_length_m * direction->ground_per_slant, options_.resolution_m);
    const Wedge wedge{map_from_head.translation().head<2>() / options_.resolution_m, direction->along,
                      std::tan(reach_rad), step_m / options_.resolution_m,
                      intensities_by_range(beam, step_m, direction->ground_per_slant)};
    if (std::ranges::all_of(wedge.intensities, [](float value) { return std::isnan(value); })) return {};
    Eigen::Vector2d low = wedge.head, high = wedge.head;
    for (const Eigen::Vector2d& corner : wedge.corners()) {
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
    if (!(low.minCoeff() > -kFarthestPixel && high.maxCoeff() < kFarthestPixel)) {
      return fail(Error::Code::kLimit,
                  fmt::format("a beam is at {:.6g}, {:.6g} m, too far for pixels of {:.6g} m",
                              map_from_head.translation().x(), map_from_head.translation().y(), options_.resolution_m));
    }
    const PixelBox box{{first_centre_from(low.x()), last_centre_to(high.x())},
                       {first_centre_from(low.y()), last_centre_to(high.y())}};
    if (box.x.count() == 0.0 || box.y.count() == 0.0) return {};
    PixelBox all = heard_;
    for (const std::int64_t x : {box.x.min, box.x.max}) all.x.add(x);
    for (const std::int64_t y : {box.y.min, box.y.max}) all.y.add(y);
    if (const auto fits = check_size(all); !fits) return fits;
    draw(wedge, box);
    return {};
  });
}

Result<void> Mosaic::check_size(const PixelBox& heard) const {
  const double pixels = heard.x.count() * heard.y.count(), cell_m = options_.resolution_m;
  if (pixels <= static_cast<double>(kMaxPixels)) return {};
  const auto edge_m = [&](std::int64_t pixel) { return static_cast<double>(pixel) * cell_m; };
  return fail(Error::Code::kLimit,
              fmt::format("the beams reach from {:.6g}, {:.6g} to {:.6g}, {:.6g} m: that is {:.0f} x {:.0f} "
                          "pixels of {:.6g} m, more than the limit of {}; pixels of {:.3g} m would fit",
                          edge_m(heard.x.min), edge_m(heard.y.min), edge_m(heard.x.max + 1), edge_m(heard.y.max + 1),
                          heard.x.count(), heard.y.count(), cell_m, kMaxPixels,
                          cell_m * 1.1 * std::sqrt(pixels / static_cast<double>(kMaxPixels))));
}

/// What is heard in steps on the ground, which hold one bin or several; NaN where none is to be drawn.
std::vector<float> Mosaic::intensities_by_range(const Beam& beam, double step_m, double ground_per_slant) const {
  const double bins_m = beam.bin_length_m * static_cast<double>(beam.intensities.size());
  const double range_m = std::min(bins_m, options_.max_range_m);
  std::vector<float> steps(static_cast<std::size_t>(std::ceil(range_m * ground_per_slant / step_m)), kNotHeard);
  std::vector<float> counts(steps.size(), 0.0F);
  for (std::size_t bin = 0; bin < beam.intensities.size(); ++bin) {
    const double middle_m = (static_cast<double>(bin) + 0.5) * beam.bin_length_m;
    if (middle_m < options_.min_range_m || middle_m > range_m) continue;
    const auto step = static_cast<std::size_t>(middle_m * ground_per_slant / step_m);
    if (step >= steps.size()) break;
    const auto intensity = static_cast<float>(beam.intensities[bin]);
    float& value = steps[step];
    float& count = counts[step];
    if (count == 0.0F) value = 0.0F;
    count += 1.0F;
    value = options_.blend == Blend::kMean ? value + (intensity - value) / count : std::max(value, intensity);
  }
  return steps;
}

void Mosaic::draw(const Wedge& wedge, const PixelBox& box) {
  const std::array<Eigen::Vector2d, 4> corners = wedge.corners();
  for (std::int64_t y = box.y.min; y <= box.y.max; ++y) {
    const double centre_y = static_cast<double>(y) + 0.5;
    double from = std::numeric_limits<double>::infinity(), to = -from;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Eigen::Vector2d &a = corners[i], &b = corners[(i + 1) % corners.size()];
      if ((a.y() <= centre_y) == (b.y() <= centre_y)) continue;
      const double x = a.x() + (b.x() - a.x()) * (centre_y - a.y()) / (b.y() - a.y());
      from = std::min(from, x);
      to = std::max(to, x);
    }
    if (from > to) continue;
    for (std::int64_t x = first_centre_from(from); x <= last_centre_to(to); ++x) {
      const Pixel heard = wedge.at({static_cast<double>(x) + 0.5, centre_y});
      if (heard.weight == 0.0F) continue;
      Pixel& pixel = pixel_at(x, y);
      if (options_.blend == Blend::kMean) {
        pixel.intensity += heard.weight * heard.intensity;
        pixel.weight += heard.weight;
      } else {
        pixel = {std::max(pixel.intensity, heard.intensity), 1.0F};
      }
      heard_.x.add(x);
      heard_.y.add(y);
    }
  }
}

Mosaic::Pixel& Mosaic::pixel_at(std::int64_t x, std::int64_t y) {
  const auto name = [](std::int64_t pixel) { return static_cast<std::uint32_t>(pixel >> kTileBits); };
  Tile& tile = tiles_[(std::uint64_t{name(y)} << 32) | name(x)];
  if (tile.empty()) tile.resize(kTileEdge * kTileEdge);
  const auto within = [](std::int64_t pixel) { return static_cast<std::size_t>(pixel & (kTileEdge - 1)); };
  return tile[within(y) * kTileEdge + within(x)];
}

Result<Raster<float>> Mosaic::picture() const {
  if (empty()) return fail(Error::Code::kUnsupported, "no beam was drawn");
  return detail::without_exceptions([&]() -> Result<Raster<float>> {
    Raster<float> raster{
        static_cast<std::size_t>(heard_.x.count()),
        static_cast<std::size_t>(heard_.y.count()),
        options_.resolution_m,
        options_.resolution_m * Eigen::Vector2d(static_cast<double>(heard_.x.min), static_cast<double>(heard_.y.min)),
        {}};
    raster.values.assign(raster.columns * raster.rows, kNotHeard);
    const auto low_of = [](std::uint64_t name) {
      return std::int64_t{static_cast<std::int32_t>(static_cast<std::uint32_t>(name))} * kTileEdge;
    };
    for (const auto& [name, tile] : tiles_) {
      const std::int64_t low_x = low_of(name), low_y = low_of(name >> 32);
      for (std::int64_t i = 0; i < kTileEdge * kTileEdge; ++i) {
        const Pixel& pixel = tile[static_cast<std::size_t>(i)];
        if (pixel.weight == 0.0F) continue;
        const auto column = static_cast<std::size_t>(low_x + i % kTileEdge - heard_.x.min);
        const auto row = static_cast<std::size_t>(low_y + i / kTileEdge - heard_.y.min);
        raster.values[row * raster.columns + column] = pixel.intensity / pixel.weight;
      }
    }
    return raster;
  });
}

}  // namespace pingvox
