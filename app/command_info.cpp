#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "console.hpp"
#include "json.hpp"
#include "map_report.hpp"
#include "nav_report.hpp"
#include "open_log.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/io/mesh.hpp"
#include "pingvox/io/nav.hpp"
#include "pingvox/io/tum.hpp"
#include "pingvox/mapping/beam_model.hpp"
#include "pingvox/nav/receiver_clock.hpp"
#include "pingvox/nav/time_order.hpp"
#include "pingvox/nav/trajectory_steps.hpp"
#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/filters.hpp"
#include "pingvox/sonar/sweep.hpp"
#include "step_report.hpp"
#include "threshold_range.hpp"

namespace pingvox::app {
namespace {

/// A report as text and JSON.
struct Summary {
  JsonObject json;
  std::string text;
};

std::string headline(const std::string& name, Format format) {
  return fmt::format("{}: {}\n", on_one_line(name), description_of(format));
}

/// Angle covered by the head: a full turn, or all but the widest gap between bearings.
double sector_deg(std::vector<double> bearings_rad, bool has_turn) {
  if (has_turn) return 360.0;
  if (bearings_rad.empty()) return 0.0;
  constexpr double kTurn_rad = 2.0 * std::numbers::pi;
  std::sort(bearings_rad.begin(), bearings_rad.end());
  double widest = bearings_rad.front() + kTurn_rad - bearings_rad.back();
  for (std::size_t i = 1; i < bearings_rad.size(); ++i) {
    widest = std::max(widest, bearings_rad[i] - bearings_rad[i - 1]);
  }
  return rounded_degrees(kTurn_rad - widest);
}

std::string_view name_of(BeamClock clock) {
  switch (clock) {
    case BeamClock::kTimeOfDay:
      return "time of day";
    case BeamClock::kNone:
      return "none";
    default:
      return "own";
  }
}

void add_device(Summary& summary, const DeviceProfile& device, Format format) {
  const double width_deg = rounded_degrees(device.beam_width_rad), height_deg = rounded_degrees(device.beam_height_rad);
  JsonObject json;
  json.add("name", device.name)
      .add("beam_width_deg", width_deg)
      .add("beam_height_deg", height_deg)
      .add("blanking_m", device.blanking_m)
      .add("full_scale", device.full_scale);
  summary.json.add("device", json);
  summary.text += report_line(
      "device", fmt::format("{}, beam {:.6g} x {:.6g} degrees (--device); its maker's minimum range is {:.6g} m",
                            device.title, width_deg, height_deg, device.blanking_m));
  // Bins that were hit have none.
  if (format != Format::kBeamHits) summary.text += report_line("intensities", std::string(device.intensity));
}

void add_damage(Summary& summary, const std::vector<DamageKind>& kinds) {
  if (kinds.empty()) return;
  std::vector<JsonObject> list;
  for (const DamageKind& kind : kinds) {
    JsonObject& json = list.emplace_back();
    json.add("what", kind.what).add("count", kind.count);
    if (kind.first_byte) json.add("first_byte", *kind.first_byte);
    summary.text +=
        report_line("", fmt::format("{} x {}", kind.count, kind.what) +
                            (kind.first_byte ? fmt::format(", first at byte {}", *kind.first_byte) : std::string()));
  }
  summary.json.add("damage", std::span<const JsonObject>(list));
}

using BinLengths = std::vector<std::pair<double, std::size_t>>;  ///< [m], with the beams that have it
constexpr std::size_t kMaxListed = 8;

/// As a report shows a length.
std::string length_text(double length_m) {
  return fmt::format("{:.6g}", length_m);
}

/// Lengths that a report shows alike are one: that of most beams. They differ by rounding.
/// @param beams  by length
BinLengths distinct_lengths(const std::map<double, std::size_t>& beams) {
  BinLengths lengths;
  std::size_t most = 0;
  for (const auto& [length_m, count] : beams) {
    if (lengths.empty() || length_text(lengths.back().first) != length_text(length_m)) {
      lengths.emplace_back(length_m, count);
      most = count;
      continue;
    }
    lengths.back().second += count;
    if (count <= most) continue;
    lengths.back().first = length_m;
    most = count;
  }
  return lengths;
}

std::string lengths_text(const BinLengths& lengths) {
  if (lengths.size() == 1) return length_text(lengths.front().first) + " m";
  std::string text;
  for (std::size_t i = 0; i < std::min(lengths.size(), kMaxListed); ++i) {
    text += fmt::format("{}{} m ({})", i == 0 ? "" : ", ", length_text(lengths[i].first),
                        counted(lengths[i].second, "beam"));
  }
  return lengths.size() > kMaxListed ? text + fmt::format(" and {} more", lengths.size() - kMaxListed) : text;
}

/// {"0.0125": 400}: beams by bin length.
JsonObject lengths_json(const BinLengths& lengths) {
  JsonObject json;
  for (std::size_t i = 0; i < std::min(lengths.size(), kMaxListed); ++i) {
    json.add(length_text(lengths[i].first), lengths[i].second);
  }
  return json;
}

/// Ascending numbers with ranges: "2-5, 8".
std::string numbers_text(const std::vector<std::size_t>& numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    text += fmt::format("{}{}", text.empty() ? "" : ", ", numbers[i]);
    if (last > i) text += fmt::format("-{}", numbers[last]);
    i = last + 1;
  }
  return text;
}

template <typename Source>
std::string skipped_line(const Source& source) {
  return report_line("skipped", damage_text(source.skipped(), source.first_damage()));
}

class BeamSurvey {
 public:
  void add(const Beam& beam) {
    if (beams_++ == 0) first_s_ = last_s_ = beam.time_s;
    first_s_ = std::min(first_s_, beam.time_s);
    last_s_ = std::max(last_s_, beam.time_s);
    order_.add(beam.time_s);
    fewest_bins_ = std::min(fewest_bins_, beam.intensities.size());
    most_bins_ = std::max(most_bins_, beam.intensities.size());
    longest_m_ = std::max(longest_m_, static_cast<double>(beam.intensities.size()) * beam.bin_length_m);
    ++bin_lengths_[beam.bin_length_m];
    constexpr double kStep_rad = 1e-4 * kDegree_rad;
    bearings_rad_.insert(std::round(beam.bearing_rad / kStep_rad) * kStep_rad);
    take(assembler_.add(beam));
  }

