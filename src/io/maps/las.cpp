#include "pingvox/io/las.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "io/bytes/byte_writer.hpp"
#include "io/maps/local_crs.hpp"
#include "io/maps/occupied_leaves.hpp"

// docs/formats.md: a header, records of variable length, points of format 6 with two extra floats.
namespace pingvox {
namespace {

constexpr std::uint16_t kLasHeader = 375, kVlrHeader = 54;
constexpr std::size_t kReturns = 15;

/// Text of a fixed length, filled up with zeros.
void put_padded(ByteWriter& writer, std::string_view text, std::size_t length) {
  std::string padded(text.substr(0, length));
  padded.resize(length, '\0');
  writer.put(padded);
}

void put_vlr_header(ByteWriter& writer, std::string_view user, std::uint16_t record, std::size_t length,
                    std::string_view description) {
  constexpr std::size_t kUser = 16, kDescription = 32;
  writer.put(std::uint16_t{0});
  put_padded(writer, user, kUser);
  writer.put(record);
  writer.put(static_cast<std::uint16_t>(length));
  put_padded(writer, description, kDescription);
}

/// A dimension of the extra bytes, as the record that describes them has it.
struct ExtraFloat {
  std::string_view name, description;
};
constexpr std::array kExtra = {ExtraFloat{"probability", "that the cell is occupied"},
                               ExtraFloat{"size", "edge of the cell [m]"}};
constexpr std::size_t kExtraDescriptor = 192;
constexpr std::uint16_t kPointBytes = 30 + kExtra.size() * sizeof(float);

void put_extra(ByteWriter& writer, const ExtraFloat& extra) {
  constexpr std::uint8_t kFloat = 9;
  constexpr std::size_t kName = 32, kValues = 124;  // ranges, scales and offsets, none of which is used
  writer.put(std::uint16_t{0});
  writer.put(kFloat);
  writer.put(std::uint8_t{0});
  put_padded(writer, extra.name, kName);
  put_padded(writer, {}, kValues);
  put_padded(writer, extra.description, kName);
}

/// The occupied leaves' centres.
struct LasPoints {
  std::uint64_t count = 0;
  Eigen::Vector3d low_m = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()), high_m = -low_m;
};

/// The finest power of ten [m] in whose units all coordinates from the offset are 32-bit numbers; 0: there is none.
double unit_for(const LasPoints& points, const Eigen::Vector3d& offset_m) {
  constexpr double kFarthest = 2.0e9;
  const double reach_m =
      (points.high_m - offset_m).cwiseAbs().cwiseMax((points.low_m - offset_m).cwiseAbs()).maxCoeff();
  for (const double unit_m : {1e-4, 1e-3, 1e-2}) {
    if (reach_m / unit_m < kFarthest) return unit_m;
  }
  return 0.0;
}

}  // namespace

Result<std::size_t> write_las(const OccupancyMap& map, const std::optional<Eigen::Vector3d>& origin_fix,
                              std::ostream& out) {
  LasPoints points;
  for_each_occupied(map, [&](const Leaf& leaf) {
    ++points.count;
    points.low_m = points.low_m.cwiseMin(leaf.centre_m());
    points.high_m = points.high_m.cwiseMax(leaf.centre_m());
  });
  if (points.count == 0) return fail(Error::Code::kUnsupported, "no cell is occupied: there are no points to write");
  const Eigen::Vector3d offset_m = points.low_m.array().floor();
  const double unit_m = unit_for(points, offset_m);
  if (unit_m == 0.0) return fail(Error::Code::kLimit, "its occupied cells are too far apart for the numbers of .las");

  // The text ends with a NUL.
  const std::string crs = origin_fix ? local_crs_wkt(*origin_fix, WktDialect::kOgc) : std::string();
  const std::size_t extra_bytes = kExtra.size() * kExtraDescriptor;
  const std::size_t data_at = kLasHeader + kVlrHeader + extra_bytes + (origin_fix ? kVlrHeader + crs.size() + 1 : 0);
  constexpr std::uint16_t kWkt = 1U << 4U;
  constexpr std::size_t kGuid = 16, kNameBytes = 32;
  constexpr std::uint8_t kPointFormat = 6;
  ByteWriter writer(out);
  writer.put("LASF");
  writer.put(std::uint16_t{0});  // the source
  writer.put(kWkt);
  put_padded(writer, {}, kGuid);
  writer.put(std::uint8_t{1});
  writer.put(std::uint8_t{4});
  put_padded(writer, "OTHER", kNameBytes);
  put_padded(writer, "pingvox", kNameBytes);
  writer.put(std::uint32_t{0});  // day and year: the same map gives the same bytes
  writer.put(kLasHeader);
  writer.put(static_cast<std::uint32_t>(data_at));
  writer.put(static_cast<std::uint32_t>(origin_fix ? 2 : 1));
  writer.put(kPointFormat);
  writer.put(kPointBytes);
  for (std::size_t legacy = 0; legacy < 6; ++legacy) writer.put(std::uint32_t{0});
  for (std::size_t axis = 0; axis < 3; ++axis) writer.put(unit_m);
  for (const double number : offset_m) writer.put(number);
  // As the points are read: in units from the offset.
  const auto units = [&](const Eigen::Vector3d& point_m, Eigen::Index axis) {
    return static_cast<std::int32_t>(std::lround((point_m[axis] - offset_m[axis]) / unit_m));
  };
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    for (const Eigen::Vector3d& corner_m : {points.high_m, points.low_m}) {
      writer.put(units(corner_m, axis) * unit_m + offset_m[axis]);
    }
  }
  writer.put(std::uint64_t{0});  // waveforms
  writer.put(std::uint64_t{0});  // extended records
  writer.put(std::uint32_t{0});
  writer.put(points.count);
  for (std::size_t nth = 0; nth < kReturns; ++nth) writer.put(nth == 0 ? points.count : std::uint64_t{0});

  constexpr std::uint16_t kExtraRecord = 4, kWktRecord = 2112;
  put_vlr_header(writer, "LASF_Spec", kExtraRecord, extra_bytes, "extra bytes");
  for (const ExtraFloat& extra : kExtra) put_extra(writer, extra);
  if (origin_fix) {
    put_vlr_header(writer, "LASF_Projection", kWktRecord, crs.size() + 1, "coordinate reference system");
    put_padded(writer, crs, crs.size() + 1);
  }
  for_each_occupied(map, [&](const Leaf& leaf) {
    constexpr std::uint8_t kFirstOfOne = 0x11;
    const Eigen::Vector3d centre_m = leaf.centre_m();
    const double probability = leaf.belief.probability();
    for (Eigen::Index axis = 0; axis < 3; ++axis) writer.put(units(centre_m, axis));
    writer.put(static_cast<std::uint16_t>(std::lround(probability * std::numeric_limits<std::uint16_t>::max())));
    writer.put(kFirstOfOne);
    writer.put(std::uint8_t{0});   // flags
    writer.put(std::uint8_t{0});   // class: none
    writer.put(std::uint8_t{0});   // user data
    writer.put(std::uint16_t{0});  // angle
    writer.put(std::uint16_t{0});  // source
    writer.put(0.0);               // time
    writer.put(static_cast<float>(probability));
    writer.put(static_cast<float>(leaf.edge_m()));
  });
  if (const auto written = writer.finish(); !written) return tl::unexpected(written.error());
  return points.count;
}

}  // namespace pingvox
