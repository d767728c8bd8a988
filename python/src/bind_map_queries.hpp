#pragma once

#include <pybind11/pybind11.h>

#include <memory>

#include "shared_map.hpp"

namespace pingvox::python {

using MapClass = py::class_<SharedMap, std::shared_ptr<SharedMap>>;

/// What is asked of a whole map: rays, nearest cells, leaves, slices; and the classes of the answers.
void bind_map_queries(py::module_& module, MapClass& map_class);

}  // namespace pingvox::python
