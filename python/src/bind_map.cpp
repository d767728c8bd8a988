#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bind_map_queries.hpp"
#include "errors.hpp"
#include "keywords.hpp"
#include "module.hpp"
#include "pingvox/cloud/insert_points.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "shared_map.hpp"

namespace pingvox::python {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

/// Keys of a map as an array, (N, 3) or (3,), which all are within its lattice.
template <KeyWord W>
class Keys {
 public:
  Keys(const py::array& array, int depth) {
    const bool is_one = array.ndim() == 1 && array.shape(0) == 3;
    if (!is_one && (array.ndim() != 2 || array.shape(1) != 3)) raise_usage("keys: must be an array of shape (N, 3)");
    const char kind = array.dtype().kind();
    if (kind != 'i' && kind != 'u') raise_usage("keys: must be whole numbers; points in metres are the first argument");
    rows_ = is_one ? 1 : size_of(array, 0);
    const std::uint64_t last = depth >= kLevelsOf<std::uint64_t> ? ~std::uint64_t{0} : (std::uint64_t{1} << depth) - 1;
    if (!py::isinstance<py::array_t<W>>(array))
      check(py::array_t < std::int64_t, py::array::c_style | py::array::forcecast > ::ensure(array), last);
    words_ = py::array_t < W, py::array::c_style | py::array::forcecast > ::ensure(array);
    check(words_, last);
  }

  std::size_t size() const { return rows_; }
  BasicKey<W> operator[](std::size_t row) const {
    const W* const word = words_.data() + 3 * row;
    return {word[0], word[1], word[2]};
  }

 private:
  template <class Array>
  void check(const Array& words, std::uint64_t last) const {
    const auto* const data = words.data();
    for (py::ssize_t i = 0; i < words.size(); ++i) {
      if (std::cmp_less(data[i], 0) || std::cmp_greater(data[i], last)) {
        raise_usage(fmt::format("keys[{}]: is outside of the lattice: must be in 0..{}", i / 3, last));
      }
    }
  }

  std::size_t rows_ = 0;
  py::array_t<W, py::array::c_style | py::array::forcecast> words_;
};

/// Calls f.operator()<W>() with the width of a map's keys; numpy has none of more than 64 bits.
template <class F>
void with_keys_of(const Lattice& lattice, F&& f) {
  if (lattice.depth() > kLevelsOf<std::uint64_t>) raise_usage("keys: numpy holds them up to a depth of 64");
  with_key_word(lattice.depth(), [&]<KeyWord W>() {
    if constexpr (!std::is_same_v<W, WideWord>) f.template operator()<W>();
  });
}

/// One value for each of some points [m] or keys, of the state of their cells in the map.
/// @param value  of (map, belief), where nullopt is unknown
template <class T, class Value>
py::array values_at(const SharedMap& shared, const py::object& points, const py::object& keys, const Value& value) {
  if (points.is_none() == keys.is_none()) raise_usage("give either points or keys");
  const auto fill = [&](const auto& places) {
    py::array_t<T> values(static_cast<py::ssize_t>(places.size()));
    T* const out = values.mutable_data();
    shared.read([&](const OccupancyMap& map) {
      SignalCheck check;
      for (std::size_t i = 0; i < places.size(); ++i) {
        out[i] = value(map, map.at(places[i]));
        check();
      }
    });
    return py::array(values);
  };
  if (!points.is_none()) return fill(Rows(points, "points"));
  py::array values;
  const Lattice lattice = lattice_of(shared);
  with_keys_of(lattice,
               [&]<KeyWord W>() { values = fill(Keys<W>(number_array(keys, "keys", "(N, 3)"), lattice.depth())); });
  return values;
}

py::array log_odds_at(const SharedMap& shared, const py::object& points, const py::object& keys) {
  return values_at<float>(shared, points, keys, [](const OccupancyMap&, const std::optional<LogOdds>& belief) {
    return belief ? belief->value() : kUnknown;
  });
}

py::array probability_at(const SharedMap& shared, const py::object& points, const py::object& keys) {
  return values_at<float>(shared, points, keys, [](const OccupancyMap&, const std::optional<LogOdds>& belief) {
    return belief ? static_cast<float>(belief->probability()) : kUnknown;
  });
}

py::array occupancy_at(const SharedMap& shared, const py::object& points, const py::object& keys) {
  return values_at<std::uint8_t>(
      shared, points, keys, [](const OccupancyMap& map, const std::optional<LogOdds>& belief) {
        return number_of(belief ? classify(*belief, map.options().thresholds) : Occupancy::kUnknown);
      });
}

py::tuple keys_of(const SharedMap& shared, const py::object& places) {
  const Rows points(places, "points");
  const Lattice lattice = lattice_of(shared);
  py::array keys;
  std::vector<std::uint8_t> inside;
  with_keys_of(lattice, [&]<KeyWord W>() {
    std::vector<W> words;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto key = lattice.key_of<W>(points[i]);
      inside.push_back(key ? 1 : 0);
      const BasicKey<W> known = key.value_or(BasicKey<W>{});
      words.insert(words.end(), {known.x, known.y, known.z});
    }
    keys = rows_of(std::move(words));
  });
  return py::make_tuple(keys, array_of(std::move(inside)).attr("astype")("bool"));
}

