#include "pingvox/sim/scene.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "base/option_errors.hpp"
#include "pingvox/geometry/random.hpp"
#include "pingvox/sim/sonar.hpp"

namespace pingvox {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// One fixed seed, so that the scenes never change.
constexpr std::uint64_t kSceneSeed = 2014;

constexpr Material kConcrete = {.scatter = 0.8, .glint = 0.6, .mirror = 0.3};
constexpr Material kSteel = {.scatter = 0.7, .glint = 1.2, .mirror = 0.4};
constexpr Material kMud = {.scatter = 0.15, .glint = 0.3, .mirror = 0.1};
constexpr Material kSand = {.scatter = 0.5, .glint = 0.3, .mirror = 0.1};
constexpr Material kRock = {.scatter = 1.0, .glint = 0.2, .mirror = 0.1};

/// Lanes along x from one corner of a rectangle to the other.
Route lanes(const Vector3d& from, const Vector3d& to, int count) {
  Route route;
  for (int lane = 0; lane < count; ++lane) {
    const double y = from.y() + (to.y() - from.y()) * lane / (count - 1);
    const bool is_back = lane % 2 == 1;
    const double third = (to.x() - from.x()) / 3.0;
    for (int i = 0; i < 4; ++i) {
      const double x = is_back ? to.x() - i * third : from.x() + i * third;
      route.waypoints_m.emplace_back(x, y, from.z());
    }
  }
  return route;
}

/// A rectangle, counter-clockwise, with cut corners for the vehicle to turn.
Route round(const Vector3d& low, const Vector3d& high) {
  const double cut = std::min(0.25 * std::min(high.x() - low.x(), high.y() - low.y()), 1.2);
  const double z = low.z();
  return {{{low.x() + cut, low.y(), z},
           {high.x() - cut, low.y(), z},
           {high.x(), low.y() + cut, z},
           {high.x(), high.y() - cut, z},
           {high.x() - cut, high.y(), z},
           {low.x() + cut, high.y(), z},
           {low.x(), high.y() - cut, z},
           {low.x(), low.y() + cut, z}},
          Route::End::kStarts};
}

/// A tube: `rows` rings of `around` points each; the last point of a ring is its first.
template <class PointAt>
TriangleMesh tube(std::size_t rows, std::size_t around, const PointAt& point_at) {
  TriangleMesh mesh;
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t i = 0; i < around; ++i) mesh.vertices_m.push_back(point_at(row, i));
  }
  const auto vertex = [around](std::size_t row, std::size_t i) {
    return static_cast<std::uint32_t>(row * around + i % around);
  };
  for (std::size_t row = 0; row + 1 < rows; ++row) {
    for (std::size_t i = 0; i < around; ++i) {
      mesh.triangles.push_back({vertex(row, i), vertex(row, i + 1), vertex(row + 1, i)});
      mesh.triangles.push_back({vertex(row, i + 1), vertex(row + 1, i + 1), vertex(row + 1, i)});
    }
  }
  return mesh;
}

/// Sum of waves in random directions: a smooth random function of two coordinates, about -1..1.
class Waves {
 public:
  Waves(Random& random, double longest) {
    for (std::size_t n = 0; n < waves_.size(); ++n) {
      const double angle = 2.0 * std::numbers::pi * random.uniform();
      const double length = longest * std::pow(0.62, static_cast<double>(n));
      waves_[n].turns_x = std::cos(angle) / length;
      waves_[n].turns_y = std::sin(angle) / length;
      waves_[n].phase = random.uniform();
      waves_[n].height = 0.4 * length / longest;
    }
  }
  double at(double x, double y) const {
    double sum = 0.0;
    for (const Wave& w : waves_)
      sum += w.height * std::sin(2.0 * std::numbers::pi * (w.turns_x * x + w.turns_y * y + w.phase));
    return sum;
  }

 private:
  struct Wave {
    double turns_x, turns_y, phase, height;
  };
  std::array<Wave, 6> waves_{};
};

