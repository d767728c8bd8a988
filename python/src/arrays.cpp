#include "arrays.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <string_view>

namespace pingvox::python {
namespace {

constexpr std::size_t kMatrixSize = 16;

[[noreturn]] void raise_shape(const std::string& name, const std::string& shape) {
  raise_usage(fmt::format("{}: must be an array of shape {}", name, shape));
}

}  // namespace

py::array number_array(const py::object& values, const std::string& name, const std::string& shape) {
  py::array array = py::array::ensure(values);
  if (!array) raise_shape(name, shape);
  // Whole and real numbers, and objects that may be such; not the truth values of a mask, nor texts, dates, or None.
  constexpr std::string_view kNumbers = "iufO";
  const bool is_empty_list = array.size() == 0 && array.dtype().kind() != 'b';
  if (values.is_none() || (!is_empty_list && kNumbers.find(array.dtype().kind()) == std::string_view::npos)) {
    raise_usage(fmt::format("{}: must be an array of numbers, of shape {}, is one of {}", name, shape,
                            py::str(array.dtype()).cast<std::string>()));
  }
  return array;
}

DoubleArray double_array(const py::object& values, const std::string& name, const std::string& shape) {
  DoubleArray numbers = DoubleArray::ensure(number_array(values, name, shape));
  if (!numbers) raise_shape(name, shape);
  return numbers;
}

ByteArray byte_array(const py::object& values, const std::string& name, const std::string& shape) {
  const py::array array = py::array::ensure(values);
  if (!array) raise_shape(name, shape);
  const char kind = array.dtype().kind();
  if (kind != 'b' && !py::isinstance<py::array_t<std::uint8_t>>(array)) {
    constexpr double kMax = std::numeric_limits<std::uint8_t>::max();
    const DoubleArray numbers = double_array(array, name, shape);
    const std::span all(numbers.data(), static_cast<std::size_t>(numbers.size()));
    for (const double number : all) {
      if (number >= 0.0 && number <= kMax && std::trunc(number) == number) continue;
      raise_usage(fmt::format("{}: must be whole numbers in 0..255, has {}", name, number));
    }
  }
  return ByteArray::ensure(array);
}

Eigen::Vector3d vector_from(const py::object& values, const std::string& name) {
  const DoubleArray array = double_array(values, name, "(3,)");
  if (array.ndim() != 1 || array.shape(0) != 3) raise_shape(name, "(3,)");
  const Eigen::Vector3d vector(array.data());
  if (!vector.allFinite()) raise_usage(name + ": must be finite");
  return vector;
}

Rows::Rows(const py::object& values, const std::string& name, const std::string& shape)
    : array_(double_array(values, name, shape)) {
  const bool is_one = array_.ndim() == 1 && array_.shape(0) == 3;
  if (!is_one && (array_.ndim() != 2 || array_.shape(1) != 3)) raise_shape(name, shape);
  rows_ = is_one ? 1 : size_of(array_, 0);
}

Pose pose_from(std::span<const double> matrix, const std::string& name) {
  constexpr double kTolerance = 1e-6;
  Pose pose;
  pose.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(matrix.data());
  const Eigen::Matrix3d rotation = pose.linear();
  const bool is_rigid = pose.matrix().allFinite() && rotation.determinant() > 0.0 &&
                        (rotation * rotation.transpose()).isIdentity(kTolerance) &&
                        pose.matrix().row(3).isApprox(Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0), kTolerance);
  if (!is_rigid)
    raise_usage(name + ": is not a rigid transform: must be a rotation and a translation as a 4 x 4 matrix");
  return pose;
}

Pose pose_from(const py::object& values, const std::string& name) {
  const DoubleArray array = double_array(values, name, "(4, 4)");
  if (array.ndim() != 2 || array.shape(0) != 4 || array.shape(1) != 4) raise_shape(name, "(4, 4)");
  return pose_from(std::span(array.data(), kMatrixSize), name);
}

}  // namespace pingvox::python
