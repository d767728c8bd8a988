#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "calibration_file.hpp"
#include "commands.hpp"
#include "json.hpp"
#include "map_log.hpp"
#include "map_report.hpp"
#include "nav_clock.hpp"
#include "nav_report.hpp"
#include "open_log.hpp"
#include "option_values.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/io/nav.hpp"
#include "pingvox/io/tum.hpp"
#include "pingvox/slam/slam_smoother.hpp"
#include "pingvox/sonar/device_profile.hpp"
#include "progress.hpp"
#include "stopwatch.hpp"

namespace pingvox::app {
namespace {

struct Seconds {
  double read = 0.0, field = 0.0, locate = 0.0, total = 0.0;
};

/// Motion of the vehicle, as far as it is known.
struct Motion {
  std::optional<Trajectory> odometry;
  std::string text = "none: the vehicle is assumed to move little";
  bool turns_only = false;  ///< x and y are not known
  std::optional<NavLog> nav;
  OdometryOptions nav_options;
  std::optional<NavOffset> clock;
  std::optional<Water> water;  ///< by the navigation log, where it was asked
  std::size_t skipped = 0;
  Eigen::Vector3d sonar_moved_m = Eigen::Vector3d::Zero();  ///< added to the place of the sonar: by a calibration
};

/// What was found.
struct Found {
  std::vector<StampedPose> poses;
  std::vector<bool> was_sure;         ///< of each pose, when it was known
  std::vector<std::size_t> segments;  ///< where each begins: between them the poses jump
  std::vector<bool> is_smoothed;      ///< of each pose: by all of the recording
  bool fits_always = false;           ///< the map, with the poses by all of the recording
  struct Span {
    double from_s, to_s;
  };
  std::vector<Span> sure;  ///< when the pose was sure
  bool is_sure = false;    ///< at the end
  std::vector<PoseHypothesis> hypotheses;
  std::size_t beams = 0, skipped = 0, most_particles = 0;
  double mean_particles = 0.0, from_s = 0.0, to_s = 0.0;
  double sound_speed_m_s = kAssumedSoundSpeed_m_s;
};

std::size_t smoothed_poses(const Found& found) {
  return static_cast<std::size_t>(std::ranges::count(found.is_smoothed, true));
}

Result<OccupancyMap> map_in(const std::string& name) {
  const Result<FileBytes> file = read_file(name);
  if (!file) return tl::unexpected(file.error());
  Result<MapFile> map = read_map(*file);
  if (!map) return tl::unexpected(map.error());
  return std::move(map->map);
}

Result<Motion> motion_of(const LocateCommand& command) {
  Motion motion;
  if (command.odometry) {
    Result<Trajectory> odometry = trajectory_of(command.odometry);
    if (!odometry) return tl::unexpected(odometry.error());
    motion.text = fmt::format("{} poses of {}", odometry->poses().size(), on_one_line(*command.odometry));
    motion.odometry = *std::move(odometry);
    return motion;
  }
  if (command.navs.empty()) return motion;
  const Result<NavFiles> nav = read_navs(command.navs, command.damage, command.bag.nav);
  if (!nav) return tl::unexpected(nav.error());
  motion.skipped = nav->damaged;
  if (command.nav_salinity) {
    const Result<Water> water = water_of(water_around(nav->log), *command.nav_salinity);
    if (!water) return tl::unexpected(water.error());
    motion.water = *water;
  }
  Result<NavOffset> offset =
      nav_offset(command.nav_offset_s, nav->log, {command.logs.front(), command.bag.beams}, command.damage);
  if (!offset) return tl::unexpected(offset.error());
  OdometryOptions options = command.nav;
  options.offset_s = offset->offset_s;
  options.turns = TurnsBy::kTurnRate;
  motion.clock = *std::move(offset);
  if (command.calibration) {
    const Result<Eigen::Vector3d> moved_m = use_calibration(*command.calibration, options);
    if (!moved_m) return tl::unexpected(moved_m.error());
    motion.sonar_moved_m = *moved_m;
  }
  Result<Odometry> odometry = odometry_of(nav->log, options);
  if (!odometry)
    return fail(odometry.error().code, fmt::format("{}: {}", fmt::join(command.navs, ", "), odometry.error().message));
  motion.text = odometry->velocity.empty()
                    ? fmt::format("heading of {}, no velocity", on_one_line(odometry->heading))
                    : fmt::format("velocity of {} along the heading of {}", on_one_line(odometry->velocity),
                                  on_one_line(odometry->heading));
  motion.turns_only = odometry->velocity.empty();
  if (motion.turns_only) motion.text += ": the vehicle is assumed to move little";
  motion.odometry = std::move(odometry->odometry_from_body);
  motion.nav = nav->log;
  motion.nav_options = std::move(options);
  return motion;
}

Result<std::vector<Beam>> beams_of(const LocateCommand& command, std::size_t& skipped) {
  std::vector<Beam> beams;
  for (const std::string& name : command.logs) {
    Result<ByteStream> stream = ByteStream::open(name);
    if (!stream) return tl::unexpected(stream.error());
    const std::string shown = stream->name();
    Result<Log> log = open_log(std::move(*stream), command.damage, std::nullopt, command.bag.beams);
    if (!log) return tl::unexpected(log.error());
    auto* source = std::get_if<std::unique_ptr<BeamSource>>(&*log);
    if (source == nullptr) {
      return fail(Error::Code::kUnsupported, fmt::format("{}: holds scans of points, not beams of a sonar", shown));
    }
    Result<std::vector<Beam>> read = read_all(**source);
    if (!read) return tl::unexpected(read.error());
    skipped += (*source)->skipped();
    std::ranges::move(*read, std::back_inserter(beams));
  }
  if (beams.empty())
    return fail(Error::Code::kUnsupported, fmt::format("{}: there are no beams", command.logs.front()));
  return beams;
}

/// The layer of the map around the sonar at the first beam.
DistanceFieldOptions layer_of(const LocateCommand& command, const std::optional<Pose>& first) {
  constexpr double kHalf_m = 0.5;
  const Pose body = first.value_or(Pose::Identity());
  const double z_m = (body * command.localizer.body_from_sonar.translation()).z();
  return {command.min_z_m.value_or(z_m - kHalf_m), command.max_z_m.value_or(z_m + kHalf_m)};
}

/// Puts the poses by all of the recording in the place of those that were found, from one to another, where the map
/// fits. False: it does not.
Result<bool> smooth(const SlamSmoother& smoother, const DistanceField& field, std::size_t from, std::size_t to,
                    Found& found) {
  const auto first = found.poses.begin() + static_cast<std::ptrdiff_t>(from);
  const Result<Trajectory> near = Trajectory::make({first, found.poses.begin() + static_cast<std::ptrdiff_t>(to)});
  if (!near) return false;
  const Result<SlamSolution> solution = smoother.solve_in(field, *near);
  if (!solution && solution.error().code == Error::Code::kUnsupported) return false;
  if (!solution) return tl::unexpected(solution.error());
  for (std::size_t i = from; i < to; ++i) {
    const auto better = solution->trajectory.at(found.poses[i].time_s);
    if (!better) continue;
    found.poses[i].map_from_body = *better;
    found.is_smoothed[i] = true;
  }
  return true;
}

/// Where the poses jump, as when the vehicle was carried away or was lost and is found.
std::vector<std::size_t> segments_of(const std::vector<StampedPose>& poses) {
  constexpr double kJump_m = 0.5, kFastest_m_s = 2.0;
  std::vector<std::size_t> segments = {0};
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double way_m =
        (poses[i].map_from_body.translation() - poses[i - 1].map_from_body.translation()).head<2>().norm();
    if (way_m > kJump_m + kFastest_m_s * (poses[i].time_s - poses[i - 1].time_s)) segments.push_back(i);
  }
  return segments;
}

/// The same of all poses, or else of each segment.
Result<void> smooth(const SlamSmoother& smoother, const DistanceField& field, Found& found) {
  const std::size_t count = found.poses.size();
  const Result<bool> fits = smooth(smoother, field, 0, count, found);
  if (!fits) return tl::unexpected(fits.error());
  found.fits_always = *fits;
  if (found.fits_always) found.segments = {0};
  if (found.segments.size() == 1) return {};
  for (std::size_t s = 0; s < found.segments.size(); ++s) {
    const std::size_t end = s + 1 < found.segments.size() ? found.segments[s + 1] : count;
    if (const auto done = smooth(smoother, field, found.segments[s], end, found); !done) {
      return tl::unexpected(done.error());
    }
  }
  return {};
}

/// The poses that are known to be right: those that were sure. With all of the recording also those of the same segment
/// before them, and after them where the map fits; and all where it fits all the time and one place is left at the end.
std::vector<bool> known_poses(const Found& found, Estimation estimation) {
  if (estimation == Estimation::kCausal) return found.was_sure;
  const bool is_one = !found.hypotheses.empty() && found.hypotheses.front().weight >= Localizer::kSureWeight;
  std::vector<bool> known(found.poses.size(), is_one && found.fits_always);
  for (std::size_t s = 0; s < found.segments.size(); ++s) {
    const std::size_t first = found.segments[s];
    const std::size_t end = s + 1 < found.segments.size() ? found.segments[s + 1] : known.size();
    bool is_known = false;
    for (std::size_t i = end; i-- > first;) {
      is_known = is_known || found.was_sure[i];
      known[i] = known[i] || is_known;
    }
    for (std::size_t i = first; i < end; ++i) known[i] = known[i] || (is_known && found.is_smoothed[i]);
  }
  return known;
}

/// The poses that are known to be right, with gaps between them. nullopt: none.
std::optional<Trajectory> sure_trajectory(const Found& found, const std::vector<bool>& known) {
  std::vector<StampedPose> poses;
  NavSource times;
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (!known[i]) continue;
    poses.push_back(found.poses[i]);
    times.samples.push_back({.time_s = found.poses[i].time_s});
  }
  if (poses.empty()) return std::nullopt;
  Result<Trajectory> trajectory = Trajectory::make(std::move(poses), summary_of(times).longest_step_s);
  return trajectory ? std::optional(*std::move(trajectory)) : std::nullopt;
}

