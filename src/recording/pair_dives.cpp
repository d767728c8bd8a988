#include "recording/pair_dives.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <string_view>
#include <utility>

#include "io/internal/clock.hpp"
#include "recording/log_spans.hpp"

namespace pingvox {
namespace {

using Numbers = std::vector<std::size_t>;

bool touch(const TimeSpan& a, const TimeSpan& b) {
  return a.from_s <= b.to_s && b.from_s <= a.to_s;
}

TimeSpan later_by(const TimeSpan& span, double seconds) {
  return {span.from_s + seconds, span.to_s + seconds};
}

std::string folder_of(const std::string& path) {
  return std::filesystem::path(path).parent_path().string();
}

/// Whether the times of both can be compared.
bool can_compare(const LogTimes& log, const NavTimes& nav) {
  return log.zero_s ? nav.clock == NavTimes::Clock::kDates : nav.clock == NavTimes::Clock::kUnknown;
}

/// The zone of local time of logs.
struct ZoneChoice {
  std::optional<double> local_from_utc_s = std::nullopt;
  std::string why_not = {};
};

/// The zone with which most of each log, summed over all of them, has navigation.
ZoneChoice choose_zone(std::span<const LogTimes> logs, std::span<const NavTimes> navs, bool are_dates_own) {
  std::map<double, double> shares;
  for (const LogTimes& log : logs) {
    if (!log.zero_s || log.are_dates_own != are_dates_own) continue;
    std::map<double, double> of_log;
    for (const NavTimes& nav : navs) {
      if (!can_compare(log, nav)) continue;
      for (const TimeZone& zone : time_zones(later_by(log.span, *log.zero_s), nav.span)) {
        double& share = of_log[zone.local_from_utc_s];
        share = std::max(share, zone.share);
      }
    }
    for (const auto& [zone_s, share] : of_log) shares[zone_s] += share;
  }
  if (shares.empty()) return {};
  constexpr double kNextShare = 0.8;
  const auto by_share = [](const auto& a, const auto& b) { return a.second < b.second; };
  const auto best = std::ranges::max_element(shares, by_share);
  const double enough = kNextShare * best->second;
  const auto utc = shares.find(0.0);
  if (are_dates_own && utc != shares.end() && utc->second >= enough) return {0.0, {}};
  std::vector<std::string> zones;
  for (const auto& [zone_s, share] : shares) {
    if (share >= enough) zones.push_back(zone_text(zone_s));
  }
  if (zones.size() == 1) return {best->first, {}};
  constexpr std::size_t kShown = 4;
  const std::span<const std::string> shown = std::span(zones).first(std::min(zones.size(), kShown));
  return {std::nullopt,
          fmt::format("the date of its times or name may be in {}{}: give nav_offset_s, the seconds to add to the "
                      "times of the navigation",
                      fmt::join(shown, " or "), zones.size() > kShown ? " or others" : "")};
}

/// "ATTITUDE", which both have at one time within a span of their own clock; empty: none.
std::string common_source(const NavTimes& a, const NavTimes& b, const TimeSpan& within) {
  for (const NavTimes::Source& one : a.sources) {
    for (const NavTimes::Source& other : b.sources) {
      if (one.name != other.name || one.quantity != other.quantity) continue;
      const TimeSpan both = {std::max(one.span.from_s, other.span.from_s), std::min(one.span.to_s, other.span.to_s)};
      if (both.from_s < both.to_s && touch(both, within)) return one.name;
    }
  }
  return {};
}

/// Why not all of these can be used together; empty: they can.
std::string conflict_of(const Numbers& chosen, std::span<const NavTimes> navs, const TimeSpan& within) {
  for (auto one = chosen.begin(); one != chosen.end(); ++one) {
    for (auto other = one + 1; other != chosen.end(); ++other) {
      const std::string name = common_source(navs[*one], navs[*other], within);
      if (name.empty()) continue;
      return fmt::format("{} and {} both have {} at its time: keep only that of the vehicle in the folder of the log",
                         navs[*one].path, navs[*other].path, name);
    }
  }
  return {};
}

/// The navigation nearest to a log in time.
std::string nearest_text(const LogTimes& log, double nav_to_log_s, std::span<const NavTimes> navs) {
  const NavTimes* nearest = nullptr;
  double nearest_s = std::numeric_limits<double>::infinity();
  const TimeSpan span = later_by(log.span, -nav_to_log_s);
  for (const NavTimes& nav : navs) {
    if (!can_compare(log, nav)) continue;
    const double apart_s = std::max(nav.span.from_s - span.to_s, span.from_s - nav.span.to_s);
    if (apart_s >= nearest_s) continue;
    nearest_s = apart_s;
    nearest = &nav;
  }
  if (nearest == nullptr) {
    return log.zero_s ? "has dates, and no navigation has any" : "has no dates, and all navigation has some";
  }
  return fmt::format("has no navigation at its time: of {}, the nearest, {}", nearest->path,
                     apart_text(span, nearest->span));
}

class Pairing {
 public:
  Pairing(std::span<const LogTimes> logs, std::span<const NavTimes> navs, const std::optional<double>& offset_s)
      : logs_(logs), navs_(navs), offset_s_(offset_s) {
    for (const LogTimes& log : logs) ++logs_in_[folder_of(log.path)];
    if (offset_s) return;
    own_ = choose_zone(logs, navs, true);
    by_name_ = choose_zone(logs, navs, false);
  }

