#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "command_files.hpp"
#include "commands.hpp"
#include "echo_options.hpp"
#include "option_table.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/mapping/build_options.hpp"
#include "pingvox/mapping/head_options.hpp"
#include "pingvox/nav/main_source.hpp"
#include "pingvox/result.hpp"

/// Options for building maps, shared by commands.
namespace pingvox::app {

/// Mapping options of the command line.
struct BuildArgs {
  MapOptions map;
  BuildOptions build;  ///< filter and echo: see `echoes`
  HeadOptions head;
  EchoArgs echoes;
  std::string poses;
  std::vector<std::string> navs;
  std::optional<double> nav_offset_s;
  std::vector<NamedSource> nav_sources;
  std::string calibration;
  bool has_mount = false;  ///< it was given

  BuildOptions build_options() const {
    BuildOptions all = build;
    all.model = head.apply_to(build.model, nullptr);
    all.filter = echoes.filter_options();
    all.echo = echoes.echo;
    all.sound_speed_ratio = echoes.sound_speed_ratio();
    all.timing = all.vote == Vote::kPerBeam ? Timing::kByBeam : Timing::kBySweep;
    return all;
  }
  /// What follows from them, once all options are parsed.
  /// @param map  its thresholds are set by the caller
  /// @return kBadOption when one is invalid, or when two exclude each other
  Result<void> apply_to(RecordingArgs& recording, MapOptions& map, BuildOptions& build) const;
  /// The same with the thresholds of `occupancy`, whose depth is checked.
  Result<void> apply_to(RecordingArgs& recording, const OccupancyArgs& occupancy, MapOptions& map,
                        BuildOptions& build) const;
  void name_files(CommandFiles& files) const;
};

/// Validates options, except the minimum range, which scans of points do not have: see `check_ranges`.
Result<void> check_options(BuildOptions options);

/// --origin: of the rays of a cloud.
Option origin_option(std::optional<Eigen::Vector3d>& target_m);
/// --folds, of 'evaluate'.
Option folds_option(std::size_t& folds);
/// Groups of options that write into their arguments, which must outlive them.
std::vector<Option> occupancy_options(OccupancyArgs& args);
OptionTable::Group map_group(BuildArgs& args);
/// --threads: for tracing.
Option threads_option(std::size_t& target);
/// --parents and --threads: of maps that are made at once.
std::vector<Option> tree_options(BuildArgs& args);
OptionTable::Group sensor_group(BuildArgs& args);

}  // namespace pingvox::app
