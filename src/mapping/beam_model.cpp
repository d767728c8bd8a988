#include "pingvox/mapping/beam_model.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/option_errors.hpp"
#include "mapping/bundle_grid.hpp"
#include "mapping/internal/beam_tracer.hpp"
#include "mapping/internal/option_limits.hpp"
#include "pingvox/geometry/degree.hpp"

namespace pingvox {
Result<void> BeamModelOptions::validate() const {
  OptionErrors errors;
  const auto require_angle = [&errors](const char* name, double angle_rad, const Limits& limits_rad) {
    if (limits_rad.contain(angle_rad)) return;
    errors.add(
        fmt::format("{} must be {} degrees, is {:.6g}", name, limits_rad.text(kDegree_rad), angle_rad / kDegree_rad));
  };
  require_angle("beam width", width_rad, kBeamWidths_rad);
  require_angle("beam height", height_rad, kBeamHeights_rad);
  errors.require("free share", free_share, kFreeShares);
  if (!(hit > LogOdds(0.0F)) || !std::isfinite(hit.value())) {
    errors.add(fmt::format("hit must be a probability {}, is {:.6g}", kHits.text(), hit.probability()));
  }
  return errors.result("beam model");
}

BeamModelOptions beam_of_head(const DeviceProfile* head, BeamModelOptions options) {
  if (head == nullptr) return options;
  options.width_rad = head->beam_width_rad;
  options.height_rad = head->beam_height_rad;
  return options;
}

LogOdds evidence_of_intensity(std::uint8_t intensity, LogOdds hit) {
  return LogOdds(hit.value() * 0.5F * (1.0F + static_cast<float>(intensity) / 255.0F));
}

double cells_in_beam(const BeamModelOptions& options, double range_m, double resolution_m) {
  const double range = range_m / resolution_m;
  const double width = std::max(1.0, detail::width_of(options) * range),
               height = std::max(1.0, detail::height_of(options) * range);
  return range * width * height / 3.0;
}

std::size_t trace_beam(const Pose& map_from_sensor, const Beam& beam, const std::optional<Echo>& echo,
                       const BeamModelOptions& options, ScanUpdate& scan) {
  return BeamTracer(options).trace(map_from_sensor, beam, echo, scan);
}

}  // namespace pingvox
