#include "bind_map_queries.hpp"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "errors.hpp"
#include "pingvox/analysis/slice.hpp"
#include "pingvox/geometry/direction.hpp"
#include "pingvox/map/cast_ray.hpp"
#include "pingvox/map/for_each_leaf.hpp"
#include "pingvox/map/nearest_cell.hpp"
#include "pingvox/map/occupancy_map.hpp"

namespace pingvox::python {
namespace {

/// Where rays ended.
struct RayEnds {
  py::array occupancy, ranges, points;
};

RayEnds cast_rays(const SharedMap& shared, const py::object& origins, const py::object& directions, double max_range,
                  const std::string& unknown) {
  if (unknown != "pass" && unknown != "block") raise_usage("unknown: must be 'pass' or 'block'");
  if (!(max_range > 0.0 && std::isfinite(max_range))) raise_usage("max_range: must be above 0 and finite");
  const Rows from(origins, "origins"), along(directions, "directions");
  const std::size_t rays = from.size() == 1 ? along.size() : from.size();
  if (along.size() != rays && along.size() != 1) {
    raise_usage("origins and directions: must be as many, or one of either");
  }
  const UnknownCells how = unknown == "block" ? UnknownCells::kBlock : UnknownCells::kPass;
  std::vector<std::uint8_t> occupancy;
  std::vector<double> ranges, points;
  shared.read([&](const OccupancyMap& map) {
    SignalCheck check;
    for (std::size_t i = 0; i < rays; ++i) {
      const Eigen::Vector3d origin = from[from.size() == 1 ? 0 : i], direction = along[along.size() == 1 ? 0 : i];
      if (!origin.allFinite()) raise_usage(fmt::format("origins[{}]: must be finite", i));
      if (!direction.allFinite() || direction.isZero(0.0)) {
        raise_usage(fmt::format("directions[{}]: must be finite, and not 0", i));
      }
      const RayEnd end = cast_ray(map, origin, direction, max_range, how);
      occupancy.push_back(number_of(end.what));
      ranges.push_back(end.range_m);
      append(origin + end.range_m * unit_vector(direction), points);
      check();
    }
  });
  return {array_of(std::move(occupancy)), array_of(std::move(ranges)), rows_of(std::move(points))};
}

/// The nearest cells of points.
struct NearestCells {
  py::array ranges, points;
};

NearestCells nearest(const SharedMap& shared, const py::object& array, double max_range, const std::string& sought) {
  if (sought != "occupied" && sought != "not_free") raise_usage("sought: must be 'occupied' or 'not_free'");
  if (!(max_range >= 0.0)) raise_usage("max_range: must be 0 or more");
  const Rows points(array, "points");
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const Sought what = sought == "occupied" ? Sought::kOccupied : Sought::kNotFree;
  std::vector<double> ranges, places;
  shared.read([&](const OccupancyMap& map) {
    SignalCheck check;
    for (std::size_t i = 0; i < points.size(); ++i) {
      check();
      if (!points[i].allFinite()) {  // as where an echo is missing
        ranges.push_back(kNan);
        append(Eigen::Vector3d::Constant(kNan), places);
        continue;
      }
      const auto cell = nearest_cell(map, points[i], max_range, what);
      ranges.push_back(cell ? cell->range_m : std::numeric_limits<double>::infinity());
      append(cell ? cell->point_m : Eigen::Vector3d::Constant(kNan), places);
    }
  });
  return {array_of(std::move(ranges)), rows_of(std::move(places))};
}

/// All leaves of a map.
struct Leaves {
  py::array centres, sizes, log_odds, occupancy, depths;
};

Leaves leaves_of(const SharedMap& shared, std::optional<int> max_depth, const py::object& box) {
  const int levels = lattice_of(shared).depth();
  if (max_depth && (*max_depth < 0 || *max_depth > levels)) {
    raise_usage(fmt::format("max_depth: must be in 0..{}, the levels of the map, is {}", levels, *max_depth));
  }
  LeafQuery query{.max_depth = max_depth, .box = std::nullopt};
  if (!box.is_none()) {
    const Rows corners(box, "box", "(2, 3)");
    if (corners.size() != 2) raise_usage("box: must be an array of shape (2, 3)");
    query.box = Box{corners[0], corners[1]};
    if (!(corners[0].array() <= corners[1].array()).all()) {
      raise_usage("box: must be the least and the greatest corner, without NaN");
    }
  }
  std::vector<double> centres, sizes;
  std::vector<float> log_odds;
  std::vector<std::uint8_t> occupancy, depths;
  shared.read([&](const OccupancyMap& map) {
    SignalCheck check;
    for_each_leaf(map, query, [&](const Leaf& leaf) {
      append(leaf.centre_m(), centres);
      sizes.push_back(leaf.edge_m());
      log_odds.push_back(leaf.belief.value());
      occupancy.push_back(number_of(classify(leaf.belief, map.options().thresholds)));
      depths.push_back(static_cast<std::uint8_t>(leaf.depth));
      check();
    });
  });
  return {rows_of(std::move(centres)), array_of(std::move(sizes)), array_of(std::move(log_odds)),
          array_of(std::move(occupancy)), array_of(std::move(depths))};
}

/// A map seen from above.
struct Slice {
  py::array occupancy;
  std::array<double, 4> extent{};  ///< x min, x max, y min, y max
};

Slice slice(const SharedMap& shared, std::optional<double> min_z, std::optional<double> max_z) {
  const SliceOptions options{min_z, max_z};
  value_of(options.validate());
  auto found = shared.read([&](const OccupancyMap& map) -> std::optional<Result<Raster<Occupancy>>> {
    if (!check_slice(map, options)) return std::nullopt;
    return slice_of(map, options);
  });
  if (!found) return {py::array_t<std::uint8_t>(std::vector<py::ssize_t>{0, 0}), {}};  // nothing is known there
  const Raster<Occupancy> raster = value_of(*std::move(found));
  std::vector<std::uint8_t> cells;
  cells.reserve(raster.values.size());
  for (const Occupancy cell : raster.values) cells.push_back(number_of(cell));
  const auto columns = static_cast<double>(raster.columns), rows = static_cast<double>(raster.rows);
  return {array_of(std::move(cells), {static_cast<py::ssize_t>(raster.rows), static_cast<py::ssize_t>(raster.columns)}),
          {raster.corner_m.x(), raster.corner_m.x() + columns * raster.cell_m, raster.corner_m.y(),
           raster.corner_m.y() + rows * raster.cell_m}};
}

void bind_results(py::module_& module) {
  py::class_<RayEnds>(module, "RayEnds", "Where rays ended, an entry for each.")
      .def_readonly("occupancy", &RayEnds::occupancy,
                    "(N,) uint8: OCCUPIED: hit; UNKNOWN: blocked; FREE: nothing within range.")
      .def_readonly("ranges", &RayEnds::ranges, "(N,) float64, metres from the origin to where the ray ended.")
      .def_readonly("points", &RayEnds::points, "(N, 3) float64, metres: where that is.")
      .def("__len__", [](const RayEnds& ends) { return py::len(ends.ranges); });
  py::class_<NearestCells>(module, "NearestCells", "The nearest cells of points, an entry for each.")
      .def_readonly("ranges", &NearestCells::ranges,
                    "(N,) float64, metres; infinity: there is none; NaN: no finite point.")
      .def_readonly("points", &NearestCells::points, "(N, 3) float64, metres: the cells' nearest points; NaN: none.")
      .def("__len__", [](const NearestCells& cells) { return py::len(cells.ranges); });
  py::class_<Leaves>(module, "Leaves",
                     "Leaves of a map in the order of the tree, an entry for each. They stay as they were when the map "
                     "changes.")
      .def_readonly("centres", &Leaves::centres, "(N, 3) float64, metres.")
      .def_readonly("sizes", &Leaves::sizes, "(N,) float64, edges in metres.")
      .def_readonly("log_odds", &Leaves::log_odds, "(N,) float32.")
      .def_readonly("occupancy", &Leaves::occupancy, "(N,) uint8: FREE, OCCUPIED or UNKNOWN (between the thresholds).")
      .def_readonly("depths", &Leaves::depths, "(N,) uint8, levels below the root.")
      .def("__len__", [](const Leaves& leaves) { return py::len(leaves.sizes); });
  py::class_<Slice>(module, "Slice", "A map seen from above: a value for each column of cells.")
      .def_readonly("occupancy", &Slice::occupancy,
                    "(rows, columns) uint8, the lowest y first: OCCUPIED where any cell of the column is.")
      .def_readonly("extent", &Slice::extent, "x min, x max, y min, y max in metres, as for matplotlib's imshow.");
}

}  // namespace

void bind_map_queries(py::module_& module, MapClass& map_class) {
  bind_results(module);
  map_class
      .def("cast_rays", &cast_rays, py::arg("origins"), py::arg("directions"), py::arg("max_range"),
           py::arg("unknown") = "pass",
           "The first occupied cell along each ray. origins, directions: (N, 3), or (3,) for all, directions of any\n"
           "length; max_range: metres; unknown: whether unknown cells let rays 'pass' or 'block' them. A ray ends at\n"
           "the border of the map, 2^(depth - 1) cells from its origin, as FREE; one from outside of it is UNKNOWN "
           "with\n"
           "a range of 0.")
      .def("nearest", &nearest, py::arg("points"), py::arg("max_range") = std::numeric_limits<double>::infinity(),
           py::arg("sought") = "occupied",
           "The nearest cell around each point, (N, 3) metres, in all directions; NaN for a point that is not finite.\n"
           "sought: 'occupied', or 'not_free': also what is unknown.")
      .def("leaves", &leaves_of, py::arg("max_depth") = py::none(), py::arg("box") = py::none(),
           "All leaves as arrays. max_depth: levels below the root, for a coarser map; box: (2, 3) metres, the least\n"
           "and the greatest corner.")
      .def("slice", &slice, py::arg("min_z") = py::none(), py::arg("max_z") = py::none(),
           "The map from above, between two heights in metres; shape (0, 0) where nothing is known there.");
}

}  // namespace pingvox::python
