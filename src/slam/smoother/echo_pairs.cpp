#include "slam/smoother/echo_pairs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose2.hpp"
#include "pingvox/geometry/random.hpp"

namespace pingvox {
namespace {

/// The line of a wall.
constexpr std::size_t kLineEchoes = 5, kMinLineEchoes = 4;
constexpr double kLineReach_m = 5.0, kWidthOfLength = 0.25;

/// Which sweeps are partners of a sweep: these many before and after it, and some that are near in place only.
constexpr std::array<std::size_t, 5> kNear = {1, 2, 3, 5, kFarthestNear};
constexpr std::size_t kLoopPairs = 10;

constexpr double kMinAgreement = 0.85;  ///< of two normals, cosine
/// Noise of an echo: of its place in a run and at a crest, of half its length along the beam, of the beam's direction.
constexpr double kMiddle_m = 0.3, kCrest_m = 0.1, kOfHalfLength = 0.3, kBearing_rad = 1.0 * kDegree_rad;
/// The pairs of an echo weigh half an echo together, and a pair is of two echoes.
constexpr double kWeightOfEcho = 0.25;
constexpr double kRobustOfGate = 0.35;
/// The same of an echo and a wall of a map.
constexpr double kMapPlace_m = 0.05, kOfCell = 0.3, kMapBearing_rad = 0.6 * kDegree_rad, kMapWeight = 0.25;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// The echoes of one sweep in order of x, for searches of the nearest.
class SweepIndex {
 public:
  SweepIndex(std::span<const EchoOnGround> ground, std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) echoes_.push_back({ground[i].at, static_cast<std::uint32_t>(i)});
    std::ranges::sort(echoes_, {}, [](const Entry& e) { return std::pair(e.at.x(), e.echo); });
  }

  struct Entry {
    Eigen::Vector2d at;
    std::uint32_t echo;
  };
  /// Calls visit(entry, square of its distance) for each echo within `reach_m`; its return value is the new reach.
  template <class Visit>
  void near(const Eigen::Vector2d& place, double reach_m, Visit visit) const {
    const auto middle = std::ranges::lower_bound(echoes_, place.x(), {}, [](const Entry& e) { return e.at.x(); });
    auto up = middle, down = middle;
    double square = reach_m * reach_m;
    bool has_up = true, has_down = true;
    while (has_up || has_down) {
      has_up = up != echoes_.end() && (up->at.x() - place.x()) * (up->at.x() - place.x()) <= square;
      if (has_up) {
        if (const double d = (up->at - place).squaredNorm(); d <= square) square = visit(*up, d, square);
        ++up;
      }
      has_down =
          down != echoes_.begin() && ((down - 1)->at.x() - place.x()) * ((down - 1)->at.x() - place.x()) <= square;
      if (has_down) {
        --down;
        if (const double d = (down->at - place).squaredNorm(); d <= square) square = visit(*down, d, square);
      }
    }
  }

 private:
  std::vector<Entry> echoes_;
};

std::vector<SweepIndex> index_sweeps(std::span<const EchoOnGround> ground, std::span<const std::size_t> sweeps) {
  std::vector<SweepIndex> indices;
  for (std::size_t s = 0; s + 1 < sweeps.size(); ++s) indices.emplace_back(ground, sweeps[s], sweeps[s + 1]);
  return indices;
}

double variance_of(const PlacedEcho& echo, const EchoOnGround& ground, const Eigen::Vector2d& normal, double scale) {
  // A crest is as sharp as the sonar draws it, not as far as it reaches.
  const double place_m = echo.run.place == EchoRun::Place::kCrest ? kCrest_m : scale * kMiddle_m;
  const double along = kOfHalfLength * echo.run.half_length_m * normal.dot(ground.ray);
  const double across = kBearing_rad * echo.run.range_m * cross(normal, ground.ray);
  return place_m * place_m + along * along + across * across;
}

}  // namespace

Eigen::Vector2d normal_of(std::span<const Eigen::Vector2d> points) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : points) mean += p;
  mean /= static_cast<double>(points.size());
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (const Eigen::Vector2d& p : points) {
    const Eigen::Vector2d d = p - mean;
    xx += d.x() * d.x();
    xy += d.x() * d.y();
    yy += d.y() * d.y();
  }
  const double middle = 0.5 * (xx + yy), half = std::hypot(0.5 * (xx - yy), xy);
  const double long_square = middle + half, wide_square = std::max(0.0, middle - half);
  if (!(long_square > 0.0) || wide_square >= kWidthOfLength * kWidthOfLength * long_square) {
    return Eigen::Vector2d::Zero();
  }
  const double along_rad = 0.5 * std::atan2(2.0 * xy, xx - yy);
  return {-std::sin(along_rad), std::cos(along_rad)};
}

double yaw_of(const PlacedEcho& echo, const Unknowns& unknowns) {
  if (echo.fixed) return echo.fixed->yaw_rad;
  const double error_rad =
      unknowns.knots[echo.knot].z() + echo.share * (unknowns.knots[echo.knot + 1].z() - unknowns.knots[echo.knot].z());
  return echo.main_yaw_rad + error_rad;
}

