#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "io/bytes/byte_reader.hpp"
#include "io/clouds/scans.hpp"
#include "io/maps/octomap_pose.hpp"
#include "io/readers.hpp"

// OctoMap's scan graph, as its ScanGraph::writeBinary leaves it on a little-endian machine (docs/formats.md): u32
// nodes, the nodes, u32 edges, the edges. A node is u32 points, the points, a translation, a rotation, u32 id. Each
// point, translation and rotation has its own u32 count (3 or 4) in front of its f64 values.
namespace pingvox {
namespace {

constexpr std::uint32_t kVectorCount = 3;
constexpr std::uint32_t kRotationCount = 4;
constexpr std::size_t kVectorBytes = 4 + 3 * 8;
constexpr std::size_t kRotationBytes = 4 + 4 * 8;
constexpr std::size_t kEdgeBytes = 2 * 4 + kVectorBytes + kRotationBytes + 8;
constexpr std::size_t kRestOfNodeBytes = kVectorBytes + kRotationBytes + 4;

/// Reads a vector of N values with its count; nullopt for another count.
template <std::size_t N>
std::optional<std::array<float, N>> read_vector(std::span<const std::uint8_t> bytes) {
  if (value_from<std::uint32_t>(bytes, std::endian::little) != N) return std::nullopt;
  std::array<float, N> values;
  for (std::size_t i = 0; i < N; ++i) {
    values[i] = static_cast<float>(value_from<double>(bytes.subspan(4 + 8 * i), std::endian::little));
  }
  return values;
}

/// Points of the next node; nullopt when the node is longer than the rest.
std::optional<std::span<const std::uint8_t>> take_points(ByteReader& reader) {
  const auto points = reader.read<std::uint32_t>();
  if (!points || reader.left() < kRestOfNodeBytes) return std::nullopt;
  const std::uint64_t bytes = std::uint64_t{*points} * kVectorBytes;
  if (bytes > reader.left() - kRestOfNodeBytes) return std::nullopt;
  return reader.take(bytes);
}

class ScanGraphSource : public ScanSource {
 public:
  ScanGraphSource(FileBytes file, Damage damage)
      : file_(std::move(file)), damage_(damage), reader_(file_.view()), nodes_(*reader_.read<std::uint32_t>()) {}

  Result<std::optional<PointScan>> next() override {
    while (node_ < nodes_) {
      const std::size_t node = node_++;
      const auto points = take_points(reader_);
      const auto translation = read_vector<kVectorCount>(*reader_.take(kVectorBytes));
      const auto rotation = read_vector<kRotationCount>(*reader_.take(kRotationBytes));
      reader_.take(4);

      const std::string place = fmt::format("scan {}", node);
      if (!translation || !rotation || !is_rotation(*rotation)) {
        const auto damaged = handle_damage(damage_, skipped_, file_.name, place, "its pose is damaged");
        if (!damaged) return tl::unexpected(damaged.error());
        continue;
      }
      ScanBuilder scan({*translation, *rotation}, node);
      if (!scan.origin_is_finite()) {
        const auto damaged = handle_damage(damage_, skipped_, file_.name, place, "its pose is not finite");
        if (!damaged) return tl::unexpected(damaged.error());
        continue;
      }
      const std::size_t count = points->size() / kVectorBytes;
      scan.reserve(count);
      for (std::size_t i = 0; i < count; ++i) {
        const auto point = read_vector<kVectorCount>(points->subspan(i * kVectorBytes, kVectorBytes));
        if (point && scan.add(*point)) continue;
        const auto damaged = handle_damage(damage_, skipped_, file_.name, fmt::format("scan {}, point {}", node, i),
                                           point ? "is not finite" : "is damaged");
        if (!damaged) return tl::unexpected(damaged.error());
      }
      return std::move(scan).finish();
    }
    return std::nullopt;
  }

  std::size_t skipped() const override { return skipped_.count; }
  std::string first_damage() const override { return skipped_.first; }
  std::optional<double> share_read() const override { return read_share(reader_.left(), file_.bytes.size()); }

 private:
  FileBytes file_;
  Damage damage_;
  ByteReader reader_;
  std::size_t nodes_;
  std::size_t node_ = 0;
  SkippedRecords skipped_;
};

}  // namespace

bool looks_like_scan_graph(std::span<const std::uint8_t> bytes) {
  ByteReader reader(bytes);
  const auto nodes = reader.read<std::uint32_t>();
  if (!nodes) return false;
  // An empty graph: no nodes, no edges.
  if (*nodes == 0) return bytes.size() == 8 && value_from<std::uint32_t>(bytes.subspan(4), std::endian::little) == 0;

  // No magic number, but a count of 3 in front of each vector. The first ones suffice, since text has no such bytes.
  // The file may be cut off.
  const auto points = reader.read<std::uint32_t>();
  if (!points) return false;
  const std::uint64_t vectors = std::min<std::uint64_t>(std::uint64_t{*points} + 1, 4);
  for (std::uint64_t i = 0; i < vectors; ++i) {
    const auto vector = reader.take(kVectorBytes);
    if (!vector) return i > 0;
    if (value_from<std::uint32_t>(*vector, std::endian::little) != kVectorCount) return false;
  }
  return true;
}

Result<std::unique_ptr<ScanSource>> open_scan_graph(FileBytes file, Damage damage) {
  const auto corrupt = [&file](std::string_view what) {
    return fail(Error::Code::kCorrupt, fmt::format("{}: {}", file.name, what));
  };
  // Checks all counts against the size of the file first.
  ByteReader reader(file.view());
  const auto nodes = reader.read<std::uint32_t>();
  if (!nodes) return corrupt("a scan graph of less than four bytes");
  for (std::uint32_t node = 0; node < *nodes; ++node) {
    const std::size_t start = reader.position();
    if (!take_points(reader)) {
      return corrupt(
          fmt::format("byte {}: scan {} of {} does not fit into the {} bytes that are left: is the file cut off?",
                      start, node, *nodes, file.bytes.size() - start));
    }
    reader.take(kRestOfNodeBytes);
  }
  const auto edges = reader.read<std::uint32_t>();
  if (!edges) return corrupt("cut off before the list of edges");
  if (std::uint64_t{*edges} * kEdgeBytes != reader.left()) {
    return corrupt(fmt::format("byte {}: {} edges need {} bytes, {} are left", reader.position(), *edges,
                               std::uint64_t{*edges} * kEdgeBytes, reader.left()));
  }
  return std::make_unique<ScanGraphSource>(std::move(file), damage);
}

}  // namespace pingvox
