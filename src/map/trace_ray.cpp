#include "pingvox/map/trace_ray.hpp"

#include <cstdint>

#include "geometry/internal/ray_bresenham.hpp"
#include "geometry/internal/ray_dda.hpp"

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

}  // namespace

bool trace_ray(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m, RayAlgorithm algorithm, ScanUpdate& scan) {
  const Lattice& lattice = scan.lattice();
  return with_key_word(lattice.depth(), [&]<KeyWord W>() { return trace<W>(lattice, from_m, to_m, algorithm, scan); });
}

}  // namespace pingvox
