#pragma once

#include <optional>

#include "pingvox/mapping/beam_model.hpp"
#include "pingvox/sonar/device_profile.hpp"

namespace pingvox {

/// Given properties of the sonar head. The rest follows from the device that a log names.
struct HeadOptions {
  const DeviceProfile* device = nullptr;  ///< nullptr: that of the log
  std::optional<double> beam_width_rad = std::nullopt, beam_height_rad = std::nullopt;

  /// Width and height of the beam: as given, else of the device, else those of `model`.
  BeamModelOptions apply_to(const BeamModelOptions& model, const DeviceProfile* of_log) const {
    BeamModelOptions beam = beam_of_head(device != nullptr ? device : of_log, model);
    beam.width_rad = beam_width_rad.value_or(beam.width_rad);
    beam.height_rad = beam_height_rad.value_or(beam.height_rad);
    return beam;
  }
  /// Whether neither these options nor the log have the size of the beam.
  bool assumes_beam(const DeviceProfile* of_log) const {
    return device == nullptr && of_log == nullptr && !(beam_width_rad && beam_height_rad);
  }
};

}  // namespace pingvox