/// A ship's hull below the water, keel down: full sections amidships, sharp ends.
TriangleMesh hull(const Vector3d& middle_of_deck, double length, double beam, double draught) {
  constexpr std::size_t kSections = 48, kAround = 48;
  return tube(kSections + 1, kAround, [&](std::size_t section, std::size_t i) -> Vector3d {
    const double along = 2.0 * static_cast<double>(section) / kSections - 1.0;
    // Half of the points make the deck, half the sides and the keel.
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / kAround;
    const double half_beam = 0.5 * beam * (1.0 - std::pow(along, 4.0));
    const double depth = draught * (1.0 - std::pow(along, 6.0));
    const double across = std::copysign(std::pow(std::abs(std::cos(angle)), 0.5), std::cos(angle));
    const double down = angle < std::numbers::pi ? 0.0 : std::pow(std::abs(std::sin(angle)), 0.5);
    return middle_of_deck + Vector3d(0.5 * length * along, half_beam * across, -depth * down);
  });
}

}  // namespace

const Route* Scene::route(Motion motion) const {
  switch (motion) {
    case Motion::kStill:
      return nullptr;
    case Motion::kLine:
      return &line;
    case Motion::kLawnMower:
      return &lawn_mower;
    case Motion::kLoop:
    case Motion::kByHand:
      return &loop;
  }
  return nullptr;
}

Scene tank_scene(const TankOptions& o) {
  assert(o.validate());
  Scene scene;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(-o.sensor_yaw_rad, Vector3d::UnitZ()).toRotationMatrix();
  const Vector3d middle = turn * Vector3d(-o.sensor_x_m, -o.sensor_y_m, 0.0);
  const double half = 0.5 * o.side_m;
  const Vector3d half_depth = 0.5 * o.depth_m * Vector3d::UnitZ();
  for (const auto& [x, y] : {std::pair{1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}}) {
    scene.world.add(Rectangle{middle + turn * Vector3d(half * x, half * y, 0.0),
                              turn * Vector3d(-half * y, half * x, 0.0), half_depth},
                    kConcrete);
  }
  if (o.floater_radius_m > 0.0) {
    const Vector3d axis =
        o.floater_range_m * Vector3d(std::cos(o.floater_bearing_rad), std::sin(o.floater_bearing_rad), 0.0);
    scene.world.add(Cylinder{axis - half_depth, 2.0 * half_depth, o.floater_radius_m}, kConcrete);
  }
  scene.water_m = scene.world.bounds();
  const Vector3d reach(0.2 * o.side_m, 0.2 * o.side_m, 0.0);
  scene.line = {{middle - Vector3d(reach.x(), 0.0, 0.0), middle + Vector3d(reach.x(), 0.0, 0.0)}, Route::End::kStays};
  scene.lawn_mower = lanes(middle - reach, middle + reach, 3);
  scene.loop = round(middle - reach, middle + reach);
  // That of the paper's recording, unless the tank is larger.
  scene.sonar_range_m = std::max(SonarOptions().range_m(), 1.1 * o.side_m);
  return scene;
}

Result<void> HarbourOptions::validate() const {
  OptionErrors errors;
  errors.require_within("length_m", length_m, 16.0, 200.0);
  errors.require_within("width_m", width_m, 12.0, 200.0);
  errors.require_within("water_above_m", water_above_m, 0.5, 50.0);
  errors.require_within("water_below_m", water_below_m, 0.5, 50.0);
  errors.require_within("piles", piles, 0, 6);
  errors.require_within("pile_radius_m", pile_radius_m, 0.01, 0.5);
  errors.require_within("hull_length_m", hull_length_m, 0.0, 0.45 * length_m);
  errors.require_within("hull_beam_m", hull_beam_m, 0.1, 3.0);
  errors.require_within("hull_draught_m", hull_draught_m, 0.1, water_above_m + water_below_m);
  return errors.result("harbour");
}

