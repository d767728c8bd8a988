#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/without_exceptions.hpp"
#include "pingvox/sonar/background.hpp"
#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/filters.hpp"
#include "pingvox/sonar/polar_image.hpp"
#include "pingvox/sonar/sound_speed.hpp"
#include "pingvox/sonar/sweep.hpp"
#include "pingvox/web/scene.hpp"
#include "web/echo_display.hpp"
#include "web/point_collector.hpp"

namespace pingvox::web {
namespace {

/// Rows of intensities of different lengths. When they take too much memory their bins are joined.
class RowCollector {
 public:
  /// @return by how much the bins of the row are longer than those that were given; later rows may change it
  void add(std::span<const std::uint8_t> bins) {
    groups_.push_back(group_for(bins.size()));
    rows_.push_back(join_bins(bins, groups_.back()));
    bytes_ += rows_.back().size();
    if (bytes_ > kMaxBytes && max_bins_ > kMinBins) halve();
  }

  /// Puts rows of one length into the log, and the lengths of their bins into its beams.
  void finish(SceneLog& log) {
    for (const auto& row : rows_) log.bins = std::max(log.bins, row.size());
    log.intensities.reserve(log.bins * rows_.size());
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      log.beams[i].bin_length_m *= static_cast<double>(groups_[i]);
      log.intensities.insert(log.intensities.end(), rows_[i].begin(), rows_[i].end());
      log.intensities.resize(log.bins * (i + 1));
      rows_[i] = {};
    }
  }

  bool is_halved() const { return max_bins_ < SceneLog::kMaxBins; }

 private:
  static constexpr std::size_t kMaxBytes = std::size_t{1} << 28, kMinBins = 32;

  std::size_t group_for(std::size_t bins) const { return std::max<std::size_t>((bins + max_bins_ - 1) / max_bins_, 1); }

  void halve() {
    max_bins_ /= 2;
    bytes_ = 0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const std::size_t group = group_for(rows_[i].size());
      rows_[i] = join_bins(rows_[i], group);
      groups_[i] *= group;
      bytes_ += rows_[i].size();
    }
  }

  std::size_t max_bins_ = SceneLog::kMaxBins;
  std::size_t bytes_ = 0;
  std::vector<std::vector<std::uint8_t>> rows_;
  std::vector<std::size_t> groups_;  ///< bins that one of a row is made of
};

/// The level that the detector compared with, as far as it is known (SceneBeam::threshold).
std::optional<double> threshold_of(const EchoOptions& options, const std::optional<Echo>& echo,
                                   std::span<const std::uint8_t> filtered) {
  if (const std::optional<double> level = level_of(options, echo)) return level;
  return echo ? std::optional<double>(filtered[echo->first]) : std::nullopt;
}

/// Detects the echoes of a log sweep by sweep, as BeamMapper does.
class LogCollector {
 public:
  LogCollector(SceneLog& log, const BuildOptions& build) : log_(log), build_(build) {}

  void add(Beam beam) {
    if (const auto sweep = assembler_.add(std::move(beam))) take(*sweep);
  }

  void finish() {
    if (const auto sweep = assembler_.finish()) take(*sweep);
    rows_.finish(log_);
  }

  bool has_joined_bins() const { return rows_.is_halved(); }

 private:
  void take(const Sweep& sweep) {
    const PolarImage filtered = apply_filter(PolarImage(sweep), build_.filter);
    const std::vector<std::optional<Echo>> echoes = detect_echoes(filtered, sweep, build_.echo);
    for (std::size_t i = 0; i < sweep.beams.size(); ++i) {
      const Beam& beam = sweep.beams[i];
      SceneBeam shown{.time_s = beam.time_s,
                      .bearing_rad = beam.bearing_rad,
                      .bin_length_m = beam.bin_length_m,
                      .threshold = threshold_of(build_.echo, echoes[i], filtered.row(i)),
                      .sweep = sweeps_};
      if (echoes[i]) show_echo(*echoes[i], build_.model, shown);
      log_.beams.push_back(shown);
      rows_.add(beam.intensities);
    }
    ++sweeps_;
  }

