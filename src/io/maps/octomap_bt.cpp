#include "io/maps/octomap_bt.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <utility>

#include "io/bytes/byte_reader.hpp"
#include "io/maps/bt_words.hpp"
#include "io/maps/map_files.hpp"
#include "io/maps/octomap_header.hpp"
#include "pingvox/map/tree_view.hpp"

// docs/formats.md: two bytes for each inner node, two bits for each of its children.
namespace pingvox {
namespace {

constexpr int kBrickDepth = kOctomapDepth - 2;

/// Builds the tree bottom-up by whole groups and bricks.
class BtTreeReader {
 public:
  /// @param map  an empty map for a .bt file
  BtTreeReader(const FileBytes& file, std::size_t tree_at, const OccupancyMap& map)
      : file_(file),
        tree_at_(tree_at),
        reader_(file.view().subspan(tree_at)),
        options_(map.options()),
        tree_(map.options()) {}

  Result<OccupancyMap> read(std::uint64_t nodes) {
    detail::Entry root;
    if (nodes > 0) {
      nodes_ = 1;
      const auto read = read_group(0);
      if (!read) return tl::unexpected(read.error());
      root = *read;
    }
    if (nodes_ != nodes) {
      return damage_error(file_, position(),
                          fmt::format("the tree has {} nodes and the header says {}", nodes_, nodes));
    }
    if (reader_.left() > 0)
      return damage_error(file_, position(), fmt::format("{} bytes after the tree", reader_.left()));
    return tree_.finish(root);
  }

 private:
  std::size_t position() const { return tree_at_ + reader_.position(); }

  /// The word of an inner node; 0 (invalid) if damaged, see `bad_word`.
  unsigned read_word() {
    const auto word = reader_.read<std::uint16_t>();
    is_at_end_ = !word;
    nodes_ += children_of(word.value_or(0));
    return word.value_or(0);
  }
  /// Error of the last word. Separate, because returning a Result for each word would double the time.
  tl::unexpected<Error> bad_word() const {
    if (is_at_end_) return damage_error(file_, position(), "the file ends inside of the tree");
    return damage_error(file_, position() - sizeof(std::uint16_t), "an inner node without children");
  }

  /// Reads the subtree of the node at `depth`.
  Result<detail::Entry> read_group(int depth) {
    const std::size_t at = position();
    const unsigned word = read_word();
    if (word == 0) return bad_word();
    detail::Group group;
    for (std::size_t octant = 0; octant < 8; ++octant) {
      const unsigned state = state_of(word, octant);
      if (state == bt::kUnknown) continue;
      if (state != bt::kInner) {
        group.child[octant] = detail::Entry::leaf(belief_of(state));
        continue;
      }
      const auto child = depth + 1 == kBrickDepth ? read_brick() : read_group(depth + 1);
      if (!child) return child;
      group.child[octant] = *child;
    }
    return check_limit(tree_.add(group), at);
  }

  /// Reads the node of a brick and its cells.
  Result<detail::Entry> read_brick() {
    const std::size_t at = position();
    const unsigned word = read_word();
    if (word == 0) return bad_word();
    const States octants = states_of(word);
    const unsigned inner = octants.free & octants.occupied;
    detail::CellStates cells{whole_octants(octants.free & ~inner), whole_octants(octants.occupied & ~inner)};
    for (unsigned rest = inner; rest != 0; rest &= rest - 1) {
      const unsigned octant_word = read_word();
      if (octant_word == 0) return bad_word();
      const States below = states_of(octant_word);
      if ((below.free & below.occupied) != 0) {
        return damage_error(file_, position(), "an inner node below the 16th level");
      }
      const int shift = std::countr_zero(rest) * 8;
      cells.free |= std::uint64_t{below.free} << shift;
      cells.occupied |= std::uint64_t{below.occupied} << shift;
    }
    return check_limit(tree_.add(cells), at);
  }

  float belief_of(unsigned state) const {
    return (state == bt::kOccupied ? options_.clamp.highest : options_.clamp.lowest).value();
  }

  /// The entry, or kLimit when the tree exceeds the limit.
  Result<detail::Entry> check_limit(detail::Entry entry, std::size_t byte) const {
    const std::size_t limit = options_.memory_limit_bytes;
    if (limit > 0 && tree_.bytes() > limit) return over_limit(file_, byte, limit);
    return entry;
  }

  const FileBytes& file_;
  std::size_t tree_at_;
  ByteReader reader_;
  MapOptions options_;
  detail::TreeBuilder tree_;
  std::uint64_t nodes_ = 0;
  bool is_at_end_ = false;  ///< the file ended before the word
};

/// Words of the maximum-likelihood tree: leaves rounded to occupied or free, and pruned.
class TreeWords {
 public:
  explicit TreeWords(const OccupancyMap& map)
      : tree_(detail::view_of(map)),
        thresholds_(map.options().thresholds),
        has_maxima_(map.options().parents == Parents::kMax),
        words_(room_for(tree_)),
        end_(words_.get()) {
    const unsigned state = add(tree_.root, 0);
    // A root without children would be read as occupied by liboctomap.
    if (state == bt::kFree) *end_++ = kAllFree;
    if (state == bt::kOccupied) *end_++ = kAllOccupied;
  }

  std::span<std::uint16_t> words() { return {words_.get(), end_}; }

