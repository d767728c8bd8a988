#include "rays.hpp"

#include <fmt/core.h>
#include <octomap/OcTree.h>

#include <cmath>
#include <random>

#include "bench/paired_timing.hpp"
#include "claim.hpp"
#include "geometry/internal/ray_bresenham.hpp"
#include "geometry/internal/ray_dda.hpp"
#include "paper_dda.hpp"
#include "ray_cells.hpp"

namespace pingvox::bench {
namespace {

using test::ExactSegment;
using Cell = ExactSegment::Cell;

std::vector<Cell> octomap_cells(const octomap::OcTree& tree, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const auto point = [](const Eigen::Vector3d& p) {
    return octomap::point3d(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()));
  };
  octomap::KeyRay ray;
  std::vector<Cell> cells;
  if (!tree.computeRayKeys(point(from), point(to), ray)) return cells;
  for (const octomap::OcTreeKey& key : ray) {
    cells.push_back({std::int64_t{key[0]} - 32768, std::int64_t{key[1]} - 32768, std::int64_t{key[2]} - 32768});
  }
  return cells;
}

/// Bresenham knows cells only, so it is compared with the segment between their centres.
ExactSegment between_middles(const RandomSegment& segment) {
  const auto middle = [](ExactSegment::Point point) {
    for (std::int64_t& axis : point) axis = (axis & ~(ExactSegment::kUnit - 1)) + ExactSegment::kUnit / 2;
    return point;
  };
  return {middle(segment.from), middle(segment.to)};
}

void add_cells(int dimensions, std::vector<Row>& rows) {
  constexpr std::size_t kRays = 5'000;
  const octomap::OcTree tree(1.0);
  RayJudgement ours, lines, best, peer;
  for (const RandomSegment& segment : random_segments(kRays, dimensions, 1)) {
    const ExactSegment exact(segment.from, segment.to);
    const Eigen::Vector3d from = segment.from_cells(), to = segment.to_cells();
    ours.add(exact, dda_cells(from, to));
    lines.add(exact, bresenham_cells(from, to));
    best.add(between_middles(segment), bresenham_cells(from, to));
    peer.add(exact, octomap_cells(tree, from, to));
  }
  const auto row = [&](const char* what, const char* unit, Value paper, double own, Value octomap, Holds holds,
                       const char* why) {
    rows.push_back(row_of({.name = fmt::format("rays-{}d-{}", dimensions, what),
                           .section = "6",
                           .unit = unit,
                           .paper = std::move(paper),
                           .ours = own,
                           .octomap = std::move(octomap),
                           .holds = holds,
                           .checked = true,
                           .why = why}));
  };
  row("dda-missed", "% of crossed cells", "some", per_cent(ours.missed, ours.crossed),
      per_cent(peer.missed, peer.crossed), ours.missed == 0 ? Holds::kNo : Holds::kYes,
      "on integers; liboctomap's ends are floats");
  row("dda-strayed", "% of walked cells", {}, per_cent(ours.strayed, ours.walked), per_cent(peer.strayed, peer.walked),
      Holds::kNotJudged, "");
  row("bresenham-missed", "% of crossed cells", {}, per_cent(lines.missed, lines.crossed), {}, Holds::kNotJudged,
      "cut corners, and only the ends' cells are known to it");
  row("bresenham-strayed", "% of walked cells", {}, per_cent(lines.strayed, lines.walked), {}, Holds::kNotJudged, "");
  row("bresenham-missed-from-middles", "% of crossed cells", {}, per_cent(best.missed, best.crossed), {},
      Holds::kNotJudged, "ends in the middle of their cells: its best case");
  row("bresenham-strayed-from-middles", "% of walked cells", {}, per_cent(best.strayed, best.walked), {},
      Holds::kNotJudged, "");
  row("bresenham-diagonal", "% of steps", "yes", per_cent(lines.diagonal, lines.walked), {}, Holds::kYes,
      "two or three components change at once: like a laser, section 6.2");
  row("dda-diagonal", "% of steps", "never", per_cent(ours.diagonal, ours.walked), per_cent(peer.diagonal, peer.walked),
      ours.diagonal == 0 ? Holds::kYes : Holds::kNo, "");
}

/// Whether a traversal is connected face by face up to its end cell.
bool reaches(const std::vector<Cell>& cells, const Cell& start, const Cell& end) {
  const Cell& last = cells.empty() ? start : cells.back();
  std::int64_t apart = 0;
  for (std::size_t i = 0; i < 3; ++i) apart += std::abs(last[i] - end[i]);
  return cells.empty() ? start == end : apart == 1;
}

/// Rays with round ends: from the origin to multiples of 0.1 m, in cells of 0.1 m.
struct RoundRay {
  Eigen::Vector3d to;
  Cell end;
};

std::vector<RoundRay> round_rays() {
  std::mt19937_64 random(2);
  const Lattice lattice(0.1);
  std::vector<RoundRay> rays;
  for (int i = 0; i < 20'000; ++i) {
    const auto axis = [&] { return (static_cast<double>(random() % 201) - 100.0) / 10.0; };
    const double x = axis(), y = axis(), z = axis();
    const Eigen::Vector3d to(x, y, z);
    const auto key = lattice.key_of(to);
    if (key) rays.push_back({to, {key->x - 32768, key->y - 32768, key->z - 32768}});
  }
  return rays;
}

void add_ends(std::vector<Row>& rows) {
  const std::vector<RoundRay> rays = round_rays();
  const Lattice lattice(0.1);
  const Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  std::size_t beyond_double = 0, beyond_float = 0, travelled_double = 0, travelled_float = 0, ours = 0, lines = 0;
  const auto lost = [](const std::vector<Cell>& cells, const RoundRay& ray) {
    return reaches(cells, Cell{0, 0, 0}, ray.end) ? 0U : 1U;
  };
  for (const RoundRay& ray : rays) {
    beyond_double += lost(paper_dda<double>(origin, ray.to, 0.1, PaperStop::kBeyondLength), ray);
    beyond_float += lost(paper_dda<float>(origin, ray.to, 0.1, PaperStop::kBeyondLength), ray);
    travelled_double += lost(paper_dda<double>(origin, ray.to, 0.1, PaperStop::kTravelled), ray);
    travelled_float += lost(paper_dda<float>(origin, ray.to, 0.1, PaperStop::kTravelled), ray);
    const auto walk = dda<std::uint16_t>(lattice, origin, ray.to);
    std::vector<Cell> cells;
    for (const Key key : *walk) cells.push_back({key.x - 32768, key.y - 32768, key.z - 32768});
    ours += lost(cells, ray);
    const auto end = lattice.key_of(ray.to);
    Key last{32768, 32768, 32768};
    for (const Key key : bresenham(last, *end)) last = key;
    const auto apart = [](std::uint16_t a, std::uint16_t b) { return std::abs(int{a} - int{b}) > 1; };
    lines += apart(last.x, end->x) || apart(last.y, end->y) || apart(last.z, end->z) ? 1U : 0U;
  }
  std::size_t anywhere = 0;
  const std::vector<RandomSegment> segments = random_segments(rays.size(), 3, 4);
  for (const RandomSegment& segment : segments) {
    const auto cells = paper_dda<double>(segment.from_cells(), segment.to_cells(), 1.0, PaperStop::kBeyondLength);
    anywhere += reaches(cells, ExactSegment::cell_of(segment.from), ExactSegment::cell_of(segment.to)) ? 0U : 1U;
  }
  const auto row = [&](const char* name, const char* section, Value paper, std::size_t rays_lost, Holds holds,
                       const char* why) {
    rows.push_back(row_of({.name = name,
                           .section = section,
                           .unit = "% of rays",
                           .paper = std::move(paper),
                           .ours = per_cent(rays_lost, rays.size()),
                           .octomap = {},
                           .holds = holds,
                           .checked = true,
                           .why = why}));
  };
  const auto found = [](std::size_t lost_rays) { return lost_rays > 0 ? Holds::kYes : Holds::kNo; };
  row("figure-11-paper-double", "6.1", "some", beyond_double, found(beyond_double),
      "its DDA as it is written, stopped beyond the length: rays that lack their last cells");
  row("figure-11-paper-float", "6.1", "some", beyond_float, found(beyond_float), "the same in single precision");
  row("figure-11-paper-anywhere", "6.1", "some", anywhere, found(anywhere),
      "ends anywhere in their cells instead of on multiples of 0.1 m");
  row("figure-12-paper-double", "6.1", "sometimes", travelled_double, found(travelled_double),
      "stopped by the distance travelled: rays that end beside their end");
  row("figure-12-paper-float", "6.1", "sometimes", travelled_float, found(travelled_float),
      "the same in single precision");
  row("figure-11-and-12-ours", "6.1", "some", ours, found(ours), "the number of steps is known before the first");
  row("bresenham-reaches-its-end", "6.2", "never missed", lines, lines == 0 ? Holds::kYes : Holds::kNo, "");
}

void add_times(std::vector<Row>& rows) {
  const octomap::OcTree tree(1.0);
  const Lattice lattice(1.0);
  const std::vector<RandomSegment> segments = random_segments(2'000, 3, 3);
  std::uint64_t sink = 0;
  const auto each = [&](auto&& walk) {
    return Side{{}, [&sink, &segments, walk] {
                  for (const RandomSegment& segment : segments) sink += walk(segment.from_cells(), segment.to_cells());
                }};
  };
  const auto sum = [](const auto& keys) {
    std::uint64_t all = 0;
    for (const Key key : keys) all += key.x + key.y + key.z;
    return all;
  };
  const Side face_by_face = each([&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    return sum(*dda<std::uint16_t>(lattice, from, to));
  });
  const Side line = each([&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    return sum(bresenham(*lattice.key_of(from), *lattice.key_of(to)));
  });
  octomap::KeyRay ray;
  const Side peer = each([&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    tree.computeRayKeys(
        octomap::point3d(static_cast<float>(from.x()), static_cast<float>(from.y()), static_cast<float>(from.z())),
        octomap::point3d(static_cast<float>(to.x()), static_cast<float>(to.y()), static_cast<float>(to.z())), ray);
    std::uint64_t all = 0;
    for (const octomap::OcTreeKey& key : ray) all += static_cast<std::uint64_t>(key[0] + key[1] + key[2]);
    return all;
  });
  const auto count = static_cast<double>(segments.size());
  const PairedTimes beside = time_in_pairs(face_by_face, peer, {.pairs = 5, .min_s = 0.05});
  const PairedTimes both = time_in_pairs(line, face_by_face, {.pairs = 5, .min_s = 0.05});
  const auto row = [&](const char* name, const char* unit, Value paper, double ours, Value octomap, Holds holds,
                       const char* why) {
    rows.push_back(row_of({.name = name,
                           .section = "6.2",
                           .unit = unit,
                           .paper = std::move(paper),
                           .ours = ours,
                           .octomap = std::move(octomap),
                           .holds = holds,
                           .checked = sink != 0,
                           .why = why}));
  };
  row("rays-time-dda", "us a ray", {}, 1e6 * beside.ours_s / count, 1e6 * beside.peer_s / count, Holds::kNotJudged,
      "3D, ends within 100 cells; walked, not stored");
  row("rays-time-bresenham", "us a ray", {}, 1e6 * both.ours_s / count, {}, Holds::kNotJudged, "the same rays");
  row("rays-time-dda-to-bresenham", "times", 6.2, both.ratio, {}, both.ratio > 1.0 ? Holds::kYes : Holds::kNo,
      "DDA has about twice the cells; the paper's number is from the authors' published files");
}

}  // namespace

Result<std::vector<Row>> paper_rays(const BenchOptions&) {
  std::vector<Row> rows;
  add_cells(2, rows);
  add_cells(3, rows);
  add_ends(rows);
  add_times(rows);
  return rows;
}

}  // namespace pingvox::bench