  Summary finish(const std::string& name, Format format, const BeamSource& source) {
    const std::size_t skipped = source.skipped();
    take(assembler_.finish());
    // Most frequent first.
    BinLengths lengths = distinct_lengths(bin_lengths_);
    std::sort(lengths.begin(), lengths.end(),
              [](const auto& a, const auto& b) { return std::pair(b.second, a.first) < std::pair(a.second, b.first); });
    const std::size_t fewest = beams_ > 0 ? fewest_bins_ : 0;
    const double sector = sector_deg({bearings_rad_.begin(), bearings_rad_.end()}, has_turn_);
    Summary summary;
    JsonObject bins, threshold;
    if (thresholds_.min) {
      threshold.add("min", *thresholds_.min).add("max", *thresholds_.max);
    } else {
      threshold.add_null("min").add_null("max");
    }
    bins.add("min", fewest).add("max", most_bins_);
    summary.json.add("kind", "log")
        .add("format", name_of(format))
        .add("beams", beams_)
        .add("sweeps", complete_.size())
        .add("all_sweeps", sweeps_)
        .add("bins", bins)
        .add("bin_length_m", beams_ > 0 ? lengths.front().first : std::numeric_limits<double>::quiet_NaN())
        .add("bin_lengths", lengths_json(lengths))
        .add("duration_s", last_s_ - first_s_)
        .add("clock", name_of(source.clock()))
        .add("late", order_.late())
        .add("sector_deg", sector)
        .add("echoes", echoes_)
        .add("threshold", threshold)
        .add("skipped", skipped);
    summary.text =
        headline(name, format) + report_line("beams", fmt::format("{}", beams_)) + report_line("sweeps", sweeps_text());
    if (beams_ > 0) {
      summary.text += report_line("bins", fewest == most_bins_ ? fmt::format("{} per beam", fewest)
                                                               : fmt::format("{} to {} per beam", fewest, most_bins_)) +
                      report_line("bin length", lengths_text(lengths)) +
                      report_line("range", fmt::format("{:.6g} m", longest_m_)) +
                      report_line("sector", fmt::format("{:.6g} degrees", sector)) +
                      report_line("duration", beam_duration_text(source.clock())) + order_text() +
                      report_line("echoes", fmt::format("{}, threshold {}", echoes_, thresholds_.text(std::nullopt)));
    }
    if (const DeviceProfile* device = source.device()) {
      add_device(summary, *device, format);
    } else {
      const BeamModelOptions assumed;
      summary.text +=
          report_line("device", fmt::format("not named: a beam of {:.6g} x {:.6g} degrees is assumed (--device)",
                                            rounded_degrees(assumed.width_rad), rounded_degrees(assumed.height_rad)));
    }
    if (const std::string note = source.note(); !note.empty()) {
      summary.json.add("note", note);
      summary.text += report_line("note", on_one_line(note));
    }
    if (skipped > 0) summary.text += skipped_line(source);
    add_damage(summary, source.damage());
    return summary;
  }