SlamOptions smoother_options(const Motion& motion, const LocalizerOptions& localizer) {
  SlamOptions options;
  options.seed = localizer.seed;
  options.body_from_sonar = localizer.body_from_sonar;
  options.body_from_source = motion.nav_options.body_from_source;
  options.nav_offset_s = motion.nav_options.offset_s;
  options.calibration = motion.nav_options.calibration;
  options.filter = localizer.filter;
  options.sound_speed_ratio = localizer.sound_speed_ratio;
  options.echo = localizer.echo;
  return options;
}

Result<Found> locate(std::vector<Beam> beams, const Motion& motion, const DistanceField& field,
                     const LocateCommand& command) {
  LocalizerOptions options = command.localizer;
  if (motion.turns_only) options.noise = MotionNoise::turns_only();
  options.body_from_sonar.pretranslate(motion.sonar_moved_m);
  if (motion.water) options.sound_speed_ratio = sound_speed_ratio(*motion.water);
  Localizer localizer(field, options);
  std::optional<SlamSmoother> smoother;
  if (command.estimation == Estimation::kBatch && motion.nav && !motion.turns_only) {
    smoother.emplace(smoother_options(motion, options));
    if (const auto added = smoother->add(*motion.nav); !added) return tl::unexpected(added.error());
  }
  if (command.start) {
    const StartPose& start = *command.start;
    localizer.start(start.x_m, start.y_m, start.yaw_rad, start.deviation_m, start.deviation_rad);
  }
  Found found;
  found.beams = beams.size();
  found.sound_speed_m_s = options.sound_speed_ratio * kAssumedSoundSpeed_m_s;
  found.from_s = beams.front().time_s;
  ProgressBar bar(command.output_options);
  bool was_sure = false;
  double sum = 0.0;
  const auto note = [&](double time_s) {
    const std::optional<Localizer::Located> located = localizer.pose();
    if (!located) return;
    if (!found.poses.empty() && found.poses.back().time_s >= time_s) {
      found.poses.pop_back();
      found.was_sure.pop_back();
    }
    found.poses.push_back({time_s, located->map_from_body});
    found.is_sure = localizer.is_sure();
    found.was_sure.push_back(found.is_sure);
    if (found.is_sure && !was_sure) found.sure.push_back({time_s, time_s});
    if (found.is_sure) found.sure.back().to_s = time_s;
    was_sure = found.is_sure;
  };
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const double time_s = beams[i].time_s;
    if (smoother) smoother->add(beams[i]);
    if (bar.is_due()) bar.draw(static_cast<double>(i) / static_cast<double>(beams.size()), "locating");
    if (const auto pose = motion.odometry ? motion.odometry->at(time_s) : std::nullopt) localizer.add({time_s, *pose});
    if (const auto added = localizer.add(std::move(beams[i])); !added) {
      return fail(added.error().code, fmt::format("{}: {}", command.logs.front(), added.error().message));
    }
    note(time_s);
    sum += static_cast<double>(localizer.particles());
    found.most_particles = std::max(found.most_particles, localizer.particles());
    found.to_s = time_s;
  }
  localizer.finish();
  note(found.to_s);
  bar.clear();
  found.hypotheses = localizer.hypotheses();
  found.mean_particles = sum / static_cast<double>(beams.size());
  if (found.poses.empty()) {
    return fail(Error::Code::kUnsupported, fmt::format("{}: no echo fits anywhere in the map", command.logs.front()));
  }
  found.is_smoothed.assign(found.poses.size(), false);
  found.segments = segments_of(found.poses);
  if (smoother) {
    if (const auto done = smooth(*smoother, field, found); !done) {
      return fail(done.error().code, fmt::format("{}: {}", fmt::join(command.navs, ", "), done.error().message));
    }
  }
  return found;
}

