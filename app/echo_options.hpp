#pragma once

#include <optional>
#include <string>
#include <vector>

#include "option_table.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/filters.hpp"
#include "pingvox/sonar/sound_speed.hpp"

/// Options for detecting echoes.
namespace pingvox::app {

/// Echo options of the command line. The default filter follows from the detector.
struct EchoArgs {
  Filter filter = FilterOptions{}.filter;
  std::optional<int> kernel;
  std::optional<double> sigma;
  EchoOptions echo;
  std::optional<double> background_m;     ///< nullopt: none is subtracted
  std::optional<double> sound_speed_m_s;  ///< nullopt: of `water`, else as the device assumes
  std::optional<Water> water;
  std::optional<double> nav_salinity;  ///< of water whose temperature the navigation log has

  double sound_speed_ratio() const;
  /// kBadOption when both set the speed of sound, or when a navigation log should and there is none.
  Result<void> validate(const std::vector<std::string>& navs = {}) const;

  FilterOptions filter_options() const {
    const FilterOptions usual = default_filter(echo.detector);
    return {filter, kernel.value_or(usual.kernel), sigma.value_or(usual.sigma)};
  }
};

/// Whether a command has a navigation log with properties of the water.
enum class WaterOfNav { kNo, kYes };
/// The group, which writes into its arguments: they must outlive it.
OptionTable::Group echo_group(EchoArgs& args, WaterOfNav water);

}  // namespace pingvox::app
