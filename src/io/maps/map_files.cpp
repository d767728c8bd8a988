#include "io/maps/map_files.hpp"

#include <fmt/core.h>

#include <cmath>

namespace pingvox {

tl::unexpected<Error> damage_error(const FileBytes& file, std::size_t byte, std::string_view reason) {
  return fail(Error::Code::kCorrupt, fmt::format("{}: byte {}: {}", file.name, byte, reason));
}

tl::unexpected<Error> over_limit(const FileBytes& file, std::size_t byte, std::size_t limit) {
  return fail(Error::Code::kLimit,
              fmt::format("{}: byte {}: the map needs more than its limit of {} bytes", file.name, byte, limit));
}

Result<void> check_octomap_depth(const OccupancyMap& map, std::string_view suffix) {
  if (map.lattice().depth() == kOctomapDepth) return {};
  return fail(
      Error::Code::kUnsupported,
      fmt::format("{} holds maps of {} levels only and this one has {}: write it as .pvx, which holds any depth",
                  suffix, kOctomapDepth, map.lattice().depth()));
}

WideKey child_key(const WideKey& parent, int depth, int levels, int octant) {
  const int bit = levels - 1 - depth;
  const auto with_bit = [&](WideWord word, int axis) {
    return word | (static_cast<WideWord>((octant >> axis) & 1) << bit);
  };
  return {with_bit(parent.x, 0), with_bit(parent.y, 1), with_bit(parent.z, 2)};
}

Result<void> LeafBuilder::add(const WideKey& key, int depth, float belief, std::size_t byte) {
  if (!std::isfinite(belief)) return damage_error(file_, byte, fmt::format("a log-odds of {}", belief));
  editor_.set(key, depth, LogOdds(belief));
  if (memory_limit_bytes_ > 0 && map_.memory_bytes() > memory_limit_bytes_) {
    return over_limit(file_, byte, memory_limit_bytes_);
  }
  return {};
}

}  // namespace pingvox
