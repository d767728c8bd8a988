#include "cloud/window_tracer.hpp"

#include <cmath>
#include <utility>

#include "geometry/internal/tree_order.hpp"

namespace pingvox::detail {
namespace {

/// Below, opening and emptying a window costs more than it saves.
constexpr std::size_t kMinRays = 16;
constexpr int kPageBits = ScanUpdate::kPageBits;

/// Of a window that holds rays of such a reach. More than there may be where it is of no use.
int window_bits(const Eigen::Vector3d& middle, double reach) {
  const double cells = 2.0 * (reach + 1.0 + (1 << kPageBits));
  // Farther out, doubles have gaps, and keys of deep lattices are no whole numbers of 64 bits.
  const double farthest_cell = middle.cwiseAbs().maxCoeff() + cells;
  if (!(farthest_cell < 0x1p40)) return ScanWindow::kMaxBits + 1;
  return std::max(kPageBits, std::ilogb(cells) + 1);
}

}  // namespace

bool WindowTracer::open(const Lattice& lattice, RayAlgorithm ray, std::size_t rays, const Eigen::Vector3d& middle_m,
                        double reach_m) {
  const Eigen::Vector3d middle = lattice.in_cells(middle_m);
  const int bits = window_bits(middle, reach_m * lattice.cells_per_m());
  if (ray != RayAlgorithm::kDda || rays < kMinRays || lattice.depth() <= kPageBits || bits > ScanWindow::kMaxBits) {
    return false;
  }
  window_.open(bits);
  grid_.cells_per_m = lattice.cells_per_m();
  const double edge = std::ldexp(1.0, bits), border = std::ldexp(1.0, lattice.depth() - 1);
  for (std::size_t a = 0; a < 3; ++a) {
    const auto cell = static_cast<std::int64_t>(std::floor(middle[static_cast<Eigen::Index>(a)]));
    const std::int64_t lowest = cell - (std::int64_t{1} << (bits - 1));
    // Pages begin at multiples of their size, counted from the centre of the lattice.
    grid_.lowest[a] = (lowest >> kPageBits) * (1 << kPageBits);
    const auto base = static_cast<double>(grid_.lowest[a]);
    grid_.inside_from[a] = std::max(base, -border);
    grid_.inside_to[a] = std::min(base + edge, border);
  }
  return true;
}

void WindowTracer::hand_over(LogOdds hit, ScanUpdate& scan) {
  const WideWord centre = WideWord{1} << (scan.lattice().depth() - 1);
  const auto lowest = [&](std::size_t a) {
    const std::int64_t n = grid_.lowest[a];
    return n < 0 ? centre - static_cast<WideWord>(-n) : centre + static_cast<WideWord>(n);
  };
  const WideKey corner{lowest(0), lowest(1), lowest(2)};
  window_.take_touched([&](std::uint64_t number, bool has_hits) {
    const BasicKey<std::uint64_t> offset = key_of_code(number << (3 * kPageBits));
    const std::uint32_t page = scan.page_of(WideKey{corner.x + offset.x, corner.y + offset.y, corner.z + offset.z});
    const std::span<std::uint64_t, 64> missed(window_.missed() + number * 64, 64);
    scan.mark_missed_in(page, missed);
    std::fill(missed.begin(), missed.end(), 0);
    if (!has_hits) return;
    for (std::size_t brick = 0; brick < 64; ++brick) {
      const std::uint64_t cells = std::exchange(window_.hit()[number * 64 + brick], 0);
      if (cells != 0) scan.mark_hit_in(page, brick, cells, hit);
    }
  });
}

}  // namespace pingvox::detail
