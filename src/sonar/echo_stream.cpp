#include "pingvox/sonar/echo_stream.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

namespace pingvox {
namespace {

struct Found {
  std::vector<std::optional<Echo>> echoes, beyond;
};

/// The echo of each beam, or the one beyond max_range_m.
Found echoes_of(const Sweep& sweep, const FilterOptions& filter, const EchoOptions& options) {
  const PolarImage image = apply_filter(PolarImage(sweep), filter);
  Found found{detect_echoes(image, sweep, options), std::vector<std::optional<Echo>>(sweep.beams.size())};
  if (!std::isfinite(options.max_range_m)) return found;
  EchoOptions anywhere = options;
  anywhere.max_range_m = std::numeric_limits<double>::infinity();
  std::vector<std::optional<Echo>> all = detect_echoes(image, sweep, anywhere);
  for (std::size_t n = 0; n < all.size(); ++n) {
    if (!found.echoes[n] && all[n] && all[n]->range_m > options.max_range_m) found.beyond[n] = all[n];
  }
  return found;
}

std::optional<std::size_t> delay_of(const FilterOptions& filter, const EchoOptions& echo) {
  const std::optional<std::size_t> reach = reach_beams(echo);
  if (!reach) return std::nullopt;
  return reach_beams(filter) + *reach;
}

}  // namespace

EchoStream::EchoStream(const FilterOptions& filter, const EchoOptions& echo, Wait wait)
    : filter_(filter), echo_(echo), delay_(wait == Wait::kForSweep ? std::nullopt : delay_of(filter, echo)) {
  assert(filter.validate());
  assert(echo.validate());
}

std::vector<EchoStream::BeamWithEcho> EchoStream::add(Beam beam) {
  std::vector<BeamWithEcho> heard;
  if (std::optional<Sweep> finished = assembler_.add(std::move(beam))) heard = rest_of(std::move(*finished));
  const std::span<const Beam> pending = assembler_.pending();
  if (!delay_ || pending.size() <= 2 * *delay_) return heard;
  // The beam in the middle of this window depends on no beam outside of it.
  const std::span<const Beam> around = pending.last(2 * *delay_ + 1);
  const Sweep window{.extent = Sweep::Extent::kCut, .beams = {around.begin(), around.end()}};
  const Found found = echoes_of(window, filter_, echo_);
  const std::uint64_t number = first_ + pending.size() - 1 - *delay_;
  heard.push_back({number, around[*delay_], found.echoes[*delay_], found.beyond[*delay_]});
  ++returned_;
  return heard;
}

std::vector<EchoStream::BeamWithEcho> EchoStream::finish() {
  std::optional<Sweep> last = assembler_.finish();
  return last ? rest_of(std::move(*last)) : std::vector<BeamWithEcho>{};
}

std::vector<EchoStream::BeamWithEcho> EchoStream::rest_of(Sweep sweep) {
  const Found found = echoes_of(sweep, filter_, echo_);
  std::vector<BeamWithEcho> rest;
  for (std::size_t n = 0; n < sweep.beams.size(); ++n) {
    const bool was_returned = returned_ > 0 && n >= *delay_ && n < *delay_ + returned_;
    if (!was_returned) rest.push_back({first_ + n, std::move(sweep.beams[n]), found.echoes[n], found.beyond[n]});
  }
  first_ += sweep.beams.size();
  complete_sweeps_ += sweep.extent == Sweep::Extent::kCut ? 0 : 1;
  returned_ = 0;
  return rest;
}

}  // namespace pingvox
