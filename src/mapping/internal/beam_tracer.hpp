#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "cloud/internal/trace_rays.hpp"
#include "pingvox/mapping/beam_model.hpp"

namespace pingvox {

namespace detail {
class ElevationTables;
}

/// A beam whose echo is known, and where its head was when it was heard.
struct PlacedBeam {
  Pose map_from_sensor = Pose::Identity();
  double bearing_rad = 0.0, bin_length_m = 0.0;
  std::size_t bins = 0;
  std::optional<Echo> echo;
};

/// Traces the beams of one head, for one thread: what `trace_beam` does, in less time. The angles that a beam's rays
/// have up and down are kept from one beam to the next (up to some hundred kilobytes); beams that are rays are walked
/// side by side.
class BeamTracer {
 public:
  /// @param max_range_m  cells farther away are not touched: a beam that heard only what is beyond frees up to here
  /// REQUIRES what `BeamModelOptions::validate` checks, and max_range_m > 0
  explicit BeamTracer(const BeamModelOptions& options, double max_range_m = std::numeric_limits<double>::infinity());
  BeamTracer(BeamTracer&&) noexcept;
  BeamTracer& operator=(BeamTracer&&) noexcept;
  ~BeamTracer();

  /// @return for each beam, the number of rays left out: @see trace_beam
  std::vector<std::size_t> trace(std::span<const PlacedBeam> beams, ScanUpdate& scan);
  /// @see trace_beam
  std::size_t trace(const Pose& map_from_sensor, const Beam& beam, const std::optional<Echo>& echo, ScanUpdate& scan);

 private:
  std::vector<std::size_t> trace_axes(std::span<const PlacedBeam> beams, ScanUpdate& scan);

  BeamModelOptions options_;
  double max_range_m_;
  std::unique_ptr<detail::ElevationTables> elevations_;
  RayTracer rays_;
};

}  // namespace pingvox
