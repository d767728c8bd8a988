#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/byte_reader.hpp"
#include "pingvox/io/bytes.hpp"
#include "pingvox/result.hpp"

/// As much of MATLAB's level-5 files as a log of beams needs: one array of structs whose fields are numeric arrays.
/// The layout is in docs/formats.md.
namespace pingvox::mat5 {

/// One numeric array where it lies in the file. The stored type may be narrower than the array's class.
class NumericArray {
 public:
  /// REQUIRES that `bytes` are whole numbers of a stored type that `bytes_of` knows.
  NumericArray(std::uint32_t stored_type, std::span<const std::uint8_t> bytes, std::endian order)
      : stored_type_(stored_type), bytes_(bytes), order_(order) {}

  std::size_t size() const;
  /// Column by column. REQUIRES index < size().
  double at(std::size_t index) const;

 private:
  std::uint32_t stored_type_;
  std::span<const std::uint8_t> bytes_;
  std::endian order_;
};

/// An array of structs, read element by element.
class StructArray {
 public:
  /// Finds a variable in a file and checks that all of its elements are there.
  /// @return kUnsupported for version 7.3 (which is HDF5) and for a variable that is not there or no array of structs;
  ///         kCorrupt when the frame is broken
  static Result<StructArray> open(FileBytes file, std::string_view variable);

  /// Where in an element's arrays a field is; nullopt: there is none of that name.
  std::optional<std::size_t> field(std::string_view name) const;

  /// The next element, an array for each field: nullopt for one that is no real numeric array or does not fit its own
  /// dimensions. nullopt after the last element.
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

/// Whether bytes begin like a file of level 5 or of version 7.3.
bool looks_like_matlab(std::span<const std::uint8_t> bytes);

}  // namespace pingvox::mat5
