// pingvox-mpi: 'pingvox map' of many dives, shared out among processes that mpirun starts.

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "base/without_exceptions.hpp"
#include "campaign.hpp"
#include "campaign_messages.hpp"
#include "command_line.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "option_names.hpp"
#include "option_values.hpp"
#include "pingvox/io/maps.hpp"
#include "ranks.hpp"
#include "vectors.hpp"

namespace pingvox::app {
namespace {

constexpr std::string_view kUsage =
    "Usage: mpirun -n N pingvox-mpi map FOLDER... --nav FOLDER -o MAP|FOLDER/ [OPTION]...\n"
    "Maps many dives on several processes: the map is that of 'pingvox map' with the same arguments, to the bit\n"
    "(see 'pingvox map --help'). All processes have to see the same files at the same paths; maps of dives are kept\n"
    "in MAP.dives, so that a killed run resumes with the missing dives.\n";

using MaybeMap = std::optional<OccupancyMap>;

/// Empty: no map.
Result<std::string> bytes_of_map(const MaybeMap& map) {
  if (!map) return std::string();
  std::ostringstream out;
  if (const auto written = write_map(*map, Format::kPvx, "", out); !written) return tl::unexpected(written.error());
  return std::move(out).str();
}

Result<MaybeMap> map_from(const std::string& bytes, std::size_t from) {
  if (bytes.empty()) return MaybeMap();
  return read_map({fmt::format("the map of rank {}", from), {bytes.begin(), bytes.end()}}).map([](MapFile file) {
    return MaybeMap(std::move(file.map));
  });
}

/// The sum of the maps of dives in the order of `sum_of_maps`, each part by the rank that owns its first dive.
class SharedSum {
 public:
  SharedSum(const Ranks& ranks, std::size_t dives, const std::function<Result<MaybeMap>(std::size_t)>& map_of)
      : ranks_(ranks), dives_(dives), map_of_(map_of) {}

  /// nullopt also at other ranks than the owner of `from`.
  Result<MaybeMap> of(std::size_t from, std::size_t to) const {
    const std::size_t owner = owner_of(from);
    if (owner == owner_of(to - 1)) return owner == ranks_.own() ? sum_of_maps(from, to, map_of_) : MaybeMap();
    const std::size_t middle = middle_of_sum(from, to), other = owner_of(middle);
    Result<MaybeMap> sum = of(from, middle);
    if (!sum) return sum;
    Result<MaybeMap> rest = of(middle, to);
    if (!rest) return rest;
    if (owner != other && other == ranks_.own()) {
      return bytes_of_map(*rest).map([&](const std::string& bytes) {
        ranks_.send(bytes, owner);
        return MaybeMap();
      });
    }
    if (owner != ranks_.own()) return MaybeMap();
    if (owner != other) rest = map_from(ranks_.receive(other), other);
    if (!rest || !*rest) return rest ? std::move(sum) : std::move(rest);
    if (!*sum) return rest;
    if (const auto merged = (*sum)->merge(**rest); !merged) return tl::unexpected(merged.error());
    return sum;
  }

 private:
  /// Neighbouring dives belong to one rank, so that most sums need no message.
  std::size_t owner_of(std::size_t dive) const { return dive * ranks_.count() / dives_; }

