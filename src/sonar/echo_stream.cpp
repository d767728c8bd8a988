#include "sonar/internal/echo_stream.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

namespace pingvox {
namespace {

struct Found {
  std::optional<Echo> echo;
  std::optional<Echo> beyond;  ///< max_range_m, without an echo
};

EchoOptions at_any_range(EchoOptions options) {
  options.max_range_m = std::numeric_limits<double>::infinity();
  return options;
}

/// @param anywhere  the first echo of the beam at any range
Found found_of(const std::optional<Echo>& echo, const std::optional<Echo>& anywhere, double max_range_m) {
  return {echo, !echo && anywhere && anywhere->range_m > max_range_m ? anywhere : std::nullopt};
}

std::vector<Found> echoes_of(const Sweep& sweep, const FilterOptions& filter, const EchoOptions& options) {
  const PolarImage image = apply_filter(PolarImage(sweep), filter);
  const std::vector<std::optional<Echo>> echoes = detect_echoes(image, sweep, options);
  const std::vector<std::optional<Echo>> anywhere =
      std::isfinite(options.max_range_m) ? detect_echoes(image, sweep, at_any_range(options)) : echoes;
  std::vector<Found> found;
  for (std::size_t n = 0; n < echoes.size(); ++n)
    found.push_back(found_of(echoes[n], anywhere[n], options.max_range_m));
  return found;
}

/// The same of one beam.
Found echo_of(const Sweep& sweep, std::size_t beam, const FilterOptions& filter, const EchoOptions& options) {
  const PolarImage image = apply_filter(PolarImage(sweep), filter);
  const std::optional<Echo> echo = detect_echo(image, sweep, beam, options);
  const bool is_limited = !echo && std::isfinite(options.max_range_m);
  const std::optional<Echo> anywhere = is_limited ? detect_echo(image, sweep, beam, at_any_range(options)) : echo;
  return found_of(echo, anywhere, options.max_range_m);
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
  const Found found = echo_of(window, *delay_, filter_, echo_);
  const std::uint64_t number = first_ + pending.size() - 1 - *delay_;
  heard.push_back({number, around[*delay_], found.echo, found.beyond});
  ++returned_;
  return heard;
}

std::vector<EchoStream::BeamWithEcho> EchoStream::finish() {
  std::optional<Sweep> last = assembler_.finish();
  return last ? rest_of(std::move(*last)) : std::vector<BeamWithEcho>{};
}

std::vector<EchoStream::BeamWithEcho> EchoStream::rest_of(Sweep sweep) {
  const std::vector<Found> found = echoes_of(sweep, filter_, echo_);
  std::vector<BeamWithEcho> rest;
  for (std::size_t n = 0; n < sweep.beams.size(); ++n) {
    const bool was_returned = returned_ > 0 && n >= *delay_ && n < *delay_ + returned_;
    if (!was_returned) rest.push_back({first_ + n, std::move(sweep.beams[n]), found[n].echo, found[n].beyond});
  }
  first_ += sweep.beams.size();
  complete_sweeps_ += sweep.extent == Sweep::Extent::kCut ? 0 : 1;
  returned_ = 0;
  return rest;
}

}  // namespace pingvox
