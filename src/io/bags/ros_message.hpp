#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "io/bags/ros_layout.hpp"

// Messages of ROS 1 and ROS 2, decoded by their layout, and those in JSON (docs/formats.md).
namespace pingvox {

/// Where the values of a field are in a message: `count` of them, `stride` bytes apart. Of a text, count is its length.
struct RosValues {
  RosNumber type = RosNumber::kU8;
  std::size_t first = 0, count = 0, stride = 1;
};

/// Reads messages of a layout. Of an array of messages whose size varies (with texts or arrays in them) only one has
/// values. In JSON the numbers of all of them are an array, and the first text has a value; with `element` above 0 it
/// is only that one. Fields that a message in JSON lacks, or that are of another type in it, have no values.
class RosMessage {
 public:
  /// false: the bytes do not fit the layout. They must outlive the use of the values.
  /// @param element  which one has values, in each such array; there are none in a shorter one
  bool read(const RosLayout& layout, std::span<const std::uint8_t> bytes, std::size_t element = 0);

  std::size_t count(std::size_t field) const { return values_[field].count; }
  /// NaN when it has less values. Of a text, the codes of its characters.
  double number(std::size_t field, std::size_t i = 0) const;
  /// A single number rounded once to single precision: in JSON by its text.
  float single(std::size_t field) const;
  /// Nothing for a field of numbers.
  std::string_view text(std::size_t field) const;
  /// An array of bytes where it is in the message; nothing for a field of other values.
  std::span<const std::uint8_t> byte_array(std::size_t field) const;
  /// All values, rounded to 0..255.
  std::vector<std::uint8_t> bytes(std::size_t field) const;

 private:
  class Walk;
  friend class JsonFields;
  /// A single number in JSON: double, then single precision, as it was rounded from its text.
  static constexpr std::size_t kJsonNumber = sizeof(double) + sizeof(float);

  bool read_json(const RosLayout& layout, std::string_view message, std::size_t element);

  std::span<const std::uint8_t> bytes_;
  std::endian order_ = std::endian::little;
  std::vector<RosValues> values_;
  std::vector<std::uint8_t> decoded_;  ///< the values of a message in JSON
};

}  // namespace pingvox
