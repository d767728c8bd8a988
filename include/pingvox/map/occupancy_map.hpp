#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "pingvox/geometry/key.hpp"
#include "pingvox/geometry/lattice.hpp"
#include "pingvox/map/log_odds.hpp"
#include "pingvox/map/tree_view.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

class ScanUpdate;
class Editor;

namespace detail {
struct MapAccess;
}

struct MapOptions {
  static constexpr double kDefaultResolution_m = 0.05;
  /// Edge of a cell of the finest resolution, > 0. nullopt: of a map of a recording by its range and beam width
  /// (`forecast_map`), of others the default.
  std::optional<double> resolution_m = std::nullopt;
  int depth = Lattice::kDefaultDepth;
  Clamp clamp{};
  Thresholds thresholds{};  ///< for classify()
  Parents parents = Parents::kMax;
  std::size_t memory_limit_bytes = 0;  ///< for what `memory_bytes` counts; 0: none

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// A box of space in the map frame [m]; both corners belong to it.
struct Box {
  Eigen::Vector3d min, max;
};

/// Size of a map. Cells are of the finest resolution, whatever was pruned; sums saturate at 2^64 - 1.
struct MapCounts {
  std::uint64_t leaves = 0, inner = 0;
  std::uint64_t occupied_cells = 0, free_cells = 0, undecided_cells = 0;
  std::uint64_t nodes() const { return leaves + inner; }
};

/// Effect of a scan: cells of the finest resolution that it updated.
struct ApplyReport {
  std::uint64_t cells_freed = 0, cells_hit = 0;
};

/// A map of occupied, free and unknown space: an octree of log-odds over a Lattice, after OctoMap (Hornung et al.
/// 2013). Given the same freed and hit cells it holds what liboctomap's OcTree holds, bit for bit. Its nodes live in
/// pools over bricks of 4 x 4 x 4 cells (docs/architecture.md). Const functions may run in many threads at once.
class OccupancyMap {
 public:
  static Result<OccupancyMap> make(const MapOptions& options);
  /// REQUIRES options that validate.
  explicit OccupancyMap(const MapOptions& options = {});
  OccupancyMap(const OccupancyMap& other);
  OccupancyMap& operator=(const OccupancyMap& other);
  /// A map that was moved from may only be destroyed, or be given another one.
  OccupancyMap(OccupancyMap&& other) noexcept;
  OccupancyMap& operator=(OccupancyMap&& other) noexcept;
  ~OccupancyMap();

  const Lattice& lattice() const { return lattice_; }
  const MapOptions& options() const { return options_; }
  bool empty() const;

  /// Belief about a cell of the finest resolution; nullopt: never observed, which is not log-odds 0.
  /// REQUIRES a key below 2^depth in each component.
  template <KeyWord W>
  std::optional<LogOdds> at(const BasicKey<W>& key) const;
  /// The same for the cell that holds a point [m]; also nullopt outside of the lattice.
  std::optional<LogOdds> at(const Eigen::Vector3d& point_m) const;

  /// The whole tree to walk over; nullopt when nothing is known.
  std::optional<NodeView> root() const;
  /// The node at `depth` that holds `key`, or the leaf above it that stands for it; nullopt when nothing is known
  /// there. REQUIRES 0 <= depth <= lattice().depth()
  template <KeyWord W>
  std::optional<NodeView> node_at(const BasicKey<W>& key, int depth) const;

  /// `at`, judged by options().thresholds; kUnknown where nothing was observed.
  template <KeyWord W>
  Occupancy classify(const BasicKey<W>& key) const;
  Occupancy classify(const Eigen::Vector3d& point_m) const;

  MapCounts counts() const;
  /// The smallest box around all that is known; nullopt when nothing is.
  std::optional<Box> bounds() const;
  /// Bytes of the tree's storage, free room in its pools included.
  std::size_t memory_bytes() const;

  /// Applies one scan: each cell it missed or hit gets its evidence once, clamped; then parents are up to date and the
  /// tree is pruned. @return kLimit when memory_limit_bytes would be passed, kBadOption for a scan made for another
  /// lattice: the map is as before then. kNoMemory when memory ran out: some of the scan's cells have got their
  /// evidence then, and the map stays valid.
  Result<ApplyReport> apply(const ScanUpdate& scan);

  /// A batch of updates (paper, section 5.5): each key's cell gets the evidence as often as the key is named, in the
  /// tree's order whatever theirs is; then parents are right and the tree is pruned. The map is the one that an editor
  /// makes of them one by one. @return kLimit and kNoMemory as for
  /// `apply` (deeper than 23 levels the limit is not checked)
  template <KeyWord W>
  Result<void> update(std::span<const BasicKey<W>> keys, LogOdds evidence);

  /// Adds another map's log-odds to this one's, clamped, cell by cell; a cell that only one knows keeps its belief.
  /// @return kBadOption when the lattices differ, kLimit as for `apply`, kNoMemory; the map is as before then
  Result<void> merge(const OccupancyMap& other);

  /// For many single updates. REQUIRES no other editor of this map alive.
  [[nodiscard]] Editor edit(Pruning pruning = Pruning::kLazy);

  /// Removes all cells and frees the storage.
  void clear();

 private:
  friend class Editor;
  friend class detail::TreeBuilder;
  friend struct detail::MapAccess;
  /// REQUIRES a tree of options.depth levels whose parents are right and whose equal leaves are joined.
  OccupancyMap(const MapOptions& options, std::unique_ptr<detail::BrickTree> tree);

  MapOptions options_;
  Lattice lattice_;
  std::unique_ptr<detail::BrickTree> tree_;
};

/// Changes single cells. Inner nodes may be stale between `synchronize` calls, as `Pruning` says, and stay so in copies
/// of the map that are made then; leaves never are. Holds a path into the tree, so neighbouring updates are cheap.
/// Ignores memory_limit_bytes.
class Editor {
 public:
  Editor(OccupancyMap& map, Pruning pruning);
  Editor(const Editor&) = delete;
  Editor& operator=(const Editor&) = delete;
  ~Editor();  ///< synchronizes: it only reads and frees, so it cannot fail

  /// Adds evidence to one cell of the finest resolution, clamped.
  template <KeyWord W>
  void update(const BasicKey<W>& key, LogOdds evidence);

  /// Sets the belief of the whole cell at `depth` that holds `key`, without clamping. For readers.
  /// REQUIRES a finite belief.
  template <KeyWord W>
  void set(const BasicKey<W>& key, int depth, LogOdds belief);

  /// Updates all inner nodes and, unless Pruning::kNever, joins equal leaves.
  void synchronize();

 private:
  OccupancyMap& map_;
  struct Place;
  std::unique_ptr<Place> place_;  ///< in the tree
};

}  // namespace pingvox
