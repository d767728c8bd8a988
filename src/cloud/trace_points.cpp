#include "pingvox/cloud/trace_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <span>
#include <vector>

#include "map/dense_fan.hpp"
#include "map/kernels/ray_lanes.hpp"
#include "map/tree_order.hpp"

namespace pingvox {
namespace {

using Ends = detail::RayEnds;

/// Traces many rays from one place: those that fit into a window of the scan several at a time, the others one by one.
class FanTracer {
 public:
  /// @param some  ends of rays [m]; the window is made for them and may be too small for others
  template <class Point>
  FanTracer(const Lattice& lattice, const Eigen::Vector3d& origin_m, const PointScanOptions& options,
            std::span<const Point> some, ScanUpdate& scan)
      : lattice_(lattice), origin_m_(origin_m), options_(options), scan_(scan) {
    const double reach = reach_of(some);
    const int bits = window_bits(reach);
    if (options.ray != RayAlgorithm::kDda || some.size() < kFewRays || lattice.depth() <= ScanUpdate::kPageBits ||
        bits > detail::ScanWindow::kMostBits) {
      return;
    }
    window_ = &scan.window(bits);
    squares_ = 2 * static_cast<std::uint32_t>(std::ceil(kSquaresPerCell * std::max(reach, 1.0)));
    place_window(bits);
  }

  /// Marks the cells of rays as missed, and where they end as hit unless that is too far away.
  /// @return how many of them leave the lattice
  template <class Point>
  std::size_t trace_points(std::span<const Point> points_m) {
    return has_range() ? trace_in_range(points_m) : trace(points_m, Ends::kHit);
  }

  /// The same for rays to the middles of the cells that hold points, each cell once.
  template <class Point>
  std::size_t trace_cells(std::span<const Point> points_m) {
    const std::span<const Eigen::Vector3d> middles_m = cells_of(points_m);
    if (!has_range()) return trace(middles_m, Ends::kMarked);
    // Marked only to know them again; whether each is a hit its range decides.
    for (const std::uint64_t place : room().cells) window_->hit()[place / 64] &= ~(std::uint64_t{1} << (place % 64));
    return trace_in_range(middles_m);
  }

  /// Hands what was marked to the scan. To be called last.
  void finish() {
    if (window_ != nullptr) scan_.take_window(key_of(fan_.window_lowest), options_.hit);
  }

 private:
  // Below, opening and emptying a window costs more than it saves.
  static constexpr std::size_t kFewRays = 16;
  static constexpr std::size_t kBlock = 2048;
  // Of directions, at the far ends of the rays.
  static constexpr double kSquaresPerCell = 0.8;

  bool has_range() const { return std::isfinite(options_.max_range_m); }
  detail::FanRoom& room() { return window_ != nullptr ? window_->fan_room() : own_room_; }

  template <class Point>
  std::size_t trace_in_range(std::span<const Point> ends_m) {
    std::vector<Eigen::Vector3d> near_m, cut_m;
    for (const Point& point : ends_m) {
      const Eigen::Vector3d& end_m = point.template cast<double>();
      const Eigen::Vector3d way_m = end_m - origin_m_;
      const double range_m = way_m.norm();
      if (range_m > options_.max_range_m) {
        cut_m.emplace_back(origin_m_ + way_m * (options_.max_range_m / range_m));
      } else {
        near_m.push_back(end_m);
      }
    }
    return trace(std::span<const Eigen::Vector3d>(near_m), Ends::kHit) +
           trace(std::span<const Eigen::Vector3d>(cut_m), Ends::kNothing);
  }

  /// The middles of the cells that hold points, each cell once; points outside of the lattice as they are. They last as
  /// long as the tracer, and until it is asked again. Those in the window are marked as hit, and are room().cells.
  template <class Point>
  std::span<const Eigen::Vector3d> cells_of(std::span<const Point> points_m) {
    std::vector<Eigen::Vector3d>& middles_m = room().middles_m;
    middles_m.clear();
    std::set<WideKey> seen;  // of those outside of the window
    const auto add_singly = [&](const Point& point) {
      const Eigen::Vector3d& point_m = point.template cast<double>();
      const auto key = lattice_.key_of<WideWord>(point_m);
      if (!key || seen.insert(*key).second) middles_m.push_back(key ? lattice_.centre_of(*key) : point_m);
    };
    if (window_ == nullptr) {
      std::for_each(points_m.begin(), points_m.end(), add_singly);
      return middles_m;
    }
    std::vector<std::uint64_t>& found = room().cells;
    found.clear();
    std::vector<std::uint32_t> outside;
    std::array<std::uint64_t, kBlock + detail::kWrittenBeyond> places;
    for_each_block(points_m, [&](std::span<const Point> block) {
      outside.clear();
      const std::size_t count = detail::find_cells(lanes_, fan_, block, places, outside);
      const std::size_t fresh = detail::mark_hits(std::span(places).first(count), *window_, places.data());
      found.insert(found.end(), places.begin(), places.begin() + static_cast<std::ptrdiff_t>(fresh));
      for (const std::uint32_t i : outside) add_singly(block[i]);
    });
    const std::size_t singly = middles_m.size();
    middles_m.resize(singly + found.size());
    detail::find_middles(lanes_, fan_, lattice_.resolution_m(), found, std::span(middles_m).subspan(singly));
    return middles_m;
  }