py::array centres_of(const SharedMap& shared, const py::object& places) {
  const py::array array = number_array(places, "keys", "(N, 3)");
  const Lattice lattice = lattice_of(shared);
  std::vector<double> centres;
  with_keys_of(lattice, [&]<KeyWord W>() {
    const Keys<W> keys(array, lattice.depth());
    for (std::size_t i = 0; i < keys.size(); ++i) append(lattice.centre_of(keys[i]), centres);
  });
  return rows_of(std::move(centres));
}

py::dict insert(SharedMap& shared, const py::object& cloud, const py::object& origin, const py::kwargs& keywords) {
  const BuildOptions options = insert_options(keywords);
  const InsertOptions how{{.ray = options.model.ray, .hit = options.model.hit, .max_range_m = options.echo.max_range_m},
                          options.miss};
  const Eigen::Vector3d origin_m = vector_from(origin, "origin");
  const py::array points = number_array(cloud, "points", "(N, 3)");
  const bool is_one = points.ndim() == 1 && points.shape(0) == 3;
  if (!is_one && (points.ndim() != 2 || points.shape(1) != 3)) raise_usage("points: must be an array of shape (N, 3)");
  const auto insert_all = [&]<class Point>(const Point&) {
    using Number = typename Point::Scalar;
    const auto array = py::array_t < Number, py::array::c_style | py::array::forcecast > ::ensure(points);
    if (!array) raise_usage("points: must be an array of shape (N, 3)");
    const std::size_t rows = is_one ? 1 : size_of(array, 0);
    std::vector<Point> all_m;
    all_m.reserve(rows);
    for (std::size_t i = 0; i < rows; ++i) all_m.emplace_back(array.data() + 3 * i);
    return shared.change(
        [&](OccupancyMap& map) { return insert_points(map, origin_m, std::span<const Point>(all_m), how); });
  };
  const bool is_single = py::isinstance<py::array_t<float>>(points);
  const InsertReport report = value_of(is_single ? insert_all(Eigen::Vector3f()) : insert_all(Eigen::Vector3d()));
  py::dict counts;
  counts["cells_freed"] = report.applied.cells_freed;
  counts["cells_hit"] = report.applied.cells_hit;
  counts["outside"] = report.outside;
  return counts;
}

void update(SharedMap& shared, const py::object& points, const py::object& keys, double probability) {
  if (!(probability > 0.0 && probability < 1.0)) raise_usage("probability: must be between 0 and 1");
  if (points.is_none() == keys.is_none()) raise_usage("give either points or keys");
  const Lattice lattice = lattice_of(shared);
  with_keys_of(lattice, [&]<KeyWord W>() {
    std::vector<BasicKey<W>> cells;
    if (!points.is_none()) {
      const Rows rows(points, "points");
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto key = lattice.key_of<W>(rows[i]);
        if (!key) raise_usage(fmt::format("points[{}]: is outside of the map", i));
        cells.push_back(*key);
      }
    } else {
      const Keys<W> words(number_array(keys, "keys", "(N, 3)"), lattice.depth());
      for (std::size_t i = 0; i < words.size(); ++i) cells.push_back(words[i]);
    }
    value_of(shared.change([&](OccupancyMap& map) {
      return map.update(std::span<const BasicKey<W>>(cells), LogOdds::from_probability(probability));
    }));
  });
}

