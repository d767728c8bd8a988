#include "pingvox/io/points.hpp"

#include <fmt/core.h>

#include <optional>
#include <vector>

#include "io/byte_writer.hpp"
#include "io/pcd.hpp"
#include "io/ply.hpp"

namespace pingvox {

Result<std::size_t> write_points(ScanSource& scans, Format format, std::ostream& out) {
  if (format != Format::kPly && format != Format::kPcd && format != Format::kXyz) {
    return fail(Error::Code::kUnsupported,
                fmt::format("points cannot be written as .{}: .ply, .pcd and .xyz can hold them", name_of(format)));
  }
  std::vector<Eigen::Vector3f> points_m;
  for (;;) {
    const Result<std::optional<PointScan>> scan = scans.next();
    if (!scan) return tl::unexpected(scan.error());
    if (!*scan) break;
    for (const Eigen::Vector3d& point_m : (*scan)->points_m) points_m.emplace_back(point_m.cast<float>());
  }
  ByteWriter writer(out);
  if (format == Format::kPly) writer.put(ply_header("points of scans", points_m.size(), {"x", "y", "z"}));
  if (format == Format::kPcd) writer.put(pcd_header("points of scans", points_m.size(), {"x", "y", "z"}));
  for (const Eigen::Vector3f& p : points_m) {
    if (format == Format::kXyz) {
      writer.put(fmt::format("{} {} {}\n", p.x(), p.y(), p.z()));
    } else {
      for (const float value : p) writer.put(value);
    }
  }
  if (!writer.finish()) return fail(Error::Code::kIo, "the points could not be written");
  return points_m.size();
}

}  // namespace pingvox
