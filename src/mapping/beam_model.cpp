#include "pingvox/mapping/beam_model.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/option_errors.hpp"
#include "mapping/bundle_grid.hpp"
#include "mapping/internal/beam_tracer.hpp"
#include "pingvox/geometry/degree.hpp"

namespace pingvox {
Result<void> BeamModelOptions::validate() const {
  OptionErrors errors;
  if (!(width_rad > 0.0 && width_rad <= std::numbers::pi)) {
    errors.add(fmt::format("beam width must be in (0, 180] degrees, is {:.6g}", width_rad / kDegree_rad));
  }
  if (!(height_rad > 0.0 && height_rad < std::numbers::pi)) {
    errors.add(fmt::format("beam height must be in (0, 180) degrees, is {:.6g}", height_rad / kDegree_rad));
  }
  if (!(free_share > 0.0 && free_share <= 1.0))
    errors.add(fmt::format("free share must be in (0, 1], is {}", free_share));
  if (!(hit > LogOdds(0.0F)) || !std::isfinite(hit.value())) {
    errors.add(fmt::format("hit must be a probability in (0.5, 1), is {:.6g}", hit.probability()));
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
