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
#include "json.hpp"
#include "map_report.hpp"
#include "open_log.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/io/mesh.hpp"
#include "pingvox/io/tum.hpp"
#include "pingvox/sonar/sweep.hpp"

namespace pingvox::app {
namespace {

/// A report in both forms.
struct Told {
  JsonObject json;
  std::string text;
};

std::string headline(const std::string& name, Format format) {
  return fmt::format("{}: {}\n", on_one_line(name), described(format));
}

/// Angle that the head covered: a full turn, or all but the widest gap between two bearings.
double sector_deg(std::vector<double> bearings_rad, bool has_turn) {
  if (has_turn) return 360.0;
  if (bearings_rad.empty()) return 0.0;
  constexpr double kTurn_rad = 2.0 * std::numbers::pi;
  std::sort(bearings_rad.begin(), bearings_rad.end());
  double widest = bearings_rad.front() + kTurn_rad - bearings_rad.back();
  for (std::size_t i = 1; i < bearings_rad.size(); ++i) {
    widest = std::max(widest, bearings_rad[i] - bearings_rad[i - 1]);
  }
  // A bearing is never known better than to a millionth of a degree: rounded, so that 90 is not 90.00000000000001.
  return std::round((kTurn_rad - widest) / std::numbers::pi * 180.0 * 1e6) / 1e6;
}

void add_device(Told& told, const DeviceProfile& device) {
  const auto degrees = [](double angle_rad) { return std::round(angle_rad / std::numbers::pi * 180.0 * 1e6) / 1e6; };
  const double width_deg = degrees(device.beam_width_rad), height_deg = degrees(device.beam_height_rad);
  JsonObject json;
  json.add("name", device.name)
      .add("beam_width_deg", width_deg)
      .add("beam_height_deg", height_deg)
      .add("blanking_m", device.blanking_m)
      .add("full_scale", device.full_scale);
  told.json.add("device", json);
  told.text += report_line("device", fmt::format("{}, beam {:.6g} x {:.6g} degrees, hears from {:.6g} m (--device)",
                                                 device.title, width_deg, height_deg, device.blanking_m)) +
               report_line("intensities", std::string(device.intensity));
}

void add_damage(Told& told, const std::vector<DamageKind>& kinds) {
  if (kinds.empty()) return;
  std::vector<JsonObject> list;
  for (const DamageKind& kind : kinds) {
    list.emplace_back().add("what", kind.what).add("count", kind.count).add("first_byte", kind.first_byte);
    told.text += report_line("", fmt::format("{} x {}, first at byte {}", kind.count, kind.what, kind.first_byte));
  }
  told.json.add("damage", std::span<const JsonObject>(list));
}

class BeamSurvey {
 public:
  void add(const Beam& beam) {
    if (beams_++ == 0) first_s_ = last_s_ = beam.time_s;
    first_s_ = std::min(first_s_, beam.time_s);
    last_s_ = std::max(last_s_, beam.time_s);
    fewest_bins_ = std::min(fewest_bins_, beam.intensities.size());
    most_bins_ = std::max(most_bins_, beam.intensities.size());
    longest_m_ = std::max(longest_m_, static_cast<double>(beam.intensities.size()) * beam.bin_length_m);
    ++bin_lengths_[beam.bin_length_m];
    bearings_rad_.insert(beam.bearing_rad);
    count(assembler_.add(beam));
  }

