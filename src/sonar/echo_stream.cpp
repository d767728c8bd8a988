#include "pingvox/sonar/echo_stream.hpp"

#include <algorithm>
#include <cassert>
#include <span>
#include <utility>

namespace pingvox {
namespace {

std::vector<std::optional<Echo>> echoes_of(const Sweep& sweep, const FilterOptions& filter, const EchoOptions& echo) {
  return detect_echoes(filtered(PolarImage(sweep), filter), sweep, echo);
}

std::optional<std::size_t> delay_of(const FilterOptions& filter, const EchoOptions& echo) {
  const std::optional<std::size_t> reach = reach_beams(echo);
  if (!reach) return std::nullopt;
  return reach_beams(filter) + *reach;
}

}  // namespace

EchoStream::EchoStream(const FilterOptions& filter, const EchoOptions& echo)
    : filter_(filter), echo_(echo), delay_(delay_of(filter, echo)) {
  assert(filter.validate());
  assert(echo.validate());
}

std::vector<EchoStream::Heard> EchoStream::add(Beam beam) {
  std::vector<Heard> heard;
  if (const std::optional<Sweep> finished = assembler_.add(std::move(beam))) heard = rest_of(*finished);
  const std::span<const Beam> gathered = assembler_.gathered();
  if (!delay_ || gathered.size() <= 2 * *delay_) return heard;
  // Nothing beyond these beams decides about the one in their middle, so they may as well be all there are.
  const std::span<const Beam> around = gathered.last(2 * *delay_ + 1);
  const Sweep window{.extent = Sweep::Extent::kCut, .beams = {around.begin(), around.end()}};
  heard.push_back({around[*delay_], echoes_of(window, filter_, echo_)[*delay_]});
  ++settled_;
  return heard;
}

std::vector<EchoStream::Heard> EchoStream::finish() {
  const std::optional<Sweep> last = assembler_.finish();
  return last ? rest_of(*last) : std::vector<Heard>{};
}

std::vector<EchoStream::Heard> EchoStream::rest_of(const Sweep& sweep) {
  const std::vector<std::optional<Echo>> echoes = echoes_of(sweep, filter_, echo_);
  std::vector<Heard> rest;
  for (std::size_t n = 0; n < sweep.beams.size(); ++n) {
    const bool settled = settled_ > 0 && n >= *delay_ && n < *delay_ + settled_;
    if (!settled) rest.push_back({sweep.beams[n], echoes[n]});
  }
  settled_ = 0;
  return rest;
}

}  // namespace pingvox
