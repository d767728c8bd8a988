#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "commands.hpp"
#include "json.hpp"
#include "map_agreement.hpp"
#include "map_report.hpp"
#include "open_log.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/map/compare.hpp"
#include "pingvox/map/for_each_leaf.hpp"
#include "pingvox/map/slice.hpp"

namespace pingvox::app {
namespace {

/// The map in a file, or one layer of it.
Result<MapFile> map_at(const std::string& path, const std::optional<double>& layer_z_m) {
  const Result<FileBytes> file = read_file(path);
  if (!file) return tl::unexpected(file.error());
  if (const auto format = format_of(file->view()); format && kind_of(*format) != FormatKind::kMap) {
    return fail(Error::Code::kUnsupported,
                fmt::format("{}: is {}, not a map (.bt, .ot or .pvx)", file->name, describe(*format)));
  }
  Result<MapFile> read = read_map(*file);
  if (!read || !layer_z_m) return read;
  Result<OccupancyMap> layer = map_of_slice(read->map, {layer_z_m, layer_z_m});
  if (!layer) return fail(layer.error().code, fmt::format("{}: {}", file->name, layer.error().message));
  return MapFile{read->format, *std::move(layer), read->made_by};
}

/// The map with another probability from which on a cell is occupied; those below are free up to 0.5 and unknown above.
OccupancyMap with_threshold(const OccupancyMap& map, double probability) {
  MapOptions options = map.options();
  options.thresholds.upper = LogOdds::from_probability(probability);
  options.thresholds.lower = std::min(options.thresholds.lower, options.thresholds.upper);
  OccupancyMap out(options);
  Editor editor = out.edit();
  for_each_leaf(map, [&](const Leaf& leaf) { editor.set(leaf.key, leaf.depth, leaf.belief); });
  editor.synchronize();
  return out;
}

/// How two lattices differ.
std::string difference_of(const std::string& name_a, const Lattice& a, const std::string& name_b, const Lattice& b) {
  if (a.resolution_m() != b.resolution_m()) {
    return fmt::format("{} has cells of {} m, {} of {} m", name_a, a.resolution_m(), name_b, b.resolution_m());
  }
  return fmt::format("{} has {} levels, {} has {}", name_a, a.depth(), name_b, b.depth());
}

void add_share(JsonObject& json, std::string_view key, const std::optional<double>& share) {
  if (share) {
    json.add(key, *share);
  } else {
    json.add_null(key);
  }
}

std::string json_of(const MapComparison& found, const MapAgreement& agreement) {
  JsonObject classes, against_b, json;
  classes.add("occupied_a", agreement.occupied_a)
      .add("occupied_b", agreement.occupied_b)
      .add("occupied_both", agreement.occupied_both)
      .add("free_a", agreement.free_a)
      .add("free_b", agreement.free_b)
      .add("free_both", agreement.free_both);
  add_share(against_b, "precision", agreement.precision());
  add_share(against_b, "recall", agreement.recall());
  add_share(against_b, "free_true", agreement.free_true());
  json.add("cells", found.cells())
      .add("same", found.same)
      .add("different", found.different)
      .add("only_a", found.only_a)
      .add("only_b", found.only_b)
      .add("max_log_odds_difference", found.max_log_odds_difference)
      .add("classes", classes)
      .add("against_b", against_b);
  return json.text() + "\n";
}

/// Rounded down: one different cell of a million is not 100 %.
std::string share_text(std::uint64_t part, std::uint64_t whole) {
  if (part == whole) return "100";
  return fmt::format("{:.4f}", std::floor(static_cast<double>(part) / static_cast<double>(whole) * 1e6) / 1e4);
}

std::string share_text(const std::optional<double>& share) {
  return share ? fmt::format("{:.4g} %", 100.0 * *share) : "-";
}

std::string text_of(const MapComparison& found, const MapAgreement& agreement, Sameness sameness) {
  const std::uint64_t cells = found.cells();
  // A map that holds no log-odds says nothing about how far they differ.
  const std::string log_odds =
      sameness == Sameness::kLogOdds
          ? report_line("log-odds", fmt::format("differ by {:.6g} at most", found.max_log_odds_difference))
          : "";
  const char* by = sameness == Sameness::kLogOdds ? "by log-odds" : "by occupied or free";
  return fmt::format("{} % of {} cells are the same ({})\n", share_text(found.same, cells), cells, by) +
         report_line("same", fmt::format("{}", found.same)) +
         report_line("different", fmt::format("{}", found.different)) +
         report_line("only in A", fmt::format("{}", found.only_a)) +
         report_line("only in B", fmt::format("{}", found.only_b)) + log_odds +
         report_line("occupied", fmt::format("{} in A, {} in B, {} in both", agreement.occupied_a, agreement.occupied_b,
                                             agreement.occupied_both)) +
         report_line("free", fmt::format("{} in A, {} in B, {} in both", agreement.free_a, agreement.free_b,
                                         agreement.free_both)) +
         report_line("B as truth", fmt::format("precision {}, recall {} (occupied, within one cell); free {}",
                                               share_text(agreement.precision()), share_text(agreement.recall()),
                                               share_text(agreement.free_true())));
}

}  // namespace

Result<int> run(const CompareCommand& command, Console& console) {
  Result<MapFile> a = map_at(command.a, command.layer_z_m);
  if (!a) return tl::unexpected(a.error());
  const Result<MapFile> b = map_at(command.b, command.layer_z_m);
  if (!b) return tl::unexpected(b.error());
  if (command.occupied_probability) a->map = with_threshold(a->map, *command.occupied_probability);

  const bool has_bt = a->format == Format::kBt || b->format == Format::kBt;
  const Sameness sameness = has_bt ? Sameness::kOccupancy : Sameness::kLogOdds;
  const Result<MapComparison> found = compare_maps(a->map, b->map, sameness);
  if (!found) {
    return fail(found.error().code,
                fmt::format("{}: only maps of the same cells can be compared",
                            difference_of(command.a, a->map.lattice(), command.b, b->map.lattice())));
  }
  const MapAgreement agreement = agreement_of(a->map, b->map);
  const Result<void> summary = command.output_options.report == Report::kJson
                                   ? console.print(json_of(*found, agreement))
                                   : console.summarise(text_of(*found, agreement, sameness), "");
  if (!summary) return tl::unexpected(summary.error());
  return found->equal() ? 0 : 1;
}

}  // namespace pingvox::app