Scene harbour_scene(const HarbourOptions& o) {
  assert(o.validate());
  Scene scene;
  World& world = scene.world;
  const double x = 0.5 * o.length_m;
  const double y = 0.5 * o.width_m;
  const double height = o.water_above_m + o.water_below_m;
  const double middle_z = o.water_above_m - 0.5 * height;
  const Vector3d half_height(0.0, 0.0, 0.5 * height);
  world.add(Rectangle{{0.0, y, middle_z}, {x, 0.0, 0.0}, half_height}, kConcrete);
  world.add(Rectangle{{x, 0.0, middle_z}, {0.0, y, 0.0}, half_height}, kConcrete);
  world.add(Rectangle{{-x, 0.0, middle_z}, {0.0, y, 0.0}, half_height}, kConcrete);
  world.add(Rectangle{{0.0, 0.0, -o.water_below_m}, {x, 0.0, 0.0}, {0.0, y, 0.0}}, kMud);
  for (std::size_t n = 0; n < o.piles; ++n) {
    // From the corner on, 2 m apart, 3.5 m from the wall.
    world.add(
        Cylinder{
            {-x + 2.0 + 2.0 * static_cast<double>(n), y - 3.5, -o.water_below_m}, {0.0, 0.0, height}, o.pile_radius_m},
        kConcrete);
  }
  if (o.hull_length_m > 0.0) {
    world.add(hull({x - 2.0 - 0.5 * o.hull_length_m, y - 0.6 - 0.5 * o.hull_beam_m, o.water_above_m}, o.hull_length_m,
                   o.hull_beam_m, o.hull_draught_m),
              kSteel);
  }
  scene.water_m = {Vector3d(-x, -y, -o.water_below_m), Vector3d(x, y, o.water_above_m)};
  const Vector3d low(-x + 3.0, -y + 2.5, 0.0);
  const Vector3d high(x - 3.0, y - 5.5, 0.0);
  scene.line = {{{low.x(), 0.0, 0.0}, {high.x(), 0.0, 0.0}}, Route::End::kStays};
  scene.lawn_mower = lanes(low, high, 3);
  scene.loop = round(low, high);
  scene.sonar_range_m = 10.0;
  return scene;
}

Result<void> MarinaOptions::validate() const {
  OptionErrors errors;
  errors.require_within("water_above_m", water_above_m, 0.5, 50.0);
  errors.require_within("water_below_m", water_below_m, 0.5, 50.0);
  return errors.result("marina");
}