JsonObject hypothesis_json(const PoseHypothesis& h) {
  JsonObject json;
  return json.add("x_m", h.x_m)
      .add("y_m", h.y_m)
      .add("yaw_deg", h.yaw_rad / kDegree_rad)
      .add("sd_m", h.deviation_m)
      .add("sd_deg", h.deviation_rad / kDegree_rad)
      .add("weight", h.weight);
}

/// @param unsure  poses that may be wrong
std::string json_of(const Found& found, std::size_t written, std::size_t unsure, const Motion& motion,
                    std::size_t field_bytes, const Seconds& seconds) {
  std::vector<JsonObject> hypotheses, spans;
  for (const PoseHypothesis& h : found.hypotheses) hypotheses.push_back(hypothesis_json(h));
  for (const Found::Span& span : found.sure) spans.emplace_back().add("from_s", span.from_s).add("to_s", span.to_s);
  JsonObject particles, took, json;
  particles.add("mean", found.mean_particles).add("max", found.most_particles);
  took.add("read", round_to_us(seconds.read))
      .add("field", round_to_us(seconds.field))
      .add("locate", round_to_us(seconds.locate))
      .add("total", round_to_us(seconds.total));
  json.add("poses", written)
      .add("unsure", unsure)
      .add("smoothed", smoothed_poses(found))
      .add("beams", found.beams)
      .add("skipped", found.skipped + motion.skipped)
      .add("sound_speed_m_s", found.sound_speed_m_s)
      .add("motion", motion.text);
  motion.clock ? json.add("nav_clock", json_of(*motion.clock)) : json.add_null("nav_clock");
  json.add_truth("sure", found.is_sure).add("hypotheses", hypotheses).add("sure_spans", spans);
  if (found.sure.empty()) {
    json.add_null("converged_at_s");
  } else {
    json.add("converged_at_s", found.sure.front().from_s);
  }
  json.add("particles", particles)
      .add("field_bytes", field_bytes)
      .add("recorded_s", found.to_s - found.from_s)
      .add("seconds", took);
  return json.text() + "\n";
}

