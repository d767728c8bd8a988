#include "pingvox/sonar/polar_image.hpp"

#include <algorithm>
#include <utility>

namespace pingvox {
namespace {

std::vector<std::size_t> bins_of(const Sweep& sweep) {
  std::vector<std::size_t> bins;
  bins.reserve(sweep.beams.size());
  for (const Beam& beam : sweep.beams) bins.push_back(beam.intensities.size());
  return bins;
}

std::size_t longest_of(const Sweep& sweep) {
  std::size_t longest = 0;
  for (const Beam& beam : sweep.beams) longest = std::max(longest, beam.intensities.size());
  return longest;
}

}  // namespace

PolarImage::PolarImage(const Sweep& sweep)
    : PolarImage(bins_of(sweep), longest_of(sweep),
                 sweep.extent == Sweep::Extent::kTurn ? Wrap::kAround : Wrap::kNone) {
  for (std::size_t n = 0; n < rows(); ++n) std::ranges::copy(sweep.beams[n].intensities, row(n).begin());
}

PolarImage::PolarImage(std::vector<std::size_t> bins_in, std::size_t columns, Wrap wrap)
    : bins_in_(std::move(bins_in)), columns_(columns), wrap_(wrap), pixels_(bins_in_.size() * columns) {
  assert(std::ranges::all_of(bins_in_, [columns](std::size_t bins) { return bins <= columns; }));
}

}  // namespace pingvox
