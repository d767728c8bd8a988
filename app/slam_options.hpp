#pragma once

#include <optional>
#include <vector>

#include "option_table.hpp"
#include "pingvox/slam/locate_recording.hpp"
#include "pingvox/slam/slam_smoother.hpp"

/// Options for estimating where the vehicle was.
namespace pingvox::app {

/// How 'slam' estimates: --matching, --causal and --seed.
std::vector<Option> slam_options(SlamOptions& slam, Estimation& estimation);
/// How 'locate' estimates: --causal and --seed.
std::vector<Option> locate_options(LocalizerOptions& localizer, Estimation& estimation);
/// --min-z and --max-z: heights of a known map.
std::vector<Option> height_options(std::optional<double>& min_z_m, std::optional<double>& max_z_m);
/// Where the vehicle begins in a known map; nullopt: anywhere.
Option start_option(std::optional<StartPose>& start);

}  // namespace pingvox::app
