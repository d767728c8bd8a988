#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "pingvox/mapping/build_options.hpp"
#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/web/scene.hpp"

namespace pingvox::web {

/// The level that the detector compares with; nullopt: it does not.
inline std::optional<double> level_of(const EchoOptions& options, const std::optional<Echo>& echo) {
  const bool is_level = options.detector == Detector::kLevel || options.detector == Detector::kMax;
  if (is_level && echo) return echo->threshold;
  return is_level && options.threshold ? std::optional<double>(*options.threshold) : std::nullopt;
}

/// Sets range and evidence of an echo in a beam.
inline void show_echo(const Echo& echo, const BeamModelOptions& model, SceneBeam& beam) {
  beam.echo_m = echo.range_m;
  const LogOdds hit = model.hit;
  beam.echo_probability =
      (model.hit_from == HitFrom::kIntensity ? evidence_of_intensity(echo.intensity, hit) : hit).probability();
}

}  // namespace pingvox::web
