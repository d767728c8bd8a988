#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <system_error>
#include <utility>

#include "base/without_exceptions.hpp"
#include "pingvox/io/folder_logs.hpp"
#include "pingvox/recording/campaign.hpp"
#include "pingvox/recording/map_origin.hpp"
#include "recording/dive_recording.hpp"
#include "recording/log_spans.hpp"
#include "recording/pair_dives.hpp"

namespace pingvox {
namespace {

namespace fs = std::filesystem;

/// A file that may be a log of a campaign.
struct CampaignFile {
  std::string path, name;     ///< the name below its folder
  bool may_be_other = false;  ///< a bag in a folder, which may hold beams, navigation or both
};

/// The files that are named, and those in the folders that are.
class FileList {
 public:
  /// @param of  those of a folder, besides its bags
  Result<void> add(const std::string& path, std::vector<std::string> FolderTree::* of, Campaign& campaign,
                   std::vector<UnpairedFile>& unreadable) {
    std::error_code ignored;
    if (!fs::is_directory(path, ignored) || ByteStream::open(path)) {
      add_file({path, fs::path(path).filename().string()});
      return {};
    }
    Result<FolderTree> tree = logs_below_folder(path);
    if (!tree) return tl::unexpected(tree.error());
    const auto add_all = [&](const std::vector<std::string>& files, bool may_be_other) {
      for (const std::string& file : files) {
        std::string name = fs::path(file).lexically_relative(path).string();
        std::ranges::replace(name, '/', '_');
        add_file({file, std::move(name), may_be_other});
      }
    };
    add_all((*tree).*of, false);
    add_all(tree->bags, true);
    for (auto& [file, reason] : tree->unreadable) unreadable.push_back({std::move(file), std::move(reason)});
    for (std::string& file : tree->unknown) {
      if (std::ranges::find(campaign.unknown, file) == campaign.unknown.end()) {
        campaign.unknown.push_back(std::move(file));
      }
    }
    std::ranges::sort(files_.begin() + static_cast<std::ptrdiff_t>(sorted_), files_.end(), {}, &CampaignFile::path);
    sorted_ = files_.size();
    return {};
  }

  const std::vector<CampaignFile>& files() const { return files_; }

 private:
  void add_file(CampaignFile file) {
    std::error_code ignored;
    if (!known_.insert(fs::weakly_canonical(file.path, ignored).string()).second) return;
    const std::string name = file.name;
    for (int number = 2; !names_.insert(file.name).second; ++number) file.name = fmt::format("{}-{}", name, number);
    files_.push_back(std::move(file));
  }