  template <class Point, class F>
  static void for_each_block(std::span<const Point> all, F&& f) {
    for (std::size_t first = 0; first < all.size(); first += kBlock) {
      f(all.subspan(first, std::min(kBlock, all.size() - first)));
    }
  }

  /// @param ends  what their last cells say
  template <class Point>
  std::size_t trace(std::span<const Point> ends_m, Ends ends) {
    if (window_ == nullptr) return trace_singly(ends_m, ends);
    others_.clear();
    detail::DenseFan<Point>(lanes_, fan_, start_, squares_, *window_).mark(ends_m, ends, others_);
    std::size_t outside = 0;
    for (const std::uint32_t other : others_) outside += trace_singly(ends_m.subspan(other, 1), ends);
    return outside;
  }

  template <class Point>
  std::size_t trace_singly(std::span<const Point> ends_m, Ends ends) {
    std::size_t outside = 0;
    for (const Point& point : ends_m) {
      const Eigen::Vector3d& end_m = point.template cast<double>();
      if (ends != Ends::kNothing) {
        if (const auto end = lattice_.key_of<WideWord>(end_m)) scan_.add_hit(*end, options_.hit);
      }
      if (!trace_ray(lattice_, origin_m_, end_m, options_.ray, scan_)) ++outside;
    }
    return outside;
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
    const double cells = 2.0 * (reach + 1.0 + (1 << ScanUpdate::kPageBits));
    // Farther out, doubles have gaps, and keys of deep lattices are no whole numbers of 64 bits.
    const double farthest_cell = origin_m_.cwiseAbs().maxCoeff() / lattice_.resolution_m() + cells;
    if (!(farthest_cell < 0x1p40)) return detail::ScanWindow::kMostBits + 1;
    return std::max(ScanUpdate::kPageBits, std::ilogb(cells) + 1);
  }

  void place_window(int bits) {
    fan_.cells_per_m = lattice_.cells_per_m();
    fan_.from = lattice_.in_cells(origin_m_);
    const double edge = std::ldexp(1.0, bits), border = std::ldexp(1.0, lattice_.depth() - 1);
    start_ = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto cell = static_cast<std::int64_t>(std::floor(fan_.from[static_cast<Eigen::Index>(a)]));
      const std::int64_t lowest = cell - (std::int64_t{1} << (bits - 1));
      // Pages begin at multiples of their size, counted from the centre of the lattice.
      fan_.window_lowest[a] = (lowest >> ScanUpdate::kPageBits) * (1 << ScanUpdate::kPageBits);
      const auto base = static_cast<double>(fan_.window_lowest[a]);
      fan_.lowest[a] = std::max(base, -border);
      fan_.highest[a] = std::min(base + edge, border) - 1.0;
      start_ |= detail::spread_bits(static_cast<std::uint64_t>(cell - fan_.window_lowest[a])) << a;
    }
    // From outside of the lattice nothing is traced.
    if (!lattice_.key_of<WideWord>(origin_m_)) fan_.highest.fill(-std::numeric_limits<double>::infinity());
  }

  WideKey key_of(const std::array<std::int64_t, 3>& cell) const {
    const WideWord centre = WideWord{1} << (lattice_.depth() - 1);
    const auto word = [&](std::int64_t n) {
      return n < 0 ? centre - static_cast<WideWord>(-n) : centre + static_cast<WideWord>(n);
    };
    return {word(cell[0]), word(cell[1]), word(cell[2])};
  }

  const Lattice& lattice_;
  Eigen::Vector3d origin_m_;
  const PointScanOptions& options_;
  ScanUpdate& scan_;
  detail::ScanWindow* window_ = nullptr;  ///< nullptr: every ray by itself
  detail::RayFan fan_;
  std::uint32_t squares_ = 1;  ///< of directions, along an edge
  std::uint64_t start_ = 0;    ///< place of the cell where the rays begin
  detail::Lanes lanes_ = detail::widest_lanes();
  std::vector<std::uint32_t> others_;
  detail::FanRoom own_room_;  ///< without a window
};

template <class Point>
std::size_t trace_fan(const Lattice& lattice, const Eigen::Vector3d& origin_m, std::span<const Point> points_m,
                      const PointScanOptions& options, ScanUpdate& scan) {
  try {
    FanTracer tracer(lattice, origin_m, options, points_m, scan);
    const std::size_t outside =
        options.ends == EndPoints::kCells ? tracer.trace_cells(points_m) : tracer.trace_points(points_m);
    tracer.finish();
    return outside;
  } catch (...) {
    scan.drop_window();  // or its marks would become those of the next scan, at another place
    throw;
  }
}

}  // namespace

std::size_t trace_points(const Lattice& lattice, const PointScan& points, const PointScanOptions& options,
                         ScanUpdate& scan) {
  return trace_points(lattice, points.origin_m, points.points_m, options, scan);
}

std::size_t trace_points(const Lattice& lattice, const Eigen::Vector3d& origin_m,
                         std::span<const Eigen::Vector3d> points_m, const PointScanOptions& options, ScanUpdate& scan) {
  return trace_fan(lattice, origin_m, points_m, options, scan);
}

std::size_t trace_points(const Lattice& lattice, const Eigen::Vector3d& origin_m,
                         std::span<const Eigen::Vector3f> points_m, const PointScanOptions& options, ScanUpdate& scan) {
  return trace_fan(lattice, origin_m, points_m, options, scan);
}

}  // namespace pingvox
