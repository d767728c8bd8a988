#include "pingvox/map/trace_ray.hpp"

#include <array>
#include <cassert>
#include <cmath>
#include <span>
#include <vector>

#include "map/kernels/ray_lanes.hpp"
#include "pingvox/map/ray_bresenham.hpp"
#include "pingvox/map/ray_dda.hpp"

namespace pingvox {
namespace {

/// Marks the cells of a ray, asking for a page only when the ray enters one.
class Marker {
 public:
  explicit Marker(ScanUpdate& scan) : scan_(scan) {}

  template <KeyWord W>
  void miss(const BasicKey<W>& key) {
    const BasicKey<W> page{static_cast<W>(key.x >> kBits), static_cast<W>(key.y >> kBits),
                           static_cast<W>(key.z >> kBits)};
    if (!inside_ || page.template as<WideWord>() != page_key_) {
      page_ = scan_.page_of(key.template as<WideWord>());
      page_key_ = page.template as<WideWord>();
      inside_ = true;
    }
    scan_.mark_missed(page_, ScanUpdate::cell_in_page(key));
  }

 private:
  static constexpr int kBits = ScanUpdate::kPageBits;
  ScanUpdate& scan_;
  WideKey page_key_;
  std::uint32_t page_ = 0;
  bool inside_ = false;
};

template <KeyWord W>
bool trace(const Lattice& lattice, const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m, RayAlgorithm algorithm,
           ScanUpdate& scan) {
  Marker marker(scan);
  if (algorithm == RayAlgorithm::kDda) {
    const auto ray = dda<W>(lattice, from_m, to_m);
    if (!ray) return false;
    for (const BasicKey<W> key : *ray) marker.miss(key);
    return true;
  }
  const auto from = lattice.key_of<W>(from_m), to = lattice.key_of<W>(to_m);
  if (!from || !to) return false;
  for (const BasicKey<W> key : bresenham(*from, *to)) marker.miss(key);
  return true;
}

/// Those that a ray crosses; none when an end of it lies outside of the lattice.
std::size_t faces_between(const Lattice& lattice, const Segment& ray) {
  const auto from = lattice.key_of(ray.from_m), to = lattice.key_of(ray.to_m);
  if (!from || !to) return 0;
  const auto along = [](std::uint16_t a, std::uint16_t b) { return static_cast<std::size_t>(a < b ? b - a : a - b); };
  return along(from->x, to->x) + along(from->y, to->y) + along(from->z, to->z);
}

}  // namespace

bool trace_ray(const Lattice& lattice, const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m,
               RayAlgorithm algorithm, ScanUpdate& scan) {
  return with_key_word(lattice.depth(), [&]<KeyWord W>() { return trace<W>(lattice, from_m, to_m, algorithm, scan); });
}

void trace_keys(const Lattice& lattice, std::span<const Segment> rays, RayKeys& into) {
  assert(lattice.depth() <= kLevelsOf<std::uint16_t>);
  const detail::Lanes lanes = detail::widest_lanes();
  std::vector<detail::ReadyRay> ready(rays.size());
  std::vector<std::uint32_t> others;
  detail::prepare_rays(lanes, {lattice.cells_per_m(), std::ldexp(1.0, lattice.depth() - 1)}, rays, ready,
                       others);

  into.ends_.resize(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) into.ends_[i] = ready[i].left;
  for (const std::uint32_t i : others) into.ends_[i] = faces_between(lattice, rays[i]);
  std::size_t begin = 0;
  for (std::size_t& end : into.ends_) {
    end += begin;
    begin = end + 1;
  }
  if (into.keys_.size() < begin + 1) into.keys_.resize(begin + 1);

  std::vector<Key*> places(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) places[i] = into.keys_.data() + into.begin_of(i);
  detail::write_keys(lanes, ready, places);
  for (const std::uint32_t i : others) {
    const auto ray = dda<std::uint16_t>(lattice, rays[i].from_m, rays[i].to_m);
    if (!ray) continue;
    Key* at = places[i];
    for (const Key key : *ray) *at++ = key;
  }
}

}  // namespace pingvox