py::object bounds_of(const SharedMap& shared) {
  const std::optional<Box> box = shared.read([](const OccupancyMap& map) { return map.bounds(); });
  if (!box) return py::none();
  std::vector<double> corners;
  append(box->min, corners);
  append(box->max, corners);
  return rows_of(std::move(corners));
}

py::dict info_of(const SharedMap& shared) {
  py::dict info;
  shared.read([&](const OccupancyMap& map) {
    const MapCounts counts = map.counts();
    const std::optional<Box> box = map.bounds();
    const std::size_t bytes = map.memory_bytes();
    const py::gil_scoped_acquire lock;
    info["resolution"] = map.lattice().resolution_m();
    info["depth"] = map.lattice().depth();
    info["leaves"] = counts.leaves;
    info["inner"] = counts.inner;
    info["memory_bytes"] = bytes;
    info["occupied_cells"] = counts.occupied_cells;
    info["free_cells"] = counts.free_cells;
    py::dict bounds;
    const auto corner = [](const Eigen::Vector3d& at) { return std::vector<double>(at.data(), at.data() + 3); };
    bounds["min"] = box ? py::cast(corner(box->min)) : py::none();
    bounds["max"] = box ? py::cast(corner(box->max)) : py::none();
    info["bounds"] = bounds;
  });
  return info;
}

std::shared_ptr<SharedMap> open_map(const std::filesystem::path& path, std::size_t memory_limit,
                                    const py::kwargs& keywords) {
  const app::OccupancyArgs occupancy = open_map_options(keywords);
  return without_lock([&] {
    MapFile file = value_of(read_map(value_of(read_file(path.string())), memory_limit));
    return std::make_shared<SharedMap>(value_of(occupancy.apply_to(std::move(file.map))), file.axes);
  });
}

void save(const SharedMap& shared, const std::filesystem::path& file, const std::string& made_by) {
  const std::string path = file.string();
  value_of(shared.read([&](const OccupancyMap& map) {
    const std::optional<Format> format = format_for_writing(path);
    // Without a suffix that it knows, this one says which there are.
    if (!format) return write_map(map, path, made_by);
    return write_map(map, *format, made_by, path, shared.axes());
  }));
}

std::shared_ptr<SharedMap> copy_of(const SharedMap& shared) {
  return std::make_shared<SharedMap>(shared.read([](const OccupancyMap& map) { return map; }), shared.axes());
}

void merge(SharedMap& shared, const SharedMap& other) {
  // By a copy: two threads may merge two maps into each other.
  const OccupancyMap added = other.read([](const OccupancyMap& map) { return map; });
  value_of(shared.change([&](OccupancyMap& map) { return map.merge(added); }));
}

std::string text_of(const SharedMap& shared) {
  return shared.read([](const OccupancyMap& map) {
    return fmt::format("<pingvox.OccupancyMap of {} m, {} leaves>", map.lattice().resolution_m(), map.counts().leaves);
  });
}

}  // namespace

py::tuple state_of(const SharedMap& shared) {
  std::ostringstream out;
  value_of(shared.read([&](const OccupancyMap& map) { return write_map(map, Format::kPvx, "", out, shared.axes()); }));
  const std::size_t memory_limit =
      shared.read([](const OccupancyMap& map) { return map.options().memory_limit_bytes; });
  return py::make_tuple(py::bytes(out.str()), memory_limit);
}

MapFile map_of_state(const py::tuple& state) {
  if (state.size() != 2) raise_usage("the state of a map: must be its bytes and its memory limit");
  const auto bytes = state[0].cast<std::string>();
  const auto memory_limit = state[1].cast<std::size_t>();
  return without_lock(
      [&] { return value_of(read_map(FileBytes{"bytes of a map", {bytes.begin(), bytes.end()}}, memory_limit)); });
}

