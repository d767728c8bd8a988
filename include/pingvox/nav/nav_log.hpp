#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pingvox/nav/time_order.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// What a sensor of the vehicle measures. The body frame is x ahead, y left, z up; the world frame x east, y north,
/// z up (ROS REP-103); angles are counter-clockwise [rad].
enum class NavQuantity {
  kVelocity,     ///< over ground, in the body frame [m/s]: x, y, z
  kAttitude,     ///< roll, pitch, yaw [rad], fixed-axis as in pose_from_rpy; yaw 0 is east unless the source says
                 ///< otherwise
  kHeading,      ///< yaw alone [rad]: x
  kTurnRate,     ///< about the body's axes [rad/s]: x, y, z
  kDepth,        ///< below the surface [m], positive down: x
  kPosition,     ///< in the source's own local frame [m]: x east, y north, z up
  kFix,          ///< WGS 84: x latitude [rad], y longitude [rad], z altitude [m]
  kRange,        ///< to an obstacle or the bottom along the sensor's axis [m]: x
  kPressure,     ///< [Pa]: x
  kTemperature,  ///< where the sensor is: of the water, or inside of a hull [degrees C]: x
};

/// Lower-case name, as in "turn rate".
std::string_view name_of(NavQuantity quantity);
/// The quantity of a name that `name_of` gives; nullopt: none has it.
std::optional<NavQuantity> nav_quantity_of(std::string_view name);
/// Number of values that a sample of this quantity uses: 1 or 3.
int numbers_of(NavQuantity quantity);

/// One measurement. Numbers that the quantity does not use are 0.
struct NavSample {
  double time_s = 0.0;  ///< on the log's clock
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  /// Standard deviation of each number, in its unit; NaN: unknown.
  Eigen::Vector3d deviation = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  bool valid = true;               ///< false: marked as invalid by the device, or left out
  bool is_in_other_frame = false;  ///< left out for a step that no vehicle makes
};

/// A step of a position, depth or heading that no vehicle makes, and the samples that are left out because of it: it is
/// an outlier, or the origin was reset.
struct SourceStep {
  double from_s = 0.0, to_s = 0.0;  ///< times of the samples before and after it
  double moved_m = 0.0, turned_rad = 0.0;
  bool is_new_start = false;  ///< the device restarted: it is back at its origin
  std::size_t left_out = 0;
  double left_from_s = 0.0, left_to_s = 0.0;  ///< times of the first and last sample that are left out
};

/// Whose pose or motion a source has; the first ones are preferred (main_source.hpp).
enum class NavSubject {
  kChosen,      ///< the vehicle's, as the user says: its name does not matter
  kVehicle,     ///< the vehicle's: its log says so, or it is a sensor of the vehicle
  kTransforms,  ///< the vehicle's by tf, in the frame at the root; it repeats other sources, often filtered
  kUncertain,   ///< perhaps the vehicle's: a pose whose body is not named, or another one of tf
  kOther        ///< not the vehicle's, or not in a frame that can be used: only where it is chosen by its name
};

/// Whether it is the vehicle's by its log or by its user.
constexpr bool is_of_vehicle(NavSubject subject) {
  return subject == NavSubject::kChosen || subject == NavSubject::kVehicle;
}

/// The samples of one quantity by one sensor, in order of time.
struct NavSource {
  std::string name;  ///< as the log names it: "ATTITUDE", "DISTANCE_SENSOR 1/194"
  NavQuantity quantity = NavQuantity::kVelocity;
  std::vector<NavSample> samples;
  std::optional<ClockStep> step_back = std::nullopt;  ///< nullopt: its clock was not set back
  std::size_t late = 0;  ///< samples that came more than kMaxLate_s after a later one, and were put in order
  std::vector<SourceStep> steps = {};  ///< in order of time
  /// Why its values cannot be used, as in "latitude of 54.3 rad is beyond pi/2: is it in degrees?"; empty: nothing is
  /// wrong with them. Nothing is computed from a source with a fault.
  std::string fault = {};
  /// A doubt about its values, which are used all the same, as in "the vehicle is upside down all the time"; empty:
  /// none.
  std::string doubt = {};
  NavSubject subject = NavSubject::kVehicle;
  /// Name of the frame that the values are in: "odom"; of a velocity and a turn rate that of the body. Empty: not
  /// named.
  std::string frame = {};
  std::string child = {};  ///< of a position and an attitude: name of the frame whose pose they are, "base_link"
  /// How it was read, where its format leaves that open ("read as kPa", "turned from world_ned"), or why it is not the
  /// vehicle's; empty: no remark.
  std::string note = {};
};

/// Whether something can be computed from it: it has no fault and at least one valid sample.
bool is_usable(const NavSource& source);

/// Origin of the times of a log.
enum class NavClock {
  kUnix,    ///< 1970-01-01 UTC
  kBoot,    ///< the start of the device
  kUnknown  ///< not known
};
std::string_view name_of(NavClock clock);

