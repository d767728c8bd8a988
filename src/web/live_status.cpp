#include "web/live_status.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string_view>
#include <vector>

#include "live/internal/motion_name.hpp"
#include "mapping/internal/obstacle_sectors.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/sonar/device_profile.hpp"

namespace pingvox::web {
namespace {

constexpr double kTurn_deg = 360.0;

std::string_view gain_name(ReceiverGain gain) {
  constexpr std::array<std::string_view, 3> kNames = {"low", "normal", "high"};
  return kNames[static_cast<std::size_t>(gain)];
}

/// In degrees counter-clockwise from ahead: step and sector.
struct HeadAngles {
  double step_deg = 0.0;
  std::optional<std::array<double, 2>> sector_deg;
};

double signed_deg(double degrees) {
  return std::remainder(degrees, kTurn_deg);
}

HeadAngles angles_of(const LiveHead& head) {
  constexpr double kGrads = 400.0, kMicronSteps = 6400.0;
  HeadAngles angles;
  const auto sector = [&](double first, double width, double steps) {
    // Clockwise angles whose middle is ahead.
    const double to = signed_deg(-(first - steps / 2.0) * kTurn_deg / steps);
    angles.sector_deg = {to - width * kTurn_deg / steps, to};
  };
  if (head.kind == LiveHead::Kind::kPing360) {
    angles.step_deg = head.ping360.step_grad * kTurn_deg / kGrads;
    if (head.ping360.sector) sector(head.ping360.sector->first_grad, head.ping360.sector->width_grad, kGrads);
  } else {
    angles.step_deg = head.micron.step * kTurn_deg / kMicronSteps;
    if (const auto& of = head.micron.sector) {
      const double width = std::fmod(of->right - of->left + kMicronSteps, kMicronSteps);
      sector(of->left, width, kMicronSteps);
    }
  }
  return angles;
}

JsonObject head_json(const LiveHead& head) {
  JsonObject json;
  json.add("name", head.name());
  // The settings of other heads are unknown.
  if (head.kind != LiveHead::Kind::kPing360 && head.kind != LiveHead::Kind::kMicron) return json;
  const bool is_micron = head.kind == LiveHead::Kind::kMicron;
  const HeadAngles angles = angles_of(head);
  json.add("range_m", is_micron ? head.micron.range_m : head.ping360.range_m)
      .add("gain", gain_name(is_micron ? head.micron.gain : head.ping360.gain))
      .add("step_deg", angles.step_deg);
  if (angles.sector_deg) return json.add("sector_deg", std::span<const double>(*angles.sector_deg));
  return json.add_null("sector_deg");
}

/// Metres by sector, clockwise from ahead; null: unknown, -1: nothing near.
JsonObject& add_obstacles(const ObstacleSectors& obstacles, JsonObject& json) {
  constexpr double kClear = -1.0, kUnknown = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> ranges_m;
  for (const ObstacleSectors::Sector& sector : obstacles.sectors) {
    using What = ObstacleSectors::What;
    ranges_m.push_back(sector.what == What::kObstacle ? sector.range_m
                       : sector.what == What::kClear  ? kClear
                                                      : kUnknown);
  }
  return json.add("obstacles_m", std::span<const double>(ranges_m));
}

/// Degrees clockwise from north, or, where that is unknown, counter-clockwise from x.
double heading_deg(const Pose& map_from_body, MapAxes axes) {
  const Eigen::Vector3d ahead = map_from_body.linear().col(0);
  const double yaw_deg = std::atan2(ahead.y(), ahead.x()) / kDegree_rad;
  if (axes != MapAxes::kEastNorth) return signed_deg(yaw_deg);
  return std::fmod(kTurn_deg / 4.0 - yaw_deg + kTurn_deg, kTurn_deg);
}

}  // namespace

std::optional<ObstacleSectors> live_obstacles(const LiveMapping& live) {
  const std::optional<StampedPose> pose = live.pose();
  if (!pose) return std::nullopt;
  const LiveHead& head = live.head();
  const double range_m = head.kind == LiveHead::Kind::kMicron ? head.micron.range_m : head.ping360.range_m;
  return nearest_obstacles(live.map(), pose->map_from_body, {.max_range_m = range_m});
}

JsonObject live_status_json(const LiveMapping& live, const LiveStatus& status, const LiveFigures& figures,
                            MapAxes axes) {
  constexpr double kMs_per_s = 1000.0;
  const HeadStatus& head = status.head;
  JsonObject json;
  json.add("time_s", status.time_s)
      .add_truth("connected", head.is_connected)
      .add("problem", head.is_connected ? std::string_view() : std::string_view(head.problem))
      .add("head", head_json(live.head()))
      .add("beams", std::uint64_t{status.beams})
      .add("beams_per_s", figures.beams_per_s)
      .add("mapped", std::uint64_t{status.mapped})
      .add("not_mapped", std::uint64_t{status.not_mapped})
      .add("waiting", std::uint64_t{status.waiting})
      .add("echoes", std::uint64_t{live.report().echoes})
      .add("damaged", std::uint64_t{head.damaged})
      .add("unanswered", std::uint64_t{head.unanswered})
      .add("unexpected", std::uint64_t{head.unexpected})
      .add("latency_ms", kMs_per_s * figures.latency_s)
      .add("map_age_s", figures.map_age_s)
      .add("beam_age_s", figures.beam_age_s)
      .add_truth("recording", live.is_recording())
      .add_truth("recording_failed", head.recording_error.has_value());
  if (const auto& files = live.recordings(); live.is_recording() && !files.empty()) {
    json.add("recording_file", files.back().stem().string());
  } else {
    json.add_null("recording_file");
  }
  // Depth and heading are known also where dead reckoning has lost the position.
  std::optional<StampedPose> pose = live.pose();
  if (!pose && status.slam) pose = status.slam->predicted;
  if (pose) {
    const Eigen::Vector3d place_m = pose->map_from_body.translation();
    json.add("position_m", place_m)
        .add("depth_m", -place_m.z())
        .add("heading_deg", heading_deg(pose->map_from_body, axes))
        .add("pose_age_s", std::max(0.0, status.time_s - pose->time_s));
  } else {
    json.add_null("position_m").add_null("depth_m").add_null("heading_deg").add_null("pose_age_s");
  }
  json.add("deviation_m", pose && status.slam ? status.slam->deviation_m : 0.0);
  if (figures.obstacles) {
    add_obstacles(*figures.obstacles, json);
  } else {
    json.add_null("obstacles_m");
  }
  if (!status.slam) return json.add_null("slam");
  JsonObject slam;
  slam.add("motion", name_of(status.slam->motion))
      .add("loops", std::uint64_t{status.slam->loops})
      .add("corrections", std::uint64_t{status.slam->corrections})
      .add_truth("correcting", status.slam->is_correcting);
  return json.add("slam", slam);
}

}  // namespace pingvox::web
