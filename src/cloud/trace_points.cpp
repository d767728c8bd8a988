#include "pingvox/cloud/trace_points.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "cloud/ray_kernels.hpp"
#include "cloud/scan_window.hpp"

namespace pingvox {
namespace {

using detail::ScanWindow;

/// What the last cells of rays say.
enum class RayEnds { kHit, kNothing };

/// Below, opening and emptying a window costs more than it saves.
constexpr std::size_t kMinRays = 16;
/// Rays that are walked together.
constexpr std::size_t kBlock = 1024;
constexpr int kPageBits = ScanUpdate::kPageBits;

/// A number of up to 21 bits with two zero bits between its bits, and back.
std::uint64_t spread_bits(std::uint64_t word) {
  std::uint64_t spread = 0;
  for (int bit = 0; bit < 21; ++bit) spread |= (word >> bit & 1) << (3 * bit);
  return spread;
}
WideWord gather_bits(std::uint64_t word) {
  std::uint64_t gathered = 0;
  for (int bit = 0; bit < 21; ++bit) gathered |= (word >> (3 * bit) & 1) << bit;
  return gathered;
}

}  // namespace

/// Rays that fit into a window are traced several at a time, the others one by one.
class PointTracer::Tracer {
 public:
  explicit Tracer(const PointScanOptions& options) : options_(options) {}

  template <class Point>
  std::size_t trace(const Eigen::Vector3d& origin_m, std::span<const Point> points_m, ScanUpdate& scan) {
    origin_m_ = origin_m;
    scan_ = &scan;
    lattice_ = scan.lattice();
    try {
      open_window(points_m);
      const std::size_t outside =
          options_.ends == EndPoints::kCells ? trace_in_range(cells_of(points_m)) : trace_in_range(points_m);
      if (has_window_) hand_over();
      return outside;
    } catch (...) {
      window_.drop();  // or its marks would become those of the next scan, at another place
      throw;
    }
  }

 private:
  /// @return how many rays leave the lattice
  template <class Point>
  std::size_t trace_in_range(std::span<const Point> ends_m) {
    if (!std::isfinite(options_.max_range_m)) return trace_ends(ends_m, RayEnds::kHit);
    near_m_.clear();
    cut_m_.clear();
    for (const Point& point : ends_m) {
      const Eigen::Vector3d& end_m = point.template cast<double>();
      const Eigen::Vector3d way_m = end_m - origin_m_;
      const double range_m = way_m.norm();
      if (range_m > options_.max_range_m) {
        cut_m_.emplace_back(origin_m_ + way_m * (options_.max_range_m / range_m));
      } else {
        near_m_.push_back(end_m);
      }
    }
    return trace_ends(std::span<const Eigen::Vector3d>(near_m_), RayEnds::kHit) +
           trace_ends(std::span<const Eigen::Vector3d>(cut_m_), RayEnds::kNothing);
  }

  /// The middles of the cells that hold points, each cell once; points outside of the lattice as they are.
  template <class Point>
  std::span<const Eigen::Vector3d> cells_of(std::span<const Point> points_m) {
    middles_m_.clear();
    std::set<WideKey> seen;  // of those outside of the window
    const auto add_one = [&](const Eigen::Vector3d& point_m) {
      const auto key = lattice_.key_of<WideWord>(point_m);
      if (!key || seen.insert(*key).second) middles_m_.push_back(key ? lattice_.centre_of(*key) : point_m);
    };
    if (!has_window_) {
      for (const Point& point : points_m) add_one(point.template cast<double>());
      return middles_m_;
    }
    // The window's hits tell which cells were found before.
    found_.clear();
    for_each_block(points_m, [&](std::span<const Point> block) {
      find_places(grid_, block, places_);
      for (std::size_t i = 0; i < block.size(); ++i) {
        const std::uint64_t place = places_[i];
        if (place == detail::kNoPlace) {
          add_one(block[i].template cast<double>());
        } else if (window_.mark_hit(place)) {
          found_.push_back(place);
          middles_m_.push_back(middle_of(block[i].template cast<double>()));
        }
      }
    });
    window_.clear_hits(found_);
    return middles_m_;
  }

  /// The middle of the cell that holds a point in the window, as Lattice::centre_of has it.
  Eigen::Vector3d middle_of(const Eigen::Vector3d& point_m) const {
    return lattice_.centre_of(*lattice_.key_of<WideWord>(point_m));
  }

  template <class Point, class F>
  static void for_each_block(std::span<const Point> all, F&& f) {
    for (std::size_t first = 0; first < all.size(); first += kBlock) {
      f(all.subspan(first, std::min(kBlock, all.size() - first)));
    }
  }

  template <class Point>
  std::size_t trace_ends(std::span<const Point> ends_m, RayEnds ends) {
    std::size_t outside = 0;
    if (!has_window_) {
      for (const Point& point : ends_m) outside += trace_one(point.template cast<double>(), ends);
      return outside;
    }
    for_each_block(ends_m, [&](std::span<const Point> block) {
      prepare_rays(grid_, block, rays_);
      for (std::size_t i = 0; i < block.size(); ++i) {
        if (rays_.end[i] == detail::kNoPlace) {
          outside += trace_one(block[i].template cast<double>(), ends);
        } else if (ends == RayEnds::kHit) {
          window_.mark_hit(rays_.end[i]);
        }
      }
      mark_rays(rays_, start_, window_);
    });
    return outside;
  }

  /// @return how many rays leave the lattice: 0 or 1
  std::size_t trace_one(const Eigen::Vector3d& end_m, RayEnds ends) {
    if (ends == RayEnds::kHit) {
      if (const auto end = lattice_.key_of<WideWord>(end_m)) scan_->add_hit(*end, options_.hit);
    }
    return trace_ray(origin_m_, end_m, options_.ray, *scan_) ? 0 : 1;
  }

