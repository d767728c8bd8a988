#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>

#include "pingvox/sonar/beam.hpp"
#include "sonar/internal/beam_source_decorator.hpp"

namespace pingvox {

/// A log whose first beams can be looked at before they are taken.
class BeamsAhead final : public BeamSourceDecorator {
 public:
  /// Reads up to `count` beams. What then fails is an error of `next`, after the beams before it.
  BeamsAhead(std::unique_ptr<BeamSource> source, std::size_t count);

  Result<std::optional<Beam>> next() override;

  std::size_t count() const { return ahead_.size(); }
  /// Whether the log has no more beams than those.
  bool has_ended() const { return end_.has_value(); }
  /// The median of their ranges [m]; nullopt: there are none.
  std::optional<double> usual_range_m() const;

 private:
  std::deque<Beam> ahead_;
  std::optional<Result<std::optional<Beam>>> end_;  ///< what was read behind them, if it was no beam
};

}  // namespace pingvox