  Told finish(const std::string& name, Format format, const BeamSource& source) {
    const std::size_t skipped = source.skipped();
    count(assembler_.finish());
    // Of a log whose settings changed, the bin length of most beams.
    const auto usual = std::max_element(bin_lengths_.begin(), bin_lengths_.end(),
                                        [](const auto& a, const auto& b) { return a.second < b.second; });
    const std::size_t fewest = beams_ > 0 ? fewest_bins_ : 0;
    const double sector = sector_deg({bearings_rad_.begin(), bearings_rad_.end()}, has_turn_);
    Told told;
    JsonObject bins;
    bins.add("min", fewest).add("max", most_bins_);
    told.json.add("kind", "log")
        .add("format", name_of(format))
        .add("beams", beams_)
        .add("sweeps", sweeps_)
        .add("bins", bins)
        .add("bin_length_m", beams_ > 0 ? usual->first : std::numeric_limits<double>::quiet_NaN())
        .add("duration_s", last_s_ - first_s_)
        .add("sector_deg", sector)
        .add("skipped", skipped);
    told.text = headline(name, format) + report_line("beams", fmt::format("{}, {} complete sweeps", beams_, sweeps_));
    if (beams_ > 0) {
      const std::string lengths =
          bin_lengths_.size() > 1 ? fmt::format(" in most beams ({} lengths)", bin_lengths_.size()) : "";
      told.text += report_line("bins", fewest == most_bins_ ? fmt::format("{} a beam", fewest)
                                                            : fmt::format("{} to {} a beam", fewest, most_bins_)) +
                   report_line("bin length", fmt::format("{:.6g} m{}", usual->first, lengths)) +
                   report_line("range", fmt::format("{:.6g} m", longest_m_)) +
                   report_line("sector", fmt::format("{:.6g} degrees", sector)) +
                   report_line("duration", fmt::format("{:.3f} s, from {:.3f} s", last_s_ - first_s_, first_s_));
    }
    if (const DeviceProfile* device = source.device()) add_device(told, *device);
    if (skipped > 0) told.text += report_line("left out", fmt::format("{} damaged", skipped));
    add_damage(told, source.damage());
    return told;
  }

 private:
  void count(const std::optional<Sweep>& sweep) {
    if (!sweep || sweep->extent == Sweep::Extent::kCut) return;
    ++sweeps_;
    has_turn_ = has_turn_ || sweep->extent == Sweep::Extent::kTurn;
  }