/// All navigation of a log: where a vehicle was and how it moved.
class NavLog {
 public:
  /// Takes samples as they came; those of a source are put in order of time, equal times as they came, and where its
  /// clock was set back is noted. Sources without samples are left out. A single value that cannot be true (a yaw
  /// beyond 2 pi, a latitude beyond pi/2) is marked as invalid; where they are not single, the source gets a fault. Of
  /// positions, depths and headings that step faster than a vehicle moves, the samples that are not in the frame of
  /// most others become invalid (SourceStep). The subjects of the sources are judged (judge_subjects), and doubts added
  /// where they have none.
  /// @return kCorrupt naming the first source with a time or value that is not finite
  static Result<NavLog> make(std::vector<NavSource> sources, NavClock clock);

  const std::vector<NavSource>& sources() const { return sources_; }
  NavClock clock() const { return clock_; }

  /// The best source of a quantity: of those without a fault that are known for at least half
  /// as long as the one that is known longest, the one with most valid samples and few_left_out; of equals the one that
  /// begins first, then by name, so that the order of files does not matter. nullptr: there is none.
  const NavSource* best(NavQuantity quantity) const;

 private:
  NavLog(std::vector<NavSource> sources, NavClock clock) : sources_(std::move(sources)), clock_(clock) {}
  std::vector<NavSource> sources_;
  NavClock clock_;
};

/// Adds samples of the same source, of another log or part of it: they are no step back of its clock. Which of all of
/// them are in another frame is found again by NavLog::make.
void add_samples(const NavSource& from, NavSource& to);

/// Samples that are left out as being in another frame, where these are few (a twentieth at most), else 0: outliers are
/// no reason to prefer another source.
std::size_t few_left_out(const NavSource& source);

/// Moves all times of a source.
void shift_times(NavSource& source, double offset_s);

/// @return kCorrupt when its clock was set back, for which times are right is not known; when it has a fault
Result<void> check_source(const NavSource& source);
/// The same of all sources of these quantities, those that something is computed from. One with a fault is an error
/// only where no other source of these quantities can replace it: any heading or attitude replaces another.
/// @return kCorrupt naming the first clock, or all faults
Result<void> check_sources(const NavLog& log, std::span<const NavQuantity> quantities);
/// The same of all sources.
Result<void> check_sources(const NavLog& log);
/// The sources with a fault, each with its reason, for a warning; empty: there are none.
std::string faults_text(const NavLog& log);
/// The sources that are used in spite of a doubt, each with the doubt, for warnings.
std::vector<std::string> doubt_texts(const NavLog& log);

/// The quantities of a vehicle's rotation, and those of dead reckoning besides the depth.
inline constexpr std::array kHeadingQuantities = {NavQuantity::kHeading, NavQuantity::kAttitude};
inline constexpr std::array kReckoningQuantities = {NavQuantity::kHeading, NavQuantity::kAttitude,
                                                    NavQuantity::kTurnRate, NavQuantity::kVelocity};

/// Depth by the best source; in a log without depth by the highest pressure, if it exceeds 1100 hPa,
/// which is not that of air: as metres of sea water (1025 kg/m3) below 1013.25 hPa. nullopt: neither is known.
std::optional<NavSource> depth_source(const NavLog& log);

/// The water around a vehicle.
struct WaterAround {
  double temperature_c = 0.0;
  double depth_m = 0.0;  ///< median of the depth; 0 where none is known
};
/// The temperature is the lowest median of its sources, of those within 0..35 degrees C: the inside of a hull is warmer
/// than the water around it. Exactly 0 is reported where there is no thermometer. nullopt: there is none.
std::optional<WaterAround> water_around(const NavLog& log);

/// A source at a glance.
struct NavSummary {
  std::size_t samples = 0;
  std::size_t invalid = 0;  ///< of these, how many are not valid
  double rate_hz = 0.0;     ///< one over the median step of time; 0 for less than two different times
  /// Five times the median step of time, at least half a second; infinity for less than two different times.
  double longest_step_s = std::numeric_limits<double>::infinity();
  std::size_t gaps = 0;  ///< steps that are longer
  double from_s = 0.0, to_s = 0.0;
};
/// REQUIRES at least one sample.
NavSummary summary_of(const NavSource& source);

/// From north-east-down and forward-right-down to our frames.
namespace from_ned {
/// A velocity, rate or offset in the body frame: forward, right, down -> ahead, left, up.
Eigen::Vector3d body(const Eigen::Vector3d& forward_right_down);
/// A position or velocity in the world: north, east, down -> east, north, up.
Eigen::Vector3d world(const Eigen::Vector3d& north_east_down);
/// Roll, pitch and yaw [rad] of a forward-right-down body in north-east-down -> ours; yaw as by yaw().
Eigen::Vector3d attitude(const Eigen::Vector3d& roll_pitch_yaw_rad);
/// A heading, clockwise from north [rad] -> yaw from east in (-pi, pi]. Beyond 2 pi, where no heading in radians is, it
/// goes on beyond them, so that NavLog::make finds it.
double yaw(double heading_rad);
}  // namespace from_ned

}  // namespace pingvox
