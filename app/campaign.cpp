#include "campaign.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "input_kinds.hpp"
#include "map_report.hpp"
#include "nav_report.hpp"
#include "open_recording.hpp"
#include "option_names.hpp"
#include "pingvox/analysis/cut_tree.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/maps.hpp"
#include "progress.hpp"
#include "recording_report.hpp"

namespace pingvox::app {
namespace {

void say_unpaired(const Campaign& campaign, const Console& console) {
  for (const auto& [path, reason] : campaign.logs) {
    console.say(fmt::format("{}: skipped: {}", path, with_option_names(reason)));
  }
  for (const auto& [path, reason] : campaign.navs) {
    console.say(fmt::format("{}: is not used: {}", path, with_option_names(reason)));
  }
  if (campaign.unknown.empty()) return;
  constexpr std::size_t kShown = 5;
  const std::span<const std::string> shown(campaign.unknown.data(), std::min(kShown, campaign.unknown.size()));
  console.say(fmt::format(
      "skipped, unknown format: {}{}", fmt::join(shown, ", "),
      campaign.unknown.size() > kShown ? fmt::format(" and {} more", campaign.unknown.size() - kShown) : ""));
}

JsonObject origin_json(const MapOrigin& origin) {
  JsonObject json;
  return json.add("latitude_deg", origin.fix.x() / kDegree_rad)
      .add("longitude_deg", origin.fix.y() / kDegree_rad)
      .add("altitude_m", origin.fix.z());
}

/// Of the dives that are in the result.
struct Sums {
  std::size_t mapped = 0, kept = 0;
  std::uint64_t beams = 0, echoes = 0, no_pose = 0;
};

Sums sums_of(const std::vector<DiveOutcome>& outcomes) {
  Sums all;
  for (const DiveOutcome& outcome : outcomes) {
    if (!outcome.left_out.empty()) continue;
    ++all.mapped;
    all.kept += outcome.was_kept ? 1 : 0;
    all.beams += outcome.beams;
    all.echoes += outcome.echoes;
    all.no_pose += outcome.no_pose;
  }
  return all;
}

std::string campaign_json(const MapCommand& command, const Campaign& campaign, const std::vector<DiveOutcome>& outcomes,
                          const std::optional<OccupancyMap>& sum) {
  std::vector<JsonObject> dives, left_out;
  const auto leave_out = [&](const std::string& path, const std::string& reason) {
    JsonObject file;
    left_out.push_back(file.add("file", path).add("reason", reason));
  };
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const Dive& dive = campaign.dives[i];
    const DiveOutcome& outcome = outcomes[i];
    if (!outcome.left_out.empty()) {
      leave_out(dive.log, outcome.left_out);
      continue;
    }
    JsonObject json;
    json.add("log", dive.log)
        .add("nav", std::span<const std::string>(dive.navs))
        .add("beams", outcome.beams)
        .add("echoes", outcome.echoes)
        .add("no_pose", outcome.no_pose)
        .add("outside", outcome.outside)
        .add_truth("kept", outcome.was_kept)
        .add("map", kept_file(command.campaign->kept, dive));
    dives.push_back(std::move(json));
  }
  for (const auto& [path, reason] : campaign.logs) leave_out(path, reason);
  for (const auto& [path, reason] : campaign.navs) leave_out(path, reason);
  for (const std::string& path : campaign.unknown) leave_out(path, "unknown format");
  JsonObject json;
  const Sums all = sums_of(outcomes);
  json.add("beams", all.beams).add("echoes", all.echoes).add("dives", dives).add("left_out", left_out);
  campaign.origin ? json.add("origin", origin_json(*campaign.origin)) : json.add_null("origin");
  json.add("resolution_from", resolution_json(campaign.forecast, command.map));
  if (sum) json.add("map", map_json(*sum, sum->counts()));
  return json.text() + "\n";
}

std::string campaign_text(const MapCommand& command, const Campaign& campaign, const std::vector<DiveOutcome>& outcomes,
                          const std::optional<OccupancyMap>& sum) {
  const Sums all = sums_of(outcomes);
  const std::size_t logs = campaign.dives.size() + campaign.logs.size();
  std::string text =
      on_one_line(command.output) + "\n" +
      report_line("dives", fmt::format("{} of {}; maps of {} were made before and are kept in {}", all.mapped,
                                       counted(logs, "log"), all.kept, command.campaign->kept)) +
      report_line("read", fmt::format("{}, {}, {} without a pose", counted(all.beams, "beam"),
                                      counted(all.echoes, "echo"), all.no_pose)) +
      mount_line(command.recording);
  if (campaign.origin) {
    const Eigen::Vector3d& fix = campaign.origin->fix;
    text +=
        report_line("origin", fmt::format("{:.7f},{:.7f} (--origin)", fix.x() / kDegree_rad, fix.y() / kDegree_rad));
  }
  return sum ? text + map_text(*sum, sum->counts(), resolution_text(campaign.forecast, command.map)) : text;
}

}  // namespace

Result<CampaignOptions> campaign_options(const MapCommand& command) {
  RecordingArgs args = command.recording;
  args.path.navs.clear();
  Result<RecordingOptions> recording = recording_options(args);
  if (!recording) return tl::unexpected(recording.error());
  return CampaignOptions{.recording = *std::move(recording),
                         .map = command.map,
                         .build = command.build,
                         .made_with = command.campaign->made_with,
                         .option_files = command.campaign->option_files};
}