 private:
  std::string sweeps_text() const {
    if (sweeps_ == 0) return "0";
    if (complete_.size() == sweeps_) return fmt::format("{}, all complete", sweeps_);
    if (complete_.empty()) return fmt::format("{}, none complete", sweeps_);
    return fmt::format("{}, complete: {}", sweeps_, numbers_text(complete_));
  }

  std::string beam_duration_text(BeamClock clock) const {
    if (clock == BeamClock::kNone) return "not known: the log has no times";
    const std::string text = duration_text(first_s_, last_s_);
    if (clock == BeamClock::kTimeOfDay) return text + " of the day";
    if (first_s_ < kFirstDate_s && last_s_ >= kFirstDate_s) {
      return fmt::format("{} to {}: its clock was not set all the time", text, date_text(last_s_));
    }
    return date_text(first_s_).empty() ? text : text + " by its clock";
  }

  /// Of beams that came after later ones.
  std::string order_text() const {
    if (const std::optional<ClockStep> step = order_.step_back()) {
      return report_line("clock back",
                         fmt::format("by {:.3f} s, from {:.3f} to {:.3f} s; {} late", step->from_s - step->to_s,
                                     step->from_s, step->to_s, counted(step->late, "beam")));
    }
    if (order_.late() == 0) return "";
    return report_line("late", counted(order_.late(), "beam") + " behind a later one: messages were swapped");
  }

  void take(const std::optional<Sweep>& sweep) {
    if (!sweep) return;
    ++sweeps_;
    const auto echoes = detect_echoes(apply_filter(PolarImage(*sweep), FilterOptions{}), *sweep, EchoOptions{});
    echoes_ +=
        static_cast<std::size_t>(std::ranges::count_if(echoes, [](const auto& echo) { return echo.has_value(); }));
    thresholds_.add(echoes);
    if (sweep->extent == Sweep::Extent::kCut) return;
    complete_.push_back(sweeps_);
    has_turn_ = has_turn_ || sweep->extent == Sweep::Extent::kTurn;
  }

  std::size_t beams_ = 0, sweeps_ = 0, echoes_ = 0;
  std::vector<std::size_t> complete_;  ///< numbers of the complete sweeps, from 1
  ThresholdRange thresholds_;
  std::size_t fewest_bins_ = std::numeric_limits<std::size_t>::max(), most_bins_ = 0;
  double first_s_ = 0.0, last_s_ = 0.0, longest_m_ = 0.0;
  bool has_turn_ = false;
  std::map<double, std::size_t> bin_lengths_;
  TimeOrder order_;
  std::set<double> bearings_rad_;  ///< rounded: their number is bounded, however long the log
  SweepAssembler assembler_;
};

Result<Summary> summarize(BeamSource& source, const std::string& name, Format format) {
  BeamSurvey survey;
  for (;;) {
    const Result<std::optional<Beam>> beam = source.next();
    if (!beam) return tl::unexpected(beam.error());
    if (!*beam) return survey.finish(name, format, source);
    survey.add(**beam);
  }
}

Result<Summary> summarize(ScanSource& source, const std::string& name, Format format) {
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
  return std::visit([&](const auto& source) { return summarize(*source, name, format); }, *log);
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
