#include "io/maps/pvx.hpp"

#include <fmt/core.h>
#include <zlib.h>

#include <limits>
#include <string>
#include <utility>

#include "io/bytes/byte_reader.hpp"
#include "io/bytes/byte_writer.hpp"
#include "io/bytes/text.hpp"
#include "io/maps/map_files.hpp"

// docs/formats.md: a header of 64 bytes, made_by, the tree, CRC-32.
namespace pingvox {
namespace {

constexpr std::string_view kMagic = "PINGVOXM";
constexpr std::uint32_t kVersion = 1;
/// Behind the text that says how the map was made.
constexpr std::string_view kEastNorth = "\nx east, y north\n";
constexpr std::size_t kHeaderBytes = 64;
constexpr std::size_t kCrcBytes = 4;
constexpr std::size_t kInnerBytes = 2, kLeafBytes = 4;
// As in .bt, where 2 is a leaf too.
constexpr unsigned kNothing = 0, kLeaf = 1, kInner = 3;

struct Header {
  MapOptions options;
  std::size_t made_by_bytes = 0;
  std::uint64_t inner = 0, leaves = 0;
  unsigned root = kNothing;
};

/// Fields after the version. REQUIRES kHeaderBytes bytes.
Result<Header> read_header(const FileBytes& file, std::size_t memory_limit_bytes) {
  ByteReader reader(file.view().first(kHeaderBytes));
  reader.take(kMagic.size() + sizeof kVersion);
  Header header;
  header.made_by_bytes = *reader.read<std::uint32_t>();
  header.options.depth = *reader.read<std::uint8_t>();
  const unsigned parents = *reader.read<std::uint8_t>();
  header.root = *reader.read<std::uint8_t>();
  const unsigned reserved = *reader.read<std::uint8_t>() | *reader.read<std::uint32_t>();
  header.options.resolution_m = reader.read<double>();
  // validate() rejects NaN.
  header.options.clamp.lowest = LogOdds(*reader.read<float>());
  header.options.clamp.highest = LogOdds(*reader.read<float>());
  header.options.thresholds.lower = LogOdds(*reader.read<float>());
  header.options.thresholds.upper = LogOdds(*reader.read<float>());
  header.inner = *reader.read<std::uint64_t>();
  header.leaves = *reader.read<std::uint64_t>();
  header.options.memory_limit_bytes = memory_limit_bytes;
  if (parents > 1) return damage_error(file, 17, fmt::format("unknown parent rule {}", parents));
  header.options.parents = parents == 0 ? Parents::kMax : Parents::kMean;
  if (header.root != kNothing && header.root != kLeaf && header.root != kInner) {
    return damage_error(file, 18, fmt::format("unknown node type {} of the root", header.root));
  }
  if (reserved != 0) return damage_error(file, 19, "the reserved bytes are not 0");
  if (const auto valid = header.options.validate(); !valid) {
    return damage_error(file, 16, "the header does not make sense: " + valid.error().message);
  }
  return header;
}

class PvxTreeReader {
 public:
  PvxTreeReader(const FileBytes& file, const Header& header, std::size_t tree_at, OccupancyMap& map)
      : file_(file),
        levels_(header.options.depth),
        tree_at_(tree_at),
        reader_(file.view().subspan(tree_at, file.bytes.size() - kCrcBytes - tree_at)),
        builder_(map, file, header.options.memory_limit_bytes) {}

  Result<void> read(const Header& header) {
    if (const auto done = read_node(header.root, WideKey{}, 0); !done) return done;
    if (inner_ != header.inner || leaves_ != header.leaves) {
      return damage_error(file_, position(),
                          fmt::format("the tree has {} inner nodes and {} leaves, and the header says {} and {}",
                                      inner_, leaves_, header.inner, header.leaves));
    }
    return {};
  }

 private:
  std::size_t position() const { return tree_at_ + reader_.position(); }

  Result<void> read_node(unsigned state, const WideKey& key, int depth) {
    const std::size_t at = position();
    if (state == kNothing) return {};
    if (state == kLeaf) {
      const auto belief = reader_.read<float>();
      if (!belief) return damage_error(file_, at, "the tree needs more bytes than the header says");
      ++leaves_;
      return builder_.add(key, depth, *belief, at);
    }
    if (state != kInner) return damage_error(file_, at, "unknown node type");
    if (depth == levels_) return damage_error(file_, at, "an inner node below the last level");
    const auto word = reader_.read<std::uint16_t>();
    if (!word) return damage_error(file_, at, "the tree needs more bytes than the header says");
    if (*word == 0) return damage_error(file_, at, "an inner node without children");
    ++inner_;
    for (int octant = 0; octant < 8; ++octant) {
      const unsigned child = (*word >> (2 * octant)) & 3U;
      const auto done = read_node(child, child_key(key, depth, levels_, octant), depth + 1);
      if (!done) return done;
    }
    return {};
  }