Scene marina_scene(const MarinaOptions& o) {
  assert(o.validate());
  using Eigen::Vector2d;
  // The shore, then two islands that the loop goes around, and two more between canals.
  static const std::array<std::vector<Vector2d>, 5> kQuays = {{
      {{-100.0, -62.0}, {-62.0, -64.0}, {-60.0, -16.0}, {-22.0, -15.0}, {-20.0, -76.0},  {-48.0, -78.0},
       {-50.0, -130.0}, {40.0, -132.0}, {42.0, -78.0},  {120.0, -74.0}, {121.0, -118.0}, {236.0, -122.0},
       {240.0, -60.0},  {300.0, -58.0}, {298.0, 30.0},  {285.0, 60.0},  {288.0, 168.0},  {170.0, 165.0},
       {166.0, 72.0},   {100.0, 70.0},  {98.0, 140.0},  {30.0, 144.0},  {28.0, 69.0},    {-24.0, 71.0},
       {-26.0, 150.0},  {-92.0, 146.0}, {-96.0, 60.0},  {-100.0, 20.0}},
      {{14.0, -16.0}, {62.0, -14.0}, {64.0, -20.0}, {86.0, -18.0}, {88.0, -43.0}, {40.0, -46.0}, {16.0, -44.0}},
      {{16.0, 15.0}, {50.0, 14.0}, {76.0, 16.0}, {74.0, 40.0}, {45.0, 42.0}, {44.0, 36.0}, {18.0, 39.0}},
      {{122.0, 18.0}, {200.0, 15.0}, {202.0, 38.0}, {124.0, 42.0}},
      {{-62.0, 16.0}, {-24.0, 15.0}, {-26.0, 44.0}, {-58.0, 47.0}},
  }};
  Scene scene;
  World& world = scene.world;
  const double height = o.water_above_m + o.water_below_m;
  const Vector3d half_height(0.0, 0.0, 0.5 * height);
  for (const std::vector<Vector2d>& quay : kQuays) {
    for (std::size_t n = 0; n < quay.size(); ++n) {
      const Vector2d& from = quay[n];
      const Vector2d& to = quay[(n + 1) % quay.size()];
      const Vector2d middle = 0.5 * (from + to);
      const Vector2d half = 0.5 * (to - from);
      world.add(
          Rectangle{{middle.x(), middle.y(), o.water_above_m - 0.5 * height}, {half.x(), half.y(), 0.0}, half_height},
          kConcrete);
    }
  }
  world.add(Rectangle{{100.0, 18.0, -o.water_below_m}, {200.0, 0.0, 0.0}, {0.0, 150.0, 0.0}}, kMud);
  // Moored along the quays: middle, length and beam.
  for (const auto& [x, y, length, beam] : {std::array{35.0, -17.5, 9.0, 2.8},
                                           {75.0, -48.0, 12.0, 3.4},
                                           {-8.0, 66.0, 11.0, 3.2},
                                           {60.0, 66.5, 8.0, 2.6},
                                           {140.0, 13.0, 14.0, 4.0},
                                           {-45.0, 11.5, 10.0, 3.0},
                                           {150.0, -70.0, 12.0, 3.2}}) {
    world.add(hull({x, y, o.water_above_m}, length, beam, std::min(2.6, 0.8 * height)), kSteel);
  }
  for (const auto& [x, y] : {std::pair{105.0, -25.0},
                             {107.0, -35.0},
                             {-12.0, 30.0},
                             {-14.0, 38.0},
                             {98.0, 30.0},
                             {5.0, -30.0},
                             {180.0, 80.0},
                             {190.0, 80.0},
                             {200.0, 80.0},
                             {-70.0, 90.0}}) {
    world.add(Cylinder{{x, y, -o.water_below_m}, {0.0, 0.0, height}, 0.3}, kConcrete);
  }
  scene.water_m = {Vector3d(-100.0, -132.0, -o.water_below_m), Vector3d(300.0, 168.0, o.water_above_m)};
  scene.line = {{{-40.0, 0.0, 0.0}, {120.0, 0.0, 0.0}}, Route::End::kStays};
  scene.lawn_mower = lanes({-8.0, -6.0, 0.0}, {100.0, 6.0, 0.0}, 3);
  // The canal between the islands is gone through twice, first ahead, then back.
  scene.loop = {{{0.0, 0.0, 0.0},    {50.0, -1.0, 0.0},  {92.0, -1.0, 0.0}, {101.0, -12.0, 0.0}, {101.0, -50.0, 0.0},
                 {92.0, -59.0, 0.0}, {50.0, -62.0, 0.0}, {8.0, -60.0, 0.0}, {-2.0, -50.0, 0.0},  {-3.0, -10.0, 0.0},
                 {-4.0, 44.0, 0.0},  {6.0, 54.0, 0.0},   {45.0, 56.0, 0.0}, {80.0, 54.0, 0.0},   {88.0, 44.0, 0.0},
                 {88.0, 12.0, 0.0},  {78.0, 3.0, 0.0},   {45.0, 3.0, 0.0},  {10.0, 6.0, 0.0},    {-8.0, 6.0, 0.0}},
                Route::End::kStarts};
  scene.sonar_range_m = 50.0;
  scene.beams_per_s = 14.5;
  scene.cell_m = 0.2;
  return scene;
}

Result<void> SeabedOptions::validate() const {
  OptionErrors errors;
  errors.require_within("side_m", side_m, 20.0, 200.0);
  errors.require_within("depth_m", depth_m, 1.5, 50.0);
  errors.require_within("slope", slope, -0.1, 0.1);
  errors.require_within("ripples", ripples, 0.0, 2.0);
  errors.require_within("boulders", boulders, 0, 1000);
  return errors.result("seabed");
}

