#include <fmt/format.h>

#include <array>
#include <optional>
#include <string>
#include <utility>

#include "command_files.hpp"
#include "mapping_options.hpp"
#include "option_table.hpp"
#include "option_values.hpp"
#include "parse_commands.hpp"
#include "query_places.hpp"
#include "shared_options.hpp"

namespace pingvox::app {
namespace {

constexpr std::array kUnknowns = {Choice<UnknownCells>{"pass", UnknownCells::kPass},
                                  Choice<UnknownCells>{"block", UnknownCells::kBlock}};

/// What was asked, kept until it is known that it is one kind of question.
struct Asked {
  std::optional<QuestionKind> kind;
  std::string other;  ///< the name of another kind
};

/// One of the questions: each value is a place, or "-" for standard input.
Option question(const QuestionKind& kind, std::string help, QueryCommand& command, Asked& asked) {
  const Take take = [&command, &asked, kind](const std::string& text) -> Result<void> {
    if (asked.kind && asked.kind->question != kind.question) asked.other = asked.kind->option;
    asked.kind = kind;
    command.question = kind.question;
    if (text == "-") {
      command.reads_places = true;
      return {};
    }
    Result<std::vector<double>> place = place_from(text, kind);
    if (!place) return tl::unexpected(place.error());
    command.places.push_back(*std::move(place));
    return {};
  };
  return {std::string(kind.option), 0, std::string(kind.value), std::move(help), "none", take, Repeats::kEachCounts};
}

}  // namespace

Result<Command> query_command(const Args& args) {
  QueryCommand command;
  Asked asked;
  const auto ask = [&](Question what, std::string help) {
    return question(kind_of(what), std::move(help), command, asked);
  };
  OptionTable::Group how{
      "How",
      {only_with({{"--ray"}, {"--nearest"}, {"--clearance"}}, {"--max-range", 0, "M", "largest range", "no limit",
                                                               within(kPositive, store_number(command.max_range_m))}),
       only_with({{"--ray"}}, choice("--unknown", kUnknowns, "whether unknown cells block rays", command.unknown)),
       json_option(command.output_options), config_option()}};
  for (Option& option : occupancy_options(command.occupancy)) how.options.push_back(std::move(option));
  const OptionTable table{
      "query",
      "Queries a map: one kind of question, for any number of places. Where a place is - they are read from standard\n"
      "input, one on each line, with commas or spaces between the numbers; points may be poses "
      "(TUM).\n"
      "The answers are a table (CSV), in the order of the places; without an answer its columns are empty. Metres, in "
      "the\n"
      "frame of the map.",
      {{"MAP", Positional::Count::kOne, ".bt, .ot or .pvx", store(command.map)}},
      {{"Question",
        {ask(Question::kPoint, "occupancy and probability of the cell that contains a point"),
         ask(Question::kRay, "first cell that a ray hits, from X,Y,Z along DX,DY,DZ, and its range"),
         ask(Question::kNearest, "the nearest point of an occupied cell, in all directions"),
         ask(Question::kClearance, "the same for cells that are occupied or unknown: the clearance"),
         ask(Question::kRegion, "number of occupied, free and unknown cells in the box between two corners")}},
       std::move(how)},
      {"pingvox query tank.bt --point 1,0,-0.5 --point 1.2,0,-0.5", "pingvox query tank.bt --nearest - < dive.tum",
       "pingvox query harbour.ot --ray 0,0,-2,1,0,0 --max-range 30 --unknown block --json"},
      "Exit status: 0 done, 1 failed, 2 invalid usage."};
  return parse_command(table, args, [&](const Parsed& parsed) -> Result<Command> {
    if (!asked.other.empty())
      return usage_error(fmt::format("{} and {}: one kind of question at a time", asked.other, asked.kind->option));
    if (!asked.kind) return usage_error("a question is missing: --point, --ray, --nearest, --clearance or --region");
    if (const auto valid = command.occupancy.validate(); !valid) return tl::unexpected(valid.error());
    CommandFiles files;
    files.read("MAP", command.map);
    if (command.reads_places) files.read(std::string(asked.kind->option), "-");
    files.read("--config", parsed.config);
    if (const auto valid = files.check(); !valid) return tl::unexpected(valid.error());
    return command;
  });
}

}  // namespace pingvox::app
