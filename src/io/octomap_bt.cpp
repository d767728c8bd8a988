#include "io/octomap_bt.hpp"

#include <fmt/core.h>

#include <cassert>
#include <vector>

#include "io/byte_reader.hpp"
#include "io/byte_writer.hpp"
#include "io/map_files.hpp"
#include "io/octomap_header.hpp"

// docs/formats.md: two bytes for each inner node, two bits for each of its children.
namespace pingvox {
namespace {

constexpr unsigned kUnknown = 0, kFree = 1, kOccupied = 2, kInner = 3;
constexpr unsigned kAllFree = 0x5555, kAllOccupied = 0xAAAA;

constexpr unsigned state_of(unsigned word, int octant) {
  return (word >> (2 * octant)) & 3U;
}

class TreeReader {
 public:
  TreeReader(const FileBytes& file, std::size_t tree_at, OccupancyMap& map, std::size_t memory_limit_bytes)
      : file_(file),
        tree_at_(tree_at),
        reader_(file.view().subspan(tree_at)),
        builder_(map, file, memory_limit_bytes),
        clamp_(map.options().clamp) {}

  Result<void> read(std::uint64_t nodes) {
    if (nodes > 0) {
      nodes_ = 1;
      if (const auto done = read_inner(WideKey{}, 0); !done) return done;
    }
    if (nodes_ != nodes) {
      return damaged(file_, position(), fmt::format("the tree has {} nodes and the header says {}", nodes_, nodes));
    }
    if (reader_.left() > 0) return damaged(file_, position(), fmt::format("{} bytes after the tree", reader_.left()));
    return {};
  }

 private:
  std::size_t position() const { return tree_at_ + reader_.position(); }

  Result<void> read_inner(const WideKey& key, int depth) {
    const std::size_t at = position();
    if (depth == kOctomapDepth) return damaged(file_, at, "an inner node below the 16th level");
    const auto word = reader_.read<std::uint16_t>();
    if (!word) return damaged(file_, at, "the file ends inside of the tree");
    if (*word == 0) return damaged(file_, at, "an inner node without children");
    for (int octant = 0; octant < 8; ++octant) {
      const unsigned state = state_of(*word, octant);
      if (state == kUnknown) continue;
      ++nodes_;
      const WideKey child = child_key(key, depth, kOctomapDepth, octant);
      const float belief = (state == kOccupied ? clamp_.highest : clamp_.lowest).value();
      const auto done = state == kInner ? read_inner(child, depth + 1) : builder_.add(child, depth + 1, belief, at);
      if (!done) return done;
    }
    return {};
  }

  const FileBytes& file_;
  std::size_t tree_at_;
  ByteReader reader_;
  LeafBuilder builder_;
  Clamp clamp_;
  std::uint64_t nodes_ = 0;
};

/// Makes the words of a tree as they would be if each leaf were as sure as it can be and equal ones were joined.
class TreeWords {
 public:
  explicit TreeWords(const OccupancyMap& map) : thresholds_(map.options().thresholds) {
    const auto root = map.root();
    if (!root) return;
    const unsigned state = add(*root);
    // The format cannot say what a root without children is: liboctomap reads it as occupied.
    if (state == kFree || state == kOccupied) words_.push_back(state == kFree ? kAllFree : kAllOccupied);
  }

  const std::vector<std::uint16_t>& words() const { return words_; }

  std::uint64_t nodes() const {
    std::uint64_t nodes = words_.empty() ? 0 : 1;
    for (const std::uint16_t word : words_) {
      for (int octant = 0; octant < 8; ++octant) nodes += state_of(word, octant) != kUnknown ? 1 : 0;
    }
    return nodes;
  }

 private:
  /// The state of a node, after its words and those below it, if there are any.
  unsigned add(const NodeView& node) {
    if (node.is_leaf()) {
      switch (classified(node.belief(), thresholds_)) {
        case Occupancy::kOccupied:
          return kOccupied;
        case Occupancy::kFree:
          return kFree;
        case Occupancy::kUnknown:
          break;
      }
      return kUnknown;
    }
    const std::size_t at = words_.size();
    words_.push_back(0);
    unsigned word = 0;
    for (int octant = 0; octant < 8; ++octant) {
      if (const auto child = node.child(octant)) word |= add(*child) << (2 * octant);
    }
    if (word == 0 || word == kAllFree || word == kAllOccupied) {
      assert(words_.size() == at + 1);
      words_.pop_back();
      return word & 3U;
    }
    words_[at] = static_cast<std::uint16_t>(word);
    return kInner;
  }

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
  const auto done = TreeReader(file, header.tree_at, *map, memory_limit_bytes).read(header.nodes);
  if (!done) return tl::unexpected(done.error());
  return map;
}

Result<void> write_bt(const OccupancyMap& map, std::ostream& out) {
  if (const auto fits = check_octomap_depth(map, ".bt"); !fits) return fits;
  const TreeWords tree(map);
  ByteWriter writer(out);
  writer.put(octomap_header(kBtFirstLine, tree.nodes(), map.lattice().resolution_m()));
  for (const std::uint16_t word : tree.words()) writer.put(word);
  return writer.finish();
}

}  // namespace pingvox