  NavOfLog navs_of(const LogTimes& log) const {
    NavOfLog found;
    double nav_to_log_s = offset_s_.value_or(0.0);
    if (!offset_s_ && log.zero_s) {
      const ZoneChoice& zone = log.are_dates_own ? own_ : by_name_;
      if (!zone.why_not.empty()) return {{}, std::nullopt, zone.why_not};
      nav_to_log_s = zone.local_from_utc_s.value_or(0.0) - *log.zero_s;
      if (nav_to_log_s != 0.0) found.offset_s = nav_to_log_s;
    }
    const TimeSpan span = later_by(log.span, -nav_to_log_s);
    for (std::size_t i = 0; i < navs_.size(); ++i) {
      const bool is_given = offset_s_.has_value();
      if ((is_given || can_compare(log, navs_[i])) && touch(span, navs_[i].span)) found.navs.push_back(i);
    }
    const std::string conflict = conflict_of(found.navs, navs_, span);
    if (!conflict.empty()) {
      Numbers at_its_time = found.navs;
      keep_nearest(log, found.navs);
      if (found.navs.empty() || !conflict_of(found.navs, navs_, span).empty()) {
        return {.navs = {}, .reason = conflict, .in_conflict = std::move(at_its_time)};
      }
    }
    if (!offset_s_) add_by_folder(log, found);
    if (found.navs.empty()) found.reason = nearest_text(log, nav_to_log_s, navs_);
    return found;
  }

 private:
  /// Of those with the same source: the log itself, which is a bag, or those in its folder.
  void keep_nearest(const LogTimes& log, Numbers& chosen) const {
    const auto is_itself = [&](std::size_t i) { return navs_[i].path == log.path; };
    const auto is_beside = [&](std::size_t i) { return folder_of(navs_[i].path) == folder_of(log.path); };
    const bool has_itself = std::ranges::any_of(chosen, is_itself);
    std::erase_if(chosen, [&](std::size_t i) { return has_itself ? !is_itself(i) : !is_beside(i); });
  }

  /// Adds what cannot be compared in time: Recording aligns it by the rotation of the vehicle, or returns why it
  /// cannot.
  void add_by_folder(const LogTimes& log, NavOfLog& found) const {
    const std::string folder = folder_of(log.path);
    if (logs_in_.at(folder) > 1) return;
    const bool is_alone = found.navs.empty();
    for (std::size_t i = 0; i < navs_.size(); ++i) {
      if (can_compare(log, navs_[i]) || folder_of(navs_[i].path) != folder) continue;
      if (is_alone || navs_[i].clock == NavTimes::Clock::kStart) found.navs.push_back(i);
    }
    if (is_alone) found.offset_s.reset();
  }

  std::span<const LogTimes> logs_;
  std::span<const NavTimes> navs_;
  const std::optional<double>& offset_s_;
  std::map<std::string, std::size_t> logs_in_;
  ZoneChoice own_, by_name_;  ///< of logs whose times are dates, and of those with a date in their name
};

}  // namespace

std::vector<NavOfLog> pair_by_time(std::span<const LogTimes> logs, std::span<const NavTimes> navs,
                                   const std::optional<double>& offset_s) {
  const Pairing pairing(logs, navs, offset_s);
  std::vector<NavOfLog> found;
  found.reserve(logs.size());
  for (const LogTimes& log : logs) found.push_back(pairing.navs_of(log));
  return found;
}

}  // namespace pingvox
