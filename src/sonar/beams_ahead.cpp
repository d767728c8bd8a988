#include "sonar/internal/beams_ahead.hpp"

#include <utility>
#include <vector>

#include "base/median.hpp"

namespace pingvox {

BeamsAhead::BeamsAhead(std::unique_ptr<BeamSource> source, std::size_t count) : BeamSourceDecorator(std::move(source)) {
  while (ahead_.size() < count && !end_) {
    Result<std::optional<Beam>> beam = this->source().next();
    if (beam && *beam) {
      ahead_.push_back(std::move(**beam));
    } else {
      end_ = std::move(beam);
    }
  }
}

Result<std::optional<Beam>> BeamsAhead::next() {
  if (!ahead_.empty()) {
    Beam beam = std::move(ahead_.front());
    ahead_.pop_front();
    return beam;
  }
  if (end_) return *std::exchange(end_, std::nullopt);
  return source().next();
}

std::optional<double> BeamsAhead::usual_range_m() const {
  if (ahead_.empty()) return std::nullopt;
  std::vector<double> ranges_m;
  ranges_m.reserve(ahead_.size());
  for (const Beam& beam : ahead_) ranges_m.push_back(static_cast<double>(beam.intensities.size()) * beam.bin_length_m);
  return median(std::move(ranges_m));
}

}  // namespace pingvox
