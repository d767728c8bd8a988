#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "io/readers.hpp"
#include "io/scalar.hpp"
#include "io/text.hpp"

// What the readers of clouds share: points as lines of text, and points as bytes. A cloud is one scan.
namespace pingvox {

/// Whether a point of NaN is damage or, as in PCD, the place of a beam that brought nothing back. Both are counted.
enum class NanPoint { kDamage, kNoReturn };

/// Points as lines of words between blanks, tabs or commas.
struct TextCloud {
  struct Column {
    std::size_t word = 0;           ///< counted from 0
    Scalar type = Scalar::kDouble;  ///< kFloat: the text is rounded to it, as whoever else reads the file does
  };
  std::array<Column, 3> xyz;
  /// Lines of points: fewer are damage, what follows them belongs to something else. nullopt: all there are.
  std::optional<std::uint64_t> points;
  NanPoint nan = NanPoint::kDamage;
};

/// @param lines  of the file, up to the first point already read
/// REQUIRES that `lines` looks into the file's bytes
std::unique_ptr<ScanSource> text_cloud(FileBytes file, Lines lines, const TextCloud& cloud, Damage damage,
                                       const Eigen::Vector3d& origin_m);

/// Points as bytes.
struct ByteCloud {
  struct Column {
    std::size_t first = 0;  ///< where the value of the first point stands
    std::size_t step = 0;   ///< bytes from there to the one of the next point
    Scalar type = Scalar::kFloat;
  };
  std::array<Column, 3> xyz;
  std::size_t points = 0;
  std::endian order = std::endian::little;
  NanPoint nan = NanPoint::kDamage;
};

/// REQUIRES that each value of each point is within `bytes`.
std::unique_ptr<ScanSource> byte_cloud(std::string name, std::vector<std::uint8_t> bytes, const ByteCloud& cloud,
                                       Damage damage, const Eigen::Vector3d& origin_m);

}  // namespace pingvox
