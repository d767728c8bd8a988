#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pingvox/geometry/key.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "placed_sweep.hpp"

namespace pingvox::bench {

/// The occupancy grid of the paper's section 3.1: one layer of cells, all of which are there from the start.
class DenseGrid {
 public:
  /// @param lattice  whose cells these are
  /// @param box      of the cells, map frame; its z is that of the layer
  DenseGrid(const Lattice& lattice, const Box& box);

  /// Takes a sweep in as OccupancyMap does with rays: a vote for each cell, and a hit beats a miss.
  void add(const PlacedSweep& sweep);

  std::size_t size() const { return beliefs_.size(); }
  std::size_t memory_bytes() const { return beliefs_.size() * sizeof(beliefs_[0]); }
  std::size_t known() const;  ///< cells
  /// nullopt: never observed, or outside.
  std::optional<LogOdds> at(const Key& key) const;

 private:
  std::optional<std::size_t> index_of(const Key& key) const;

  Lattice lattice_;
  Key first_;
  std::size_t width_ = 0, height_ = 0;
  std::vector<float> beliefs_;  ///< by row; NaN: never observed
  std::vector<float> votes_;    ///< of the present sweep; 0: none
};

}  // namespace pingvox::bench
