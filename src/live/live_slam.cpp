#include "live/live_slam.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "nav/internal/navigation.hpp"

namespace pingvox {
namespace {

constexpr double kToDecide_s = 5.0;
/// A beam waits so long for samples of its time, and its pose may be that much older.
constexpr double kPatienceOfSlam_s = 1.0;
/// A source that was silent for longer is not waited for.
constexpr double kSilent_s = 2.0;
/// Without beams, samples of so long are kept for when they come.
constexpr double kKept_s = 60.0;
/// Of the time that a correction takes, none begins for so many times after it.
constexpr double kPause_corrections = 30.0;

bool tells_motion(NavQuantity quantity) {
  const auto& moves = kReckoningQuantities;
  return quantity == NavQuantity::kDepth || quantity == NavQuantity::kPressure ||
         std::ranges::find(moves, quantity) != moves.end();
}

}  // namespace

Result<LiveSlam> LiveSlam::make(SlamOptions options, Navigation navigation, const BuildOptions& build,
                                const MapOptions& map) {
  options.body_from_sonar = build.body_from_sensor;
  options.filter = build.filter;
  options.echo = build.echo;
  options.sound_speed_ratio = build.sound_speed_ratio;
  if (const auto valid = options.validate(); !valid) return tl::unexpected(valid.error());
  Result<RebuiltMap> made = RebuiltMap::make(build, map);
  if (!made) return tl::unexpected(made.error());
  const double cell_m = made->map().lattice().resolution_m();
  return LiveSlam(std::move(options), navigation, cell_m, *std::move(made));
}

LiveSlam::LiveSlam(SlamOptions options, Navigation navigation, double cell_m, RebuiltMap map)
    : options_(std::move(options)), navigation_(navigation), cell_m_(cell_m), map_(std::move(map)) {}

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
  if (!tells_motion(quantity) || !std::isfinite(sample.time_s) || !sample.value.allFinite()) return;
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
  if (!slam_) return navigation_ == Navigation::kSome && now_s < beam_s + kToDecide_s;
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
  motion_ = has_turns ? LiveMotion::kSonarAndHeading : LiveMotion::kSonar;
  if (has_velocity) motion_ = LiveMotion::kVelocity;
  options_.motion = has_velocity ? MotionSource::kVelocity : MotionSource::kSonar;

  live_event::MotionChosen chosen{.motion = motion_, .velocity = {}, .heading = {}, .deviation_m_sqrt_s = std::nullopt};
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
  if (const auto added = slam_->add(beam); !added) note_failure(added.error());
  if (slam_->solutions() > solutions_) compare_with_solution();
  const std::optional<Pose> pose = pose_at(beam.time_s);
  mapped_.push_back({beam.time_s, pose});
  const Result<void> mapped = map_.add(std::move(beam), pose);
  return mapped ? update(now_s) : mapped;
}

/// nullopt also of one that is old: the path will tell it.
std::optional<Pose> LiveSlam::pose_at(double beam_s) const {
  const std::optional<StampedPose> last = slam_->pose(beam_s);
  const bool is_of_sonar = motion_ != LiveMotion::kVelocity;  // known by the sweep
  if (!last || (!is_of_sonar && last->time_s < beam_s - kPatienceOfSlam_s)) return std::nullopt;
  return last->map_from_body;
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
    moved_m_ = std::max(
        moved_m_, (pose->map_from_body.translation() - beam.map_from_body->translation()).template head<2>().norm());
  }
  const std::size_t loops = slam_->loops().kept;
  if (loops > loops_) events_.emplace_back(live_event::LoopClosed{loops - loops_, moved_m_});
  is_outdated_ = is_outdated_ || moved_m_ > cell_m_ || loops > loops_;
  loops_ = loops;
}

Result<void> LiveSlam::update(double now_s) {
  Result<void> updated = map_.update();
  if (!updated || map_.is_rebuilding()) return updated;
  if (std::exchange(is_correcting_, false)) may_correct_s_ = now_s + kPause_corrections * (now_s - corrected_s_);
  if (!is_outdated_ || now_s < may_correct_s_ || !slam_) return {};
  const std::optional<Trajectory> path = slam_->path();
  if (!path) return {};
  corrected_s_ = now_s;
  return correct(*path);
}

Result<void> LiveSlam::correct(const Trajectory& path) {
  is_outdated_ = false;
  is_correcting_ = true;
  ++corrections_;
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
  if (std::optional<Trajectory> path = slam_->path()) {
    path_ = with_last_beams(*path);
    if (const auto corrected = correct(*path_); !corrected && all) all = corrected;
  }
  if (const auto waited = map_.wait(); !waited && all) all = waited;
  return all;
}

std::optional<Trajectory> LiveSlam::path() const {
  if (path_) return path_;
  return slam_ ? slam_->path() : std::nullopt;
}

LiveSlamStatus LiveSlam::status() const {
  LiveSlamStatus status;
  status.motion = motion_;
  if (slam_) status.by = slam_->motion();
  status.loops = loops_;
  status.corrections = corrections_;
  status.is_correcting = map_.is_rebuilding();
  return status;
}

}  // namespace pingvox
