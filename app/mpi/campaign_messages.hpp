#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "campaign.hpp"
#include "pingvox/recording/campaign.hpp"

/// What ranks tell each other of a campaign, as bytes that the same program reads.
namespace pingvox::app {

/// The dives, their frame and their cells: what mapping them needs.
std::string bytes_of(const Campaign& campaign);
Campaign campaign_from(const std::string& bytes);

/// Outcomes of dives by their number.
std::string bytes_of(const std::map<std::size_t, DiveOutcome>& outcomes);
std::map<std::size_t, DiveOutcome> outcomes_from(const std::string& bytes);

}  // namespace pingvox::app
