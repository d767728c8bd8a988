#include "drives/locate.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "app/world_map.hpp"
#include "drives/drive.hpp"
#include "paired_timing.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/random.hpp"
#include "pingvox/mapping/build_map.hpp"
#include "pingvox/sim/sonar.hpp"
#include "pingvox/slam/localizer.hpp"
#include "pingvox/slam/odometry.hpp"
#include "pingvox/slam/slam_smoother.hpp"
#include "pingvox/sonar/sweep.hpp"
#include "slam/localisation/beam_likelihood.hpp"
#include "tank_beams.hpp"

namespace pingvox::bench {
namespace {

/// The layer of a map in which the head turns.
Result<DistanceField> field_of(const OccupancyMap& map) {
  return DistanceField::make(map, {});
}

Result<DistanceField> true_field(const Scene& scene) {
  const Result<OccupancyMap> map = app::world_map(scene.world, scene.water_m, Eigen::Vector3d::Zero(), scene.cell_m);
  if (!map) return tl::unexpected(map.error());
  return field_of(*map);
}

/// Distance and angle between two poses in the plane.
struct Offset {
  double m, rad;
};
Offset between(const Pose& a, const Pose& b) {
  const Eigen::Matrix3d turn = a.rotation().transpose() * b.rotation();
  return {(a.translation() - b.translation()).head<2>().norm(), std::abs(std::atan2(turn(1, 0), turn(0, 0)))};
}

/// What is known of the motion.
enum class Known {
  kNothing,
  kNavigation,  ///< dead reckoning by velocity and compass
  kMotion,      ///< the true steps
};
std::string_view name_of(Known known) {
  return known == Known::kNothing ? "nothing" : known == Known::kNavigation ? "navigation" : "true motion";
}

struct Sums {
  std::size_t poses = 0, sure = 0, sure_and_wrong = 0;
  double m2 = 0.0, rad2 = 0.0;

