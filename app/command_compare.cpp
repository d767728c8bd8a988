#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "io/internal/json.hpp"
#include "io/internal/unknown_file.hpp"
#include "map_report.hpp"
#include "open_log.hpp"
#include "open_recording.hpp"
#include "option_values.hpp"
#include "pingvox/analysis/compare.hpp"
#include "pingvox/analysis/map_agreement.hpp"
#include "pingvox/analysis/slice.hpp"
#include "pingvox/analysis/visible_cells.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/io/tum.hpp"
#include "pingvox/nav/trajectory_score.hpp"
#include "recording_report.hpp"

namespace pingvox::app {
namespace {

Result<MapFile> map_in(const Result<FileBytes>& file) {
  if (!file) return tl::unexpected(file.error());
  if (const auto format = format_of(file->view()); format && kind_of(*format) != FormatKind::kMap) {
    return fail(Error::Code::kUnsupported,
                fmt::format("{}: is {}, not a map (.bt, .ot or .pvx)", file->name, description_of(*format)));
  }
  return read_map(*file);
}

/// Leaves only the layer of cells that holds a height.
Result<void> keep_layer(MapFile& file, const std::string& name, double z_m) {
  Result<OccupancyMap> layer = map_of_slice(file.map, {z_m, z_m});
  if (!layer) return fail(layer.error().code, fmt::format("{}: {}", name, layer.error().message));
  file.map = *std::move(layer);
  return {};
}

/// Cells are occupied from a probability on; those below are free up to 0.5 and unknown above.
Thresholds thresholds_at(double probability, const Thresholds& standard) {
  const LogOdds upper = LogOdds::from_probability(probability);
  return {std::min(standard.lower, upper), upper};
}

/// The occupied cells of `surface`, which is the world or a layer of it, that could be seen.
Result<OccupancyMap> visible_cells_of(const CompareCommand& command, const OccupancyMap& surface,
                                      const OccupancyMap& world) {
  const Result<Trajectory> trajectory = trajectory_of(command.visible_from);
  if (!trajectory) return tl::unexpected(trajectory.error());
  std::vector<Pose> map_from_sensor;
  for (const StampedPose& pose : trajectory->poses()) {
    map_from_sensor.push_back(pose.map_from_body * command.body_from_sensor);
  }
  Result<OccupancyMap> visible = visible_cells(surface, world, map_from_sensor, command.view);
  if (!visible) return fail(visible.error().code, fmt::format("{}: {}", command.b, visible.error().message));
  if (visible->empty()) {
    return fail(Error::Code::kUnsupported,
                fmt::format("{}: nothing of {} could be seen from these poses: are they in its frame, and is what they "
                            "saw in range?",
                            *command.visible_from, command.b));
  }
  return visible;
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

std::string comparison_json(const CompareCommand& command, const MapComparison& found, const MapAgreement& agreement) {
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
  add_share(against_b, "free_true_1_cell", agreement.free_true_near());
  if (command.visible_from) against_b.add("visible", agreement.to_find);
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

std::string count_text(const std::optional<std::uint64_t>& count) {
  return count ? fmt::format("{}", *count) : "-";
}

/// Report on A, counting only what could be seen of B.
std::string text_of(const MapAgreement& agreement) {
  return fmt::format("precision {}, recall {}, free {}\n", share_text(agreement.precision()),
                     share_text(agreement.recall()), share_text(agreement.free_true())) +
         report_line("precision", fmt::format("{} of A's {} occupied cells are within one cell of one of B's",
                                              count_text(agreement.a_near_b), agreement.occupied_a)) +
         report_line("recall",
                     fmt::format("{} of the {} cells of B that could be seen are within one cell of one of A's",
                                 count_text(agreement.found_by_a), agreement.to_find)) +
         report_line("free",
                     fmt::format("{} of A's {} free cells are free in B, {} within one cell", agreement.free_both,
                                 agreement.free_a, share_text(agreement.free_true_near())));
}

std::string text_of(const MapComparison& found, const MapAgreement& agreement, Sameness sameness) {
  const std::uint64_t cells = found.cells();
  // Without log-odds there is no difference to print.
  const std::string log_odds =
      sameness == Sameness::kLogOdds
          ? report_line("log-odds", fmt::format("differ by {:.6g} at most", found.max_log_odds_difference))
          : "";
  const char* by = sameness == Sameness::kLogOdds ? "by log-odds" : "by occupied or free";
  return fmt::format("{} % of the {} cells known in A or B are the same ({})\n", share_text(found.same, cells), cells,
                     by) +
         report_line("same", fmt::format("{}", found.same)) +
         report_line("different", fmt::format("{}", found.different)) +
         report_line("only in A", fmt::format("{}", found.only_a)) +
         report_line("only in B", fmt::format("{}", found.only_b)) + log_odds +
         report_line("occupied", fmt::format("{} in A, {} in B, {} in both", agreement.occupied_a, agreement.occupied_b,
                                             agreement.occupied_both)) +
         report_line("free", fmt::format("{} in A, {} in B, {} in both", agreement.free_a, agreement.free_b,
                                         agreement.free_both)) +
         report_line("B as truth", fmt::format("occupied: precision {}, recall {} (within one cell); free: {} correct",
                                               share_text(agreement.precision()), share_text(agreement.recall()),
                                               share_text(agreement.free_true())));
}

JsonObject statistics_json(const ErrorStatistics& error) {
  JsonObject json;
  return json.add("mean", error.mean_m).add("sd", error.sd_m).add("rmse", error.rmse_m).add("max", error.max_m);
}

std::string score_json(const TrajectoryScore& score) {
  JsonObject absolute, relative, json;
  absolute.add("none", statistics_json(score.none))
      .add("first_fix", statistics_json(score.first_fix))
      .add("translation", statistics_json(score.translation))
      .add("se2", statistics_json(score.se2).add("rotation_deg", score.se2_turn_rad / kDegree_rad));
  relative.add("per_m", score.per_m).add("segment_m", score.segment_m);
  json.add("poses", score.poses)
      .add("outside", score.outside)
      .add("max_difference_m", score.max_difference_m)
      .add("ate", absolute)
      .add("rpe", relative);
  return json.text() + "\n";
}

std::string text_of(const ErrorStatistics& error) {
  return fmt::format("mean {:.4g} m, sd {:.4g} m, rmse {:.4g} m, max {:.4g} m", error.mean_m, error.sd_m, error.rmse_m,
                     error.max_m);
}

std::string text_of(const TrajectoryScore& score) {
  const std::string outside =
      score.outside > 0 ? fmt::format(", {} of B outside of A's time or in its gaps", score.outside) : "";
  const std::string relative = std::isnan(score.per_m)
                                   ? "B did not move"
                                   : fmt::format("{:.4g} m/m, over segments of {:.4g} m", score.per_m, score.segment_m);
  return fmt::format("Horizontal error of A at {} of B{}, aligned by\n", counted(score.poses, "pose"), outside) +
         report_line("nothing", text_of(score.none)) + report_line("first fix", text_of(score.first_fix)) +
         report_line("translation", text_of(score.translation)) +
         report_line("SE(2)",
                     fmt::format("{}, turned by {:.3g} deg", text_of(score.se2), score.se2_turn_rad / kDegree_rad)) +
         report_line("relative", relative);
}

Result<Trajectory> trajectory_in(const Result<FileBytes>& file) {
  if (!file) return tl::unexpected(file.error());
  if (const auto format = format_of(file->view()); format != Format::kTum) {
    return fail(
        Error::Code::kUnsupported,
        fmt::format("{}: {}: a trajectory (TUM) is compared with another one", file->name,
                    format ? fmt::format("is {}", description_of(*format)) : describe_unknown_file(file->view())));
  }
  return read_tum(*file);
}

/// Positions this close are the same: files hold them with rounded decimals.
constexpr double kSame_m = 1e-9;

Result<int> compare_trajectories(const CompareCommand& command, const Result<FileBytes>& file_a,
                                 const Result<FileBytes>& file_b, Console& console) {
  if (const auto used = check_limited(command.limited, {"trajectories"}); !used) {
    return fail(used.error().code, "compare: " + used.error().message);
  }
  const Result<Trajectory> a = trajectory_in(file_a);
  if (!a) return tl::unexpected(a.error());
  const Result<Trajectory> b = trajectory_in(file_b);
  if (!b) return tl::unexpected(b.error());
  const Result<TrajectoryScore> score = score_trajectory(*a, *b);
  if (!score) return fail(score.error().code, fmt::format("{}: {}", command.b, score.error().message));
  const Result<void> summary = command.output_options.report == Report::kJson ? console.print(score_json(*score))
                                                                              : console.summarise(text_of(*score), "");
  if (!summary) return tl::unexpected(summary.error());
  return score->outside == 0 && score->max_difference_m <= kSame_m ? 0 : 1;
}

bool is_trajectory(const Result<FileBytes>& file) {
  return file && format_of(file->view()) == Format::kTum;
}

}  // namespace

Result<int> run(const CompareCommand& command, Console& console) {
  const Result<FileBytes> file_a = read_file(command.a), file_b = read_file(command.b);
  if (is_trajectory(file_a) || is_trajectory(file_b)) return compare_trajectories(command, file_a, file_b, console);
  Result<MapFile> a = map_in(file_a);
  if (!a) return tl::unexpected(a.error());
  Result<MapFile> b = map_in(file_b);
  if (!b) return tl::unexpected(b.error());
  if (!(a->map.lattice() == b->map.lattice())) {
    return fail(Error::Code::kBadOption,
                fmt::format("{}: only maps of the same cells can be compared",
                            difference_of(command.a, a->map.lattice(), command.b, b->map.lattice())));
  }
  std::optional<OccupancyMap> world;  // what hides a cell of a layer may lie in another one
  if (command.visible_from) world = b->map;
  if (command.layer_z_m) {
    if (auto kept = keep_layer(*a, command.a, *command.layer_z_m); !kept) return tl::unexpected(kept.error());
    if (auto kept = keep_layer(*b, command.b, *command.layer_z_m); !kept) return tl::unexpected(kept.error());
  }
  if (command.occupied_probability) {
    if (const auto used = OccupancyArgs{.occupied_from = command.occupied_probability}.check(a->format); !used) {
      return fail(used.error().code, fmt::format("compare: {}: {}", command.a, used.error().message));
    }
    a->map = with_thresholds(a->map, thresholds_at(*command.occupied_probability, a->map.options().thresholds));
  }

  const bool has_bt = a->format == Format::kBt || b->format == Format::kBt;
  const Sameness sameness = has_bt ? Sameness::kOccupancy : Sameness::kLogOdds;
  const Result<MapComparison> found = compare_maps(a->map, b->map, sameness);
  if (!found) return tl::unexpected(found.error());
  std::optional<OccupancyMap> visible;
  AgreementOptions counted;
  if (command.visible_from) {
    Result<OccupancyMap> cells = visible_cells_of(command, b->map, *world);
    if (!cells) return tl::unexpected(cells.error());
    visible = *std::move(cells);
    counted = {judged_box(b->map), &*visible};
  }
  const MapAgreement agreement = agreement_of(a->map, b->map, counted);
  const auto text = [&] { return visible ? text_of(agreement) : text_of(*found, agreement, sameness); };
  const Result<void> summary = command.output_options.report == Report::kJson
                                   ? console.print(comparison_json(command, *found, agreement))
                                   : console.summarise(text(), "");
  if (!summary) return tl::unexpected(summary.error());
  return found->equal() ? 0 : 1;
}

}  // namespace pingvox::app
