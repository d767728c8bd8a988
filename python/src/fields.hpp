#pragma once

#include <fmt/format.h>
#include <pybind11/pybind11.h>

#include <string>
#include <utility>
#include <vector>

namespace pingvox::python {

namespace py = pybind11;

/// A class of values whose fields can be read.
template <class T, class... Bases>
class Fields {
 public:
  Fields(py::handle scope, const char* name, const char* doc) : class_(scope, name, doc), name_(name) {}

  template <class Get>
  Fields& add(const char* name, Get get, const char* doc) {
    class_.def_property_readonly(name, std::move(get), doc);
    names_.emplace_back(name);
    return *this;
  }

  /// repr() as "Connected(device='ping360:udp://192.168.2.2:9092')". To be called when all fields are there.
  void show_fields() {
    class_.def("__repr__", [name = name_, names = names_](const py::object& self) {
      std::vector<std::string> fields;
      for (const std::string& field : names) {
        fields.push_back(fmt::format("{}={}", field, py::repr(self.attr(field.c_str())).cast<std::string>()));
      }
      return fmt::format("{}({})", name, fmt::join(fields, ", "));
    });
  }

 private:
  py::class_<T, Bases...> class_;
  std::string name_;
  std::vector<std::string> names_;
};

}  // namespace pingvox::python
