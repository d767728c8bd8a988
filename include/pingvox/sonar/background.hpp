#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

struct BackgroundOptions {
  /// Range of the vehicle's outermost part [m], in (0, kMaxRange_m]: bins beyond it are no background. Whatever is
  /// nearer in most beams of a direction counts as the vehicle, even a wall in front of a still sonar.
  double range_m = 1.5;
  static constexpr double kMaxRange_m = 10.0;

  Result<void> validate() const;  ///< kBadOption
};

/// Echoes of the sonar's own vehicle, by direction and range: the median intensity of all beams of a log, in directions
/// of one degree and cells of kCell_m, above that of nine of ten directions at that range (the ringing of the
/// transducer, reverberation) and above that of the direction at the end of the range. Cells with fewer than
/// kMinBeams beams have none.
class Background {
 public:
  /// Learns from the rest of a log.
  /// @return kBadOption when the options do not validate, else the error of the source
  static Result<Background> learn(BeamSource& source, const BackgroundOptions& options);

  /// Whether no direction has kMinBeams beams: nothing is subtracted.
  bool empty() const;

  /// Lowers the beam's intensities by the background, down to 0. Bins are taken by their middle.
  void subtract_from(Beam& beam) const;

  /// The background as a sweep: a beam in the middle of each direction that has one, with bins of kCell_m as far as
  /// kMinBeams beams reached.
  std::vector<Beam> beams() const;

  static constexpr double kCell_m = 0.02;
  static constexpr std::size_t kMinBeams = 5;

 private:
  static constexpr std::size_t kDirections = 360;
  Background(std::size_t cells, std::vector<std::optional<std::uint8_t>> intensities)
      : cells_(cells), intensities_(std::move(intensities)) {}

  std::size_t cells_;  ///< of each direction
  /// kDirections * cells_. nullopt: fewer than kMinBeams beams had the middle of a bin there.
  std::vector<std::optional<std::uint8_t>> intensities_;
};

/// A source without the background of its beams.
std::unique_ptr<BeamSource> subtract_background(std::unique_ptr<BeamSource> source, Background background);

}  // namespace pingvox