Result<Campaign> open_campaign(const MapCommand& command, const CampaignOptions& options, Console& console) {
  const std::vector<std::string> kinds = {std::string(kBeamLogs), std::string(kPointLogs), std::string(kBagScans),
                                          std::string(kNavLogs), std::string(kRayBeams)};
  if (const auto used = check_limited(command.limited, kinds); !used) return tl::unexpected(used.error());
  if (const auto ranges = check_ranges(command.build); !ranges) return tl::unexpected(ranges.error());
  Result<Campaign> campaign = plan_campaign(command.recording.logs, command.recording.path.navs, options);
  if (!campaign) return campaign;
  say_unpaired(*campaign, console);
  if (campaign->dives.empty()) {
    const std::string logs = fmt::format("{}", fmt::join(command.recording.logs, ", "));
    return fail(Error::Code::kUnsupported, campaign->logs.empty()
                                               ? fmt::format("{}: no sonar log", logs)
                                               : fmt::format("{}: no log can be mapped, {} skipped", logs,
                                                             campaign->logs.size() == 1 ? "one is" : "all are"));
  }
  std::error_code error;
  std::filesystem::create_directories(command.campaign->kept, error);
  if (error) return fail(Error::Code::kIo, fmt::format("{}: {}", command.campaign->kept, error.message()));
  return campaign;
}

DiveOutcome outcome_of(const Campaign& campaign, const Result<DiveMap>& dive, const CampaignArgs& args) {
  if (!dive) return {.left_out = with_option_names(dive.error().message)};
  DiveOutcome outcome{.beams = dive->beams,
                      .echoes = dive->echoes,
                      .no_pose = dive->no_pose,
                      .outside = dive->outside,
                      .axes = dive->axes,
                      .was_kept = dive->was_kept};
  if (args.has_sum && dive->frame == DiveMap::Frame::kOwn) {
    outcome.left_out = fmt::format(
        "its navigation has no fixes{}, so that its place relative to the others is unknown; "
        "-o FOLDER/ makes a map of each dive",
        campaign.origin ? "" : " and is not that of the first dive");
  }
  return outcome;
}

std::string outcome_text(const Campaign& campaign, std::size_t number, const DiveOutcome& outcome) {
  const Dive& dive = campaign.dives[number];
  const std::string_view reason = outcome.left_out;
  const std::string named = dive.log + ": ";
  std::string text = fmt::format("{} of {}: {}: ", number + 1, campaign.dives.size(), dive.log);
  if (!reason.empty()) {
    return text + fmt::format("skipped: {}", reason.starts_with(named) ? reason.substr(named.size()) : reason);
  }
  text += fmt::format("{}, {}", counted(outcome.beams, "beam"), counted(outcome.echoes, "echo"));
  if (outcome.no_pose > 0) text += fmt::format(", {} without a pose", outcome.no_pose);
  if (outcome.outside > 0) text += fmt::format(", {} beyond the map (--depth reaches farther)", outcome.outside);
  return outcome.was_kept ? text + " (mapped before)" : text;
}

Result<int> finish_campaign(const MapCommand& command, const Campaign& campaign,
                            const std::vector<DiveOutcome>& outcomes, std::optional<OccupancyMap> sum,
                            Console& console) {
  const auto is_mapped = [](const DiveOutcome& outcome) { return outcome.left_out.empty(); };
  const auto first = std::ranges::find_if(outcomes, is_mapped);
  if (first == outcomes.end()) {
    return fail(Error::Code::kCorrupt, fmt::format("{}: nothing could be mapped of any dive", command.output));
  }
  if (sum) {
    const bool have_same_axes = std::ranges::all_of(
        outcomes, [&](const DiveOutcome& outcome) { return !is_mapped(outcome) || outcome.axes == first->axes; });
    if (command.occupancy.cut_depth) sum = cut_tree(*sum, *command.occupancy.cut_depth);
    const auto written = write_map(*sum, command.format, command.made_by, command.output,
                                   have_same_axes ? first->axes : MapAxes::kUnknown);
    if (!written) return tl::unexpected(written.error());
  }
  const auto printed = command.output_options.report == Report::kJson
                           ? console.print(campaign_json(command, campaign, outcomes, sum))
                           : console.summarise(campaign_text(command, campaign, outcomes, sum), command.output);
  if (!printed) return tl::unexpected(printed.error());
  return campaign.logs.empty() && std::ranges::all_of(outcomes, is_mapped) ? 0 : 1;
}

Result<int> map_campaign(const MapCommand& command, Console& console) {
  const CampaignArgs& args = *command.campaign;
  const Result<CampaignOptions> options = campaign_options(command);
  if (!options) return tl::unexpected(options.error());
  const Result<Campaign> campaign = open_campaign(command, *options, console);
  if (!campaign) return tl::unexpected(campaign.error());
  const std::size_t dives = campaign->dives.size();
  std::vector<DiveOutcome> outcomes(dives);
  ProgressBar bar(command.output_options);
  Result<std::optional<OccupancyMap>> sum =
      sum_of_maps(0, dives, [&](std::size_t number) -> Result<std::optional<OccupancyMap>> {
        const Progress progress = [&](const BuildReport& done) {
          if (!bar.is_due()) return;
          bar.draw(static_cast<double>(number) / static_cast<double>(dives),
                   fmt::format("dive {} of {}, {}", number + 1, dives, counted(done.beams, "beam")));
        };
        Result<DiveMap> dive = kept_or_new_map(*campaign, number, *options, args.kept, progress);
        outcomes[number] = outcome_of(*campaign, dive, args);
        bar.clear();
        console.say(outcome_text(*campaign, number, outcomes[number]));
        const bool is_added = args.has_sum && outcomes[number].left_out.empty();
        return is_added ? std::optional(std::move(dive->map)) : std::nullopt;
      });
  if (!sum) return tl::unexpected(sum.error());
  return finish_campaign(command, *campaign, outcomes, *std::move(sum), console);
}

}  // namespace pingvox::app
