#pragma once

#include <pybind11/pybind11.h>

#include <cstddef>

#include "pingvox/mapping/build_options.hpp"

namespace pingvox::python {

/// Counts and seconds of what was mapped, named as in the program's JSON.
/// @param damaged  records of logs that could not be read
pybind11::dict report_of(const BuildReport& report, std::size_t damaged = 0);

}  // namespace pingvox::python