std::uint64_t partner_rank(std::uint64_t seed, std::size_t sweep, std::size_t other) {
  const auto mix = [](std::uint64_t bits) { return Random(bits).bits(); };
  return mix(mix(mix(seed) ^ std::min(sweep, other)) ^ std::max(sweep, other));
}

EchoOnGround place_echo(const SlamProblem& problem, const Pose2& mount, const Unknowns& unknowns,
                        const std::vector<SlamProblem::Way>& ways, const PlacedEcho& echo) {
  EchoOnGround ground;
  Eigen::Vector2d place_m;
  if (echo.fixed) {
    place_m = echo.fixed->place_m;
  } else {
    place_m = unknowns.knots[echo.knot].head<2>() +
              echo.share * (unknowns.knots[echo.knot + 1] - unknowns.knots[echo.knot]).head<2>();
    ground.bulge = problem.bulge(unknowns, ways[echo.knot], echo.knot, echo.run.time_s);
  }
  const double yaw_rad = yaw_of(echo, unknowns);
  const double ray_rad = yaw_rad + mount.yaw_rad + echo.run.bearing_rad;
  ground.ray = {std::cos(ray_rad), std::sin(ray_rad)};
  const auto& g = unknowns.globals;
  const Eigen::Vector2d lever = mount.place_m + Eigen::Vector2d(g[global::kSonarX], g[global::kSonarY]);
  const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  ground.arm = Eigen::Vector2d(c * lever.x() - s * lever.y(), s * lever.x() + c * lever.y()) +
               (echo.run.range_m + g[global::kWall] * echo.run.half_length_m) * ground.ray;
  ground.at = place_m + ground.bulge + ground.arm;
  return ground;
}

std::vector<EchoOnGround> place_echoes(const SlamProblem& problem, const Pose2& mount, const Unknowns& unknowns,
                                       const std::vector<SlamProblem::Way>& ways, std::span<const PlacedEcho> echoes,
                                       std::span<const std::size_t> sweeps) {
  std::vector<EchoOnGround> ground;
  ground.reserve(echoes.size());
  for (const PlacedEcho& echo : echoes) ground.push_back(place_echo(problem, mount, unknowns, ways, echo));
  const std::vector<SweepIndex> indices = index_sweeps(ground, sweeps);
  struct Near {
    double square;
    Eigen::Vector2d at;
  };
  std::vector<Near> nearest;
  std::vector<Eigen::Vector2d> points;
  for (std::size_t s = 0; s < indices.size(); ++s) {
    for (std::size_t i = sweeps[s]; i < sweeps[s + 1]; ++i) {
      nearest.clear();
      indices[s].near(ground[i].at, kLineReach_m, [&](const SweepIndex::Entry& entry, double d, double reach) {
        const auto place = std::ranges::upper_bound(nearest, d, {}, &Near::square);
        nearest.insert(place, {d, entry.at});
        if (nearest.size() <= kLineEchoes) return reach;
        nearest.pop_back();
        return nearest.back().square;
      });
      if (nearest.size() < kMinLineEchoes) continue;
      points.clear();
      for (const Near& near : nearest) points.push_back(near.at);
      ground[i].normal = normal_of(points);
    }
  }
  return ground;
}

