#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "pingvox/mapping/beam_model.hpp"

namespace pingvox {

namespace detail {
class ElevationTables;
}

/// Traces beam after beam of one head, for one thread: what `trace_beam` does, in less time, because the angles that a
/// beam's rays have up and down are kept from one beam to the next (up to some hundred kilobytes).
class BeamTracer {
 public:
  /// REQUIRES what `BeamModelOptions::validate` checks.
  BeamTracer(const Lattice& lattice, const BeamModelOptions& options);
  BeamTracer(BeamTracer&&) noexcept;
  BeamTracer& operator=(BeamTracer&&) noexcept;
  ~BeamTracer();

  /// @see trace_beam
  std::size_t trace(const Pose& map_from_sensor, const Beam& beam, const std::optional<Echo>& echo, ScanUpdate& scan);

 private:
  Lattice lattice_;
  BeamModelOptions options_;
  std::unique_ptr<detail::ElevationTables> elevations_;
};

}  // namespace pingvox
