#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "errors.hpp"
#include "pingvox/geometry/pose.hpp"

/// numpy's arrays, to and from values of the library.
namespace pingvox::python {

/// Any array of numbers, as double and without gaps: not copied where it is.
using DoubleArray = py::array_t<double, py::array::c_style | py::array::forcecast>;

inline std::size_t size_of(const py::array& array, int axis) {
  return static_cast<std::size_t>(array.shape(axis));
}

/// Any array of bytes without gaps.
using ByteArray = py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>;

/// An array of whole or real numbers of whatever type, from what numpy takes as one.
/// @param name   for the message of pingvox.Error
/// @param shape  that it should have, for the message
py::array number_array(const py::object& values, const std::string& name, const std::string& shape);
/// The same as double.
DoubleArray double_array(const py::object& values, const std::string& name, const std::string& shape);
/// Whole numbers in 0..255 of whatever type as bytes; numpy would take others modulo 256.
/// @param name  for the message of pingvox.Error, which others and fractions raise
ByteArray byte_array(const py::object& values, const std::string& name, const std::string& shape);

/// The three finite numbers of an array of shape (3,).
Eigen::Vector3d vector_from(const py::object& values, const std::string& name);

/// Rows of three numbers: (N, 3), or (3,) as one row.
class Rows {
 public:
  /// @param name   for the message of pingvox.Error
  /// @param shape  that it should have, for the message
  Rows(const py::object& values, const std::string& name, const std::string& shape = "(N, 3)");

  std::size_t size() const { return rows_; }
  Eigen::Vector3d operator[](std::size_t row) const { return Eigen::Vector3d(array_.data() + 3 * row); }

 private:
  DoubleArray array_;
  std::size_t rows_ = 0;
};

/// The numbers of a vector as an array of this shape, which owns them: they are not copied.
template <class T>
py::array_t<T> array_of(std::vector<T> values, std::vector<py::ssize_t> shape) {
  auto held = std::make_unique<std::vector<T>>(std::move(values));
  T* const data = held->data();
  const py::capsule owner(held.get(), [](void* pointer) { delete static_cast<std::vector<T>*>(pointer); });
  static_cast<void>(held.release());
  return py::array_t<T>(std::move(shape), data, owner);
}
template <class T>
py::array_t<T> array_of(std::vector<T> values) {
  const auto size = static_cast<py::ssize_t>(values.size());
  return array_of(std::move(values), {size});
}
/// Three numbers a row.
template <class T>
py::array_t<T> rows_of(std::vector<T> values) {
  const auto rows = static_cast<py::ssize_t>(values.size() / 3);
  return array_of(std::move(values), {rows, 3});
}

/// Memory of an object of Python as an array that keeps the object alive, and cannot be written.
inline py::array view_of(const std::uint8_t* data, std::vector<py::ssize_t> shape, const py::object& owner) {
  py::array_t<std::uint8_t> array(std::move(shape), data, owner);
  array.attr("flags").attr("writeable") = false;
  return array;
}

inline void append(const Eigen::Vector3d& vector, std::vector<double>& to) {
  to.insert(to.end(), vector.data(), vector.data() + 3);
}

/// A pose as a matrix of 4 x 4, row by row.
inline void append(const Pose& pose, std::vector<double>& to) {
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = pose.matrix();
  to.insert(to.end(), matrix.data(), matrix.data() + matrix.size());
}

/// Raises pingvox.Error where the matrix is no rigid transform.
Pose pose_from(std::span<const double> matrix, const std::string& name);
/// The same of an array of shape (4, 4).
Pose pose_from(const py::object& values, const std::string& name);

}  // namespace pingvox::python