std::string sure_text(const Found& found) {
  constexpr std::size_t kShown = 8;
  if (found.sure.empty()) return "never";
  std::string text = found.is_sure ? "at the end" : "not at the end";
  for (std::size_t i = 0; i < std::min(kShown, found.sure.size()); ++i) {
    text += fmt::format("{} {:.1f} to {:.1f}", i == 0 ? "; from" : ",", found.sure[i].from_s, found.sure[i].to_s);
  }
  text += " s";
  if (found.sure.size() > kShown) text += fmt::format(", and {} times more", found.sure.size() - kShown);
  return text;
}

std::string text_of(const Found& found, std::size_t written, std::size_t unsure, const Motion& motion,
                    const LocateCommand& command, const Seconds& seconds) {
  std::string text = written == 0            ? "no trajectory is written\n"
                     : command.output == "-" ? "standard output\n"
                                             : on_one_line(command.output) + "\n";
  text += report_line("motion", motion.text);
  if (motion.clock) text += report_line("nav clock", text_of(*motion.clock));
  if (motion.water) text += report_line("water", water_text(*motion.water));
  text += report_line(
      "trajectory",
      fmt::format("{} poses of {} beams, {} {}; {} by all of the recording; {:.0f} particles on average, {} at most",
                  written, found.beams, unsure, written == found.poses.size() ? "may be wrong" : "left out",
                  smoothed_poses(found), found.mean_particles, found.most_particles));
  constexpr std::size_t kShown = 8;
  for (const PoseHypothesis& h : std::span(found.hypotheses).first(std::min(kShown, found.hypotheses.size()))) {
    text += report_line("at the end",
                        fmt::format("{:.3f} {:.3f} m +- {:.3f}, {:.1f} +- {:.1f} degrees, weight {:.3f}", h.x_m, h.y_m,
                                    h.deviation_m, h.yaw_rad / kDegree_rad, h.deviation_rad / kDegree_rad, h.weight));
  }
  if (found.hypotheses.size() > kShown) {
    text += report_line("at the end", fmt::format("{} places more", found.hypotheses.size() - kShown));
  }
  text += report_line("sure", sure_text(found));
  return text +
         report_line("seconds", fmt::format("{:.3f} = {:.3f} read + {:.3f} distance field + {:.3f} locate + rest",
                                            seconds.total, seconds.read, seconds.field, seconds.locate));
}

}  // namespace