  void add(const Offset& error, bool is_sure) {
    ++poses;
    m2 += error.m * error.m;
    rad2 += error.rad * error.rad;
    if (!is_sure) return;
    ++sure;
    if (error.m > 0.5) ++sure_and_wrong;
  }
  double rmse_m() const { return std::sqrt(m2 / static_cast<double>(poses)); }
  double yaw_rmse_deg() const { return std::sqrt(rad2 / static_cast<double>(poses)) / kDegree_rad; }
};

/// Errors of the same poses by all of the recording.
Result<Sums> smooth(const Drive& drive, const DistanceField& field, std::vector<StampedPose> found) {
  const Result<Trajectory> near = Trajectory::make(std::move(found));
  if (!near) return tl::unexpected(near.error());
  SlamSmoother smoother({});
  for (const Beam& beam : drive.beams) smoother.add(beam);
  if (const auto added = smoother.add(drive.nav); !added) return tl::unexpected(added.error());
  const Result<MapSolution> solution = smoother.solve_in(field, *near);
  if (!solution) return tl::unexpected(solution.error());
  Sums sums;
  for (const StampedPose& pose : solution->trajectory.poses()) {
    if (const auto truth = drive.reference.at(pose.time_s)) sums.add(between(pose.map_from_body, *truth), false);
  }
  return sums;
}

/// Errors from when the vehicle is found.
Result<Row> follow(std::string_view world, Known known, const Drive& drive, const DistanceField& field,
                   std::uint64_t seed) {
  std::optional<Trajectory> odometry;
  if (known == Known::kMotion) odometry = drive.reference;
  if (known == Known::kNavigation) {
    Result<Odometry> reckoned = odometry_of(drive.nav, {.body_from_source = {}, .turns = TurnsBy::kTurnRate});
    if (!reckoned) return tl::unexpected(reckoned.error());
    odometry = std::move(reckoned->odometry_from_body);
  }
  LocalizerOptions options;
  options.seed = seed;
  std::vector<Beam> beams = drive.beams;
  const double recorded_s = beams.back().time_s - beams.front().time_s, begin_s = beams.front().time_s;
  const double before_s = cpu_time_s();
  Localizer localizer(field, options);
  std::vector<StampedPose> found;
  Sums sums;
  double found_s = std::numeric_limits<double>::quiet_NaN();
  for (Beam& beam : beams) {
    const double time_s = beam.time_s;
    if (const auto pose = odometry ? odometry->at(time_s) : std::nullopt) localizer.add({time_s, *pose});
    if (const auto added = localizer.add(std::move(beam)); !added) return tl::unexpected(added.error());
    const auto located = localizer.pose();
    const auto truth = drive.reference.at(time_s);
    if (!located || !truth) continue;
    if (found.empty() || time_s > found.back().time_s) found.push_back({time_s, located->map_from_body});
    if (sums.poses == 0) found_s = time_s - begin_s;
    sums.add(between(located->map_from_body, *truth), localizer.is_sure());
  }
  const double took_s = cpu_time_s() - before_s;
  const auto count = static_cast<double>(sums.poses);
  Row row;
  row.add("name", "locate")
      .add("world", world)
      .add("known", name_of(known))
      .add("seed", seed)
      .add("beams", std::uint64_t{drive.beams.size()})
      .add("found_after_s", found_s)
      .add("rmse_m", sums.rmse_m())
      .add("yaw_rmse_deg", sums.yaw_rmse_deg())
      .add("sure", static_cast<double>(sums.sure) / count)
      .add("sure_and_wrong", std::uint64_t{sums.sure_and_wrong})
      .add("share_of_core", took_s / recorded_s);
  if (known != Known::kNavigation || found.size() < 2) return row;
  const double smoothing_s = cpu_time_s();
  const auto smoothed = smooth(drive, field, std::move(found));
  if (!smoothed) return tl::unexpected(smoothed.error());
  row.add("smoothed_rmse_m", smoothed->rmse_m())
      .add("smoothed_yaw_rmse_deg", smoothed->yaw_rmse_deg())
      .add("smoothing_s", cpu_time_s() - smoothing_s);
  return row;
}

/// Every other sweep makes the map, the rest is found in it. The vehicle stood still.
Result<Row> follow_recorded_tank() {
  const Result<TankBeams> tank = tank_beams();
  if (!tank) return tl::unexpected(tank.error());
  SweepAssembler assembler;
  std::vector<Beam> mapped, found;
  std::size_t sweeps = 0;
  const auto take = [&](const std::optional<Sweep>& sweep) {
    if (!sweep) return;
    std::vector<Beam>& part = sweeps++ % 2 == 0 ? mapped : found;
    part.insert(part.end(), sweep->beams.begin(), sweep->beams.end());
  };
  for (const Beam& beam : tank->beams) take(assembler.add(beam));
  take(assembler.finish());
  OccupancyMap map({.resolution_m = 0.05});
  BeamsInMemory source(std::move(mapped));
  const BuildOptions rays{.filter = {}, .echo = {}, .model = {.shape = BeamShape::kRay}};
  if (const auto built = build_map(source, Trajectory::still(Pose::Identity()), rays, map); !built) {
    return tl::unexpected(built.error());
  }
  Result<DistanceField> field = field_of(map);
  if (!field) return tl::unexpected(field.error());
  const Result<NavLog> none = NavLog::make({}, NavClock::kUnknown);
  if (!none) return tl::unexpected(none.error());
  const Drive drive{std::move(found), *none, Pose::Identity(), Trajectory::still(Pose::Identity())};
  return follow(tank->input == "recording" ? "tank, recorded" : "tank, simulated, other sweeps", Known::kNothing, drive,
                *field, 1);
}

constexpr std::size_t kPlaces = 100, kTurns = 3;

/// Random poses in the free water of a harbour.
std::vector<Pose> random_places(const Scene& harbour, const DistanceField& field, std::size_t count) {
  constexpr double kFromWalls_m = 0.8;
  Random random(1);
  const Eigen::AlignedBox3d& water = harbour.water_m;
  std::vector<Pose> places;
  while (places.size() < count) {
    const Eigen::Vector2d place =
        water.min().head<2>() +
        Eigen::Vector2d(random.uniform(), random.uniform()).cwiseProduct(water.sizes().head<2>());
    const double yaw_rad = 2.0 * std::numbers::pi * random.uniform();
    if (field.classify(place) != Occupancy::kFree || field.distance_m(place) < kFromWalls_m) continue;
    places.push_back(pose_from_rpy({place.x(), place.y(), 0.0}, 0.0, 0.0, yaw_rad));
  }
  return places;
}

bool is_right(const std::optional<Localizer::Located>& located, const Pose& truth) {
  constexpr double kRight_m = 0.3, kRight_rad = 5.0 * kDegree_rad;
  if (!located) return false;
  const Offset error = between(located->map_from_body, truth);
  return error.m <= kRight_m && error.rad <= kRight_rad;
}

/// Calls `heard(time_s)` after each beam of three turns of the head at a place, from a time on.
template <class Heard>
Result<void> hear_at(const Pose& place, const Scene& harbour, std::uint64_t seed, double from_s, Localizer& localizer,
                     const Heard& heard) {
  SonarOptions sonar;
  sonar.seed = seed;
  sonar.beams_per_s = harbour.beams_per_s;
  sonar.bin_length_m = harbour.sonar_range_m / static_cast<double>(sonar.bins);
  SonarSimulator simulator(harbour.world, Trajectory::still(place), sonar, kTurns);
  for (;;) {
    Result<std::optional<Beam>> beam = simulator.next();
    if (!beam) return tl::unexpected(beam.error());
    if (!*beam) return {};
    (*beam)->time_s += from_s;
    const double time_s = (*beam)->time_s;
    if (const auto added = localizer.add(**std::move(beam)); !added) return added;
    heard(time_s);
  }
}

/// Random places of a harbour, each for three turns of the head.
Result<Row> find_places(const Scene& harbour, const DistanceField& field, const BenchOptions& options) {
  std::uint64_t n = 0, right = 0, right_and_sure = 0, wrong_and_sure = 0, not_found = 0;
  for (const Pose& truth : random_places(harbour, field, kPlaces)) {
    if (++n % 20 == 0 && options.say != nullptr) options.say(fmt::format("  {} of {} places", n, kPlaces));
    Localizer localizer(field, {});
    if (const auto done = hear_at(truth, harbour, n, 0.0, localizer, [](double) {}); !done) {
      return tl::unexpected(done.error());
    }
    localizer.finish();
    const auto located = localizer.pose();
    if (!located) ++not_found;
    if (is_right(located, truth)) ++right;
    if (localizer.is_sure()) ++(is_right(located, truth) ? right_and_sure : wrong_and_sure);
  }
  Row row;
  row.add("name", "locate-places")
      .add("world", "harbour")
      .add("places", std::uint64_t{kPlaces})
      .add("turns", std::uint64_t{kTurns})
      .add("right", right)
      .add("right_and_sure", right_and_sure)
      .add("wrong_and_sure", wrong_and_sure)
      .add("not_found", not_found);
  return row;
}

/// From one of the places to the next, without notice, three turns of the head at each.
Result<Row> kidnap(const Scene& harbour, const DistanceField& field, const BenchOptions& options) {
  const std::vector<Pose> places = random_places(harbour, field, kPlaces + 1);
  std::uint64_t was_sure = 0, right = 0, right_and_sure = 0, wrong_and_sure = 0;
  double longest_sure_s = 0.0;  // of the place where it no longer is
  for (std::size_t n = 0; n < kPlaces; ++n) {
    if (n % 20 == 0 && options.say != nullptr) options.say(fmt::format("  {} of {} kidnaps", n, kPlaces));
    Localizer localizer(field, {});
    double time_s = 0.0;
    const auto keep_time = [&](double now_s) { time_s = now_s; };
    if (const auto done = hear_at(places[n], harbour, 1000 + n, 0.0, localizer, keep_time); !done) {
      return tl::unexpected(done.error());
    }
    if (localizer.is_sure()) ++was_sure;
    const double kidnapped_s = time_s + 1.0 / harbour.beams_per_s;
    const Pose& truth = places[n + 1];
    const auto note = [&](double now_s) {
      if (localizer.is_sure() && !is_right(localizer.pose(), truth)) {
        longest_sure_s = std::max(longest_sure_s, now_s - kidnapped_s);
      }
    };
    if (const auto done = hear_at(truth, harbour, 2000 + n, kidnapped_s, localizer, note); !done) {
      return tl::unexpected(done.error());
    }
    localizer.finish();
    const bool found = is_right(localizer.pose(), truth);
    if (found) ++right;
    if (localizer.is_sure()) ++(found ? right_and_sure : wrong_and_sure);
  }
  Row row;
  row.add("name", "locate-kidnaps")
      .add("world", "harbour")
      .add("kidnaps", std::uint64_t{kPlaces})
      .add("turns", std::uint64_t{kTurns})
      .add("sure_before", was_sure)
      .add("right", right)
      .add("right_and_sure", right_and_sure)
      .add("wrong_and_sure", wrong_and_sure)
      .add("longest_sure_of_old_s", longest_sure_s);
  return row;
}

/// A million poses by the ends of 200 beams.
Result<Row> score_poses(const DistanceField& field) {
  constexpr std::size_t kPoses = 1'000'000, kBlock = 10'000, kBeams = 200, kChecked = 100;
  Random random(1);
  std::vector<HeardBeam> beams(kBeams);
  std::vector<EndTable> tables;
  for (HeardBeam& beam : beams) {
    const double bearing_rad = 2.0 * std::numbers::pi * random.uniform();
    beam.direction = {std::cos(bearing_rad), std::sin(bearing_rad)};
    beam.range_m = 10.0 * random.uniform();
    beam.has_echo = true;
    tables.emplace_back(beam, field, BeamLikelihood{});
  }
  std::vector<double> x(kPoses), y(kPoses), cosine(kPoses), sine(kPoses);
  for (std::size_t i = 0; i < kPoses; ++i) {
    x[i] = 20.0 * random.uniform() - 10.0;
    y[i] = 14.0 * random.uniform() - 7.0;
    const double yaw_rad = 2.0 * std::numbers::pi * random.uniform();
    cosine[i] = std::cos(yaw_rad);
    sine[i] = std::sin(yaw_rad);
  }
  std::vector<float> sums(kPoses, 0.0F);
  const double before_s = cpu_time_s();
  for (std::size_t first = 0; first < kPoses; first += kBlock) {
    const auto block = [&](const std::vector<double>& all) { return std::span(all).subspan(first, kBlock); };
    for (std::size_t b = 0; b < kBeams; ++b) {
      add_end_likelihood(field, tables[b], beams[b].end_m(), block(x), block(y), block(cosine), block(sine),
                         std::span(sums).subspan(first, kBlock));
    }
  }
  const double took_s = cpu_time_s() - before_s;
  for (std::size_t i = 0; i < kChecked; ++i) {
    double sum = 0.0;
    for (std::size_t b = 0; b < kBeams; ++b) {
      const Eigen::Vector2d end = beams[b].end_m();
      sum += tables[b][field.value_at(x[i] + cosine[i] * end.x() - sine[i] * end.y(),
                                      y[i] + sine[i] * end.x() + cosine[i] * end.y())];
    }
    if (std::abs(sum - sums[i]) > 1e-3 * std::max(1.0, std::abs(sum))) {
      return fail(Error::Code::kCorrupt, fmt::format("pose {} has {}, not {}", i, sums[i], sum));
    }
  }
  Row row;
  row.add("name", "locate-scoring")
      .add_truth("checked", true)
      .add("poses", std::uint64_t{kPoses})
      .add("beams", std::uint64_t{kBeams})
      .add("seconds", took_s)
      .add("pose_beams_per_s", static_cast<double>(kPoses) * static_cast<double>(kBeams) / took_s);
  return row;
}

}  // namespace

Result<std::vector<Row>> locate(const BenchOptions& options) {
  constexpr std::uint64_t kSeeds = 5;
  const Scene tank = tank_scene({}), harbour = harbour_scene({});
  const Result<DistanceField> tank_field = true_field(tank), harbour_field = true_field(harbour);
  if (!tank_field) return tl::unexpected(tank_field.error());
  if (!harbour_field) return tl::unexpected(harbour_field.error());
  std::vector<Row> rows;
  const auto keep = [&](Result<Row> row) -> Result<void> {
    if (!row) return tl::unexpected(row.error());
    rows.push_back(*std::move(row));
    return {};
  };
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    if (options.say != nullptr) options.say(fmt::format("  drives, seed {}", seed));
    const Result<Drive> in_tank = simulate_drive(tank, Motion::kLoop, std::nullopt, seed),
                        in_harbour = simulate_drive(harbour, Motion::kLoop, std::nullopt, seed);
    if (!in_tank) return tl::unexpected(in_tank.error());
    if (!in_harbour) return tl::unexpected(in_harbour.error());
    for (const Known known : {Known::kMotion, Known::kNavigation}) {
      if (auto done = keep(follow("tank", known, *in_tank, *tank_field, seed)); !done) {
        return tl::unexpected(done.error());
      }
      if (auto done = keep(follow("harbour", known, *in_harbour, *harbour_field, seed)); !done) {
        return tl::unexpected(done.error());
      }
    }
  }
  if (auto done = keep(follow_recorded_tank()); !done) return tl::unexpected(done.error());
  if (auto done = keep(find_places(harbour, *harbour_field, options)); !done) return tl::unexpected(done.error());
  if (auto done = keep(kidnap(harbour, *harbour_field, options)); !done) return tl::unexpected(done.error());
  if (auto done = keep(score_poses(*harbour_field)); !done) return tl::unexpected(done.error());
  return rows;
}

}  // namespace pingvox::bench
