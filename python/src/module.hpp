#pragma once

#include <pybind11/pybind11.h>

/// The parts of the module, in the order in which they are made.
namespace pingvox::python {

void bind_map(pybind11::module_& module);
void bind_trajectory(pybind11::module_& module);
void bind_beams(pybind11::module_& module);
void bind_mapper(pybind11::module_& module);
void bind_recording(pybind11::module_& module);
void bind_live_event(pybind11::module_& module);
void bind_live(pybind11::module_& module);

}  // namespace pingvox::python
