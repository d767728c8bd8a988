#pragma once

#include <optional>
#include <string>

#include "commands.hpp"
#include "option_table.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/mapping/build_map.hpp"

/// How echoes are found and maps made, as a call says it: the options of 'map' that 'render' has too.
namespace pingvox::app {

/// How echoes are found, as the call says it: what it does not say follows from the detector.
struct EchoWords {
  Filter filter = FilterOptions{}.filter;
  std::optional<int> kernel;
  std::optional<double> sigma;
  EchoOptions echo;

  FilterOptions filter_options() const {
    const FilterOptions usual = usual_filter(echo.detector);
    return {filter, kernel.value_or(usual.kernel), sigma.value_or(usual.sigma)};
  }
};

/// How a log is mapped, as the call says it.
struct BuildWords {
  MapOptions map;
  BuildOptions build;  ///< filter and echo: see `echoes`
  HeadWords head;
  EchoWords echoes;
  std::string poses;

  BuildOptions build_options() const {
    BuildOptions all = head.applied_to(build, nullptr);
    all.filter = echoes.filter_options();
    all.echo = echoes.echo;
    return all;
  }
};

/// All but whether the maximum range is beyond the minimum one, which scans of points need not have: `check_ranges`.
Result<void> check_options(BuildOptions options);

/// Groups of options that write into what they are given, which must outlive them.
OptionTable::Group echo_group(EchoWords& words, double& sound_speed_ratio);
OptionTable::Group map_group(BuildWords& words);
OptionTable::Group sensor_group(BuildWords& words);

}  // namespace pingvox::app