Result<int> run(const LocateCommand& command, Console& console) {
  const Stopwatch total;
  Seconds seconds;
  const Stopwatch read;
  const Result<OccupancyMap> map = map_in(command.map);
  if (!map) return tl::unexpected(map.error());
  const Result<Motion> motion = motion_of(command);
  if (!motion) return tl::unexpected(motion.error());
  std::size_t skipped = 0;
  Result<std::vector<Beam>> beams = beams_of(command, skipped);
  if (!beams) return tl::unexpected(beams.error());
  seconds.read = read.seconds();

  std::optional<Pose> first;
  if (motion->odometry) {
    for (const Beam& beam : *beams) {
      first = motion->odometry->at(beam.time_s);
      if (first) break;
    }
    if (!first) {
      return fail(Error::Code::kUnsupported,
                  fmt::format("{}: beams and navigation do not overlap in time: the beams are from {:.3f} to {:.3f} s, "
                              "the navigation is from {:.3f} to {:.3f} s",
                              command.logs.front(), beams->front().time_s, beams->back().time_s,
                              motion->odometry->poses().front().time_s, motion->odometry->poses().back().time_s));
    }
  }
  const Stopwatch making;
  Result<DistanceField> field = DistanceField::make(*map, layer_of(command, first));
  if (!field) {
    return fail(field.error().code,
                fmt::format("{}: {} (see --min-z and --max-z)", command.map, field.error().message));
  }
  const std::size_t field_bytes = field->memory_bytes();
  seconds.field = making.seconds();

  const Stopwatch locating;
  Result<Found> found = locate(*std::move(beams), *motion, *field, command);
  if (!found) return tl::unexpected(found.error());
  found->skipped = skipped;
  seconds.locate = locating.seconds();

  const std::vector<bool> known = known_poses(*found, command.estimation);
  const auto unsure = static_cast<std::size_t>(std::ranges::count(known, false));
  std::optional<Trajectory> trajectory;
  if (command.written == WrittenPoses::kSure) {
    trajectory = sure_trajectory(*found, known);
  } else {
    Result<Trajectory> all = Trajectory::make(found->poses);
    if (!all) return tl::unexpected(all.error());
    trajectory = *std::move(all);
    if (unsure > 0) {
      console.say(
          fmt::format("{}: {} of {} poses may be wrong, while several places fit, or none does: --only-sure "
                      "leaves them out",
                      command.logs.front(), unsure, found->poses.size()));
    }
  }
  const std::size_t written = trajectory ? trajectory->poses().size() : 0;
  if (trajectory) {
    const auto done = write_file(command.output, [&](std::ostream& out) { return write_tum(*trajectory, out); });
    if (!done) return tl::unexpected(done.error());
  }
  seconds.total = total.seconds();
  const Result<void> summary =
      command.output_options.report == Report::kJson
          ? console.print(json_of(*found, written, unsure, *motion, field_bytes, seconds))
          : console.summarise(text_of(*found, written, unsure, *motion, command, seconds), command.output);
  if (!summary) return tl::unexpected(summary.error());
  if (!trajectory) {
    return fail(Error::Code::kUnsupported,
                fmt::format("{}: it is never sure where the vehicle was", command.logs.front()));
  }
  return 0;
}

}  // namespace pingvox::app
