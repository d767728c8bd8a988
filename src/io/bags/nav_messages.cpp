#include "io/bags/nav_messages.hpp"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <string_view>

#include "io/nav/nav_fields.hpp"
#include "nav/internal/nav_frames.hpp"
#include "nav/internal/pressure_unit.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose.hpp"

namespace pingvox {
namespace {

/// An attitude from x, y, z, w, if it is one.
void add_attitude(const RosFields& message, std::size_t first, bool valid, NavSamples& samples) {
  const Eigen::Vector4d xyzw(message.number(first), message.number(first + 1), message.number(first + 2),
                             message.number(first + 3));
  if (const auto rpy = rpy_of_quaternion(xyzw)) {
    samples.add(NavQuantity::kAttitude, *rpy, valid);
  } else if (!xyzw.allFinite()) {
    samples.refuse_attitude("the quaternion has a number that is not finite");
  } else {
    samples.refuse_attitude(fmt::format("the quaternion has the length {:.4g}, not 1", xyzw.norm()));
  }
}

void add_imu(const RosFields& message, NavSamples& samples) {
  const bool has_attitude = message.number(7) != -1.0;  // of the covariance
  add_attitude(message, 0, has_attitude, samples);
  if (!has_attitude) samples.refuse_attitude("orientation_covariance begins with -1: the orientation is not known");
  samples.add(NavQuantity::kTurnRate, vector_at(message, 4));
  const auto rotation =
      rotation_of_quaternion({message.number(0), message.number(1), message.number(2), message.number(3)});
  if (rotation && has_attitude) samples.count_acceleration((*rotation * vector_at(message, 8)).z());
}

void add_pose(const RosFields& message, NavSamples& samples) {
  samples.add(NavQuantity::kPosition, vector_at(message, 0));
  add_attitude(message, 3, true, samples);
}

void add_velocity(const RosFields& message, NavSamples& samples) {
  samples.add(NavQuantity::kVelocity, vector_at(message, 0));
}

void add_twist(const RosFields& message, NavSamples& samples) {
  samples.add(NavQuantity::kVelocity, vector_at(message, 0));
  samples.add(NavQuantity::kTurnRate, vector_at(message, 3));
}

void add_fix(const RosFields& message, NavSamples& samples) {
  samples.add_fix(message.number(0), message.number(1), message.number(2), message.number(3) >= 0.0);
}

void add_xsens_fix(const RosFields& message, NavSamples& samples) {
  samples.add_fix(message.number(0), message.number(1), 0.0, message.number(2) > 0.0);
}

/// In the unit of its driver, which tell_pressures finds.
void add_pressure(const RosFields& message, NavSamples& samples) {
  samples.add(NavQuantity::kPressure, {message.number(0), 0.0, 0.0});
}

void add_depth_pressure_temperature(const RosFields& message, NavSamples& samples) {
  samples.add(NavQuantity::kDepth, {message.number(0), 0.0, 0.0});
  samples.add(NavQuantity::kPressure, {message.number(1), 0.0, 0.0});
  samples.add(NavQuantity::kTemperature, {message.number(2), 0.0, 0.0});
}

void add_temperature(const RosFields& message, NavSamples& samples) {
  samples.add(NavQuantity::kTemperature, {message.number(0), 0.0, 0.0});
}

void add_range(const RosFields& message, NavSamples& samples) {
  const double range_m = message.number(0);
  samples.add(NavQuantity::kRange, {range_m, 0.0, 0.0}, range_m >= message.number(1) && range_m <= message.number(2));
}

/// From the axes of a DVL that looks ahead (x left, y up, z ahead) to forward, right, down.
Eigen::Matrix3d frd_from_looking_ahead() {
  Eigen::Matrix3d r;
  r << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return r;
}

/// Of Water Linked's A50 and A125, whose drivers pass its numbers on: x forward, y right, z down when it looks down.
void add_dvl_velocity(const RosFields& message, const Eigen::Matrix3d& frd_from_dvl, NavSamples& samples) {
  const bool valid = message.number(3) != 0.0;
  samples.add(NavQuantity::kVelocity, from_ned::body(frd_from_dvl * vector_at(message, 0)), valid);
  const double altitude_m = message.number(4);
  samples.add(NavQuantity::kRange, {altitude_m, 0.0, 0.0}, valid && altitude_m > 0.0);
}

/// Its dead reckoning in the axes that it had at its last reset; angles in degrees.
void add_dvl_position(const RosFields& message, const Eigen::Matrix3d& frd_from_dvl, NavSamples& samples) {
  const Eigen::Vector3d rpy = vector_at(message, 3) * kDegree_rad;
  const Eigen::Matrix3d turned = pose_from_rpy(Eigen::Vector3d::Zero(), rpy.x(), rpy.y(), rpy.z()).rotation();
  samples.add_dead_reckoning(from_ned::world(frd_from_dvl * vector_at(message, 0)),
                             from_ned::attitude(rpy_of(frd_from_dvl * turned * frd_from_dvl.transpose())));
}

void add_dvl(const RosFields& message, NavSamples& samples) {
  add_dvl_velocity(message, Eigen::Matrix3d::Identity(), samples);
}

void add_dvl_ahead(const RosFields& message, NavSamples& samples) {
  add_dvl_velocity(message, frd_from_looking_ahead(), samples);
}

void add_reckoning(const RosFields& message, NavSamples& samples) {
  add_dvl_position(message, Eigen::Matrix3d::Identity(), samples);
}

void add_reckoning_ahead(const RosFields& message, NavSamples& samples) {
  add_dvl_position(message, frd_from_looking_ahead(), samples);
}

void add_json(const RosFields& message, NavSamples& samples) {
  const auto members = json_members(message.text(0));
  if (!members) return;
  if (const A50Reading report = a50_report(*members)) samples.add(*report);
}

/// As MAVLink's ATTITUDE: of a forward-right-down body in north-east-down.
void add_ned_attitude(const RosFields& message, NavSamples& samples) {
  samples.add(NavQuantity::kAttitude, from_ned::attitude(vector_at(message, 0)));
  samples.add(NavQuantity::kTurnRate, from_ned::body(vector_at(message, 3)));
}

/// What Ping Viewer 2 records of the vehicle, behind each message of the sonar: attitude as MAVLink's ATTITUDE, in
/// single precision, place by GLOBAL_POSITION_INT. Without a position `lat` and `lon` are 0; `alt` says nothing of the
/// depth then, and is that of a fix else.
void add_vehicle_data(const RosFields& message, NavSamples& samples) {
  const Eigen::Vector3d rpy(message.single(0), message.single(1), message.single(2));
  const Eigen::Vector3d place(message.number(3), message.number(4), message.number(5));
  if (!samples.is_new_pose(rpy, place)) return;
  samples.add(NavQuantity::kAttitude, from_ned::attitude(rpy));
  samples.add_fix(place.x(), place.y(), place.z(), place.x() != 0.0 || place.y() != 0.0);
}

/// Of a Ping1D in Ping Viewer 2 [mm], which is confident of its distance or not [%].
void add_echosounder(const RosFields& message, NavSamples& samples) {
  constexpr double kMillimetre_m = 1e-3;
  samples.add(NavQuantity::kRange, {message.number(0) * kMillimetre_m, 0.0, 0.0}, message.number(1) > 0.0);
}

void add_odometry(const RosFields& message, NavSamples& samples) {
  add_pose(message, samples);
  samples.add(NavQuantity::kVelocity, vector_at(message, 7));
}

/// Of Sonardyne's USBL: x east, y north, z up.
void add_usbl(const RosFields& message, NavSamples& samples) {
  samples.add(NavQuantity::kPosition, vector_at(message, 0), message.number(3) != 0.0);
}

void add_depth(const RosFields& message, NavSamples& samples) {
  samples.add(NavQuantity::kDepth, {message.number(0), 0.0, 0.0});
}

constexpr std::array<std::string_view, 11> kTransformFields = {
    "transforms.header.frame_id",         "transforms.child_frame_id",          "transforms.transform.translation.x",
    "transforms.transform.translation.y", "transforms.transform.translation.z", "transforms.transform.rotation.x",
    "transforms.transform.rotation.y",    "transforms.transform.rotation.z",    "transforms.transform.rotation.w"};

constexpr std::array kNavTypes = {
    NavType{{"Imu",
             {"orientation.x", "orientation.y", "orientation.z", "orientation.w", "angular_velocity.x",
              "angular_velocity.y", "angular_velocity.z", "orientation_covariance", "linear_acceleration.x",
              "linear_acceleration.y", "linear_acceleration.z"}},
            add_imu,
            FrameId::kOfSensor},
    NavType{{"PoseStamped",
             {"pose.position.x", "pose.position.y", "pose.position.z", "pose.orientation.x", "pose.orientation.y",
              "pose.orientation.z", "pose.orientation.w"}},
            add_pose,
            FrameId::kOfPose},
    NavType{{"PoseWithCovarianceStamped",
             {"pose.pose.position.x", "pose.pose.position.y", "pose.pose.position.z", "pose.pose.orientation.x",
              "pose.pose.orientation.y", "pose.pose.orientation.z", "pose.pose.orientation.w"}},
            add_pose,
            FrameId::kOfPose},
    NavType{{"TwistStamped",
             {"twist.linear.x", "twist.linear.y", "twist.linear.z", "twist.angular.x", "twist.angular.y",
              "twist.angular.z"}},
            add_twist,
            FrameId::kOfTwist},
    NavType{{"TwistWithCovarianceStamped", {"twist.twist.linear.x", "twist.twist.linear.y", "twist.twist.linear.z"}},
            add_velocity,
            FrameId::kOfTwist},
    NavType{{"NavSatFix", {"latitude", "longitude", "altitude", "status.status"}}, add_fix, FrameId::kOfSensor},
    // Its driver writes the latitude into `lon` and the longitude into `lat`: so in the recordings on the lake of
    // Ratzeburg (53.8 N, 10.8 E; NilsKompe/Bluerov2), the only ones that are known.
    NavType{{"Xsens700Position", {"lon", "lat", "fixind"}, "", "monsun_msgs/"}, add_xsens_fix},
    NavType{{"FluidPressure", {"fluid_pressure"}}, add_pressure},
    NavType{{"Temperature", {"temperature"}}, add_temperature},
    NavType{{"Range", {"range", "min_range", "max_range"}}, add_range},
    NavType{{"DVL", {"velocity.x", "velocity.y", "velocity.z", "velocity_valid", "altitude", "fom"}}, add_dvl},
    // Those of SOLAQUA look ahead, at the net.
    NavType{{"DVLVelocity",
             {"velocity.x", "velocity.y", "velocity.z", "velocity_valid", "altitude", "fom"},
             "",
             "sensors/"},
            add_dvl_ahead},
    NavType{{"DVLPosition", {"x", "y", "z", "roll", "pitch", "yaw", "t_last_reset"}, "", "sensors/"},
            add_reckoning_ahead},
    NavType{{"DVLVelocity", {"velocity.x", "velocity.y", "velocity.z", "velocity_valid", "altitude", "fom"}}, add_dvl},
    NavType{{"DVLPosition", {"x", "y", "z", "roll", "pitch", "yaw", "t_last_reset"}}, add_reckoning},
    NavType{{"Attitude", {"roll", "pitch", "yaw", "rollspeed", "pitchspeed", "yawspeed"}}, add_ned_attitude},
    NavType{{"DepthTemperature", {"depth", "pressure", "temperature"}}, add_depth_pressure_temperature},
    NavType{{"Odometry",
             {"pose.pose.position.x", "pose.pose.position.y", "pose.pose.position.z", "pose.pose.orientation.x",
              "pose.pose.orientation.y", "pose.pose.orientation.z", "pose.pose.orientation.w", "twist.twist.linear.x",
              "twist.twist.linear.y", "twist.twist.linear.z"}},
            add_odometry,
            FrameId::kOfOdometry},
    NavType{{"TFMessage", kTransformFields, "tf"}, nullptr, FrameId::kOfTransforms},
    NavType{{"TFMessage", kTransformFields, "tf_static"}, nullptr, FrameId::kOfTransforms},
    NavType{{"tfMessage", kTransformFields, "tf"}, nullptr, FrameId::kOfTransforms},
    NavType{{"SonardyneUSBL2", {"east", "north", "depth", "connected"}}, add_usbl},
    NavType{{"String", {"data"}, "dvl/json_data"}, add_json},
    NavType{{"VehicleData", {"roll", "pitch", "yaw", "lat", "lon", "alt"}, "", "", RosTypeName::kOfTopic},
            add_vehicle_data},
    NavType{{"Ping1D", {"distance", "confidence", "scan_start", "scan_length"}, "", "", RosTypeName::kOfTopic},
            add_echosounder},
    NavType{{"Float64", {"data"}, "depth"}, add_depth},
    NavType{{"Float32", {"data"}, "depth"}, add_depth},
    NavType{{"Float64", {"data"}, "pressure"}, add_pressure},
    NavType{{"Float32", {"data"}, "pressure"}, add_pressure},
    NavType{{"Float64", {"data"}, "temperature"}, add_temperature},
    NavType{{"Float32", {"data"}, "temperature"}, add_temperature},
};

}  // namespace

void NavSamples::add_dead_reckoning(const Eigen::Vector3d& position_m, const Eigen::Vector3d& attitude) {
  NavOrigin origin = origin_;
  origin.frame = kStartFrame;
  add(NavQuantity::kPosition, position_m, true, origin);
  add(NavQuantity::kAttitude, attitude, true, origin);
}

void NavSamples::add(const A50Report& report) {
  const double time_s = time_s_ - report.latency_s;
  if (report.made_s) state_.report_times.push_back({time_s, *report.made_s});
  add_a50_report(sources_, name_, time_s, report);
}

bool NavSamples::is_new_pose(const Eigen::Vector3d& attitude, const Eigen::Vector3d& place) {
  RepeatedPose& pose = state_.pose;
  if (pose.is_known && attitude == pose.attitude && place == pose.place) {
    const double still_s = time_s_ - pose.since_s;
    if (still_s > pose.longest_s) {
      pose.longest_s = still_s;
      pose.longest_from_s = pose.since_s;
    }
    return false;
  }
  pose.attitude = attitude;
  pose.place = place;
  pose.since_s = time_s_;
  pose.is_known = true;
  return true;
}

void NavSamples::count_acceleration(double upward_m_s2) {
  constexpr double kMin_m_s2 = 5.0;
  if (upward_m_s2 > kMin_m_s2) ++state_.upward;
  if (upward_m_s2 < -kMin_m_s2) ++state_.downward;
}

void NavSamples::add_fix(double latitude_deg, double longitude_deg, double altitude_m, bool valid) {
  if (std::isfinite(altitude_m)) state_.altitude_m = altitude_m;
  add(NavQuantity::kFix, {latitude_deg * kDegree_rad, longitude_deg * kDegree_rad, state_.altitude_m}, valid);
}

void NavSamples::add(NavQuantity quantity, const Eigen::Vector3d& value, bool valid) {
  add(quantity, value, valid, origin_);
}

void NavSamples::add(NavQuantity quantity, const Eigen::Vector3d& value, bool valid, const NavOrigin& origin) {
  NavSample sample;
  sample.time_s = time_s_;
  sample.value = value;
  sample.valid = valid;
  sources_.add(name_, quantity, sample, origin);
}

std::span<const NavType> nav_types() {
  return kNavTypes;
}

NavOrigin origin_of(FrameId frame_id, const KnownTopic& topic, const RosMessage& message) {
  const std::string frame(topic.frame_of(message)), child(topic.child_of(message));
  switch (frame_id) {
    case FrameId::kOfPose:
      return {NavSubject::kUncertain, frame, {}};
    case FrameId::kOfOdometry:
      return {NavSubject::kVehicle, frame, child};
    case FrameId::kOfSensor:
      return {NavSubject::kVehicle, {}, frame};
    case FrameId::kOfTwist:
      return {NavSubject::kUncertain, {}, frame};
    case FrameId::kNotUsed:
    case FrameId::kOfTransforms:
      break;
  }
  return {};
}

NavOrigin origin_by_name(const KnownTopic& topic, const RosMessage& message) {
  const bool is_of_pose = topic.child || is_fixed_frame(topic.frame_of(message));
  NavOrigin origin = origin_of(is_of_pose ? FrameId::kOfOdometry : FrameId::kOfSensor, topic, message);
  if (!topic.child && is_of_pose) origin.child = origin.frame;
  origin.subject = NavSubject::kChosen;
  return origin;
}

void add_transforms(const KnownTopic& topic, std::span<const std::uint8_t> message, double recorded_s,
                    TfTree::Link link, RosMessage& read, TfTree& tree) {
  constexpr std::size_t kMaxTransforms = 256;
  const RosFields transform(read, topic.fields);
  for (std::size_t next = 1; transform.count(2) > 0 && next <= kMaxTransforms; ++next) {
    const auto rotation =
        rotation_of_quaternion({transform.number(5), transform.number(6), transform.number(7), transform.number(8)});
    if (rotation) {
      Pose pose(*rotation);
      pose.translation() = vector_at(transform, 2);
      tree.add(without_slash(transform.text(0)), without_slash(transform.text(1)), topic.time_of(read, recorded_s),
               pose, link);
    }
    if (!read.read(*topic.layout, message, next)) return;
  }
}

Eigen::Vector3d vector_at(const RosFields& message, std::size_t first) {
  return {message.number(first), message.number(first + 1), message.number(first + 2)};
}

}  // namespace pingvox