  const Ranks& ranks_;
  std::size_t dives_;
  const std::function<Result<MaybeMap>(std::size_t)>& map_of_;
};

/// Numbers of dives, those with the largest logs first: the last ones to be taken should be short.
std::vector<std::size_t> by_size(const Campaign& campaign) {
  std::vector<std::size_t> numbers(campaign.dives.size());
  std::iota(numbers.begin(), numbers.end(), std::size_t{0});
  std::ranges::sort(numbers, [&](std::size_t a, std::size_t b) {
    const std::uint64_t bytes_a = campaign.dives[a].bytes, bytes_b = campaign.dives[b].bytes;
    return bytes_a != bytes_b ? bytes_a > bytes_b : a < b;
  });
  return numbers;
}

/// Maps dives that no other rank has taken until there are none left.
std::map<std::size_t, DiveOutcome> map_dives(const Ranks& ranks, const MapCommand& command, const Campaign& campaign,
                                             const CampaignOptions& options, const Console& console) {
  std::map<std::size_t, DiveOutcome> outcomes;
  const std::vector<std::size_t> numbers = by_size(campaign);
  for (;;) {
    const std::size_t taken = ranks.take_number();
    if (taken >= numbers.size()) return outcomes;
    const std::size_t number = numbers[taken];
    const Result<DiveMap> dive = kept_or_new_map(campaign, number, options, command.campaign->kept,
                                                 [&](const BuildReport&) { ranks.make_progress(); });
    DiveOutcome& outcome = outcomes[number] = outcome_of(campaign, dive, *command.campaign);
    console.say(outcome_text(campaign, number, outcome));
  }
}

/// The exit status; what one rank cannot do ends the run.
Result<int> run_shared(const Ranks& ranks, const MapCommand& command) {
  Console console(command.output_options);
  const Result<CampaignOptions> options = campaign_options(command);
  if (!options) return tl::unexpected(options.error());
  Campaign campaign;
  if (ranks.own() == 0) {
    Result<Campaign> opened = open_campaign(command, *options, console);
    if (!opened) return tl::unexpected(opened.error());
    campaign = *std::move(opened);
  }
  const std::string told = ranks.broadcast(bytes_of(campaign));
  if (ranks.own() != 0) campaign = campaign_from(told);
  const std::size_t dives = campaign.dives.size();

  std::vector<DiveOutcome> outcomes(dives);
  const std::string own = bytes_of(map_dives(ranks, command, campaign, *options, console));
  for (const std::string& bytes : ranks.gather_for_all(own)) {
    for (auto& [number, outcome] : outcomes_from(bytes)) outcomes[number] = std::move(outcome);
  }
  const std::function<Result<MaybeMap>(std::size_t)> map_of = [&](std::size_t number) -> Result<MaybeMap> {
    if (!command.campaign->has_sum || !outcomes[number].left_out.empty()) return MaybeMap();
    return kept_or_new_map(campaign, number, *options, command.campaign->kept).map([](DiveMap dive) {
      return MaybeMap(std::move(dive.map));
    });
  };
  Result<MaybeMap> sum = SharedSum(ranks, dives, map_of).of(0, dives);
  if (!sum) return tl::unexpected(sum.error());
  if (ranks.own() != 0) return 0;
  return finish_campaign(command, campaign, outcomes, *std::move(sum), console);
}

/// @return the exit status of a command line
Result<int> run_command_line(const Ranks& ranks, const std::vector<std::string>& args) {
  if (const auto limited = limit_vectors(); !limited) return tl::unexpected(limited.error());
  if (args.empty()) return usage_error("'map' is missing (see 'pingvox-mpi --help')");
  if (args.front() == "--help" || args.front() == "-h") {
    if (ranks.own() == 0) return Console({}).print(kUsage).map([] { return 0; });
    return 0;
  }
  const Result<Command> command = parse_command_line(args);
  if (!command) return tl::unexpected(command.error());
  if (const auto* text = std::get_if<ShowText>(&*command)) {
    if (ranks.own() == 0) return Console(text->output_options).print(text->text).map([] { return 0; });
    return 0;
  }
  const auto* map = std::get_if<MapCommand>(&*command);
  if (map == nullptr || !map->campaign) {
    return usage_error("only 'map' of many dives (--nav FOLDER) can be shared out (see 'pingvox-mpi --help')");
  }
  return run_shared(ranks, *map);
}

}  // namespace
}  // namespace pingvox::app

int main(int argc, char** argv) {
  using namespace pingvox;
  constexpr int kFailed = 1, kInvalidUsage = 2;
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  const app::Ranks ranks(&argc, &argv);
  const Result<int> done = detail::without_exceptions(
      [&] { return app::run_command_line(ranks, {argv + (argc > 0 ? 1 : 0), argv + argc}); });
  if (done) return *done;
  const Error& error = done.error();
  const int status = error.code == Error::Code::kBadOption ? kInvalidUsage : kFailed;
  // All ranks find the same wrong usage.
  if (status == kFailed || ranks.own() == 0) app::print_error(app::with_option_names(error.message));
  if (ranks.count() > 1) ranks.end_all(status);
  return status;
}
