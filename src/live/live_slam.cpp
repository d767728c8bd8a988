#include "live/live_slam.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "nav/internal/navigation.hpp"

namespace pingvox {
namespace {

constexpr double kToDecide_s = 5.0;
/// Where a navigation device has sent nothing yet: a DVL that is switched on with the sonar takes that long.
constexpr double kForDevices_s = 30.0;
/// A beam waits so long for samples of its time, and its pose may be that much older.
constexpr double kPatienceOfSlam_s = 1.0;
/// Sources that were silent for longer are not waited for.
constexpr double kSilent_s = 2.0;
/// Without beams, samples of so long are kept for when they come.
constexpr double kKept_s = 60.0;
/// No correction begins for so many times the duration of the last one.
constexpr double kPause_corrections = 30.0;
/// Beams are not mapped at poses with a larger deviation.
constexpr double kMaxDeviation_m = 3.0;
/// After so many solutions NotLocated is reported. One turn of the head finds the vehicle, another one confirms it, and
/// among walls that look alike it takes some more.
constexpr std::size_t kSolutionsToLocate = 6;

bool gives_motion(NavQuantity quantity) {
  const auto& moves = kReckoningQuantities;
  return quantity == NavQuantity::kDepth || quantity == NavQuantity::kPressure ||
         std::ranges::find(moves, quantity) != moves.end();
}

/// Its mount, filter, echoes and speed of sound.
SlamOptions with_sonar_of(const BuildOptions& build, SlamOptions options) {
  options.body_from_sonar = build.body_from_sensor;
  options.filter = build.filter;
  options.echo = build.echo;
  options.sound_speed_ratio = build.sound_speed_ratio;
  return options;
}

}  // namespace

Result<LiveSlam> LiveSlam::make(SlamOptions options, std::size_t devices, const BuildOptions& build,
                                const MapOptions& map) {
  options = with_sonar_of(build, std::move(options));
  if (const auto valid = options.validate(); !valid) return tl::unexpected(valid.error());
  return RebuiltMap::make(build, map).map([&](RebuiltMap made) {
    return LiveSlam(std::move(options), devices, std::move(made));
  });
}

Result<LiveSlam> LiveSlam::make(SlamOptions options, std::size_t devices, const BuildOptions& build, KnownMap known) {
  options = with_sonar_of(build, std::move(options));
  if (const auto valid = options.validate(); !valid) return tl::unexpected(valid.error());
  return RebuiltMap::extend(build, std::move(known.map)).map([&](RebuiltMap map) {
    LocalizerOptions localizer;
    localizer.seed = options.seed;
    localizer.body_from_sonar = options.body_from_sonar;
    localizer.filter = options.filter;
    localizer.echo = options.echo;
    localizer.sound_speed_ratio = options.sound_speed_ratio;
    LiveSlam slam(std::move(options), devices, std::move(map));
    slam.map_name_ = std::move(known.name);
    slam.locator_.emplace(std::move(localizer), known.start);
    return slam;
  });
}

LiveSlam::LiveSlam(SlamOptions options, std::size_t devices, RebuiltMap map)
    : options_(std::move(options)),
      has_sent_(devices),
      cell_m_(map.map().lattice().resolution_m()),
      map_(std::move(map)) {}

LiveSlam::Source& LiveSlam::source_of(std::size_t device, const std::string& name, NavQuantity quantity) {
  const auto known = std::ranges::find_if(sources_, [&](const Source& source) {
    return source.waiting.quantity == quantity && source.waiting.name == name;
  });
  if (known != sources_.end()) return *known;
  // In the order of a recording, whose devices come one after the other.
  const auto place = std::ranges::upper_bound(sources_, device, {}, &Source::device);
  return *sources_.insert(place, {device, {name, quantity, {}}, -std::numeric_limits<double>::infinity()});
}

void LiveSlam::add(std::size_t device, const std::string& source, NavQuantity quantity, const NavSample& sample) {
  if (device < has_sent_.size()) has_sent_[device] = true;
  if (!gives_motion(quantity) || !std::isfinite(sample.time_s) || !sample.value.allFinite()) return;
  Source& to = source_of(device, source, quantity);
  to.last_s = std::max(to.last_s, sample.time_s);
  if (!slam_) {
    std::vector<NavSample>& waiting = to.waiting.samples;
    waiting.push_back(sample);
    if (waiting.front().time_s < sample.time_s - 2.0 * kKept_s) {
      std::erase_if(waiting, [&](const NavSample& old) { return old.time_s < sample.time_s - kKept_s; });
    }
  } else if (const auto added = slam_->add(source, quantity, sample); !added) {
    note_failure(added.error());
  }
}

bool LiveSlam::may_come(double beam_s, double now_s) const {
  if (!slam_) {
    const bool is_complete = std::ranges::find(has_sent_, false) == has_sent_.end();
    return !has_sent_.empty() && now_s < beam_s + (is_complete ? kToDecide_s : kForDevices_s);
  }
  if (now_s >= beam_s + kPatienceOfSlam_s) return false;
  return std::ranges::any_of(
      sources_, [&](const Source& source) { return source.last_s < beam_s && source.last_s > beam_s - kSilent_s; });
}

/// A velocity counts also where the device has not found the bottom yet.
void LiveSlam::decide() {
  std::vector<NavSource> sources;
  for (const Source& source : sources_) sources.push_back(source.waiting);
  const auto has = [&](NavQuantity quantity) {
    return std::ranges::any_of(sources, [&](const NavSource& source) { return source.quantity == quantity; });
  };
  const bool has_turns = has(NavQuantity::kHeading) || has(NavQuantity::kAttitude) || has(NavQuantity::kTurnRate);
  const bool has_velocity = has(NavQuantity::kVelocity) && has_turns;
  LiveMotion& motion = status_.motion;
  motion = has_turns ? LiveMotion::kSonarAndHeading : LiveMotion::kSonar;
  if (has_velocity) motion = LiveMotion::kVelocity;
  options_.motion = has_velocity ? MotionSource::kVelocity : MotionSource::kSonar;

  live_event::MotionChosen chosen{.motion = motion, .velocity = {}, .heading = {}, .deviation_m_sqrt_s = std::nullopt};
  if (const Result<NavLog> log = NavLog::make(sources, NavClock::kUnknown)) {
    if (const NavSource* fastest = has_velocity ? log->best(NavQuantity::kVelocity) : nullptr) {
      chosen.velocity = fastest->name;
      const auto velocity = velocity_source(*fastest, mount_of(options_.body_from_source, fastest->name));
      if (velocity) chosen.deviation_m_sqrt_s = velocity->density.values().back();
    }
    if (const auto mounts = check_mounts(*log, options_.body_from_source); !mounts) note_failure(mounts.error());
    if (const auto heading = best_heading(*log, options_.body_from_source)) chosen.heading = heading->name;
  }
  events_.emplace_back(std::move(chosen));

  slam_.emplace(options_);
  for (Source& source : sources_) {
    for (const NavSample& sample : std::exchange(source.waiting.samples, {})) {
      const auto added = slam_->add(source.waiting.name, source.waiting.quantity, sample);
      if (!added) note_failure(added.error());
    }
  }
}

Result<void> LiveSlam::add(Beam beam, double now_s) {
  if (!slam_) decide();
  if (locator_) locator_->add(beam);
  if (const auto added = slam_->add(beam); !added) note_failure(added.error());
  if (slam_->solutions() > solutions_) compare_with_solution();
  const std::optional<Pose> pose = pose_at(beam.time_s);
  mapped_.push_back({beam.time_s, pose});
  const Result<void> mapped = map_.add(std::move(beam), pose);
  return mapped ? update(now_s) : mapped;
}

Pose LiveSlam::in_map(const Pose& slam_from_body) const {
  return map_from_slam_ ? *map_from_slam_ * slam_from_body : slam_from_body;
}

/// nullopt also for an old beam: the path will have it.
std::optional<Pose> LiveSlam::pose_at(double beam_s) {
  const std::optional<PredictedPose> last = slam_->predict(beam_s);
  if (!last) return std::nullopt;
  if (status_.motion == LiveMotion::kVelocity) {  // else it is known by the sweep
    note_velocity(*last);
    if (last->pose.time_s < beam_s - kPatienceOfSlam_s || last->deviation_m > kMaxDeviation_m) return std::nullopt;
  }
  if (!is_located()) return std::nullopt;
  return in_map(last->pose.map_from_body);
}

std::optional<StampedPose> LiveSlam::pose() const {
  const auto last = slam_ && is_located() ? slam_->predict(std::numeric_limits<double>::infinity()) : std::nullopt;
  const bool is_known = last && (status_.motion != LiveMotion::kVelocity || last->deviation_m <= kMaxDeviation_m);
  return is_known ? std::optional(StampedPose{last->pose.time_s, in_map(last->pose.map_from_body)}) : std::nullopt;
}

/// Reports when the velocity ends and resumes.
void LiveSlam::note_velocity(const PredictedPose& pose) {
  const double before_s = std::exchange(status_.without_velocity_s, pose.without_velocity_s);
  status_.deviation_m = pose.deviation_m;
  const bool is_without = pose.without_velocity_s > kPatienceOfSlam_s;
  const bool was_without = std::exchange(is_without_velocity_, is_without);
  if (is_without && !was_without) events_.emplace_back(live_event::VelocityEnded{slam_->motion()->velocity});
  if (!is_without && was_without) {
    events_.emplace_back(live_event::VelocityResumed{slam_->motion()->velocity, before_s});
  }
  const bool is_uncertain = pose.deviation_m > kMaxDeviation_m;
  const bool was_uncertain = std::exchange(is_uncertain_, is_uncertain);
  if (is_uncertain && !was_uncertain) events_.emplace_back(live_event::PositionUncertain{pose.deviation_m});
}

void LiveSlam::note_failure(const Error& error) {
  if (!std::exchange(has_failed_, true)) events_.emplace_back(live_event::SlamFailed{error});
}

/// Whether beams of the map have moved by more than a cell, or have a pose now.
void LiveSlam::compare_with_solution() {
  solutions_ = slam_->solutions();
  const std::vector<StampedPose> newest = slam_->newest_path();
  if (newest.empty()) return;
  // The last solution of those before it stays.
  while (!mapped_.empty() && mapped_.front().time_s < newest.front().time_s) mapped_.pop_front();
  const std::size_t loops = slam_->loops().kept, loops_before = std::exchange(status_.loops, loops);
  if (locator_) locate(newest);
  if (!is_located()) return;
  moved_m_ = 0.0;
  auto pose = newest.begin();
  for (const MappedBeam& beam : mapped_) {
    while (pose != newest.end() && pose->time_s < beam.time_s) ++pose;
    if (pose == newest.end()) break;
    if (pose->time_s > beam.time_s) continue;
    if (!beam.map_from_body) {
      is_outdated_ = true;
      continue;
    }
    const Eigen::Vector3d place_m = in_map(pose->map_from_body).translation();
    moved_m_ = std::max(moved_m_, (place_m - beam.map_from_body->translation()).head<2>().norm());
  }
  if (loops > loops_before) events_.emplace_back(live_event::LoopClosed{loops - loops_before, moved_m_});
  is_outdated_ = is_outdated_ || moved_m_ > cell_m_ || loops > loops_before;
}

void LiveSlam::locate(const std::vector<StampedPose>& newest) {
  // Until it is located no beam is mapped: the map is the known one.
  const auto located = locator_->update(newest, map_.map());
  if (!located) {
    note_failure({located.error().code, fmt::format("{}: {}", map_name_, located.error().message)});
  } else if (*located) {
    const Pose2& map_from_slam = (*located)->map_from_slam;
    map_from_slam_ =
        pose_from_rpy({map_from_slam.place_m.x(), map_from_slam.place_m.y(), 0.0}, 0.0, 0.0, map_from_slam.yaw_rad);
    status_.located = (*located)->where;
    events_.emplace_back(live_event::Located{map_name_, (*located)->where});
    locator_.reset();
    is_outdated_ = true;
  } else if (locator_->solutions() == kSolutionsToLocate) {
    events_.emplace_back(
        live_event::NotLocated{map_name_, kSolutionsToLocate * SlamOptions::kMinCausalSweeps, locator_->hypotheses()});
  }
}

Result<void> LiveSlam::update(double now_s) {
  Result<void> updated = map_.update();
  if (!updated || map_.is_rebuilding()) return updated;
  if (std::exchange(is_correcting_, false)) may_correct_s_ = now_s + kPause_corrections * (now_s - corrected_s_);
  if (!is_outdated_ || now_s < may_correct_s_ || !slam_) return {};
  const std::optional<Trajectory> path = estimated_path();
  if (!path) return {};
  corrected_s_ = now_s;
  return correct(*path);
}

Result<void> LiveSlam::correct(const Trajectory& path) {
  is_outdated_ = false;
  is_correcting_ = true;
  ++status_.corrections;
  const double end_s = path.poses().back().time_s;
  Pose moved = Pose::Identity();
  for (MappedBeam& beam : mapped_) {
    const std::optional<Pose> pose = path.at(beam.time_s);
    if (pose && beam.map_from_body) moved = *pose * beam.map_from_body->inverse();
    if (pose) beam.map_from_body = pose;
    if (!pose && beam.map_from_body && beam.time_s > end_s) beam.map_from_body = moved * *beam.map_from_body;
  }
  return map_.correct(path);
}

/// The beams after the end of the path are where the map has them.
Trajectory LiveSlam::with_last_beams(const Trajectory& path) const {
  std::vector<StampedPose> poses = path.poses();
  Pose moved = Pose::Identity();
  for (const MappedBeam& beam : mapped_) {
    if (!beam.map_from_body) continue;
    if (const auto pose = path.at(beam.time_s)) moved = *pose * beam.map_from_body->inverse();
    if (beam.time_s > poses.back().time_s) poses.push_back({beam.time_s, moved * *beam.map_from_body});
  }
  Result<Trajectory> longer = Trajectory::make(std::move(poses), path.longest_step_s(), path.cuts());
  return longer ? *std::move(longer) : path;
}

Result<void> LiveSlam::finish() {
  if (!slam_) decide();
  Result<void> all = map_.finish();
  Result<SlamSolution> solved = slam_->finish();
  if (solved) {
    solution_ = *std::move(solved);
  } else if (all) {
    all = tl::unexpected(solved.error());
  }
  if (const std::vector<StampedPose> newest = slam_->newest_path(); locator_ && !newest.empty()) locate(newest);
  if (!is_located() && all) {
    all = fail(Error::Code::kUnsupported,
               fmt::format("{}: the vehicle was not located in this map: it is not extended", map_name_));
  }
  if (std::optional<Trajectory> path = estimated_path()) {
    path_ = with_last_beams(*path);
    if (const auto corrected = correct(*path_); !corrected && all) all = corrected;
  }
  if (const auto waited = map_.wait(); !waited && all) all = waited;
  return all;
}

/// In the frame of the map.
std::optional<Trajectory> LiveSlam::estimated_path() const {
  std::optional<Trajectory> path = slam_ && is_located() ? slam_->path() : std::nullopt;
  if (!path || !map_from_slam_) return path;
  std::vector<StampedPose> poses = path->poses();
  for (StampedPose& pose : poses) pose.map_from_body = in_map(pose.map_from_body);
  Result<Trajectory> moved = Trajectory::make(std::move(poses), path->longest_step_s(), path->cuts());
  return moved ? std::optional(*std::move(moved)) : std::nullopt;
}

std::optional<Trajectory> LiveSlam::path() const {
  return path_ ? path_ : estimated_path();
}

LiveSlamStatus LiveSlam::status() const {
  LiveSlamStatus status = status_;
  if (slam_) status.by = slam_->motion();
  if (const auto last =
          slam_ && is_located() ? slam_->predict(std::numeric_limits<double>::infinity()) : std::nullopt) {
    status.predicted = {last->pose.time_s, in_map(last->pose.map_from_body)};
  }
  status.is_correcting = map_.is_rebuilding();
  return status;
}

}  // namespace pingvox
