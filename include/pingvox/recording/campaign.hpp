#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pingvox/map/map_axes.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/mapping/build_options.hpp"
#include "pingvox/recording/map_origin.hpp"
#include "pingvox/recording/recording.hpp"
#include "pingvox/result.hpp"

/// Many dives: logs of sonars paired with the navigation of their time, and one map of all of them.
namespace pingvox {

/// One log of a sonar and the navigation of its time.
struct Dive {
  std::string name;               ///< unique in its campaign: the path of the log below its folder, "monday_dive3.bin"
  std::string log;                ///< path
  std::vector<std::string> navs;  ///< paths, at least one
  /// Added to the times of the navigation, where the log has local time in a zone that fits most logs; nullopt: as in
  /// RecordingOptions.
  std::optional<double> nav_offset_s = std::nullopt;
  std::uint64_t bytes = 0;  ///< of the log
};

/// A file that is in no dive, and why.
struct UnpairedFile {
  std::string path, reason;
};

/// The files of a campaign, paired.
struct Campaign {
  std::vector<Dive> dives;           ///< in the order in which the logs were named, those of a folder by their paths
  std::vector<UnpairedFile> logs;    ///< that cannot be mapped
  std::vector<UnpairedFile> navs;    ///< at whose time there is no log, or that cannot be read
  std::vector<std::string> unknown;  ///< files in folders that are of no known format
  /// Origin of the common frame of all dives with fixes: that of the first one. nullopt: none has fixes.
  std::optional<MapOrigin> origin = std::nullopt;
  MapForecast forecast = {};  ///< of all logs together: the cells of all maps
};

/// How the dives of a campaign are mapped.
struct CampaignOptions {
  RecordingOptions recording = {};  ///< of each dive, but for its navigation
  MapOptions map = {};
  BuildOptions build = {};
  /// Names the options above and the program: kept maps with another text are not reused.
  std::string made_with = {};
  std::vector<std::string> option_files = {};  ///< that options were read from: nor when one of these has changed

  Result<void> validate() const;  ///< kBadOption also for navigation or poses
};

/// Finds logs and navigation in files and folders, also in the folders in them, and pairs them by their times: a log is
/// joined to all navigation that overlaps it. Of logs and navigation with dates the zone of local time is the one that
/// fits most logs. Times without dates are taken as those of one clock. Navigation that cannot be compared, as it
/// counts from the start of a device, is joined to a log that is alone in its folder. Where two logs of navigation
/// have the same quantity at one time, that in the folder of the log is used.
/// @return kBadOption when the options do not validate; kIo when a folder cannot be read. What is wrong with a file is
///         in the campaign.
Result<Campaign> plan_campaign(const std::vector<std::string>& logs, const std::vector<std::string>& navs,
                               const CampaignOptions& options);

/// The map of one dive.
struct DiveMap {
  enum class Frame {
    kShared,  ///< that of Campaign::origin, or of the only navigation of a campaign without fixes
    kOwn,     ///< that of its navigation: where it is beside other dives is not known
  };
  OccupancyMap map;
  MapAxes axes = MapAxes::kUnknown;
  Frame frame = Frame::kOwn;
  std::uint64_t beams = 0, echoes = 0;
  std::uint64_t no_pose = 0;  ///< beams at whose time the navigation gives no pose
  std::uint64_t outside = 0;  ///< beams that reach beyond the map
  bool was_kept = false;      ///< it was made before
};

/// Maps a dive. @param number  of Campaign::dives
/// @return errors of Recording::open, Recording::path and build_map
Result<DiveMap> map_dive(const Campaign& campaign, std::size_t number, const CampaignOptions& options,
                         const Progress& progress = {});

/// The file in a folder that keeps the map of a dive.
std::string kept_file(const std::string& folder, const Dive& dive);
/// The map of a dive as it was kept. nullopt: there is none that can be read, or it was made from other files, with
/// other options or in another frame. Files are identified by path, size and modification time.
std::optional<DiveMap> read_kept_map(const Campaign& campaign, std::size_t number, const CampaignOptions& options,
                                     const std::string& folder);
/// The map of a dive as it was kept, else a new one, which is kept: written to a temporary file and renamed.
/// @return errors of map_dive and of writing
Result<DiveMap> kept_or_new_map(const Campaign& campaign, std::size_t number, const CampaignOptions& options,
                                const std::string& folder, const Progress& progress = {});

/// Where a sum of the maps `from`..`to` - 1 is divided: it is the sum of those before and of those from there on.
/// Log-odds are clamped, so that the order of sums matters; this one depends on nothing but the numbers.
/// REQUIRES at least two
std::size_t middle_of_sum(std::size_t from, std::size_t to);
/// Adds the maps `from`..`to` - 1 in that order (OccupancyMap::merge). About log2(to - from) maps are in memory.
/// @param map_of  called once for each number, in order; nullopt: it has no map
/// @return nullopt without any map; errors of `map_of` and of merge
Result<std::optional<OccupancyMap>> sum_of_maps(
    std::size_t from, std::size_t to, const std::function<Result<std::optional<OccupancyMap>>(std::size_t)>& map_of);

}  // namespace pingvox