  /// How far rays go along any axis [cells]: a guess from some of them.
  template <class Point>
  double reach_of(std::span<const Point> ends_m) const {
    constexpr std::size_t kLooked = 1024;
    const std::size_t apart = std::max<std::size_t>(1, ends_m.size() / kLooked);
    double farthest_m = 0.0;
    for (std::size_t i = 0; i < ends_m.size(); i += apart) {
      farthest_m = std::max(farthest_m, (ends_m[i].template cast<double>() - origin_m_).cwiseAbs().maxCoeff());
    }
    return std::min(farthest_m, options_.max_range_m) / lattice_.resolution_m();
  }

  /// Of a window that holds rays of such a reach. More than there may be where it is of no use.
  int window_bits(double reach) const {
    const double cells = 2.0 * (reach + 1.0 + (1 << kPageBits));
    // Farther out, doubles have gaps, and keys of deep lattices are no whole numbers of 64 bits.
    const double farthest_cell = origin_m_.cwiseAbs().maxCoeff() / lattice_.resolution_m() + cells;
    if (!(farthest_cell < 0x1p40)) return ScanWindow::kMaxBits + 1;
    return std::max(kPageBits, std::ilogb(cells) + 1);
  }

  template <class Point>
  void open_window(std::span<const Point> points_m) {
    const int bits = window_bits(reach_of(points_m));
    has_window_ = options_.ray == RayAlgorithm::kDda && points_m.size() >= kMinRays && lattice_.depth() > kPageBits &&
                  bits <= ScanWindow::kMaxBits;
    if (!has_window_) return;
    window_.open(bits);
    grid_.cells_per_m = lattice_.cells_per_m();
    grid_.from = lattice_.in_cells(origin_m_);
    const double edge = std::ldexp(1.0, bits), border = std::ldexp(1.0, lattice_.depth() - 1);
    start_ = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto cell = static_cast<std::int64_t>(std::floor(grid_.from[static_cast<Eigen::Index>(a)]));
      const std::int64_t lowest = cell - (std::int64_t{1} << (bits - 1));
      // Pages begin at multiples of their size, counted from the centre of the lattice.
      grid_.lowest[a] = (lowest >> kPageBits) * (1 << kPageBits);
      const auto base = static_cast<double>(grid_.lowest[a]);
      grid_.inside_from[a] = std::max(base, -border);
      grid_.inside_to[a] = std::min(base + edge, border);
      start_ |= spread_bits(static_cast<std::uint64_t>(cell - grid_.lowest[a])) << a;
    }
    // From outside of the lattice nothing is traced.
    if (!lattice_.key_of<WideWord>(origin_m_)) grid_.inside_to.fill(-std::numeric_limits<double>::infinity());
  }

  /// Hands what is marked in the window to the scan, page by page, and empties it.
  void hand_over() {
    const WideWord centre = WideWord{1} << (lattice_.depth() - 1);
    const auto lowest = [&](std::size_t a) {
      const std::int64_t n = grid_.lowest[a];
      return n < 0 ? centre - static_cast<WideWord>(-n) : centre + static_cast<WideWord>(n);
    };
    const WideKey corner{lowest(0), lowest(1), lowest(2)};
    window_.take_touched([&](std::uint64_t number, bool has_hits) {
      const std::uint32_t page = scan_->page_of(WideKey{corner.x + (gather_bits(number) << kPageBits),
                                                        corner.y + (gather_bits(number >> 1) << kPageBits),
                                                        corner.z + (gather_bits(number >> 2) << kPageBits)});
      const std::span<std::uint64_t, 64> missed(window_.missed() + number * 64, 64);
      scan_->mark_missed_in(page, missed);
      std::fill(missed.begin(), missed.end(), 0);
      if (!has_hits) return;
      for (std::size_t brick = 0; brick < 64; ++brick) {
        const std::uint64_t cells = std::exchange(window_.hit()[number * 64 + brick], 0);
        if (cells != 0) scan_->mark_hit_in(page, brick, cells, options_.hit);
      }
    });
  }

  Lattice lattice_{1.0};
  PointScanOptions options_;
  ScanWindow window_;
  // Of the scan that is traced.
  ScanUpdate* scan_ = nullptr;
  Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero();
  bool has_window_ = false;
  detail::RayGrid grid_;
  std::uint64_t start_ = 0;  ///< place of the cell where the rays begin
  // Kept for the next one.
  detail::PreparedRays rays_;
  std::vector<std::uint64_t> places_, found_;
  std::vector<Eigen::Vector3d> middles_m_, near_m_, cut_m_;
};

PointTracer::PointTracer(const PointScanOptions& options) : tracer_(std::make_unique<Tracer>(options)) {}
PointTracer::PointTracer(PointTracer&& other) noexcept = default;
PointTracer& PointTracer::operator=(PointTracer&& other) noexcept = default;
PointTracer::~PointTracer() = default;

std::size_t PointTracer::trace(const Eigen::Vector3d& origin_m, std::span<const Eigen::Vector3d> points_m,
                               ScanUpdate& scan) {
  return tracer_->trace(origin_m, points_m, scan);
}
std::size_t PointTracer::trace(const Eigen::Vector3d& origin_m, std::span<const Eigen::Vector3f> points_m,
                               ScanUpdate& scan) {
  return tracer_->trace(origin_m, points_m, scan);
}

std::size_t trace_points(const PointScan& points, const PointScanOptions& options, ScanUpdate& scan) {
  return PointTracer(options).trace(points.origin_m, points.points_m, scan);
}

}  // namespace pingvox
