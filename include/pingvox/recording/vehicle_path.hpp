#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/io/bag.hpp"
#include "pingvox/io/input_file.hpp"
#include "pingvox/map/map_axes.hpp"
#include "pingvox/nav/main_source.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/recording/calibration_file.hpp"
#include "pingvox/recording/navigation.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// The trajectory of the vehicle, and its sources.
struct VehiclePath {
  Trajectory trajectory;  ///< map_from_body
  /// The navigation that it was made from.
  struct Nav {
    std::string attitude, position;  ///< names of the sources; an empty attitude: poses have no rotation
    std::string velocity = {};       ///< dead reckoning: its source; there is no position then
    std::optional<Eigen::Vector3d> origin_fix = std::nullopt;  ///< NavTrajectory::origin_fix
    std::vector<OtherSource> others = {};                      ///< sources that were not used
    std::string depth = {};                                    ///< NavTrajectory::depth
    std::string frame_note = {};  ///< how the frame of the position was read; empty: as it is
    /// The source of the heading by which dead reckoning of a device was rotated to north; empty: it was not.
    std::string north_by = {};
  };
  std::optional<Nav> nav = std::nullopt;                    ///< nullopt: it is not from navigation
  MapAxes axes = MapAxes::kUnknown;                         ///< of the frame of the trajectory
  Eigen::Vector3d sonar_moved_m = Eigen::Vector3d::Zero();  ///< added to the place of the sonar: by a calibration
  /// Steps of the poses of a file that no vehicle makes, where they are cut. Those of navigation are in its sources.
  std::vector<SourceStep> steps = {};
  /// A doubt about the poses of a file; empty: none. Those about navigation are in its sources.
  std::string doubt = {};
};

/// A vehicle that stays at the origin.
VehiclePath still_path();

/// The trajectory in a file of TUM lines, as it is.
/// @return kUnsupported naming what the file is, where it is another one
Result<Trajectory> read_trajectory(const InputFile& file);
/// The same, cut at the steps that no vehicle makes.
Result<VehiclePath> read_path(const InputFile& file);

/// Whether navigation has positions; attitudes, headings or turn rates; and what a path needs: positions and attitudes,
/// or what dead reckoning needs.
bool has_position(const NavLog& nav);
bool has_turns(const NavLog& nav);
bool has_path(const NavLog& nav);

/// The path by navigation. Without a position, but with a velocity, it is dead reckoning. Dead reckoning of a device
/// begins with the vehicle looking along y; where another source has the heading, it is rotated to north by that;
/// it is put at the depth where that is known.
/// @param names        of the files, for messages
/// @param offset_s     added to the times of the navigation
/// @param calibration  of its sensors; kBadOption where there are positions, on which it has no effect
/// @return kUnsupported when the navigation gives no path, kCorrupt when its sources have faults
Result<VehiclePath> path_of(const NavFiles& nav, const std::string& names, double offset_s,
                            const std::optional<CalibrationFile>& calibration = std::nullopt);

/// The poses of one navigation log on its own clock; positions without an attitude give poses without rotation.
/// @param name    of the file, for messages
/// @param chosen  sources to use instead of others
Result<VehiclePath> positions_of(const BagContents& contents, const std::string& name,
                                 std::span<const NamedSource> chosen);

}  // namespace pingvox
