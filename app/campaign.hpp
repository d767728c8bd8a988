#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"
#include "console.hpp"
#include "pingvox/recording/campaign.hpp"
#include "pingvox/result.hpp"

/// 'map' of many dives, each with its own navigation.
namespace pingvox::app {

/// The outcome of a dive.
struct DiveOutcome {
  std::uint64_t beams = 0, echoes = 0, no_pose = 0, outside = 0;
  MapAxes axes = MapAxes::kUnknown;
  bool was_kept = false;
  std::string left_out = {};  ///< why it is not in the result; empty: it is
};

/// @return errors of reading options
Result<CampaignOptions> campaign_options(const MapCommand& command);
/// Plans the campaign of a command, makes the folder of its maps and reports files that are in no dive.
/// @return kUnsupported when there is no dive; errors of plan_campaign
Result<Campaign> open_campaign(const MapCommand& command, const CampaignOptions& options, Console& console);

/// The outcome of a dive. A map that is not in the frame of the others is not in their sum.
DiveOutcome outcome_of(const Campaign& campaign, const Result<DiveMap>& dive, const CampaignArgs& args);
/// "12 of 100: dive3.bin: 720 beams, 650 echoes"
std::string outcome_text(const Campaign& campaign, std::size_t number, const DiveOutcome& outcome);

/// Writes the sum of the maps, if there is to be one, and the report.
/// @param sum  nullopt: no dive is in it
/// @return the exit status: 1 when a log is not in the result; kCorrupt when none is
Result<int> finish_campaign(const MapCommand& command, const Campaign& campaign,
                            const std::vector<DiveOutcome>& outcomes, std::optional<OccupancyMap> sum,
                            Console& console);

/// Runs a 'map' command with CampaignArgs.
Result<int> map_campaign(const MapCommand& command, Console& console);

}  // namespace pingvox::app