EchoPairs echo_pairs(std::span<const PlacedEcho> echoes, std::span<const EchoOnGround> ground,
                     std::span<const std::size_t> sweeps, std::span<const SweepPlace> places,
                     const PairOptions& options) {
  EchoPairs result;
  const std::vector<SweepIndex> indices = index_sweeps(ground, sweeps);
  const double robust_m = kRobustOfGate * options.gate_m;
  std::vector<std::size_t> pairs_of(echoes.size(), 0);
  std::vector<std::pair<std::uint64_t, std::size_t>> far;
  for (std::size_t s = 0; s < indices.size(); ++s) {
    if (places[s].is_held) continue;
    const std::size_t number = places[s].number;
    std::vector<std::size_t> partners;
    const auto add_number = [&](std::size_t partner) {
      const auto found = std::ranges::lower_bound(places, partner, {}, &SweepPlace::number);
      if (found == places.end() || found->number != partner) return;
      partners.push_back(static_cast<std::size_t>(found - places.begin()));
    };
    for (const std::size_t step : kNear) {
      if (step <= number) add_number(number - step);
      add_number(number + step);
    }
    const std::size_t near_partners = partners.size();
    far.clear();
    for (std::size_t other = 0; other < indices.size(); ++other) {
      const std::size_t of_other = places[other].number;
      const std::size_t apart = of_other > number ? of_other - number : number - of_other;
      if (apart <= kFar || (places[s].place_m - places[other].place_m).norm() > options.scale * kFarReach_m) continue;
      // The same for both, and in each iteration: fewer blocks in the normal equations.
      far.emplace_back(partner_rank(options.seed, number, of_other), other);
    }
    const std::size_t far_partners = std::min(far.size(), kFarPartners);
    std::ranges::partial_sort(far, far.begin() + static_cast<std::ptrdiff_t>(far_partners));
    for (std::size_t i = 0; i < far_partners; ++i) partners.push_back(far[i].second);
    result.loops_found += far_partners;

    for (std::size_t p = 0; p < partners.size(); ++p) {
      std::size_t counting = 0;
      for (std::size_t i = sweeps[s]; i < sweeps[s + 1]; ++i) {
        if (ground[i].normal.isZero(0.0)) continue;
        std::optional<std::uint32_t> nearest;
        indices[partners[p]].near(ground[i].at, options.gate_m, [&](const SweepIndex::Entry& entry, double d, double) {
          nearest = entry.echo;
          return d;
        });
        if (!nearest) continue;
        const EchoOnGround& other = ground[*nearest];
        const double agreement = ground[i].normal.dot(other.normal);
        if (std::abs(agreement) < kMinAgreement) continue;
        EchoPair pair;
        pair.a = static_cast<std::uint32_t>(i);
        pair.b = *nearest;
        pair.normal = (ground[i].normal + (agreement < 0.0 ? -1.0 : 1.0) * other.normal).normalized();
        pair.distance_m = pair.normal.dot(ground[i].at - other.at);
        const double variance = variance_of(echoes[i], ground[i], pair.normal, options.scale) +
                                variance_of(echoes[*nearest], other, pair.normal, options.scale);
        // Geman and McClure (1987): the weight of a residual.
        const double square = robust_m * robust_m;
        const double share = square / (square + pair.distance_m * pair.distance_m);
        pair.weight = share * share / variance;
        if (share > 0.5) ++counting;
        ++pairs_of[i];
        result.pairs.push_back(pair);
      }
      if (p >= near_partners && counting >= kLoopPairs) ++result.loops_kept;
    }
  }
  for (EchoPair& pair : result.pairs) pair.weight *= kWeightOfEcho / static_cast<double>(pairs_of[pair.a]);
  return result;
}

std::vector<WallMatch> match_walls(std::span<const PlacedEcho> echoes, std::span<const EchoOnGround> ground,
                                   const MapWalls& walls, double gate_m) {
  std::vector<WallMatch> matches;
  for (std::uint32_t i = 0; i < echoes.size(); ++i) {
    const auto wall = walls.nearest(ground[i].at, ground[i].ray, gate_m);
    if (!wall) continue;
    const double distance_m = wall->normal.dot(ground[i].at - wall->place_m);
    const double across_m = kMapBearing_rad * echoes[i].run.range_m;
    const double variance =
        kMapPlace_m * kMapPlace_m + kOfCell * kOfCell * walls.cell_m() * walls.cell_m() + across_m * across_m;
    const double square = kRobustOfGate * kRobustOfGate * gate_m * gate_m;
    const double share = square / (square + distance_m * distance_m);
    matches.push_back({i, wall->normal, distance_m, kMapWeight * share * share / variance});
  }
  return matches;
}

EchoRow echo_row(const PlacedEcho& echo, const EchoOnGround& ground, const Unknowns& unknowns,
                 const Eigen::Vector2d& normal) {
  EchoRow row;
  if (!echo.fixed) {
    const double rest = 1.0 - echo.share, by_yaw = normal.dot(quarter_turn(ground.arm));
    row.by_knots << rest * normal, rest * by_yaw, echo.share * normal, echo.share * by_yaw;
  }
  const double yaw_rad = yaw_of(echo, unknowns);
  const Eigen::Vector2d ahead(std::cos(yaw_rad), std::sin(yaw_rad));
  row.by_globals = {echo.run.half_length_m * normal.dot(ground.ray), normal.dot(ahead),
                    normal.dot(quarter_turn(ahead))};
  return row;
}

PairRow pair_row(const PlacedEcho& a, const EchoOnGround& ground_a, const PlacedEcho& b, const EchoOnGround& ground_b,
                 const Unknowns& unknowns, const EchoPair& pair) {
  const EchoRow of_a = echo_row(a, ground_a, unknowns, pair.normal),
                of_b = echo_row(b, ground_b, unknowns, pair.normal);
  PairRow row;
  row.distance_m = pair.normal.dot(ground_a.at - ground_b.at);
  row.by << of_a.by_knots, -of_b.by_knots, of_a.by_globals - of_b.by_globals;
  // The normal is the mean of both, and each turns with its sweep: a turn of all of them tells nothing.
  const double by_turn = 0.5 * quarter_turn(pair.normal).dot(ground_a.at - ground_b.at);
  if (!a.fixed) {
    row.by(2) += (1.0 - a.share) * by_turn;
    row.by(5) += a.share * by_turn;
  }
  if (!b.fixed) {
    row.by(8) += (1.0 - b.share) * by_turn;
    row.by(11) += b.share * by_turn;
  }
  return row;
}

}  // namespace pingvox
