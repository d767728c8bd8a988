#include "io/octomap_bt.hpp"

#include <fmt/core.h>

#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "io/byte_reader.hpp"
#include "io/map_files.hpp"
#include "io/octomap_header.hpp"

// docs/formats.md: two bytes for each inner node, two bits for each of its children.
namespace pingvox {
namespace {

constexpr unsigned kUnknown = 0, kFree = 1, kOccupied = 2, kInner = 3;
constexpr unsigned kAllFree = 0x5555, kAllOccupied = 0xAAAA;

constexpr int kBrickDepth = kOctomapDepth - 2;

constexpr unsigned state_of(unsigned word, std::size_t octant) {
  return (word >> (2 * octant)) & 3U;
}

/// Children that a word names.
constexpr unsigned children_of(unsigned word) {
  unsigned children = (word | word >> 1) & 0x5555U;
  children = (children & 0x3333U) + (children >> 2 & 0x3333U);
  children = (children + (children >> 4)) & 0x0F0FU;
  return (children + (children >> 8)) & 0xFU;
}

/// The word of eight children without children, of which these bits are free and occupied.
constexpr unsigned word_of(unsigned free, unsigned occupied) {
  unsigned bits = free | occupied << 16;  // both at once: bit i of each half goes to bit 2 i
  bits = (bits | bits << 4) & 0x0F0F0F0FU;
  bits = (bits | bits << 2) & 0x33333333U;
  bits = (bits | bits << 1) & 0x55555555U;
  return (bits | bits >> 15) & 0xFFFFU;
}

struct States {
  unsigned free, occupied;  ///< inner children are in both
};
/// What word_of was made of.
constexpr States states_of(unsigned word) {
  unsigned bits = (word & 0x5555U) | (word & 0xAAAAU) << 15;
  bits = (bits | bits >> 1) & 0x33333333U;
  bits = (bits | bits >> 2) & 0x0F0F0F0FU;
  bits = (bits | bits >> 4) & 0x00FF00FFU;
  return {bits & 0xFFU, bits >> 16};
}

/// Builds the tree from below, whole groups and bricks at a time.
class TreeReader {
 public:
  /// @param map  an empty one of a .bt file's kind
  TreeReader(const FileBytes& file, std::size_t tree_at, const OccupancyMap& map)
      : file_(file),
        tree_at_(tree_at),
        reader_(file.view().subspan(tree_at)),
        options_(map.options()),
        tree_(map.options().depth) {}

  Result<OccupancyMap> read(std::uint64_t nodes) {
    if (nodes > 0) {
      nodes_ = 1;
      const auto root = read_group(0);
      if (!root) return tl::unexpected(root.error());
      tree_.root = *root;
    }
    if (nodes_ != nodes) {
      return damaged(file_, position(), fmt::format("the tree has {} nodes and the header says {}", nodes_, nodes));
    }
    if (reader_.left() > 0) return damaged(file_, position(), fmt::format("{} bytes after the tree", reader_.left()));
    return OccupancyMap(options_, std::move(tree_));
  }

 private:
  std::size_t position() const { return tree_at_ + reader_.position(); }

  /// The word of an inner node.
  Result<unsigned> read_word() {
    const auto word = reader_.read<std::uint16_t>();
    if (!word) return damaged(file_, position(), "the file ends inside of the tree");
    if (*word == 0) return damaged(file_, position() - sizeof *word, "an inner node without children");
    nodes_ += children_of(*word);
    return *word;
  }

  /// The node at `depth` whose word is next, with all below it.
  Result<detail::Entry> read_group(int depth) {
    const std::size_t at = position();
    const auto word = read_word();
    if (!word) return tl::unexpected(word.error());
    detail::Group group;
    for (std::size_t octant = 0; octant < 8; ++octant) {
      const unsigned state = state_of(*word, octant);
      if (state == kUnknown) continue;
      if (state != kInner) {
        group.child[octant] = detail::Entry::leaf(belief_of(state));
        continue;
      }
      const auto child = depth + 1 == kBrickDepth ? read_brick() : read_group(depth + 1);
      if (!child) return child;
      group.child[octant] = *child;
    }
    return within_limit(detail::built(tree_, group, options_.parents), at);
  }

  /// The node of a brick, whose word is next, and its cells.
  Result<detail::Entry> read_brick() {
    const std::size_t at = position();
    const auto word = read_word();
    if (!word) return tl::unexpected(word.error());
    detail::CellStates cells;
    for (std::size_t octant = 0; octant < 8; ++octant) {
      const unsigned state = state_of(*word, octant);
      States below{state == kFree ? 0xFFU : 0U, state == kOccupied ? 0xFFU : 0U};
      if (state == kInner) {
        const auto octant_word = read_word();
        if (!octant_word) return tl::unexpected(octant_word.error());
        below = states_of(*octant_word);
        if ((below.free & below.occupied) != 0) {
          return damaged(file_, position(), "an inner node below the 16th level");
        }
      }
      cells.free |= std::uint64_t{below.free} << (octant * 8);
      cells.occupied |= std::uint64_t{below.occupied} << (octant * 8);
    }
    return within_limit(detail::built(tree_, cells, options_.clamp, options_.parents), at);
  }

  float belief_of(unsigned state) const {
    return (state == kOccupied ? options_.clamp.highest : options_.clamp.lowest).value();
  }

  /// The entry, when the tree with it is within the limit.
  Result<detail::Entry> within_limit(detail::Entry entry, std::size_t byte) const {
    const std::size_t limit = options_.memory_limit_bytes;
    if (limit > 0 && tree_.groups.bytes() + tree_.bricks.bytes() > limit) return over_limit(file_, byte, limit);
    return entry;
  }

