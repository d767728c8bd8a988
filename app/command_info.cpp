#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "commands.hpp"
#include "console.hpp"
#include "info_summary.hpp"
#include "io/internal/json.hpp"
#include "map_report.hpp"
#include "nav/internal/trajectory_steps.hpp"
#include "nav_report.hpp"
#include "open_log.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/io/mesh.hpp"
#include "pingvox/io/nav.hpp"
#include "pingvox/io/tum.hpp"
#include "pingvox/nav/receiver_clock.hpp"
#include "step_report.hpp"

namespace pingvox::app {
namespace {

Result<Summary> summarize_scans(ScanSource& source, const std::string& name, Format format) {
  std::size_t scans = 0, points = 0;
  std::optional<double> first_s, last_s;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  std::optional<Box> bounds;
  for (;;) {
    const Result<std::optional<PointScan>> scan = source.next();
    if (!scan) return tl::unexpected(scan.error());
    if (!*scan) break;
    ++scans;
    origin = (*scan)->origin_m;
    if (const std::optional<double> time_s = (*scan)->time_s) {
      first_s = std::min(first_s.value_or(*time_s), *time_s);
      last_s = std::max(last_s.value_or(*time_s), *time_s);
    }
    points += (*scan)->points_m.size();
    for (const Eigen::Vector3d& point : (*scan)->points_m) {
      if (!bounds) bounds = Box{point, point};
      bounds->min = bounds->min.cwiseMin(point);
      bounds->max = bounds->max.cwiseMax(point);
    }
  }
  Summary summary;
  summary.text = headline(name, format);
  if (kind_of(format) == FormatKind::kCloud) {
    summary.json.add("kind", "cloud").add("format", name_of(format)).add("points", points).add("origin", origin);
    summary.text +=
        report_line("points", fmt::format("{}", points)) +
        report_line("seen from", fmt::format("{:.6g}, {:.6g}, {:.6g} m", origin.x(), origin.y(), origin.z()));
  } else {
    summary.json.add("kind", "scans").add("format", name_of(format)).add("scans", scans).add("points", points);
    summary.text += report_line("scans", fmt::format("{} with {} points", scans, points));
  }
  if (first_s) {
    summary.json.add("duration_s", *last_s - *first_s);
    summary.text += report_line("duration", duration_text(*first_s, *last_s));
  }
  summary.json.add("bounds", bounds_json(bounds)).add("skipped", source.skipped());
  summary.text += report_line("bounds", bounds_text(bounds) + (first_s ? ", around the sensor" : ""));
  if (source.skipped() > 0) summary.text += skipped_line(source);
  return summary;
}

Result<Summary> summarize_log(ByteStream stream, Format format, Damage damage, const BeamTopic& topic = {}) {
  const std::string name = stream.name();
  const Result<Log> log = open_file_log(std::move(stream), damage, topic);
  if (!log) return tl::unexpected(log.error());
  const auto* const beams = std::get_if<std::unique_ptr<BeamSource>>(&*log);
  return beams != nullptr ? summarize_beams(**beams, name, format)
                          : summarize_scans(*std::get<std::unique_ptr<ScanSource>>(*log), name, format);
}

Result<Summary> summarize_map(const FileBytes& file) {
  const Result<MapFile> read = read_map(file);
  if (!read) return tl::unexpected(read.error());
  const OccupancyMap& map = read->map;
  const MapCounts counts = map.counts();
  Summary summary;
  summary.json.add("kind", "map")
      .add("format", name_of(read->format))
      .add("resolution", map.lattice().resolution_m())
      .add("depth", map.lattice().depth())
      .add("nodes", counts.nodes())
      .add("leaves", counts.leaves)
      .add("inner", counts.inner)
      .add("occupied_cells", counts.occupied_cells)
      .add("free_cells", counts.free_cells)
      .add("bounds", bounds_json(map.bounds()))
      .add("memory_bytes", map.memory_bytes());
  summary.text = headline(file.name, read->format) + map_text(map, counts);
  if (!read->made_by.empty()) summary.text += report_line("made by", on_one_line(read->made_by));
  return summary;
}

Result<Summary> summarize_mesh(const FileBytes& file, Format format) {
  const Result<TriangleMesh> mesh = read_mesh(file);
  if (!mesh) return tl::unexpected(mesh.error());
  Box bounds{mesh->vertices_m.front(), mesh->vertices_m.front()};  // a mesh has a triangle
  for (const Eigen::Vector3d& vertex : mesh->vertices_m) {
    bounds = {bounds.min.cwiseMin(vertex), bounds.max.cwiseMax(vertex)};
  }
  Summary summary;
  summary.json.add("kind", "mesh")
      .add("format", name_of(format))
      .add("vertices", mesh->vertices_m.size())
      .add("triangles", mesh->triangles.size())
      .add("bounds", bounds_json(bounds));
  summary.text = headline(file.name, format) + report_line("vertices", fmt::format("{}", mesh->vertices_m.size())) +
                 report_line("triangles", fmt::format("{}", mesh->triangles.size())) +
                 report_line("bounds", bounds_text(bounds));
  return summary;
}

Result<Summary> summarize_trajectory(const FileBytes& file, Format format) {
  const Result<Trajectory> trajectory = read_tum(file);
  if (!trajectory) return tl::unexpected(trajectory.error());
  const std::vector<StampedPose>& poses = trajectory->poses();
  Box bounds{poses.front().map_from_body.translation(), poses.front().map_from_body.translation()};
  double length_m = 0.0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Eigen::Vector3d position = poses[i].map_from_body.translation();
    length_m += (position - poses[i - 1].map_from_body.translation()).norm();
    bounds = {bounds.min.cwiseMin(position), bounds.max.cwiseMax(position)};
  }
  const double duration_s = poses.back().time_s - poses.front().time_s;
  const CutTrajectory cut = cut_at_steps(*trajectory);
  Summary summary;
  summary.json.add("kind", "trajectory")
      .add("format", name_of(format))
      .add("poses", poses.size())
      .add("duration_s", duration_s)
      .add("length_m", length_m)
      .add("bounds", bounds_json(bounds))
      .add("left_out", left_out(cut.steps));
  if (!cut.steps.empty()) summary.json.add("steps", steps_json(cut.steps));
  summary.text = headline(file.name, format) + report_line("poses", fmt::format("{}", poses.size())) +
                 report_line("duration", duration_text(poses.front().time_s, poses.back().time_s)) +
                 report_line("length", fmt::format("{:.6g} m", length_m)) + report_line("bounds", bounds_text(bounds));
  for (const std::string& step : step_texts(cut.steps, cut.trajectory.poses().size() + left_out(cut.steps)))
    summary.text += report_line("step", step);
  return summary;
}

Result<Summary> summarize_nav(const FileBytes& file, Format format, Damage damage) {
  const Result<NavFile> nav = read_nav(file, damage);
  if (!nav) return tl::unexpected(nav.error());
  Summary summary;
  summary.json.add("kind", "nav").add("format", name_of(format));
  add_nav(summary.json, *nav);
  summary.text = headline(file.name, format) + nav_text(*nav);
  add_damage(summary, nav->damage);
  return summary;
}

std::string_view name_of(BagTopicSummary::Use use) {
  using Use = BagTopicSummary::Use;
  switch (use) {
    case Use::kBeams:
      return "beams";
    case Use::kScans:
      return "scans";
    case Use::kNavigation:
      return "navigation";
    default:
      return "";
  }
}

void add_topics(Summary& summary, const std::vector<BagTopicSummary>& topics) {
  std::vector<JsonObject> list;
  std::size_t widest = 5;
  for (const BagTopicSummary& topic : topics) widest = std::max(widest, on_one_line(topic.name).size());
  summary.text += fmt::format("  {:<{}} {:>9}  {:<10}  type\n", "topic", widest, "messages", "read as");
  for (const BagTopicSummary& topic : topics) {
    JsonObject& json = list.emplace_back().add("name", topic.name).add("type", topic.type);
    json.add("messages", topic.messages).add("read_as", name_of(topic.use));
    if (!topic.fields.empty()) json.add("fields", topic.fields);
    summary.text += fmt::format("  {:<{}} {:>9}  {:<10}  {}\n", on_one_line(topic.name), widest, topic.messages,
                                name_of(topic.use), on_one_line(topic.type));
  }
  summary.json.add("topics", std::span<const JsonObject>(list));
}

/// The first fields of many.
std::string first_fields(const std::string& fields) {
  constexpr std::size_t kShown = 200;  // characters
  if (fields.size() <= kShown) return fields;
  return fields.substr(0, fields.rfind(',', kShown)) + ", ... (all with --json)";
}

/// What --fields can name.
std::string other_fields_text(const std::vector<BagTopicSummary>& topics) {
  std::string text;
  for (const BagTopicSummary& topic : topics) {
    if (topic.fields.empty()) continue;
    text += fmt::format("  {}: {}\n", on_one_line(topic.name), on_one_line(first_fields(topic.fields)));
  }
  return text.empty() ? text : "fields in the messages of other topics (for --fields):\n" + text;
}

/// A bag without beams. @param reason  why those of its topics cannot be used; "": none is of a sonar
Summary summarize_contents(const BagContents& bag, const std::string& name, Format format, const std::string& reason) {
  Summary summary;
  summary.json.add("kind", "nav").add("format", name_of(format));
  add_nav(summary.json, bag.nav);
  summary.text = headline(name, format);
  if (!reason.empty()) {
    summary.json.add("no_beams", reason);
    summary.text += report_line("no beams", on_one_line(reason));
  }
  summary.text += nav_text(bag.nav);
  for (const std::string& note : bag.notes) summary.text += report_line("tf", on_one_line(note));
  add_damage(summary, bag.nav.damage);
  add_topics(summary, bag.topics);
  summary.text += other_fields_text(bag.topics);
  return summary;
}

/// A bag: its beams, or what else it holds, then its topics and its navigation.
Result<Summary> summarize_bag(ByteStream stream, Format format, const InfoCommand& command) {
  const std::string name = stream.name();
  // --strict refuses the beams with the same words.
  Result<BagContents> bag = bag_contents(stream, command.damage, command.bag.nav);
  if (!bag) return tl::unexpected(bag.error());
  const std::string by_fields = command.bag.beams.fields ? command.bag.beams.name : "";
  for (BagTopicSummary& topic : bag->topics) {
    if (topic.name != by_fields) continue;
    topic.use = BagTopicSummary::Use::kBeams;
    topic.fields.clear();
  }
  const bool is_navigated = !bag->nav.log.sources().empty();
  using Use = BagTopicSummary::Use;
  const bool has_log = has(*bag, Use::kBeams) || has(*bag, Use::kScans);
  const bool has_other_encoding =
      std::ranges::any_of(bag->topics, [](const BagTopicSummary& topic) { return !topic.other_encoding.empty(); });
  if (!has_log && !command.bag.beams.fields && !has_other_encoding) return summarize_contents(*bag, name, format, "");
  Result<Summary> summary = summarize_log(std::move(stream), format, command.damage, command.bag.beams);
  // Messages of a sonar's type may hold nothing.
  const bool has_none = !summary && summary.error().code == Error::Code::kUnsupported && (is_navigated || !has_log);
  // Of several topics with scans none is chosen.
  const bool has_only_scans =
      !summary && has(*bag, Use::kScans) && !has(*bag, Use::kBeams) && command.damage == Damage::kSkip;
  if ((has_none || has_only_scans) && command.bag.beams.name.empty()) {
    // Of scans that cannot be read, the reason is worth more than the choice of a topic.
    const bool is_damaged = summary.error().code == Error::Code::kCorrupt;
    return summarize_contents(*bag, name, format, has_only_scans && !is_damaged ? "" : summary.error().message);
  }
  if (!summary) return summary;
  add_topics(*summary, bag->topics);
  if (is_navigated) {
    JsonObject nav;
    add_nav(nav, bag->nav);
    summary->json.add("nav", nav);
    summary->text += "navigation (--nav):\n" + nav_text(bag->nav);
  }
  for (const std::string& note : bag->notes) summary->text += report_line("tf", on_one_line(note));
  summary->text += other_fields_text(bag->topics);
  return summary;
}

Result<Summary> summarize_file(ByteStream stream, const InfoCommand& command) {
  const Damage damage = command.damage;
  const std::vector<LimitedOption>& limited = command.limited;
  const Result<Format> format = identify_format(stream);
  if (!format) return tl::unexpected(format.error());
  if (const auto used = check_limited(limited, {kind_text(kind_of(*format))}); !used) {
    return fail(used.error().code, "info: " + used.error().message);
  }
  if (is_bag(*format)) return summarize_bag(std::move(stream), *format, command);
  const FileBytes& file = stream.held();
  switch (kind_of(*format)) {
    case FormatKind::kMap:
      return summarize_map(file);
    case FormatKind::kMesh:
      return summarize_mesh(file, *format);
    case FormatKind::kTrajectory:
      return summarize_trajectory(file, *format);
    case FormatKind::kNav:
      return summarize_nav(file, *format, damage);
    default:
      return summarize_log(std::move(stream), *format, damage, command.bag.beams);
  }
}

}  // namespace

Result<int> run(const InfoCommand& command, Console& console) {
  Result<ByteStream> stream = ByteStream::open(command.file);
  if (!stream) return tl::unexpected(stream.error());
  const Result<Summary> summary = summarize_file(std::move(*stream), command);
  if (!summary) return tl::unexpected(summary.error());
  const bool json = command.output_options.report == Report::kJson;
  if (const auto printed = console.print(json ? summary->json.text() + "\n" : summary->text); !printed) {
    return tl::unexpected(printed.error());
  }
  return 0;
}

}  // namespace pingvox::app
