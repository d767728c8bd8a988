// Options of all layers: what validate() says when fields are broken.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/option_errors.hpp"
#include "device/internal/head_emulator.hpp"
#include "device/internal/nav_emulator.hpp"
#include "mapping/internal/obstacle_sectors.hpp"
#include "pingvox/analysis/visible_cells.hpp"
#include "pingvox/device/head_settings.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/mapping/build_options.hpp"
#include "pingvox/recording/evaluate.hpp"
#include "pingvox/recording/mosaic.hpp"
#include "pingvox/sim/nav_sensors.hpp"
#include "pingvox/sim/scene.hpp"
#include "pingvox/sim/sonar.hpp"
#include "pingvox/sim/tank.hpp"
#include "pingvox/sim/vehicle.hpp"
#include "pingvox/slam/localizer.hpp"
#include "pingvox/slam/loop_finder.hpp"
#include "pingvox/slam/slam_smoother.hpp"
#include "pingvox/sonar/cartesian_image.hpp"
#include "pingvox/sonar/mosaic.hpp"
#include "pingvox/sonar/sound_speed.hpp"
#include "pingvox/viewer/render_cartesian.hpp"
#include "pingvox/viewer/render_map.hpp"

namespace pingvox {
namespace {

const double kNaN = std::nan("");

/// What the message calls a field, and how it is broken.
template <class Options>
struct Break {
  std::string_view name;
  std::function<void(Options&)> apply;
};

/// The message of broken options.
template <class Options>
std::string message_of(const Options& broken) {
  const Result<void> valid = broken.validate();
  EXPECT_FALSE(valid);
  if (valid) return "";
  EXPECT_EQ(valid.error().code, Error::Code::kBadOption);
  return valid.error().message;
}

/// Each broken field alone is named, none is that is not broken, and all of them are in one message.
template <class Options>
void expect_all_named(const std::vector<Break<Options>>& breaks, const Options& valid = {}) {
  const Result<void> fine = valid.validate();
  EXPECT_TRUE(fine) << fine.error().message;
  Options all = valid;
  for (const Break<Options>& one : breaks) {
    SCOPED_TRACE(one.name);
    Options broken = valid;
    one.apply(broken);
    one.apply(all);
    EXPECT_NE(message_of(broken).find(one.name), std::string::npos) << message_of(broken);
  }
  const std::string message = message_of(all);
  for (const Break<Options>& one : breaks) EXPECT_NE(message.find(one.name), std::string::npos) << message;
}

TEST(BrokenOptions, OfSonarAreAllNamed) {
  expect_all_named<FilterOptions>(
      {{"kernel", [](auto& o) { o.kernel = 4; }}, {"sigma", [](auto& o) { o.sigma = 0.0; }}});
  expect_all_named<EchoOptions>({{"min_range_m", [](auto& o) { o.min_range_m = -1.0; }},
                                 {"max_range_m", [](auto& o) { o.max_range_m = kNaN; }},
                                 {"threshold", [](auto& o) { o.threshold = 0; }},
                                 {"canny.low", [](auto& o) { o.canny.low = -1; }},
                                 {"canny.link", [](auto& o) { o.canny.link = 0; }},
                                 {"cfar.guard", [](auto& o) { o.cfar.guard = 1001; }},
                                 {"cfar.training", [](auto& o) { o.cfar.training = 0; }},
                                 {"cfar.false_alarm_rate", [](auto& o) { o.cfar.false_alarm_rate = kNaN; }},
                                 {"cfar.scale", [](auto& o) { o.cfar.scale = 0.5; }}});
  expect_all_named<CartesianOptions>(
      {{"size_px", [](auto& o) { o.size_px = 1; }}, {"beam_width_rad", [](auto& o) { o.beam_width_rad = 7.0; }}});
  expect_all_named<MosaicOptions>({{"resolution_m", [](auto& o) { o.resolution_m = 0.0; }},
                                   {"min_range_m", [](auto& o) { o.min_range_m = -1.0; }},
                                   {"max_range_m", [](auto& o) { o.max_range_m = kNaN; }}});
  expect_all_named<Water>({{"temperature", [](auto& o) { o.temperature_c = 40.0; }},
                           {"salinity", [](auto& o) { o.salinity = kNaN; }},
                           {"depth", [](auto& o) { o.depth_m = -1.0; }}});
}

TEST(BrokenOptions, OfMapsAreAllNamed) {
  expect_all_named<MapOptions>({{"resolution", [](auto& o) { o.resolution_m = 0.0; }},
                                {"depth", [](auto& o) { o.depth = 0; }},
                                {"clamp", [](auto& o) { o.clamp = {LogOdds(1.0F), LogOdds(2.0F)}; }},
                                {"threshold", [](auto& o) { o.thresholds = {LogOdds(1.0F), LogOdds(-1.0F)}; }}});
  expect_all_named<BeamModelOptions>({{"beam width", [](auto& o) { o.width_rad = 0.0; }},
                                      {"beam height", [](auto& o) { o.height_rad = 4.0; }},
                                      {"free share", [](auto& o) { o.free_share = kNaN; }},
                                      {"hit", [](auto& o) { o.hit = LogOdds(-1.0F); }}});
  expect_all_named<BuildOptions>({{"kernel", [](auto& o) { o.filter.kernel = 4; }},
                                  {"max_range_m", [](auto& o) { o.echo.max_range_m = -1.0; }},
                                  {"beam width", [](auto& o) { o.model.width_rad = 0.0; }},
                                  {"miss", [](auto& o) { o.miss = LogOdds(1.0F); }},
                                  {"vote", [](auto& o) { o.timing = Timing::kByBeam; }},
                                  {"mount", [](auto& o) { o.body_from_sensor.translation().x() = kNaN; }},
                                  {"threads", [](auto& o) { o.threads = 0; }},
                                  {"sound speed", [](auto& o) { o.sound_speed_ratio = 0.0; }}});
  BuildOptions build;
  for (const double miss : {0.001, 0.3, 0.499}) {
    build.miss = LogOdds::from_probability(miss);
    EXPECT_TRUE(build.validate()) << miss;
  }
  build.miss = LogOdds::from_probability(0.5);
  EXPECT_FALSE(build.validate());
  expect_all_named<ObstacleOptions>({{"min_range_m", [](auto& o) { o.min_range_m = -1.0; }},
                                     {"max_range_m", [](auto& o) { o.max_range_m = 700.0; }},
                                     {"half_height_m", [](auto& o) { o.half_height_m = 0.0; }}});
  expect_all_named<ViewOptions>({{"min_range_m", [](auto& o) { o.min_range_m = -1.0; }},
                                 {"max_range_m", [](auto& o) { o.max_range_m = kNaN; }},
                                 {"height_rad", [](auto& o) { o.height_rad = 4.0; }}});
}

TEST(BrokenOptions, OfAnEvaluationAreAllNamed) {
  expect_all_named<EvaluateOptions>({{"folds", [](auto& o) { o.folds = 1; }},
                                     {"resolution", [](auto& o) { o.map.resolution_m = 0.0; }},
                                     {"beam width", [](auto& o) { o.build.model.width_rad = 0.0; }},
                                     {"threads", [](auto& o) { o.build.threads = 0; }}});
  EvaluateOptions options;
  options.folds = 1000;
  EXPECT_TRUE(options.validate());
  options.folds = 1001;
  EXPECT_FALSE(options.validate());
}

// Kills limits that are found by the order of the fields, not by the field.
TEST(BrokenOptions, LimitsAreThoseOfTheField) {
  SonarOptions options;
  EXPECT_EQ(options.errors().limits_of(&options.beam_width_rad), std::nullopt);
  options.beam_width_rad = 2.0;
  options.lost = 1.0;
  const OptionErrors errors = options.errors();
  ASSERT_TRUE(errors.limits_of(&options.beam_width_rad) && errors.limits_of(&options.lost));
  EXPECT_EQ(errors.limits_of(&options.beam_width_rad)->text(), "above 0 and at most 1");
  EXPECT_EQ(errors.limits_of(&options.beam_width_rad)->text(kDegree_rad), "above 0 and at most 57.2958");
  EXPECT_EQ(errors.limits_of(&options.lost)->text(), "at least 0 and below 1");
  EXPECT_EQ(errors.limits_of(&options.gain), std::nullopt);
}

// Kills a message of the first broken field alone.
TEST(BrokenOptions, OfSlamAreAllNamed) {
  expect_all_named<SlamOptions>({{"causal_sweeps", [](auto& o) { o.causal_sweeps = 1; }},
                                 {"body_from_sonar", [](auto& o) { o.body_from_sonar.translation().x() = kNaN; }},
                                 {"nav_offset_s", [](auto& o) { o.nav_offset_s = kNaN; }},
                                 {"calibration", [](auto& o) { o.calibration.emplace().sonar_x_m.value = kNaN; }},
                                 {"kernel", [](auto& o) { o.filter.kernel = 4; }},
                                 {"sound_speed_ratio", [](auto& o) { o.sound_speed_ratio = 0.0; }},
                                 {"max_range_m", [](auto& o) { o.echo.max_range_m = -1.0; }}});
  expect_all_named<LoopOptions>({{"reach_m", [](auto& o) { o.reach_m = 0.0; }},
                                 {"window_m", [](auto& o) { o.window_m = -1.0; }},
                                 {"window_yaw_rad", [](auto& o) { o.window_yaw_rad = 4.0; }},
                                 {"points_within", [](auto& o) { o.points_within = 0.0; }}});
  expect_all_named<BeamLikelihood>({{"range_deviation_m", [](auto& o) { o.range_deviation_m = 0.0; }},
                                    {"bearing_deviation_rad", [](auto& o) { o.bearing_deviation_rad = 2.0; }},
                                    {"stray", [](auto& o) { o.stray = 0.0; }},
                                    {"unknown", [](auto& o) { o.unknown = 0.0; }},
                                    {"behind", [](auto& o) { o.behind = 2.0; }},
                                    {"silent_wall", [](auto& o) { o.silent_wall = kNaN; }},
                                    {"beam_weight", [](auto& o) { o.beam_weight = -1.0; }}});
  expect_all_named<MotionNoise>({{"position_m_per_sqrt_s", [](auto& o) { o.position_m_per_sqrt_s = -1.0; }},
                                 {"position_m_per_sqrt_m", [](auto& o) { o.position_m_per_sqrt_m = -1.0; }},
                                 {"yaw_rad_per_sqrt_s", [](auto& o) { o.yaw_rad_per_sqrt_s = -1.0; }},
                                 {"yaw_rad_per_sqrt_rad", [](auto& o) { o.yaw_rad_per_sqrt_rad = kNaN; }}});
  expect_all_named<LocalizerOptions>(
      {{"body_from_sonar", [](auto& o) { o.body_from_sonar.translation().x() = kNaN; }},
       {"kernel", [](auto& o) { o.filter.kernel = 4; }},
       {"max_range_m", [](auto& o) { o.echo.max_range_m = -1.0; }},
       {"sound_speed_ratio", [](auto& o) { o.sound_speed_ratio = 0.0; }},
       {"stray", [](auto& o) { o.beam.stray = 0.0; }},
       {"motion noise: position_m_per_sqrt_s", [](auto& o) { o.noise.position_m_per_sqrt_s = -1.0; }},
       {"without odometry: motion noise", [](auto& o) { o.without.yaw_rad_per_sqrt_s = -1.0; }},
       {"min_particles", [](auto& o) { o.min_particles = 1; }},
       {"max_particles", [](auto& o) { o.max_particles = 2'000'000; }}});
  expect_all_named<DistanceFieldOptions>(
      {{"min_z_m", [](auto& o) { o.min_z_m = kNaN; }}, {"truncation_m", [](auto& o) { o.truncation_m = 0.0; }}});
}

TEST(BrokenOptions, OfDevicesAreAllNamed) {
  expect_all_named<MicronSettings>({{"range_m", [](auto& o) { o.range_m = kNaN; }},
                                    {"step", [](auto& o) { o.step = 0; }},
                                    {"timeout_s", [](auto& o) { o.timeout_s = 0.0; }},
                                    {"left", [](auto& o) { o.sector = {-1, 6400}; }},
                                    {"right", [](auto& o) { o.sector = {-1, 6400}; }}});
  expect_all_named<Ping360Settings>({{"range_m", [](auto& o) { o.range_m = 101.0; }},
                                     {"step_grad", [](auto& o) { o.step_grad = 0; }},
                                     {"timeout_s", [](auto& o) { o.timeout_s = 61.0; }},
                                     {"first_grad", [](auto& o) { o.sector = {-1, 0}; }},
                                     {"width_grad", [](auto& o) { o.sector = {-1, 0}; }}});
  expect_all_named<HeadEmulatorOptions>({{"pings_per_s", [](auto& o) { o.pings_per_s = 0.0; }},
                                         {"lost", [](auto& o) { o.lost = 0.6; }},
                                         {"doubled", [](auto& o) { o.doubled = -1.0; }},
                                         {"damaged", [](auto& o) { o.damaged = kNaN; }},
                                         {"stall_s", [](auto& o) { o.stall_s = -1.0; }},
                                         {"lines_per_request", [](auto& o) { o.lines_per_request = 3; }}});
  expect_all_named<NavEmulatorOptions>({{"reports_per_s", [](auto& o) { o.reports_per_s = 0.0; }},
                                        {"lost", [](auto& o) { o.lost = 0.6; }},
                                        {"doubled", [](auto& o) { o.doubled = -1.0; }},
                                        {"damaged", [](auto& o) { o.damaged = kNaN; }}});
}

TEST(BrokenOptions, OfTheSimulatorAreAllNamed) {
  expect_all_named<SonarOptions>({{"beams_per_turn", [](auto& o) { o.beams_per_turn = 3; }},
                                  {"bins", [](auto& o) { o.bins = 0; }},
                                  {"bin_length_m", [](auto& o) { o.bin_length_m = 0.0; }},
                                  {"beams_per_s", [](auto& o) { o.beams_per_s = kNaN; }},
                                  {"beam_width_rad", [](auto& o) { o.beam_width_rad = 2.0; }},
                                  {"beam_height_rad", [](auto& o) { o.beam_height_rad = 3.0; }},
                                  {"side_lobes", [](auto& o) { o.side_lobes = 2.0; }},
                                  {"bearing_step_rad", [](auto& o) { o.bearing_step_rad = -1.0; }},
                                  {"ringing_m", [](auto& o) { o.ringing_m = -1.0; }},
                                  {"gain", [](auto& o) { o.gain = 2.0; }},
                                  {"compression", [](auto& o) { o.compression = 0.0; }},
                                  {"absorption_db_per_m", [](auto& o) { o.absorption_db_per_m = 11.0; }},
                                  {"speckle", [](auto& o) { o.speckle = 2.0; }},
                                  {"noise", [](auto& o) { o.noise = 256.0; }},
                                  {"multipath", [](auto& o) { o.multipath = 2.0; }},
                                  {"silent", [](auto& o) { o.silent = 2.0; }},
                                  {"lost", [](auto& o) { o.lost = 1.0; }}});
  expect_all_named<TravelOptions>(
      {{"speed_m_s", [](auto& o) { o.speed_m_s = 0.0; }}, {"pose_every_s", [](auto& o) { o.pose_every_s = 0.0; }}});
  expect_all_named<DriftOptions>(
      {{"position_m", [](auto& o) { o.position_m = -1.0; }}, {"heading_rad", [](auto& o) { o.heading_rad = 11.0; }}});
  expect_all_named<NavSensorOptions>({{"dvl_per_s", [](auto& o) { o.dvl_per_s = 0.0; }},
                                      {"dvl_noise_m_s", [](auto& o) { o.dvl_noise_m_s = 11.0; }},
                                      {"dvl_outliers", [](auto& o) { o.dvl_outliers = 2.0; }},
                                      {"dvl_lost", [](auto& o) { o.dvl_lost = 1.0; }},
                                      {"dvl_yaw_rad", [](auto& o) { o.dvl_yaw_rad = 2.0; }},
                                      {"dvl_scale", [](auto& o) { o.dvl_scale = 1.0; }},
                                      {"attitude_per_s", [](auto& o) { o.attitude_per_s = 101.0; }},
                                      {"attitude_noise_rad", [](auto& o) { o.attitude_noise_rad = 2.0; }},
                                      {"compass_deviation_rad", [](auto& o) { o.compass_deviation_rad = 1.0; }},
                                      {"gyro_noise_rad_s", [](auto& o) { o.gyro_noise_rad_s = 2.0; }},
                                      {"gyro_drift_rad_s", [](auto& o) { o.gyro_drift_rad_s = 2.0; }},
                                      {"depth_per_s", [](auto& o) { o.depth_per_s = kNaN; }},
                                      {"depth_noise_m", [](auto& o) { o.depth_noise_m = 11.0; }},
                                      {"delay_s", [](auto& o) { o.delay_s = 4000.0; }}});
  expect_all_named<TankOptions>({{"side_m", [](auto& o) { o.side_m = 0.0; }},
                                 {"depth_m", [](auto& o) { o.depth_m = 0.0; }},
                                 {"sensor_x_m", [](auto& o) { o.sensor_x_m = 9.0; }},
                                 {"sensor_y_m", [](auto& o) { o.sensor_y_m = 9.0; }},
                                 {"sensor_yaw_rad", [](auto& o) { o.sensor_yaw_rad = kNaN; }},
                                 {"floater_bearing_rad", [](auto& o) { o.floater_bearing_rad = kNaN; }},
                                 {"floater_radius_m", [](auto& o) { o.floater_radius_m = -1.0; }},
                                 {"floater_range_m", [](auto& o) { o.floater_range_m = -2.0; }}});
  expect_all_named<HarbourOptions>({{"length_m", [](auto& o) { o.length_m = 1.0; }},
                                    {"width_m", [](auto& o) { o.width_m = 1.0; }},
                                    {"water_above_m", [](auto& o) { o.water_above_m = 0.1; }},
                                    {"water_below_m", [](auto& o) { o.water_below_m = 0.1; }},
                                    {"piles", [](auto& o) { o.piles = 7; }},
                                    {"pile_radius_m", [](auto& o) { o.pile_radius_m = 1.0; }},
                                    {"hull_length_m", [](auto& o) { o.hull_length_m = -1.0; }},
                                    {"hull_beam_m", [](auto& o) { o.hull_beam_m = 4.0; }},
                                    {"hull_draught_m", [](auto& o) { o.hull_draught_m = 100.0; }}});
  expect_all_named<MarinaOptions>({{"water_above_m", [](auto& o) { o.water_above_m = 0.1; }},
                                   {"water_below_m", [](auto& o) { o.water_below_m = kNaN; }}});
  expect_all_named<SeabedOptions>({{"side_m", [](auto& o) { o.side_m = 1.0; }},
                                   {"depth_m", [](auto& o) { o.depth_m = 1.0; }},
                                   {"slope", [](auto& o) { o.slope = 1.0; }},
                                   {"ripples", [](auto& o) { o.ripples = 3.0; }},
                                   {"boulders", [](auto& o) { o.boulders = 1001; }}});
  expect_all_named<CaveOptions>({{"length_m", [](auto& o) { o.length_m = 1.0; }},
                                 {"radius_m", [](auto& o) { o.radius_m = 1.0; }},
                                 {"bumps", [](auto& o) { o.bumps = 1.0; }}});
}

TEST(BrokenOptions, OfPicturesAreAllNamed) {
  expect_all_named<EchoPictureOptions>(
      {{"target_px", [](auto& o) { o.target_px = 1; }}, {"gamma", [](auto& o) { o.gamma = 0.0; }}});
  expect_all_named<CartesianPictureOptions>({{"target_px", [](auto& o) { o.style.target_px = 1; }},
                                             {"gamma", [](auto& o) { o.style.gamma = 0.0; }},
                                             {"beam_width_rad", [](auto& o) { o.beam_width_rad = 7.0; }}});
  expect_all_named<MapPictureOptions>({{"target_px", [](auto& o) { o.target_px = 1; }},
                                       {"min_z_m must be below", [](auto& o) { o.min_z_m = kNaN; }},
                                       {"layer_z_m", [](auto& o) { o.layer_z_m = kNaN; }}});
}

}  // namespace
}  // namespace pingvox