void bind_map(py::module_& module) {
  const std::string make_doc = docstring(
      "A map of occupied, free and unknown space: an octree of log-odds, as OctoMap's.\n\n"
      "Lengths are metres in the map frame (x ahead or east, y to port or north, z up). Functions run without the\n"
      "lock of the interpreter; several threads may use one map.",
      "OccupancyMap");
  const std::string open_doc =
      docstring("Reads .bt, .ot or .pvx, recognised by content; memory_limit: bytes that the map may take, 0: any.",
                "OccupancyMap.open");
  const std::string insert_doc = docstring(
      "Inserts a point cloud as OctoMap's insertPointCloud does: the cell of each point is hit, the cells before it\n"
      "are missed.\n\n"
      "points: (N, 3) float64 or float32, metres; origin: (3,) metres, from where they were seen. Ctrl-C takes effect\n"
      "when all of them are in the map.\n"
      "Returns counts of cells: cells_freed, cells_hit, and outside: points outside of the map.",
      "OccupancyMap.insert_points");
  MapClass map_class(module, "OccupancyMap", make_doc.c_str());
  map_class
      .def(py::init([](const py::kwargs& keywords) {
        return std::make_shared<SharedMap>(value_of(OccupancyMap::make(new_map_options(keywords))));
      }))
      .def_static("open", &open_map, py::arg("path"), py::arg("memory_limit") = 0, open_doc.c_str())
      .def("save", &save, py::arg("path"), py::arg("made_by") = "",
           "Writes .bt, .ot, .pvx, or the occupied cells as .ply, .pcd or .xyz, by the suffix: the program's bytes.")
      .def("copy", &copy_of, "A map of its own with the same content.")
      .def("__copy__", &copy_of)
      .def(
          "__deepcopy__", [](const SharedMap& shared, const py::dict&) { return copy_of(shared); }, py::arg("memo"))
      .def(py::pickle(&state_of,
                      [](const py::tuple& state) {
                        MapFile file = map_of_state(state);
                        return std::make_shared<SharedMap>(std::move(file.map), file.axes);
                      }))
      .def("insert_points", &insert, py::arg("points"), py::arg("origin"), insert_doc.c_str())
      .def("update", &update, py::arg("points") = py::none(), py::kw_only(), py::arg("keys") = py::none(),
           py::arg("probability"),
           "Adds evidence to cells: the probability that each is occupied, in (0, 1). points: (N, 3) metres, or keys:\n"
           "(N, 3) whole numbers; a cell that is named twice gets it twice. Ctrl-C takes effect when all are updated.")
      .def("log_odds", &log_odds_at, py::arg("points") = py::none(), py::kw_only(), py::arg("keys") = py::none(),
           "Log-odds of cells as (N,) float32; NaN: unknown, or outside. points: (N, 3) metres, or keys: (N, 3)\n"
           "whole numbers as of keys().")
      .def("probability", &probability_at, py::arg("points") = py::none(), py::kw_only(), py::arg("keys") = py::none(),
           "Probability that cells are occupied, (N,) float32; else as log_odds().")
      .def("occupancy", &occupancy_at, py::arg("points") = py::none(), py::kw_only(), py::arg("keys") = py::none(),
           "UNKNOWN, FREE or OCCUPIED as (N,) uint8; else as log_odds().")
      .def(
          "keys", &keys_of, py::arg("points"),
          "Keys of the cells that hold points, (N, 3) metres: (N, 3) unsigned integers, as narrow as the depth of the\n"
          "map allows, and (N,) bool: whether a point is inside of the map.")
      .def("centres", &centres_of, py::arg("keys"), "Centres of cells by their keys, (N, 3): (N, 3) float64 metres.")
      .def("merge", &merge, py::arg("other"), "Adds the log-odds of a map with the same resolution and depth.")
      .def(
          "clear", [](SharedMap& shared) { shared.change([](OccupancyMap& map) { map.clear(); }); },
          "Removes all cells.")
      .def("info", &info_of, "Counts and bounds, named as in the program's JSON.")
      .def_property_readonly(
          "resolution", [](const SharedMap& shared) { return lattice_of(shared).resolution_m(); },
          "Edge of the smallest cell, metres.")
      .def_property_readonly(
          "depth", [](const SharedMap& shared) { return lattice_of(shared).depth(); }, "Levels below the root.")
      .def_property_readonly("bounds", &bounds_of,
                             "(2, 3) float64 metres, the box around all that is known; None: nothing is.")
      .def_property_readonly(
          "memory_bytes",
          [](const SharedMap& shared) {
            return shared.read([](const OccupancyMap& map) { return map.memory_bytes(); });
          },
          "Bytes of the tree.")
      .def("__len__",
           [](const SharedMap& shared) {
             return shared.read([](const OccupancyMap& map) { return map.counts().leaves; });
           })
      .def("__repr__", &text_of);
  bind_map_queries(module, map_class);
}

}  // namespace pingvox::python
