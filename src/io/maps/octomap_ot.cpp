#include "io/maps/octomap_ot.hpp"

#include <fmt/core.h>

#include <cmath>

#include "io/bytes/byte_reader.hpp"
#include "io/bytes/byte_writer.hpp"
#include "io/maps/map_files.hpp"
#include "io/maps/octomap_header.hpp"

// docs/formats.md: for each node its log-odds, its colour if it has one, and a mask of its children.
namespace pingvox {
namespace {

class OtTreeReader {
 public:
  OtTreeReader(const FileBytes& file, std::size_t tree_at, std::size_t colour_bytes, OccupancyMap& map,
               std::size_t memory_limit_bytes)
      : file_(file),
        tree_at_(tree_at),
        colour_bytes_(colour_bytes),
        reader_(file.view().subspan(tree_at)),
        builder_(map, file, memory_limit_bytes) {}

  Result<void> read(std::uint64_t nodes) {
    if (nodes > 0) {
      if (const auto done = read_node(WideKey{}, 0); !done) return done;
    }
    if (nodes_ != nodes) {
      return damage_error(file_, position(),
                          fmt::format("the tree has {} nodes and the header says {}", nodes_, nodes));
    }
    if (reader_.left() > 0)
      return damage_error(file_, position(), fmt::format("{} bytes after the tree", reader_.left()));
    return {};
  }

 private:
  std::size_t position() const { return tree_at_ + reader_.position(); }

  Result<void> read_node(const WideKey& key, int depth) {
    const std::size_t at = position();
    const auto belief = reader_.read<float>();
    const auto colour = reader_.take(colour_bytes_);
    const auto children = reader_.read<std::uint8_t>();
    if (!belief || !colour || !children) return damage_error(file_, at, "the file ends inside of the tree");
    ++nodes_;
    if (*children == 0) return builder_.add(key, depth, *belief, at);
    if (!std::isfinite(*belief)) return damage_error(file_, at, fmt::format("a log-odds of {}", *belief));
    if (depth == kOctomapDepth) return damage_error(file_, at, "an inner node below the 16th level");
    for (int octant = 0; octant < 8; ++octant) {
      if (((*children >> octant) & 1) == 0) continue;
      const auto done = read_node(child_key(key, depth, kOctomapDepth, octant), depth + 1);
      if (!done) return done;
    }
    return {};
  }

  const FileBytes& file_;
  std::size_t tree_at_;
  std::size_t colour_bytes_;
  ByteReader reader_;
  LeafBuilder builder_;
  std::uint64_t nodes_ = 0;
};

void write_ot_node(const NodeView& node, ByteWriter& writer) {
  unsigned children = 0;
  for (int octant = 0; octant < 8; ++octant) {
    if (node.child(octant)) children |= 1U << octant;
  }
  writer.put(node.belief().value());
  writer.put(static_cast<std::uint8_t>(children));
  for (int octant = 0; octant < 8; ++octant) {
    if (const auto child = node.child(octant)) write_ot_node(*child, writer);
  }
}

}  // namespace

Result<OccupancyMap> read_ot(const FileBytes& file, std::size_t memory_limit_bytes) {
  const auto header = read_octomap_header(file, kOtFirstLine);
  if (!header) return tl::unexpected(header.error());
  const bool coloured = header->id == "ColorOcTree";
  // "1" is the old name of OcTree. The time stamps of an OcTreeStamped are not in its files.
  if (!coloured && header->id != "OcTree" && header->id != "OcTreeStamped" && header->id != "1") {
    return fail(Error::Code::kUnsupported,
                fmt::format("{}: holds a tree of the kind '{}'; OcTree, ColorOcTree and OcTreeStamped can be read",
                            file.name, header->id));
  }
  auto map = empty_octomap(file, header->resolution_m, memory_limit_bytes);
  if (!map) return map;
  const auto done = OtTreeReader(file, header->tree_at, coloured ? 3 : 0, *map, memory_limit_bytes).read(header->nodes);
  if (!done) return tl::unexpected(done.error());
  return map;
}

Result<void> write_ot(const OccupancyMap& map, MapAxes axes, std::ostream& out) {
  if (const auto fits = check_octomap_depth(map, ".ot"); !fits) return fits;
  ByteWriter writer(out);
  writer.put(octomap_header(kOtFirstLine, map.counts().nodes(), map.lattice().resolution_m(), axes));
  if (const auto root = map.root()) write_ot_node(*root, writer);
  return writer.finish();
}

}  // namespace pingvox
