#include "map_agreement.hpp"

#include <algorithm>
#include <limits>

#include "pingvox/map/for_each_leaf.hpp"

namespace pingvox::app {
namespace {

void add_saturated(std::uint64_t& sum, std::uint64_t n) {
  sum = n > std::numeric_limits<std::uint64_t>::max() - sum ? std::numeric_limits<std::uint64_t>::max() : sum + n;
}

/// Walks both trees at once: the time follows from their nodes, not from their cells.
class Walk {
 public:
  Walk(const OccupancyMap& a, const OccupancyMap& b, MapAgreement& out)
      : a_(a.options().thresholds), b_(b.options().thresholds), levels_(a.lattice().depth()), out_(out) {}

  void visit(const std::optional<NodeView>& a, const std::optional<NodeView>& b, int depth) {
    if (!a && !b) return;
    if ((!a || a->is_leaf()) && (!b || b->is_leaf())) {
      count(a ? classify(a->belief(), a_) : Occupancy::kUnknown, b ? classify(b->belief(), b_) : Occupancy::kUnknown,
            depth);
      return;
    }
    for (int octant = 0; octant < 8; ++octant) visit(part(a, octant), part(b, octant), depth + 1);
  }

 private:
  static std::optional<NodeView> part(const std::optional<NodeView>& node, int octant) {
    return node && !node->is_leaf() ? node->child(octant) : node;
  }

  void count(Occupancy a, Occupancy b, int depth) {
    const int bits = 3 * (levels_ - depth);
    const std::uint64_t cells = bits < 64 ? std::uint64_t{1} << bits : std::numeric_limits<std::uint64_t>::max();
    if (a == Occupancy::kOccupied) add_saturated(out_.occupied_a, cells);
    if (b == Occupancy::kOccupied) add_saturated(out_.occupied_b, cells);
    if (a == Occupancy::kOccupied && b == a) add_saturated(out_.occupied_both, cells);
    if (a == Occupancy::kFree) add_saturated(out_.free_a, cells);
    if (b == Occupancy::kFree) add_saturated(out_.free_b, cells);
    if (a == Occupancy::kFree && b == a) add_saturated(out_.free_both, cells);
  }

  Thresholds a_, b_;
  int levels_;
  MapAgreement& out_;
};

template <KeyWord W>
bool is_near_occupied(const OccupancyMap& map, const BasicKey<W>& key) {
  if (map.classify(key) == Occupancy::kOccupied) return true;
  const WideWord last = (WideWord{1} << (map.lattice().depth() - 1)) - 1 + (WideWord{1} << (map.lattice().depth() - 1));
  const auto low = [](W word) { return word == 0 ? word : static_cast<W>(word - 1); };
  const auto high = [last](W word) { return word == static_cast<W>(last) ? word : static_cast<W>(word + 1); };
  for (W x = low(key.x);; ++x) {
    for (W y = low(key.y);; ++y) {
      for (W z = low(key.z);; ++z) {
        if (map.classify(BasicKey<W>{x, y, z}) == Occupancy::kOccupied) return true;
        if (z == high(key.z)) break;
      }
      if (y == high(key.y)) break;
    }
    if (x == high(key.x)) break;
  }
  return false;
}

/// How many occupied cells of one map have an occupied one of the other within one cell.
template <KeyWord W>
std::uint64_t near_cells(const OccupancyMap& of, const OccupancyMap& to) {
  std::uint64_t near = 0;
  for_each_leaf(of, [&](const Leaf& leaf) {
    if (classify(leaf.belief, of.options().thresholds) != Occupancy::kOccupied) return;
    const WideWord edge = WideWord{1} << (of.lattice().depth() - leaf.depth);
    for (WideWord x = 0; x < edge; ++x) {
      for (WideWord y = 0; y < edge; ++y) {
        for (WideWord z = 0; z < edge; ++z) {
          near += is_near_occupied(to, BasicKey<W>{static_cast<W>(leaf.key.x + x), static_cast<W>(leaf.key.y + y),
                                                   static_cast<W>(leaf.key.z + z)});
        }
      }
    }
  });
  return near;
}

std::optional<double> share(std::uint64_t part, std::uint64_t whole) {
  if (whole == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

std::optional<double> MapAgreement::precision() const {
  return a_near_b ? share(*a_near_b, occupied_a) : std::nullopt;
}
std::optional<double> MapAgreement::recall() const {
  return b_near_a ? share(*b_near_a, occupied_b) : std::nullopt;
}
std::optional<double> MapAgreement::free_true() const {
  return share(free_both, free_a);
}

MapAgreement agreement_of(const OccupancyMap& a, const OccupancyMap& b) {
  MapAgreement out;
  Walk(a, b, out).visit(a.root(), b.root(), 0);
  if (out.occupied_a > MapAgreement::kMaxLookedAround || out.occupied_b > MapAgreement::kMaxLookedAround) return out;
  with_key_word(a.lattice().depth(), [&]<KeyWord W>() {
    out.a_near_b = near_cells<W>(a, b);
    out.b_near_a = near_cells<W>(b, a);
  });
  return out;
}

}  // namespace pingvox::app
