#pragma once

#include <cstdint>
#include <mutex>
#include <shared_mutex>
#include <string>
#include <utility>

#include "errors.hpp"
#include "pingvox/geometry/lattice.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/map/log_odds.hpp"
#include "pingvox/map/map_axes.hpp"
#include "pingvox/map/occupancy_map.hpp"

namespace pingvox::python {

/// A map that several threads of Python may use, as they would a list: its functions run without the interpreter's
/// lock, so it has one of its own.
class SharedMap {
 public:
  explicit SharedMap(OccupancyMap map, MapAxes axes = MapAxes::kUnknown) : axes_(axes), map_(std::move(map)) {}

  MapAxes axes() const { return axes_; }

  /// Calls f(map) without the interpreter's lock, while nobody changes the map.
  template <class F>
  auto read(F&& f) const {
    return without_lock([&] {
      const std::shared_lock lock(mutex_);
      return f(map_);
    });
  }
  /// The same, while nobody else uses it.
  template <class F>
  auto change(F&& f) {
    return without_lock([&] {
      const std::unique_lock lock(mutex_);
      return f(map_);
    });
  }

 private:
  MapAxes axes_;
  OccupancyMap map_;
  mutable std::shared_mutex mutex_;
};

/// Options of a map do not change, so they are read without waiting for others.
inline Lattice lattice_of(const SharedMap& shared) {
  return shared.read([](const OccupancyMap& map) { return map.lattice(); });
}

/// As arrays have it: the UNKNOWN, FREE or OCCUPIED of the module.
inline std::uint8_t number_of(Occupancy occupancy) {
  return static_cast<std::uint8_t>(occupancy);
}

/// For pickle: the bytes of the map as .pvx, and its memory limit.
py::tuple state_of(const SharedMap& shared);
/// The map of what state_of() returned.
MapFile map_of_state(const py::tuple& state);

}  // namespace pingvox::python
