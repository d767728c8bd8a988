#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "commands.hpp"
#include "option_table.hpp"
#include "pingvox/live/live_options.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/mapping/build_options.hpp"
#include "pingvox/recording/recording.hpp"
#include "pingvox/slam/slam_smoother.hpp"

/// Options as keyword arguments: rows of the program's option tables, parsed by the program's parser. A keyword is the
/// name of an option without dashes in front and with underscores within: nav_offset is --nav-offset.
namespace pingvox::python {

namespace py = pybind11;

/// Of open(): what belongs to a dive.
struct OpenOptions {
  app::RecordingArgs recording;
  double sound_speed_ratio = 1.0;
  std::vector<app::LimitedOption> limited;
};
OpenOptions open_options(const std::vector<std::string>& logs, const py::kwargs& keywords);

/// Of Recording.map(): what belongs to a map.
struct MapKeywords {
  MapOptions map;
  BuildOptions build;
  std::optional<int> cut_depth;
  std::vector<app::LimitedOption> limited;
};
MapKeywords map_options(const py::kwargs& keywords);
/// Of SlamResult.map(), whose echoes are those of the trajectory.
MapKeywords slam_map_options(const py::kwargs& keywords);

/// Of Recording.slam().
struct SlamKeywords {
  SlamOptions slam;
  Estimation estimation = Estimation::kBatch;
};
SlamKeywords slam_options(const py::kwargs& keywords);

/// Of Recording.locate().
RecordingLocateOptions locate_options(const py::kwargs& keywords);

/// Of Recording.evaluate().
EvaluateOptions evaluate_options(const py::kwargs& keywords);

/// Of OccupancyMap().
MapOptions new_map_options(const py::kwargs& keywords);

/// Of OccupancyMap.open(): the thresholds.
app::OccupancyArgs open_map_options(const py::kwargs& keywords);

/// Of OccupancyMap.insert_points().
BuildOptions insert_options(const py::kwargs& keywords);

/// Of BeamMapper().
BuildOptions mapper_options(const py::kwargs& keywords);

/// Of LiveMapping().
/// @param head  "ping360:udp://192.168.2.2:9092"
LiveOptions live_options(const std::string& head, const py::kwargs& keywords);
/// Of LiveMapping.drive().
/// @return `head`, driven as the keywords say, else as by default
LiveHead head_options(const LiveHead& head, const py::kwargs& keywords);

/// Of the functions that filter and detect.
struct EchoKeywords {
  FilterOptions filter;
  EchoOptions echo;
};
EchoKeywords echo_options(const py::kwargs& keywords);
FilterOptions filter_options(const py::kwargs& keywords);

/// An option as keyword argument.
struct Keyword {
  std::string name, value, help, standard;
};
/// Those of a function, by its name as in "Recording.map".
std::vector<Keyword> keywords_of(std::string_view function);

/// `text` and the keyword arguments of a function, as its docstring.
std::string docstring(std::string_view text, std::string_view function);

}  // namespace pingvox::python
