#include "pingvox/io/points.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "io/bytes/byte_writer.hpp"
#include "io/clouds/pcd.hpp"
#include "io/clouds/ply.hpp"

namespace pingvox {

Result<std::size_t> write_points(ScanSource& scans, Format format, std::ostream& out) {
  if (format != Format::kPly && format != Format::kPcd && format != Format::kXyz) {
    return fail(Error::Code::kUnsupported,
                fmt::format("points cannot be written as .{}: .ply, .pcd and .xyz can hold them", name_of(format)));
  }
  std::vector<Eigen::Vector3d> points_m;
  double farthest_m = 0.0;
  for (;;) {
    const Result<std::optional<PointScan>> scan = scans.next();
    if (!scan) return tl::unexpected(scan.error());
    if (!*scan) break;
    for (const Eigen::Vector3d& point_m : (*scan)->points_m) {
      points_m.push_back(point_m);
      farthest_m = std::max(farthest_m, point_m.cwiseAbs().maxCoeff());
    }
  }
  ByteWriter writer(out);
  const Coordinates coordinates = coordinates_up_to(farthest_m);
  if (format == Format::kPly) writer.put(ply_header("points of scans", points_m.size(), coordinates, {}));
  if (format == Format::kPcd) writer.put(pcd_header("points of scans", points_m.size(), coordinates, {}));
  for (const Eigen::Vector3d& point_m : points_m) {
    if (format == Format::kXyz) {
      writer.put(text_of(point_m, coordinates) + "\n");
    } else {
      put_point(point_m, coordinates, writer);
    }
  }
  if (!writer.finish()) return fail(Error::Code::kIo, "the points could not be written");
  return points_m.size();
}

}  // namespace pingvox