  std::uint64_t nodes() const {
    // Blocks whose sums fit into 16 bits, for vectorisation.
    constexpr std::size_t kBlock = 4096;
    static_assert(kBlock * 8 <= std::numeric_limits<std::uint16_t>::max());
    const std::span<const std::uint16_t> all(words_.get(), end_);
    std::uint64_t nodes = all.empty() ? 0 : 1;
    for (std::size_t first = 0; first < all.size(); first += kBlock) {
      std::uint16_t children = 0;
      for (const std::uint16_t word : all.subspan(first, std::min(kBlock, all.size() - first))) {
        children = static_cast<std::uint16_t>(children + children_of(word));
      }
      nodes += children;
    }
    return nodes;
  }

 private:
  /// Upper bound of the size, so that no word needs a bounds check.
  static std::unique_ptr<std::uint16_t[]> room_for(const detail::TreeView& tree) {
    constexpr std::size_t kMaxBrickWords = 9;  // its own and those of its octants
    return std::make_unique_for_overwrite<std::uint16_t[]>(tree.group_count + tree.brick_count * kMaxBrickWords +
                                                           kMaxBrickWords);
  }

  /// Appends the words of a subtree and returns the state of its root.
  unsigned add(const detail::Entry& entry, int depth) {
    if (entry.is_none()) return bt::kUnknown;
    if (entry.is_leaf()) return state_of(LogOdds(entry.value));
    if (depth < kBrickDepth) return add(tree_.groups[entry.link], depth);
    const detail::BrickView brick = tree_.bricks[entry.link];
    return add(is_all_free(entry) ? detail::CellStates{brick.known, 0} : detail::classify(brick, thresholds_));
  }

  unsigned add(const detail::Group& group, int depth) {
    std::uint16_t* const at = end_++;
    unsigned word = 0;
    for (std::size_t octant = 0; octant < 8; ++octant) word |= add(group.child[octant], depth + 1) << (2 * octant);
    if (is_uniform(word)) {
      assert(end_ == at + 1);
      end_ = at;
      return word & 3U;
    }
    *at = static_cast<std::uint16_t>(word);
    return bt::kInner;
  }

  /// Whether all known cells below a node are free, by the maximum: for most bricks without reading their values, which
  /// are four fifths of the memory.
  bool is_all_free(const detail::Entry& entry) const {
    return has_maxima_ && state_of(LogOdds(entry.value)) == bt::kFree;
  }

  unsigned add(const detail::CellStates& cells) {
    const EightWords octants = words_of(cells.free, cells.occupied);
    const EightWords are_inner = mixed_words(octants);
    const unsigned word = word_above(octants, are_inner);
    if (is_uniform(word)) return word & 3U;
    std::uint16_t* end = end_;
    *end++ = static_cast<std::uint16_t>(word);
    for (std::size_t octant = 0; octant < 8; ++octant) {
      *end = octants[octant];  // overwritten by the next one unless it is of an inner node
      end += are_inner[octant] & 1U;
    }
    end_ = end;
    return bt::kInner;
  }

  unsigned state_of(LogOdds belief) const {
    switch (classify(belief, thresholds_)) {
      case Occupancy::kOccupied:
        return bt::kOccupied;
      case Occupancy::kFree:
        return bt::kFree;
      case Occupancy::kUnknown:
        break;
    }
    return bt::kUnknown;
  }

  detail::TreeView tree_;
  Thresholds thresholds_;
  bool has_maxima_;  ///< inner nodes hold the maximum of their children
  std::unique_ptr<std::uint16_t[]> words_;
  std::uint16_t* end_;  ///< past the last word
};

}  // namespace

Result<OccupancyMap> read_bt(const FileBytes& file, std::size_t memory_limit_bytes) {
  OctomapHeader header;
  ByteReader oldest(file.view());
  if (const auto version = oldest.read<std::int32_t>(); version == 3) {
    const auto resolution_m = oldest.read<double>();
    const auto nodes = oldest.read<std::uint32_t>();
    if (!resolution_m || !nodes) return damage_error(file, file.bytes.size(), "the file ends inside of the header");
    header = {.id = "OcTree", .nodes = *nodes, .resolution_m = *resolution_m, .tree_at = oldest.position()};
  } else {
    auto read = read_octomap_header(file, kBtFirstLine);
    if (!read) return tl::unexpected(std::move(read).error());
    header = *std::move(read);
  }
  auto map = empty_octomap(file, header.resolution_m, memory_limit_bytes);
  if (!map) return map;
  return BtTreeReader(file, header.tree_at, *map).read(header.nodes);
}

Result<void> write_bt(const OccupancyMap& map, MapAxes axes, std::ostream& out) {
  if (const auto fits = check_octomap_depth(map, ".bt"); !fits) return fits;
  TreeWords tree(map);
  // One block; no ByteWriter, as the format has no checksum.
  out << octomap_header(kBtFirstLine, tree.nodes(), map.lattice().resolution_m(), axes);
  const std::span<std::uint16_t> words = tree.words();
  if constexpr (std::endian::native != std::endian::little) {
    for (std::uint16_t& word : words) word = static_cast<std::uint16_t>(word >> 8 | word << 8);
  }
  out.write(reinterpret_cast<const char*>(words.data()), static_cast<std::streamsize>(words.size_bytes()));
  out.flush();
  if (!out) return fail(Error::Code::kIo, "the map could not be written");
  return {};
}

}  // namespace pingvox