  SceneLog& log_;
  const BuildOptions& build_;
  SweepAssembler assembler_;
  RowCollector rows_;
  std::uint32_t sweeps_ = 0;
};

Result<void> add_beams(const Recording& recording, BeamSource& source, const std::string& name, const VehiclePath& path,
                       const BuildOptions& build, std::optional<std::size_t> path_index, Scene& scene) {
  const RecordingOptions& of = recording.options();
  BuildOptions options = build;
  options.model = of.head.apply_to(build.model, source.device());
  SceneLog log;
  log.name = name;
  log.beam_width_rad = options.model.width_rad;
  log.beam_height_rad = options.model.height_rad;
  log.body_from_sonar = of.body_from_sonar;
  log.body_from_sonar.pretranslate(path.sonar_moved_m);
  log.path = path_index;
  LogCollector collector(log, options);
  for (;;) {
    Result<std::optional<Beam>> beam = source.next();
    if (!beam) return tl::unexpected(beam.error());
    if (!*beam) break;
    (*beam)->bin_length_m *= options.sound_speed_ratio;
    collector.add(std::move(**beam));
  }
  collector.finish();
  if (log.beams.empty()) return {};
  if (collector.has_joined_bins()) {
    scene.notes.push_back(fmt::format("{}: long log, its beams are shown with {} bins", name, log.bins));
  }
  scene.logs.push_back(std::move(log));
  return {};
}

/// The points of scans where the map has them.
Result<void> add_scans(const Recording& recording, ScanSource& source, const std::string& name, const VehiclePath& path,
                       Scene& scene) {
  Pose body_from_sensor = recording.options().body_from_sonar;
  body_from_sensor.pretranslate(path.sonar_moved_m);
  PointCollector points;
  for (;;) {
    const Result<std::optional<PointScan>> scan = source.next();
    if (!scan) return tl::unexpected(scan.error());
    if (!*scan) break;
    const PointScan& next = **scan;
    Pose map_from_points = Pose::Identity();
    if (next.time_s && !next.has_points_in_map) {
      const std::optional<Pose> map_from_body = path.trajectory.at(*next.time_s);
      if (!map_from_body) continue;
      map_from_points = *map_from_body * body_from_sensor;
    }
    for (const Eigen::Vector3d& point_m : next.points_m) points.add(map_from_points * point_m);
  }
  points.finish(name, scene);
  return {};
}

Result<void> add_logs(const Recording& recording, const VehiclePath& path, const BuildOptions& build, Scene& scene) {
  BuildOptions options = build;
  if (recording.water()) options.sound_speed_ratio = sound_speed_ratio(*recording.water());
  std::optional<std::size_t> path_index;
  if (path.trajectory.poses().size() > 1) {
    path_index = scene.paths.size();
    add_path("the vehicle", path.trajectory, scene);
  }
  std::optional<Background> background;
  for (std::size_t i = 0; i < recording.logs().size(); ++i) {
    Result<OpenedLog> log = recording.open_log(i);
    if (!log) return tl::unexpected(log.error());
    if (const auto done = subtract_background(recording, *log, background); !done) return done;
    const std::string name = std::filesystem::path(log->name).filename().string();
    const Result<void> added = log->beams() != nullptr
                                   ? add_beams(recording, *log->beams(), name, path, options, path_index, scene)
                                   : add_scans(recording, *log->scans(), name, path, scene);
    if (!added) return added;
  }
  return {};
}

}  // namespace

Result<void> add_recording(const Recording& recording, const VehiclePath& path, const BuildOptions& build,
                           Scene& scene) {
  return detail::without_exceptions([&] { return add_logs(recording, path, build, scene); });
}

}  // namespace pingvox::web