  const FileBytes& file_;
  int levels_;
  std::size_t tree_at_;
  ByteReader reader_;
  LeafBuilder builder_;
  std::uint64_t inner_ = 0, leaves_ = 0;
};

unsigned state_of(const std::optional<NodeView>& node) {
  if (!node) return kNothing;
  return node->is_leaf() ? kLeaf : kInner;
}

void write_pvx_node(const NodeView& node, ByteWriter& writer) {
  if (node.is_leaf()) {
    writer.put(node.belief().value());
    return;
  }
  unsigned word = 0;
  for (int octant = 0; octant < 8; ++octant) word |= state_of(node.child(octant)) << (2 * octant);
  writer.put(static_cast<std::uint16_t>(word));
  for (int octant = 0; octant < 8; ++octant) {
    if (const auto child = node.child(octant)) write_pvx_node(*child, writer);
  }
}

}  // namespace

Result<MapFile> read_pvx(const FileBytes& file, std::size_t memory_limit_bytes) {
  const auto bytes = file.view();
  if (!text_of(bytes).starts_with(kMagic)) return damage_error(file, 0, "the file does not begin with PINGVOXM");
  ByteReader reader(bytes.subspan(kMagic.size()));
  const auto version = reader.read<std::uint32_t>();
  if (version && *version != kVersion) {
    return fail(Error::Code::kUnsupported,
                fmt::format("{}: a map of version {}; this program reads version {}", file.name, *version, kVersion));
  }
  if (bytes.size() < kHeaderBytes + kCrcBytes)
    return damage_error(file, bytes.size(), "the file ends inside of the header");
  const std::size_t crc_at = bytes.size() - kCrcBytes;
  const auto crc = value_from<std::uint32_t>(bytes.subspan(crc_at), std::endian::little);
  if (crc32_z(crc32_z(0, nullptr, 0), bytes.data(), crc_at) != crc) {
    return damage_error(file, crc_at, "the checksum does not fit: the file was cut off or changed");
  }
  const auto header = read_header(file, memory_limit_bytes);
  if (!header) return tl::unexpected(header.error());
  // Each count is checked against the remaining bytes before use.
  const std::uint64_t left = crc_at - kHeaderBytes;
  const bool fits = header->made_by_bytes <= left && header->inner <= left / kInnerBytes &&
                    header->leaves <= left / kLeafBytes &&
                    header->made_by_bytes + header->inner * kInnerBytes + header->leaves * kLeafBytes == left;
  if (!fits) return damage_error(file, kHeaderBytes, "the header's lengths are not those of the file");

  auto map = OccupancyMap::make(header->options);
  if (!map) return tl::unexpected(map.error());
  const std::size_t tree_at = kHeaderBytes + header->made_by_bytes;
  const auto done = PvxTreeReader(file, *header, tree_at, *map).read(*header);
  if (!done) return tl::unexpected(done.error());
  std::string_view made_by = text_of(bytes.subspan(kHeaderBytes, header->made_by_bytes));
  MapAxes axes = MapAxes::kUnknown;
  if (made_by.ends_with(kEastNorth)) {
    made_by.remove_suffix(kEastNorth.size());
    axes = MapAxes::kEastNorth;
  }
  return MapFile{Format::kPvx, *std::move(map), std::string(made_by), axes};
}

Result<void> write_pvx(const OccupancyMap& map, std::string_view text, MapAxes axes, std::ostream& out) {
  const std::string made_by = std::string(text) + std::string(axes == MapAxes::kEastNorth ? kEastNorth : "");
  if (made_by.size() > std::numeric_limits<std::uint32_t>::max()) {
    return fail(Error::Code::kUnsupported, "made_by is longer than 4 GiB");
  }
  const MapOptions& options = map.options();
  const MapCounts counts = map.counts();
  const auto root = map.root();
  ByteWriter writer(out);
  writer.put(kMagic);
  writer.put(kVersion);
  writer.put(static_cast<std::uint32_t>(made_by.size()));
  writer.put(static_cast<std::uint8_t>(options.depth));
  writer.put(static_cast<std::uint8_t>(options.parents == Parents::kMax ? 0 : 1));
  writer.put(static_cast<std::uint8_t>(state_of(root)));
  writer.put(std::uint8_t{0});
  writer.put(std::uint32_t{0});
  writer.put(map.lattice().resolution_m());
  writer.put(options.clamp.lowest.value());
  writer.put(options.clamp.highest.value());
  writer.put(options.thresholds.lower.value());
  writer.put(options.thresholds.upper.value());
  writer.put(counts.inner);
  writer.put(counts.leaves);
  writer.put(made_by);
  if (root) write_pvx_node(*root, writer);
  writer.put(writer.crc32());
  return writer.finish();
}

}  // namespace pingvox
