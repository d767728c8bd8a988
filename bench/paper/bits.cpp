#include "bits.hpp"

#include <fmt/core.h>
#include <octomap/OcTree.h>

#include <array>
#include <sstream>
#include <string>

#include "claim.hpp"
#include "pingvox/io/maps.hpp"

namespace pingvox::bench {
namespace {

/// A state of a child, and how the paper writes its two bits.
struct State {
  const char* name;
  const char* paper;
  unsigned value;  ///< that the file has: bit 2i + 1 above bit 2i of the node's u16
};
constexpr std::array kStates = {State{"unknown", "00", 0}, State{"occupied", "01", 2}, State{"empty", "10", 1},
                                State{"inner", "11", 3}};

}  // namespace

Result<std::vector<Row>> paper_bits(const BenchOptions&) {
  constexpr Key kOccupied{32768, 32768, 32768}, kFree{32769, 32768, 32768};
  OccupancyMap map({.resolution_m = 0.1});
  octomap::OcTree tree(0.1);
  {
    Editor editor = map.edit();
    for (const auto& [key, evidence] : {std::pair{kOccupied, LogOdds(1.0F)}, std::pair{kFree, LogOdds(-1.0F)}}) {
      editor.update(key, evidence);
      tree.updateNode(octomap::OcTreeKey(key.x, key.y, key.z), evidence.value());
    }
  }
  std::ostringstream own, peer;
  if (const auto written = write_map(map, Format::kBt, "", own); !written) return tl::unexpected(written.error());
  tree.writeBinaryData(peer);  // the tree without the header
  const std::string bytes = own.str();
  const std::string theirs = peer.str();
  if (theirs.size() != 32 || bytes.size() < 32) return fail(Error::Code::kCorrupt, "the .bt is not 16 levels deep");
  const bool is_same = bytes.ends_with(theirs);
  const auto word_at = [&](std::size_t at) {
    return static_cast<unsigned>(static_cast<unsigned char>(bytes[at])) |
           static_cast<unsigned>(static_cast<unsigned char>(bytes[at + 1])) << 8U;
  };
  // 16 levels, one u16 each: the root's only child is octant 7; below it always octant 0, down to the two cells.
  const unsigned root = word_at(bytes.size() - 32), last = word_at(bytes.size() - 2);
  const std::array<unsigned, 4> found = {last >> 4U & 3U, last & 3U, last >> 2U & 3U, root >> 14U};
  std::vector<Row> rows;
  for (std::size_t i = 0; i < kStates.size(); ++i) {
    const auto written = fmt::format("{:02b}", found[i]);
    const bool holds = written == kStates[i].paper;
    rows.push_back(row_of({.name = fmt::format("bt-{}", kStates[i].name),
                           .section = "7",
                           .unit = "high bit first",
                           .paper = kStates[i].paper,
                           .ours = written,
                           .octomap = fmt::format("{:02b}", kStates[i].value),
                           .holds = holds ? Holds::kYes : Holds::kNo,
                           .checked = found[i] == kStates[i].value && is_same,
                           .why = holds ? "" : "right only for one who reads each byte from its lowest bit on"}));
  }
  return rows;
}

}  // namespace pingvox::bench
