#include "mapping/add_hits.hpp"

#include <cmath>
#include <cstdint>
#include <vector>

#include "mapping/kernels/ray_ends.hpp"

namespace pingvox::detail {
namespace {

constexpr std::uint64_t kPage = 1 << ScanUpdate::kPageBits;

/// The middle of a lattice as a key.
WideWord centre_of(const Lattice& lattice) {
  return WideWord{1} << (lattice.depth() - 1);
}

/// Where rays of a range end, with places for all cells that they can end in, as long as these are not too many.
RayEnds ends_of(const Lattice& lattice, const Pose& map_from_sensor, double range_m) {
  RayEnds ends;
  ends.range_m = range_m;
  ends.cells_per_m = lattice.cells_per_m();
  const double border = std::ldexp(1.0, lattice.depth() - 1);
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<Eigen::Index>(a);
    for (std::size_t i = 0; i < 4; ++i)
      ends.map_from_sensor[a][i] = map_from_sensor(axis, static_cast<Eigen::Index>(i));
    // Farther out, doubles cannot hold all integers.
    const double lowest = (map_from_sensor(axis, 3) - range_m) * ends.cells_per_m - 1.0;
    if (!(std::abs(lowest) < 0x1p50)) continue;
    const auto from = static_cast<std::int64_t>(std::floor(lowest));
    // Unsigned, so that negative numbers wrap around; only the lowest bits are used.
    const std::uint64_t word = static_cast<std::uint64_t>(centre_of(lattice)) + static_cast<std::uint64_t>(from);
    ends.lowest[a] = from - static_cast<std::int64_t>(word % kPage);
    const auto base = static_cast<double>(ends.lowest[a]);
    ends.inside_from[a] = std::max(base, -border);
    ends.inside_to[a] = std::min(base + std::ldexp(1.0, kPlaceBits + ScanUpdate::kPageBits), border);
  }
  return ends;
}

/// The lowest cell of a page.
WideKey page_key(const Lattice& lattice, const RayEnds& ends, std::uint64_t page) {
  const auto word = [&](std::size_t a) {
    const std::uint64_t number = page >> (a * kPlaceBits) & ((std::uint64_t{1} << kPlaceBits) - 1);
    // Unsigned sums wrap, so negative numbers are subtracted.
    return centre_of(lattice) + static_cast<WideWord>(ends.lowest[a] + static_cast<std::int64_t>(number * kPage));
  };
  return {word(0), word(1), word(2)};
}

}  // namespace

std::size_t add_hits(const Pose& map_from_sensor, const BundleGrid& rays, double range_m, LogOdds evidence,
                     ScanUpdate& scan) {
  const Lattice& lattice = scan.lattice();
  const RayEnds ends = ends_of(lattice, map_from_sensor, range_m);
  const Elevations& elevations = rays.elevations;
  std::vector<float> shares(elevations.count);
  for (std::size_t i = 0; i < elevations.count; ++i) shares[i] = evidence.value() * static_cast<float>(rays.share(i));
  std::vector<std::uint64_t> places(elevations.count + kEndsAtOnce);
  std::uint64_t page_number = kNoPlace;
  std::uint32_t page = 0;
  std::size_t outside = 0;
  for (const BundleGrid::Level& azimuth : rays.azimuths) {
    find_ends(ends, azimuth.x, azimuth.y, std::span(elevations.across).first(elevations.count), elevations.up.data(),
              places.data());
    for (std::size_t i = 0; i < elevations.count; ++i) {
      if (places[i] == kNoPlace) {
        const auto key = lattice.key_of<WideWord>(map_from_sensor * (rays.direction(i, azimuth) * range_m));
        if (key) scan.add_hit(*key, LogOdds(shares[i]));
        outside += !key;
        continue;
      }
      if (places[i] >> kCellBits != page_number) {
        page_number = places[i] >> kCellBits;
        page = scan.page_of(page_key(lattice, ends, page_number));
      }
      scan.mark_hit(page, places[i] & ((1 << kCellBits) - 1), LogOdds(shares[i]));
    }
  }
  return outside;
}

}  // namespace pingvox::detail
