#include "slam/smoother/slam_data.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <functional>
#include <utility>

#include "base/without_exceptions.hpp"
#include "slam/smoother/slam_input.hpp"

namespace pingvox {

SlamData::SlamData(SlamOptions options) : options_(std::move(options)), turns_(options_.body_from_sonar) {
  assert(options_.validate());
}

void SlamData::add(Beam beam) {
  beam_times_s_.push_back(beam.time_s);
  if (options_.matching == Matching::kPairs) turns_.add(beam);
  if (const auto sweep = assembler_.add(std::move(beam))) sweeps_.push_back(sweep_echoes(*sweep, options_));
}

Result<void> SlamData::add(std::string_view source, NavQuantity quantity, const NavSample& sample) {
  return add_sample(source, quantity, sample, options_.nav_offset_s, sources_);
}

Result<void> SlamData::add(const NavLog& log) {
  return detail::without_exceptions([&]() -> Result<void> {
    if (const auto checked = check_sources(log, kReckoningQuantities); !checked) return checked;
    for (NavSource source : log.sources()) {
      if (source.subject == NavSubject::kOther) continue;
      for (NavSample& sample : source.samples) sample.time_s += options_.nav_offset_s;
      NavSource& to = source_in(sources_, source.name, source.quantity);
      if (to.samples.empty()) to.subject = source.subject;
      add_samples(source, to);
    }
    return {};
  });
}

Result<std::vector<SweepEchoes>> SlamData::sweeps() const {
  if (beam_times_s_.empty()) return fail(Error::Code::kUnsupported, "there are no beams");
  if (const auto back = std::ranges::adjacent_find(beam_times_s_, std::ranges::greater());
      back != beam_times_s_.end()) {
    return fail(Error::Code::kCorrupt, fmt::format("the times of the beams do not rise: beam {} is at {:.3f} s, the "
                                                   "next at {:.3f} s",
                                                   back - beam_times_s_.begin(), *back, *(back + 1)));
  }
  std::vector<SweepEchoes> all = sweeps_;
  SweepAssembler rest = assembler_;
  if (const auto sweep = rest.finish()) all.push_back(sweep_echoes(*sweep, options_));
  return all;
}

}  // namespace pingvox