  const FileBytes& file_;
  std::size_t tree_at_;
  ByteReader reader_;
  MapOptions options_;
  detail::BrickTree tree_;
  std::uint64_t nodes_ = 0;
};

/// Makes the words of a tree as they would be if each leaf were as sure as it can be and equal ones were joined.
class TreeWords {
 public:
  explicit TreeWords(const OccupancyMap& map) : tree_(map.tree()), thresholds_(map.options().thresholds) {
    words_.reserve(tree_.groups.bytes() / sizeof(detail::Group) +
                   tree_.bricks.bytes() / sizeof(detail::Brick) * kMostBrickWords);
    const unsigned state = add(tree_.root, 0);
    // The format cannot say what a root without children is: liboctomap reads it as occupied.
    if (state == kFree || state == kOccupied) words_.push_back(state == kFree ? kAllFree : kAllOccupied);
  }

  const std::vector<std::uint16_t>& words() const { return words_; }

  std::uint64_t nodes() const {
    std::uint64_t nodes = words_.empty() ? 0 : 1;
    for (const std::uint16_t word : words_) nodes += children_of(word);
    return nodes;
  }

 private:
  static constexpr std::size_t kMostBrickWords = 9;  ///< its own and those of its octants

  /// The state of a node, after its words and those below it, if there are any.
  unsigned add(const detail::Entry& entry, int depth) {
    if (entry.is_none()) return kUnknown;
    if (entry.is_leaf()) return state_of_leaf(LogOdds(entry.value));
    if (depth == kBrickDepth) return add(tree_.bricks[entry.link]);
    const std::size_t at = words_.size();
    words_.push_back(0);
    const detail::Group& group = tree_.groups[entry.link];
    if (depth + 1 == kBrickDepth) detail::fetch_bricks(tree_, group);
    unsigned word = 0;
    for (std::size_t octant = 0; octant < 8; ++octant) word |= add(group.child[octant], depth + 1) << (2 * octant);
    if (is_alike(word)) {
      assert(words_.size() == at + 1);
      words_.pop_back();
      return word & 3U;
    }
    words_[at] = static_cast<std::uint16_t>(word);
    return kInner;
  }

  unsigned add(const detail::Brick& brick) {
    const detail::CellStates cells = detail::classified(brick, thresholds_);
    std::array<std::uint16_t, kMostBrickWords> words;
    std::ptrdiff_t count = 1;
    unsigned word = 0;
    for (std::size_t octant = 0; octant < 8; ++octant) {
      const auto byte_of = [&](std::uint64_t mask) { return static_cast<unsigned>(mask >> (octant * 8)) & 0xFFU; };
      const unsigned below = word_of(byte_of(cells.free), byte_of(cells.occupied));
      const bool is_inner = !is_alike(below);
      words[static_cast<std::size_t>(count)] = static_cast<std::uint16_t>(below);
      count += is_inner ? 1 : 0;
      word |= (is_inner ? kInner : below & 3U) << (2 * octant);
    }
    if (is_alike(word)) return word & 3U;
    words[0] = static_cast<std::uint16_t>(word);
    words_.insert(words_.end(), words.begin(), words.begin() + count);
    return kInner;
  }

  /// Whether all children are in the same state, and have no children.
  static bool is_alike(unsigned word) { return word == 0 || word == kAllFree || word == kAllOccupied; }

  unsigned state_of_leaf(LogOdds belief) const {
    switch (classified(belief, thresholds_)) {
      case Occupancy::kOccupied:
        return kOccupied;
      case Occupancy::kFree:
        return kFree;
      case Occupancy::kUnknown:
        break;
    }
    return kUnknown;
  }

  const detail::BrickTree& tree_;
  Thresholds thresholds_;
  std::vector<std::uint16_t> words_;
};

}  // namespace

Result<OccupancyMap> read_bt(const FileBytes& file, std::size_t memory_limit_bytes) {
  OctomapHeader header;
  ByteReader oldest(file.view());
  if (const auto version = oldest.read<std::int32_t>(); version == 3) {
    const auto resolution_m = oldest.read<double>();
    const auto nodes = oldest.read<std::uint32_t>();
    if (!resolution_m || !nodes) return damaged(file, file.bytes.size(), "the file ends inside of the header");
    header = {.id = "OcTree", .nodes = *nodes, .resolution_m = *resolution_m, .tree_at = oldest.position()};
  } else {
    auto read = read_octomap_header(file, kBtFirstLine);
    if (!read) return tl::unexpected(std::move(read).error());
    header = *std::move(read);
  }
  auto map = empty_octomap(file, header.resolution_m, memory_limit_bytes);
  if (!map) return map;
  return TreeReader(file, header.tree_at, *map).read(header.nodes);
}

Result<void> write_bt(const OccupancyMap& map, std::ostream& out) {
  if (const auto fits = check_octomap_depth(map, ".bt"); !fits) return fits;
  const TreeWords tree(map);
  // As one block, and without the checksum that a ByteWriter keeps: the format has none.
  out << octomap_header(kBtFirstLine, tree.nodes(), map.lattice().resolution_m());
  std::vector<std::uint16_t> words = tree.words();
  if constexpr (std::endian::native != std::endian::little) {
    for (std::uint16_t& word : words) word = static_cast<std::uint16_t>(word >> 8 | word << 8);
  }
  out.write(reinterpret_cast<const char*>(words.data()), static_cast<std::streamsize>(words.size() * sizeof words[0]));
  out.flush();
  if (!out) return fail(Error::Code::kIo, "the map could not be written");
  return {};
}

}  // namespace pingvox
