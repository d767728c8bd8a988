#include "pingvox/geometry/lattice.hpp"

#include <fmt/core.h>

#include <string>

namespace pingvox {

Result<Lattice> Lattice::make(double resolution_m, int depth) {
  // The inverse must be finite too: with a subnormal resolution it is not, and every point would be outside.
  std::string bad;
  if (!(resolution_m > 0.0) || !std::isfinite(resolution_m) || !std::isfinite(1.0 / resolution_m)) {
    bad = fmt::format("resolution must be a length > 0 m, is {}", resolution_m);
  }
  if (depth < 1 || depth > kMaxDepth) {
    bad += fmt::format("{}depth must be in 1..{} levels, is {}", bad.empty() ? "" : "; ", kMaxDepth, depth);
  }
  if (!bad.empty()) return fail(Error::Code::kBadOption, bad);
  if (!std::isfinite(std::ldexp(resolution_m, depth))) {
    return fail(Error::Code::kBadOption,
                fmt::format("{} levels of cells of {} m exceed the range of double", depth, resolution_m));
  }
  return Lattice(resolution_m, depth);
}

Lattice::Lattice(double resolution_m, int depth)
    : resolution_m_(resolution_m), cells_per_m_(1.0 / resolution_m), half_(std::ldexp(1.0, depth - 1)), depth_(depth) {
  assert(resolution_m > 0.0 && std::isfinite(cells_per_m_));
  assert(depth >= 1 && depth <= kMaxDepth);
  assert(std::isfinite(std::ldexp(resolution_m, depth)));
}

}  // namespace pingvox
