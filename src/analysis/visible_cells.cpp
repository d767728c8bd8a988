#include "pingvox/analysis/visible_cells.hpp"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <vector>

#include "base/option_errors.hpp"
#include "pingvox/map/cast_ray.hpp"
#include "pingvox/map/for_each_leaf.hpp"

namespace pingvox {
namespace {

using Eigen::Vector3d;

constexpr std::uint64_t kMaxOccupied = 20'000'000;
constexpr std::size_t kMaxViews = 1000;

/// Poses without those that are nearly equal to the one before.
std::vector<Pose> distinct(std::span<const Pose> poses, double cell_m) {
  constexpr double kSameUp = 0.99985;  // cosine of 1 degree
  std::vector<Pose> views;
  for (const Pose& pose : poses) {
    const bool is_same = !views.empty() && (pose.translation() - views.back().translation()).norm() < cell_m &&
                         pose.linear().col(2).dot(views.back().linear().col(2)) > kSameUp;
    if (!is_same) views.push_back(pose);
  }
  if (views.size() <= kMaxViews) return views;
  std::vector<Pose> some;
  for (std::size_t n = 0; n < kMaxViews; ++n) some.push_back(views[n * views.size() / kMaxViews]);
  return some;
}

/// A face of a cell: its middle, and which way it looks.
struct Face {
  Vector3d middle_m, normal;
};

class Search {
 public:
  Search(const OccupancyMap& world, std::vector<Pose> views, const ViewOptions& options)
      : world_(world), views_(std::move(views)), options_(options), max_sine_(std::sin(0.5 * options.height_rad)) {}

  /// Whether any view sees a cell: first the one that saw the last.
  template <KeyWord W>
  bool sees(const BasicKey<W>& key) {
    const std::vector<Face> faces = open_faces(key);
    if (faces.empty()) return false;
    for (std::size_t n = 0; n < views_.size(); ++n) {
      const std::size_t view = (last_ + n) % views_.size();
      for (const Face& face : faces) {
        if (!sees(views_[view], face, key.template as<WideWord>())) continue;
        last_ = view;
        return true;
      }
    }
    return false;
  }

 private:
  /// The faces of a cell without an occupied cell before them.
  template <KeyWord W>
  std::vector<Face> open_faces(const BasicKey<W>& key) const {
    const Lattice& lattice = world_.lattice();
    const Vector3d centre_m = lattice.centre_of(key);
    std::vector<Face> faces;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double side : {-1.0, 1.0}) {
        const Vector3d normal = side * Vector3d::Unit(axis);
        if (world_.classify(centre_m + normal * lattice.resolution_m()) == Occupancy::kOccupied) continue;
        faces.push_back({centre_m + 0.5 * lattice.resolution_m() * normal, normal});
      }
    }
    return faces;
  }

  bool sees(const Pose& view, const Face& face, const WideKey& key) const {
    const Vector3d way_m = face.middle_m - view.translation();
    const double range_m = way_m.norm();
    if (!(range_m > 0.0 && range_m >= options_.min_range_m && range_m <= options_.max_range_m)) return false;
    if (face.normal.dot(way_m) >= 0.0) return false;  // seen from behind
    if (std::abs(view.linear().col(2).dot(way_m)) > max_sine_ * range_m) return false;
    const RayEnd end = cast_ray(world_, view.translation(), way_m, range_m + world_.lattice().resolution_m());
    return end.what == Occupancy::kOccupied && end.key == key;
  }

  const OccupancyMap& world_;
  std::vector<Pose> views_;
  ViewOptions options_;
  double max_sine_;
  std::size_t last_ = 0;
};

}  // namespace

Result<void> ViewOptions::validate() const {
  OptionErrors errors;
  errors.require("min_range_m", min_range_m, kMinRanges_m);
  errors.require(max_range_m > min_range_m, "max_range_m", fmt::format("above min_range_m ({})", min_range_m),
                 max_range_m);
  errors.require("height_rad", height_rad, kHeights_rad);
  return errors.result("view");
}

Result<OccupancyMap> visible_cells(const OccupancyMap& surface, const OccupancyMap& world,
                                   std::span<const Pose> map_from_sensor, const ViewOptions& options) {
  if (auto valid = options.validate(); !valid) return tl::unexpected(valid.error());
  if (!(surface.lattice() == world.lattice())) return fail(Error::Code::kBadOption, "maps of different lattices");
  if (const std::uint64_t cells = surface.counts().occupied_cells; cells > kMaxOccupied) {
    return fail(Error::Code::kLimit, fmt::format("too many occupied cells: {}, at most {}", cells, kMaxOccupied));
  }
  const Lattice& lattice = world.lattice();
  OccupancyMap visible(surface.options());
  Search search(world, distinct(map_from_sensor, lattice.resolution_m()), options);
  Editor editor = visible.edit();
  with_key_word(lattice.depth(), [&]<KeyWord W>() {
    for_each_leaf(surface, [&](const Leaf& leaf) {
      if (classify(leaf.belief, surface.options().thresholds) != Occupancy::kOccupied) return;
      const WideWord edge = WideWord{1} << (lattice.depth() - leaf.depth);  // few cells: no leaf is 2^128 wide
      for (WideWord n = 0; n < edge * edge * edge; ++n) {
        const BasicKey<W> key{static_cast<W>(leaf.key.x + n % edge), static_cast<W>(leaf.key.y + n / edge % edge),
                              static_cast<W>(leaf.key.z + n / edge / edge)};
        if (search.sees(key)) editor.set(key, lattice.depth(), leaf.belief);
      }
    });
  });
  editor.synchronize();
  return visible;
}

}  // namespace pingvox
