#include "pingvox/cloud/trace_points.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "cloud/window_tracer.hpp"

namespace pingvox {
namespace {

/// What the last cells of rays say.
enum class RayEnds { kHit, kNothing };

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
      has_window_ = window_.open(lattice_, options_.ray, points_m.size(), origin_m, reach_of(points_m));
      const std::size_t outside =
          options_.ends == EndPoints::kCells ? trace_in_range(cells_of(points_m)) : trace_in_range(points_m);
      if (has_window_) window_.hand_over(options_.hit, scan);
      return outside;
    } catch (...) {
      window_.drop();
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
    constexpr std::size_t kBlock = detail::WindowTracer::kBlock;
    for (std::size_t first = 0; first < points_m.size(); first += kBlock) {
      const std::span<const Point> block = points_m.subspan(first, std::min(kBlock, points_m.size() - first));
      find_places(window_.grid(), block, places_);
      for (std::size_t i = 0; i < block.size(); ++i) {
        const std::uint64_t place = places_[i];
        if (place == detail::kNoPlace) {
          add_one(block[i].template cast<double>());
        } else if (window_.window().mark_hit(place)) {
          found_.push_back(place);
          middles_m_.push_back(middle_of(block[i].template cast<double>()));
        }
      }
    }
    window_.window().clear_hits(found_);
    return middles_m_;
  }

  /// The middle of the cell that holds a point in the window, as Lattice::centre_of has it.
  Eigen::Vector3d middle_of(const Eigen::Vector3d& point_m) const {
    return lattice_.centre_of(*lattice_.key_of<WideWord>(point_m));
  }

  template <class Point>
  std::size_t trace_ends(std::span<const Point> ends_m, RayEnds ends) {
    std::size_t outside = 0;
    if (!has_window_) {
      for (const Point& point : ends_m) outside += trace_one(point.template cast<double>(), ends);
      return outside;
    }
    window_.trace(std::span(&origin_m_, 1), ends_m, [&](std::size_t i, std::uint64_t end) {
      if (end == detail::kNoPlace) {
        outside += trace_one(ends_m[i].template cast<double>(), ends);
      } else if (ends == RayEnds::kHit) {
        window_.window().mark_hit(end);
      }
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

  /// How far rays go along any axis [m]: a guess from some of them.
  template <class Point>
  double reach_of(std::span<const Point> ends_m) const {
    constexpr std::size_t kLooked = 1024;
    const std::size_t apart = std::max<std::size_t>(1, ends_m.size() / kLooked);
    double farthest_m = 0.0;
    for (std::size_t i = 0; i < ends_m.size(); i += apart) {
      farthest_m = std::max(farthest_m, (ends_m[i].template cast<double>() - origin_m_).cwiseAbs().maxCoeff());
    }
    return std::min(farthest_m, options_.max_range_m);
  }

  Lattice lattice_{1.0};
  PointScanOptions options_;
  detail::WindowTracer window_;
  // Of the scan that is traced.
  ScanUpdate* scan_ = nullptr;
  Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero();
  bool has_window_ = false;
  // Kept for the next one.
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
