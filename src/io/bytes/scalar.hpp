#pragma once

#include <cstddef>
#include <cstdint>

namespace pingvox {

/// Number types in files of points and meshes.
enum class Scalar { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kInt64, kUint64, kFloat, kDouble };

inline constexpr bool is_integer(Scalar type) {
  return type != Scalar::kFloat && type != Scalar::kDouble;
}

inline constexpr std::size_t bytes_of(Scalar type) {
  switch (type) {
    case Scalar::kInt8:
    case Scalar::kUint8:
      return 1;
    case Scalar::kInt16:
    case Scalar::kUint16:
      return 2;
    case Scalar::kInt32:
    case Scalar::kUint32:
    case Scalar::kFloat:
      return 4;
    default:
      return 8;
  }
}

/// Calls `f.template operator()<T>()` with the C++ type of `type`.
template <class F>
constexpr decltype(auto) with_scalar(Scalar type, F&& f) {
  switch (type) {
    case Scalar::kInt8:
      return f.template operator()<std::int8_t>();
    case Scalar::kUint8:
      return f.template operator()<std::uint8_t>();
    case Scalar::kInt16:
      return f.template operator()<std::int16_t>();
    case Scalar::kUint16:
      return f.template operator()<std::uint16_t>();
    case Scalar::kInt32:
      return f.template operator()<std::int32_t>();
    case Scalar::kUint32:
      return f.template operator()<std::uint32_t>();
    case Scalar::kInt64:
      return f.template operator()<std::int64_t>();
    case Scalar::kUint64:
      return f.template operator()<std::uint64_t>();
    case Scalar::kFloat:
      return f.template operator()<float>();
    case Scalar::kDouble:
      break;
  }
  return f.template operator()<double>();
}

}  // namespace pingvox