Scene seabed_scene(const SeabedOptions& o) {
  assert(o.validate());
  constexpr double kStep_m = 0.2;
  Scene scene;
  World& world = scene.world;
  Random random(kSceneSeed);
  const double half = 0.5 * o.side_m;
  const Waves waves(random, 7.0);
  // The bottom is cut off flat where it would leave the vehicle no room.
  const auto bottom = [&](double x, double y) {
    return std::min(-o.depth_m + o.slope * y + 0.3 * o.ripples * waves.at(x, y), -0.7);
  };
  const auto steps = static_cast<std::size_t>(std::ceil(o.side_m / kStep_m));
  const double step = o.side_m / static_cast<double>(steps);
  std::vector<double> heights;
  for (std::size_t row = 0; row <= steps; ++row) {
    for (std::size_t column = 0; column <= steps; ++column) {
      heights.push_back(bottom(static_cast<double>(column) * step - half, static_cast<double>(row) * step - half));
    }
  }
  world.add(heightfield(heights, steps + 1, {-half, -half, 0.0}, step), kSand);

  const auto add_boulder = [&](double x, double y, const Vector3d& radii) {
    Pose pose = Pose::Identity();
    pose.translation() = Vector3d(x, y, bottom(x, y));
    pose.linear() = Eigen::AngleAxisd(2.0 * std::numbers::pi * random.uniform(), Vector3d::UnitZ()).toRotationMatrix();
    world.add(Ellipsoid{pose, radii}, kRock);
  };
  // Tall ones, between the lanes.
  for (const auto& [x, y] : {std::pair{-5.0, 4.0}, {3.0, 4.0}, {6.0, -4.0}, {-3.0, -4.0}, {-6.0, 0.0}, {5.5, 0.0}}) {
    const double width = 0.7 + 0.3 * random.uniform();
    const double slenderness = 0.8 + 0.2 * random.uniform();
    add_boulder(x, y, {width, slenderness * width, 0.6 - bottom(x, y)});
  }
  for (std::size_t n = 0; n < o.boulders; ++n) {
    const double x = (random.uniform() - 0.5) * (o.side_m - 3.0);
    const double y = (random.uniform() - 0.5) * (o.side_m - 3.0);
    const double width = 0.25 + 0.45 * random.uniform();
    const double length = width * (0.7 + 0.5 * random.uniform());
    const double height = std::min(width * (0.6 + 0.6 * random.uniform()), -0.5 - bottom(x, y));
    if (height > 0.1) add_boulder(x, y, {length, width, height});
  }
  const Vector3d corner(half, half, 2.0);
  scene.water_m = {Vector3d(-half, -half, *std::min_element(heights.begin(), heights.end())), corner};
  scene.line = {{{-8.0, 2.0, 0.0}, {8.0, 2.0, 0.0}}, Route::End::kStays};
  scene.lawn_mower = lanes({-8.0, -6.0, 0.0}, {8.0, 6.0, 0.0}, 4);
  scene.loop = round({-8.5, -6.5, 0.0}, {8.5, 6.5, 0.0});
  scene.sonar_range_m = 8.0;
  return scene;
}

Result<void> CaveOptions::validate() const {
  OptionErrors errors;
  errors.require_within("length_m", length_m, 10.0, 500.0);
  errors.require_within("radius_m", radius_m, 1.5, 50.0);
  errors.require_within("bumps", bumps, 0.0, 0.3);
  return errors.result("cave");
}

