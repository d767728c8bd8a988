#include "module.hpp"

#include <pybind11/pybind11.h>

#include <cstddef>
#include <string>

#include "errors.hpp"
#include "keywords.hpp"

namespace {

/// Makes it an error to use an object whose __init__ was not called, as after T.__new__(T): pybind11 would take memory
/// for the value and read what happens to be there.
void refuse_uninitialised_objects(const pybind11::module_& module) {
  namespace py = pybind11;
  for (const auto& [name, thing] : py::dict(module.attr("__dict__"))) {
    if (!py::isinstance<py::type>(thing)) continue;
    // It takes that memory by this, which may be set for each type.
    py::detail::type_info* const type = py::detail::get_type_info(reinterpret_cast<PyTypeObject*>(thing.ptr()));
    if (type == nullptr) continue;
    type->operator_new = [](std::size_t) -> void* {
      pingvox::python::raise_usage("the object has no value: its __init__ was not called");
    };
  }
}

}  // namespace

PYBIND11_MODULE(_pingvox, module) {
  namespace py = pybind11;
  namespace python = pingvox::python;
  module.doc() = "Sonar logs to 3D occupancy maps: the library pingvox.";
  module.attr("__version__") = PINGVOX_VERSION;
  python::translate_errors();
  python::bind_trajectory(module);
  python::bind_map(module);
  python::bind_beams(module);
  python::bind_mapper(module);
  python::bind_recording(module);
  python::bind_live_event(module);
  python::bind_live(module);
  refuse_uninitialised_objects(module);
  module.def(
      "options_of",
      [](const std::string& function) {
        py::dict all;
        for (const python::Keyword& keyword : python::keywords_of(function)) {
          std::string text = keyword.help;
          if (!keyword.value.empty()) text = keyword.value + ": " + text;
          if (!keyword.standard.empty()) text += " [" + keyword.standard + "]";
          all[py::str(keyword.name)] = text;
        }
        return all;
      },
      py::arg("function"),
      "The keyword arguments that are options, with what they mean and their defaults.\n\n"
      "function: 'open', 'Recording.map', 'Recording.slam', 'Recording.locate', 'Recording.evaluate',\n"
      "'SlamResult.map', 'OccupancyMap', 'OccupancyMap.insert_points', 'OccupancyMap.open', 'BeamMapper',\n"
      "'filter_image', 'Beams.echoes', 'LiveMapping' or 'LiveMapping.drive'.");
}
