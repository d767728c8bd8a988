#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "pingvox/io/file.hpp"
#include "pingvox/io/folder_logs.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/recording/campaign.hpp"
#include "recording/dive_recording.hpp"
#include "recording/moved_to_origin.hpp"

namespace pingvox {
namespace {

namespace fs = std::filesystem;

/// Path, size and time of the last change of a file, or of each file in a folder.
std::string stamp_of(const std::string& path) {
  std::error_code error;
  std::vector<fs::path> files;
  if (fs::is_directory(path, error)) {
    for (fs::directory_iterator entry(path, error), end; !error && entry != end; entry.increment(error)) {
      files.push_back(entry->path());
    }
    std::ranges::sort(files);
  } else {
    files.emplace_back(path);
  }
  std::string stamp;
  for (const fs::path& file : files) {
    std::error_code of_size, of_time;
    const std::uintmax_t bytes = fs::file_size(file, of_size);
    const auto changed = fs::last_write_time(file, of_time).time_since_epoch().count();
    stamp += fmt::format(" {} {} {};", fs::weakly_canonical(file, error).string(), of_size ? 0 : bytes,
                         of_time ? 0 : static_cast<std::int64_t>(changed));
  }
  return stamp;
}

/// All that determines the map of a dive.
std::string recipe_of(const Campaign& campaign, const Dive& dive, const CampaignOptions& options) {
  std::string text = fmt::format("{}; log{}", options.made_with, stamp_of(dive.log));
  for (const std::string& file : files_beside_log(dive.log)) text += stamp_of(file);
  text += " navigation";
  for (const std::string& nav : dive.navs) text += stamp_of(nav);
  for (const std::string& file : options.option_files) text += " options" + stamp_of(file);
  if (dive.nav_offset_s) text += fmt::format(" offset {};", *dive.nav_offset_s);
  if (campaign.origin) {
    const auto& [fix, heights] = *campaign.origin;
    text += fmt::format(" origin {} {} {}{};", fix.x(), fix.y(), fix.z(),
                        heights == MapOrigin::Heights::kAboveFix ? " and heights above it" : "");
  }
  return text + fmt::format(" cells {};", campaign.forecast.resolution_m);
}

/// After the recipe, the counts of the map, to report without making it again.
constexpr std::string_view kCounts = " beams, echoes, beams without a pose, beams beyond the map, fixes:";

std::string counts_text(const DiveMap& map, bool has_origin) {
  return fmt::format("{} {} {} {} {} {}", kCounts, map.beams, map.echoes, map.no_pose, map.outside, has_origin ? 1 : 0);
}

/// The numbers of `counts_text`; nullopt: it is another text.
std::optional<std::array<std::uint64_t, 5>> counts_from(std::string_view text) {
  if (!text.starts_with(kCounts)) return std::nullopt;
  text.remove_prefix(kCounts.size());
  std::array<std::uint64_t, 5> counts{};
  for (std::uint64_t& count : counts) {
    if (!text.starts_with(' ')) return std::nullopt;
    text.remove_prefix(1);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (error != std::errc()) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  }
  return text.empty() ? std::optional(counts) : std::nullopt;
}

DiveMap::Frame frame_of(const Campaign& campaign, const Dive& dive, bool has_origin) {
  const bool is_shared = campaign.origin ? has_origin : dive.navs == campaign.dives.front().navs;
  return is_shared ? DiveMap::Frame::kShared : DiveMap::Frame::kOwn;
}

/// A map of a dive, and whether its navigation places it on the earth.
struct PlacedMap {
  DiveMap map;
  bool has_origin = false;
};

Result<PlacedMap> make_placed_map(const Campaign& campaign, const Dive& dive, const CampaignOptions& options,
                                  const Progress& progress) {
  const Result<Recording> recording = open_dive(dive, options.recording);
  if (!recording) return tl::unexpected(recording.error());
  Result<VehiclePath> path = recording->path();
  if (!path) return tl::unexpected(path.error());
  std::optional<MapOrigin> origin;
  if (campaign.origin) {
    origin = map_origin(*path, recording->nav().log, recording->nav_offset()->offset_s);
    if (origin) path = moved_to_origin(*std::move(path), *origin, *campaign.origin);
  }
  MapOptions cells = options.map;
  cells.resolution_m = campaign.forecast.resolution_m;
  Result<RecordingMap> made = build_map(*recording, *std::move(path), cells, options.build, progress);
  if (!made) return tl::unexpected(made.error());
  const BuildReport& report = made->report;
  return PlacedMap{{.map = std::move(made->map),
                    .axes = made->path.axes,
                    .frame = frame_of(campaign, dive, origin.has_value()),
                    .beams = report.beams,
                    .echoes = report.echoes,
                    .no_pose = report.no_pose.count,
                    .outside = report.outside.count},
                   origin.has_value()};
}

std::optional<DiveMap> read_kept(const Campaign& campaign, const Dive& dive, const std::string& recipe,
                                 const std::string& path) {
  Result<MapFile> read = read_file(path).and_then([](const FileBytes& file) { return read_map(file); });
  if (!read || !read->made_by.starts_with(recipe)) return std::nullopt;
  const auto counts = counts_from(std::string_view(read->made_by).substr(recipe.size()));
  if (!counts) return std::nullopt;
  const auto& [beams, echoes, no_pose, outside, has_origin] = *counts;
  return DiveMap{.map = std::move(read->map),
                 .axes = read->axes,
                 .frame = frame_of(campaign, dive, has_origin != 0),
                 .beams = beams,
                 .echoes = echoes,
                 .no_pose = no_pose,
                 .outside = outside,
                 .was_kept = true};
}

}  // namespace

Result<Recording> open_dive(const Dive& dive, const RecordingOptions& options) {
  RecordingOptions of_dive = options;
  of_dive.nav.assign(dive.navs.begin(), dive.navs.end());
  if (dive.nav_offset_s) of_dive.nav_offset_s = dive.nav_offset_s;
  return Recording::open({dive.log}, std::move(of_dive));
}

Result<DiveMap> map_dive(const Campaign& campaign, std::size_t number, const CampaignOptions& options,
                         const Progress& progress) {
  return make_placed_map(campaign, campaign.dives[number], options, progress).map([](PlacedMap placed) {
    return std::move(placed.map);
  });
}

std::string kept_file(const std::string& folder, const Dive& dive) {
  return (fs::path(folder) / (dive.name + ".pvx")).string();
}

std::optional<DiveMap> read_kept_map(const Campaign& campaign, std::size_t number, const CampaignOptions& options,
                                     const std::string& folder) {
  const Dive& dive = campaign.dives[number];
  return read_kept(campaign, dive, recipe_of(campaign, dive, options), kept_file(folder, dive));
}

Result<DiveMap> kept_or_new_map(const Campaign& campaign, std::size_t number, const CampaignOptions& options,
                                const std::string& folder, const Progress& progress) {
  const Dive& dive = campaign.dives[number];
  const std::string path = kept_file(folder, dive);
  // Before the files are read: what changes meanwhile is another recipe the next time.
  const std::string recipe = recipe_of(campaign, dive, options);
  if (std::optional<DiveMap> kept = read_kept(campaign, dive, recipe, path)) return *std::move(kept);
  Result<PlacedMap> made = make_placed_map(campaign, dive, options, progress);
  if (!made) return tl::unexpected(made.error());
  const std::string made_by = recipe + counts_text(made->map, made->has_origin);
  const auto written = write_map(made->map.map, Format::kPvx, made_by, path, made->map.axes);
  if (!written) return tl::unexpected(written.error());
  return std::move(made->map);
}

std::size_t middle_of_sum(std::size_t from, std::size_t to) {
  return from + std::bit_floor(to - from - 1);
}

Result<std::optional<OccupancyMap>> sum_of_maps(
    std::size_t from, std::size_t to, const std::function<Result<std::optional<OccupancyMap>>(std::size_t)>& map_of) {
  if (from >= to) return std::nullopt;
  if (to - from == 1) return map_of(from);
  const std::size_t middle = middle_of_sum(from, to);
  Result<std::optional<OccupancyMap>> sum = sum_of_maps(from, middle, map_of);
  if (!sum) return sum;
  Result<std::optional<OccupancyMap>> rest = sum_of_maps(middle, to, map_of);
  if (!rest || !*rest) return rest ? std::move(sum) : std::move(rest);
  if (!*sum) return rest;
  if (const auto merged = (*sum)->merge(**rest); !merged) return tl::unexpected(merged.error());
  return sum;
}

}  // namespace pingvox
