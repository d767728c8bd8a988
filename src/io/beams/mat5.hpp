#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/bytes/byte_reader.hpp"
#include "pingvox/io/bytes.hpp"
#include "pingvox/result.hpp"

/// Subset of MATLAB's level-5 format: an array of structs whose fields are numeric arrays (docs/formats.md).
namespace pingvox::mat5 {

/// View of a numeric array in the file. The stored type may be narrower than the array's class.
class NumericArray {
 public:
  /// REQUIRES `bytes` to hold complete values of a type known to `bytes_of`.
  NumericArray(std::uint32_t stored_type, std::span<const std::uint8_t> bytes, std::endian order)
      : stored_type_(stored_type), bytes_(bytes), order_(order) {}

  std::size_t size() const;
  /// Value in column-major order. REQUIRES index < size().
  double at(std::size_t index) const;

 private:
  std::uint32_t stored_type_;
  std::span<const std::uint8_t> bytes_;
  std::endian order_;
};

/// An array of structs, read sequentially.
class StructArray {
 public:
  /// Finds a variable in a file and checks that it is complete.
  /// @return kUnsupported for version 7.3 (HDF5) and if the variable is missing or not an array of structs;
  ///         kCorrupt when the file is damaged
  static Result<StructArray> open(FileBytes file, std::string_view variable);

  /// Index of a field; nullopt: no field of this name.
  std::optional<std::size_t> field(std::string_view name) const;

  /// The arrays of the next element; nullopt for a field that is no real numeric array or contradicts its dimensions.
  /// nullopt after the last element.
  std::optional<std::vector<std::optional<NumericArray>>> next();
  std::uint64_t elements_left() const { return elements_left_; }

 private:
  StructArray(std::vector<std::uint8_t> bytes, std::endian order) : bytes_(std::move(bytes)), order_(order) {}

  std::vector<std::uint8_t> bytes_;
  std::endian order_;
  std::vector<std::string> fields_;
  std::uint64_t elements_left_ = 0;
  std::optional<ByteReader> reader_;  ///< at the next element, in bytes_
};

/// Whether bytes begin like a file of level 5 or version 7.3.
bool looks_like_matlab(std::span<const std::uint8_t> bytes);

}  // namespace pingvox::mat5