  std::vector<CampaignFile> files_;
  std::size_t sorted_ = 0;
  std::set<std::string> known_, names_;
};

std::uint64_t bytes_of_log(const std::string& path) {
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(path, error);
  return error ? 0 : bytes;
}

/// nullopt: it is a bag of navigation only.
Result<std::optional<LogTimes>> log_times_of(const CampaignFile& file, const RecordingOptions& options) {
  const Result<std::optional<LogSpan>> read =
      log_span({file.path, options.topic, options.body_from_sonar, options.damage});
  if (!read) {
    if (file.may_be_other && read.error().code == Error::Code::kUnsupported) return std::nullopt;
    return tl::unexpected(read.error());
  }
  if (!*read) return fail(Error::Code::kCorrupt, fmt::format("{}: has no beams, or scans without times", file.path));
  const auto& [span, clock] = **read;
  LogTimes times{.path = file.path, .span = span};
  times.are_dates_own = span.from_s >= kFirstDate_s;
  times.zero_s = times.are_dates_own ? 0.0 : zero_in_name(file.path, clock);
  return times;
}

NavTimes::Clock clock_of(const NavLog& nav, const TimeSpan& span) {
  if (nav.clock() == NavClock::kBoot) return NavTimes::Clock::kStart;
  return span.to_s >= kFirstDate_s ? NavTimes::Clock::kDates : NavTimes::Clock::kUnknown;
}

/// nullopt: it is a bag without navigation.
Result<std::optional<NavTimes>> nav_times_of(const CampaignFile& file, const RecordingOptions& options) {
  const Result<BagContents> contents = ByteStream::open(file.path).and_then(
      [&](ByteStream stream) { return read_nav_log(std::move(stream), options.damage, options.nav_fields); });
  if (!contents) return tl::unexpected(contents.error());
  const NavLog& nav = contents->nav.log;
  NavTimes times{.path = file.path, .span = {}};
  for (const NavSource& source : nav.sources()) {
    if (source.subject == NavSubject::kOther || !is_usable(source)) continue;
    times.sources.push_back(
        {source.name, source.quantity, {source.samples.front().time_s, source.samples.back().time_s}});
  }
  if (times.sources.empty()) {
    if (file.may_be_other) return std::nullopt;
    return fail(Error::Code::kUnsupported, fmt::format("{}: has no navigation of a vehicle", file.path));
  }
  times.span = times.sources.front().span;
  for (const auto& source : times.sources) {
    times.span.from_s = std::min(times.span.from_s, source.span.from_s);
    times.span.to_s = std::max(times.span.to_s, source.span.to_s);
  }
  if (const std::optional<TimeSpan> poses = nav_span(nav)) times.span = *poses;
  times.clock = clock_of(nav, times.span);
  return times;
}

bool gives_fixes(const NavTimes& nav) {
  return std::ranges::any_of(nav.sources, [](const auto& source) { return source.quantity == NavQuantity::kFix; });
}

/// The message of an error without the path that it begins with.
std::string reason_of(const Error& error, const std::string& path) {
  const std::string named = path + ": ";
  return error.message.starts_with(named) ? error.message.substr(named.size()) : error.message;
}

/// Of the first dive that has one. @param with_fixes  paths of navigation that has fixes
std::optional<MapOrigin> common_origin(const std::vector<Dive>& dives, const std::set<std::string>& with_fixes,
                                       const CampaignOptions& options) {
  for (const Dive& dive : dives) {
    if (std::ranges::none_of(dive.navs, [&](const std::string& nav) { return with_fixes.contains(nav); })) continue;
    const Result<Recording> recording = open_dive(dive, options.recording);
    if (!recording) continue;
    const Result<VehiclePath> path = recording->path();
    if (!path) continue;
    const auto origin = map_origin(*path, recording->nav().log, recording->nav_offset()->offset_s);
    if (origin) return origin;
  }
  return std::nullopt;
}

Result<MapForecast> forecast_dives(const std::vector<Dive>& dives, const CampaignOptions& options) {
  RecordingOptions recording = options.recording;
  recording.nav_offset_s.reset();
  recording.nav_sources.clear();
  recording.nav_salinity.reset();
  recording.calibration.reset();
  std::vector<InputFile> logs;
  for (const Dive& dive : dives) logs.emplace_back(dive.log);
  return Recording::open(std::move(logs), std::move(recording)).and_then([&](const Recording& all) {
    return forecast_map(all, options.map, options.build);
  });
}

Result<Campaign> plan(const std::vector<std::string>& logs, const std::vector<std::string>& navs,
                      const CampaignOptions& options) {
  Campaign campaign;
  FileList log_files, nav_files;
  for (const std::string& path : logs) {
    const auto added = log_files.add(path, &FolderTree::logs, campaign, campaign.logs);
    if (!added) return tl::unexpected(added.error());
  }
  for (const std::string& path : navs) {
    const auto added = nav_files.add(path, &FolderTree::nav, campaign, campaign.navs);
    if (!added) return tl::unexpected(added.error());
  }
  if (!log_files.files().empty() && nav_files.files().empty()) {
    return fail(Error::Code::kUnsupported, fmt::format("{}: there is no navigation", fmt::join(navs, ", ")));
  }
  std::vector<LogTimes> log_times;
  std::vector<std::string> names;
  for (const CampaignFile& file : log_files.files()) {
    Result<std::optional<LogTimes>> times = log_times_of(file, options.recording);
    if (!times) {
      campaign.logs.push_back({file.path, reason_of(times.error(), file.path)});
    } else if (*times) {
      log_times.push_back(**std::move(times));
      names.push_back(file.name);
    }
  }
  std::vector<NavTimes> nav_times;
  std::set<std::string> with_fixes;
  for (const CampaignFile& file : nav_files.files()) {
    Result<std::optional<NavTimes>> times = nav_times_of(file, options.recording);
    if (!times) {
      campaign.navs.push_back({file.path, reason_of(times.error(), file.path)});
    } else if (*times) {
      if (gives_fixes(**times)) with_fixes.insert(file.path);
      nav_times.push_back(**std::move(times));
    }
  }
  const std::vector<NavOfLog> pairs = pair_by_time(log_times, nav_times, options.recording.nav_offset_s);
  std::vector<bool> is_used(nav_times.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const NavOfLog& pair = pairs[i];
    for (const std::size_t nav : pair.in_conflict) is_used[nav] = true;  // reported with the log
    if (pair.navs.empty()) {
      campaign.logs.push_back({log_times[i].path, pair.reason});
      continue;
    }
    Dive dive{names[i], log_times[i].path, {}, pair.offset_s, bytes_of_log(log_times[i].path)};
    for (const std::size_t nav : pair.navs) {
      dive.navs.push_back(nav_times[nav].path);
      is_used[nav] = true;
    }
    campaign.dives.push_back(std::move(dive));
  }
  for (std::size_t i = 0; i < nav_times.size(); ++i) {
    if (!is_used[i]) campaign.navs.push_back({nav_times[i].path, "there is no log at its time"});
  }
  if (campaign.dives.empty()) return campaign;
  campaign.origin = common_origin(campaign.dives, with_fixes, options);
  Result<MapForecast> forecast = forecast_dives(campaign.dives, options);
  if (!forecast) return tl::unexpected(forecast.error());
  campaign.forecast = *std::move(forecast);
  return campaign;
}

}  // namespace

Result<void> CampaignOptions::validate() const {
  if (!recording.nav.empty() || recording.poses) {
    return fail(Error::Code::kBadOption, "campaign: nav and poses are those of each dive");
  }
  if (const auto valid = map.validate(); !valid) return valid;
  return build.validate();
}

Result<Campaign> plan_campaign(const std::vector<std::string>& logs, const std::vector<std::string>& navs,
                               const CampaignOptions& options) {
  if (const auto valid = options.validate(); !valid) return tl::unexpected(valid.error());
  return detail::without_exceptions([&]() -> Result<Campaign> { return plan(logs, navs, options); });
}

}  // namespace pingvox