  std::size_t beams_ = 0, sweeps_ = 0;
  std::size_t fewest_bins_ = std::numeric_limits<std::size_t>::max(), most_bins_ = 0;
  double first_s_ = 0.0, last_s_ = 0.0, longest_m_ = 0.0;
  bool has_turn_ = false;
  std::map<double, std::size_t> bin_lengths_;
  std::set<double> bearings_rad_;  ///< a head has so many and no more, however long the log is
  SweepAssembler assembler_;
};

Result<Told> told_of(BeamSource& source, const std::string& name, Format format) {
  BeamSurvey survey;
  for (;;) {
    const Result<std::optional<Beam>> beam = source.next();
    if (!beam) return tl::unexpected(beam.error());
    if (!*beam) return survey.finish(name, format, source);
    survey.add(**beam);
  }
}

Result<Told> told_of(ScanSource& source, const std::string& name, Format format) {
  std::size_t scans = 0, points = 0;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  std::optional<Box> bounds;
  for (;;) {
    const Result<std::optional<PointScan>> scan = source.next();
    if (!scan) return tl::unexpected(scan.error());
    if (!*scan) break;
    ++scans;
    origin = (*scan)->origin_m;
    points += (*scan)->points_m.size();
    for (const Eigen::Vector3d& point : (*scan)->points_m) {
      if (!bounds) bounds = Box{point, point};
      bounds->min = bounds->min.cwiseMin(point);
      bounds->max = bounds->max.cwiseMax(point);
    }
  }
  Told told;
  told.text = headline(name, format);
  if (kind_of(format) == FormatKind::kCloud) {
    told.json.add("kind", "cloud").add("format", name_of(format)).add("points", points).add("origin", origin);
    told.text += report_line("points", fmt::format("{}", points)) +
                 report_line("seen from", fmt::format("{:.6g}, {:.6g}, {:.6g} m", origin.x(), origin.y(), origin.z()));
  } else {
    told.json.add("kind", "scans").add("format", name_of(format)).add("scans", scans).add("points", points);
    told.text += report_line("scans", fmt::format("{} with {} points", scans, points));
  }
  told.json.add("bounds", bounds_json(bounds)).add("skipped", source.skipped());
  told.text += report_line("bounds", bounds_text(bounds));
  if (source.skipped() > 0) told.text += report_line("left out", fmt::format("{} damaged", source.skipped()));
  return told;
}

Result<Told> told_of_log(ByteStream stream, Format format, Damage damage) {
  const std::string name = stream.name();
  const Result<Log> log = open_log(std::move(stream), damage);
  if (!log) return tl::unexpected(log.error());
  return std::visit([&](const auto& source) { return told_of(*source, name, format); }, *log);
}

Result<Told> told_of_map(const FileBytes& file) {
  const Result<MapFile> read = read_map(file);
  if (!read) return tl::unexpected(read.error());
  const OccupancyMap& map = read->map;
  const MapCounts counts = map.counts();
  Told told;
  told.json.add("kind", "map")
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
  told.text = headline(file.name, read->format) + map_text(map, counts);
  if (!read->made_by.empty()) told.text += report_line("made by", on_one_line(read->made_by));
  return told;
}

Result<Told> told_of_mesh(const FileBytes& file, Format format) {
  const Result<TriangleMesh> mesh = read_mesh(file);
  if (!mesh) return tl::unexpected(mesh.error());
  Box bounds{mesh->vertices_m.front(), mesh->vertices_m.front()};  // a mesh has a triangle
  for (const Eigen::Vector3d& vertex : mesh->vertices_m) {
    bounds = {bounds.min.cwiseMin(vertex), bounds.max.cwiseMax(vertex)};
  }
  Told told;
  told.json.add("kind", "mesh")
      .add("format", name_of(format))
      .add("vertices", mesh->vertices_m.size())
      .add("triangles", mesh->triangles.size())
      .add("bounds", bounds_json(bounds));
  told.text = headline(file.name, format) + report_line("vertices", fmt::format("{}", mesh->vertices_m.size())) +
              report_line("triangles", fmt::format("{}", mesh->triangles.size())) +
              report_line("bounds", bounds_text(bounds));
  return told;
}

Result<Told> told_of_trajectory(const FileBytes& file, Format format) {
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
  Told told;
  told.json.add("kind", "trajectory")
      .add("format", name_of(format))
      .add("poses", poses.size())
      .add("duration_s", duration_s)
      .add("length_m", length_m)
      .add("bounds", bounds_json(bounds));
  told.text = headline(file.name, format) + report_line("poses", fmt::format("{}", poses.size())) +
              report_line("duration", fmt::format("{:.3f} s, from {:.3f} s", duration_s, poses.front().time_s)) +
              report_line("length", fmt::format("{:.6g} m", length_m)) + report_line("bounds", bounds_text(bounds));
  return told;
}

Result<Told> told_of_file(ByteStream stream, Damage damage) {
  const Result<Format> format = recognised(stream);
  if (!format) return tl::unexpected(format.error());
  const FileBytes& file = stream.held();
  switch (kind_of(*format)) {
    case FormatKind::kMap:
      return told_of_map(file);
    case FormatKind::kMesh:
      return told_of_mesh(file, *format);
    case FormatKind::kTrajectory:
      return told_of_trajectory(file, *format);
    default:
      return told_of_log(std::move(stream), *format, damage);
  }
}

}  // namespace

Result<int> run(const InfoCommand& command, Console& console) {
  Result<ByteStream> stream = ByteStream::open(command.file);
  if (!stream) return tl::unexpected(stream.error());
  const Result<Told> told = told_of_file(std::move(*stream), command.damage);
  if (!told) return tl::unexpected(told.error());
  const bool json = command.manner.report == Report::kJson;
  if (const auto printed = console.print(json ? told->json.text() + "\n" : told->text); !printed) {
    return tl::unexpected(printed.error());
  }
  return 0;
}

}  // namespace pingvox::app
