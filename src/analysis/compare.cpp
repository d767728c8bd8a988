#include "pingvox/analysis/compare.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "geometry/internal/cell_counts.hpp"

namespace pingvox {
namespace {

using detail::add_saturated;

class Comparison {
 public:
  Comparison(const OccupancyMap& a, const OccupancyMap& b, Sameness sameness)
      : a_(a.options().thresholds), b_(b.options().thresholds), sameness_(sameness), levels_(a.lattice().depth()) {}

  /// Compares two nodes for the same cube at `depth`. A leaf above it has the same value for each of its parts; nullopt
  /// is unknown space.
  void compare(const std::optional<NodeView>& a, const std::optional<NodeView>& b, int depth) {
    if (!a && !b) return;
    if ((!a || a->is_leaf()) && (!b || b->is_leaf())) {
      count(a, b, depth);
      return;
    }
    for (int octant = 0; octant < 8; ++octant) compare(part(a, octant), part(b, octant), depth + 1);
  }

  const MapComparison& result() const { return result_; }

 private:
  static std::optional<NodeView> part(const std::optional<NodeView>& node, int octant) {
    return node && !node->is_leaf() ? node->child(octant) : node;
  }

  void count(const std::optional<NodeView>& a, const std::optional<NodeView>& b, int depth) {
    const std::uint64_t cells = detail::cells_in_node(levels_ - depth);
    if (!b) return add_saturated(result_.only_a, cells);
    if (!a) return add_saturated(result_.only_b, cells);
    const LogOdds belief_a = a->belief(), belief_b = b->belief();
    const double difference = std::abs(double{belief_a.value()} - double{belief_b.value()});
    result_.max_log_odds_difference = std::max(result_.max_log_odds_difference, difference);
    const bool same =
        sameness_ == Sameness::kLogOdds ? belief_a == belief_b : classify(belief_a, a_) == classify(belief_b, b_);
    add_saturated(same ? result_.same : result_.different, cells);
  }

  Thresholds a_, b_;
  Sameness sameness_;
  int levels_;
  MapComparison result_;
};

}  // namespace

std::uint64_t MapComparison::cells() const {
  std::uint64_t sum = same;
  for (const std::uint64_t n : {different, only_a, only_b}) add_saturated(sum, n);
  return sum;
}

Result<MapComparison> compare_maps(const OccupancyMap& a, const OccupancyMap& b, Sameness sameness) {
  if (a.lattice() != b.lattice()) {
    return fail(
        Error::Code::kBadOption,
        fmt::format("the maps have different cells: {} m and {} levels, {} m and {} levels", a.lattice().resolution_m(),
                    a.lattice().depth(), b.lattice().resolution_m(), b.lattice().depth()));
  }
  Comparison comparison(a, b, sameness);
  comparison.compare(a.root(), b.root(), 0);
  return comparison.result();
}

}  // namespace pingvox
