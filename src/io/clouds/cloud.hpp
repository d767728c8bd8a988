#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "io/bytes/scalar.hpp"
#include "io/bytes/text.hpp"
#include "io/readers.hpp"

// Shared by the readers of clouds: points as text and as bytes. A cloud is one scan.
namespace pingvox {

/// Meaning of a NaN point: damage or, as in PCD, a beam without return. Both are counted.
enum class NanPoint { kDamage, kNoReturn };

/// Points as text lines, separated by blanks, tabs or commas.
struct TextCloud {
  struct Column {
    std::size_t word = 0;           ///< counted from 0
    Scalar type = Scalar::kDouble;  ///< kFloat: rounded to float, as other readers do
  };
  std::array<Column, 3> xyz;
  /// Number of lines with points: fewer are damage, and so are further lines where nothing else may follow. nullopt:
  /// all lines.
  std::optional<std::uint64_t> points;
  bool is_last = false;  ///< nothing else may follow
  /// As many are announced, but all lines are read: fewer are damage.
  std::optional<std::uint64_t> announced = std::nullopt;
  NanPoint nan = NanPoint::kDamage;
};

/// @param lines  positioned at the first point
/// REQUIRES `lines` to be a view of the file's bytes
std::unique_ptr<ScanSource> text_cloud(FileBytes file, Lines lines, const TextCloud& cloud, Damage damage,
                                       const Eigen::Vector3d& origin_m);

/// Points as binary records.
struct ByteCloud {
  struct Column {
    std::size_t first = 0;  ///< offset of the first value
    std::size_t step = 0;   ///< stride [bytes]
    Scalar type = Scalar::kFloat;
  };
  std::array<Column, 3> xyz;
  std::size_t points = 0;
  std::uint64_t bytes_behind = 0;  ///< of what looks like more points, where nothing else may follow
  std::endian order = std::endian::little;
  NanPoint nan = NanPoint::kDamage;
};

/// The size of what is behind the last point, if it is as long as a point; 0 for zeros, which fill up a page.
std::uint64_t bytes_like_points(std::span<const std::uint8_t> behind, std::uint64_t point_bytes);

/// REQUIRES that each value of each point is within `bytes`.
std::unique_ptr<ScanSource> byte_cloud(std::string name, std::vector<std::uint8_t> bytes, const ByteCloud& cloud,
                                       Damage damage, const Eigen::Vector3d& origin_m);

}  // namespace pingvox