Scene cave_scene(const CaveOptions& o) {
  assert(o.validate());
  constexpr std::size_t kAround = 72;
  Scene scene;
  Random random(kSceneSeed);
  const Waves lengthwise(random, 5.0);
  // Three metres of it lie behind the origin.
  const double start = -3.0;
  const auto middle = [](double x) -> Vector3d { return {x, 1.3 * std::sin(0.35 * x), 0.0}; };
  const auto rows = static_cast<std::size_t>(std::ceil(o.length_m / 0.2)) + 1;
  scene.world.add(tube(rows, kAround,
                       [&](std::size_t row, std::size_t i) -> Vector3d {
                         const double share = static_cast<double>(row) / static_cast<double>(rows - 1);
                         const double x = start + share * o.length_m;
                         const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / kAround;
                         const double y = std::cos(angle);
                         const double z = std::sin(angle);
                         // Waves on the tunnel's wall, laid out so that they meet all the way around.
                         const double bump = o.bumps * (0.6 * lengthwise.at(x + 2.5 * z, 2.5 * y) +
                                                        0.4 * lengthwise.at(2.0 * x + 4.0 * y, 4.0 * z));
                         // Rounded ends.
                         const double from_end = std::min(x - start, start + o.length_m - x) / o.radius_m;
                         const double end =
                             from_end < 1.0 ? std::sqrt(std::max(0.0, from_end * (2.0 - from_end))) : 1.0;
                         return middle(x) + o.radius_m * end * (1.0 + bump) * Vector3d(0.0, y, z);
                       }),
                  kRock);
  scene.water_m = scene.world.bounds();
  const double last = start + o.length_m - 2.0;
  const auto beside = [&](double x, double off) -> Vector3d { return middle(x) + Vector3d(0.0, off, 0.0); };
  const double off = 0.2 * o.radius_m;
  for (double x = -1.0; x <= last; x += 1.0) {
    scene.line.waypoints_m.push_back(beside(x, 0.0));
    scene.loop.waypoints_m.push_back(beside(x, -off));
  }
  const std::size_t there = scene.loop.waypoints_m.size();
  for (std::size_t n = there; n-- > 0;) {
    const Vector3d back = scene.loop.waypoints_m[n] + Vector3d(0.0, 2.0 * off, 0.0);
    scene.loop.waypoints_m.push_back(back);
  }
  scene.loop.end = Route::End::kStarts;
  for (double x = -1.0; x <= last; x += 2.0) {
    const double side = std::fmod(x + 1.0, 4.0) < 1.0 ? off : -off;
    scene.lawn_mower.waypoints_m.push_back(beside(x, side));
    scene.lawn_mower.waypoints_m.push_back(beside(x + 0.2, -side));
  }
  scene.sonar_range_m = 6.0;
  return scene;
}

Result<Scene> mesh_scene(TriangleMesh mesh) {
  if (mesh.triangles.empty()) return fail(Error::Code::kBadOption, "the mesh has no triangles");
  Scene scene;
  scene.world.add(std::move(mesh), kRock);
  const AlignedBox3d box = scene.world.bounds();
  if (!(box.sizes().maxCoeff() <= 10'000.0 && box.max().cwiseAbs().maxCoeff() <= 1e6)) {
    return fail(
        Error::Code::kBadOption,
        fmt::format("the mesh is {:.6g} x {:.6g} x {:.6g} m in size: more than 10 km, or too far from its origin",
                    box.sizes().x(), box.sizes().y(), box.sizes().z()));
  }
  constexpr double kClear_m = 1.5;
  const Vector3d low = box.min() - Vector3d::Constant(kClear_m);
  const Vector3d high = box.max() + Vector3d::Constant(kClear_m);
  const double z = box.center().z();
  scene.line = {{{low.x(), low.y(), z}, {high.x(), low.y(), z}}, Route::End::kStays};
  scene.lawn_mower = lanes({low.x(), low.y(), high.z()}, {high.x(), high.y(), high.z()}, 4);
  scene.loop = round({low.x(), low.y(), z}, {high.x(), high.y(), z});
  scene.water_m = {low - Vector3d::Constant(1.0), high + Vector3d::Constant(1.0)};
  scene.sonar_range_m = std::clamp(0.6 * box.diagonal().norm(), 3.0, 50.0);
  return scene;
}

}  // namespace pingvox
