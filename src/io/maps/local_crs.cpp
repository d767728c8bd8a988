#include "io/maps/local_crs.hpp"

#include <fmt/core.h>

#include "pingvox/geometry/degree.hpp"

namespace pingvox {

std::string local_crs_wkt(const Eigen::Vector3d& origin_fix, WktDialect dialect) {
  const double latitude_deg = origin_fix.x() / kDegree_rad, longitude_deg = origin_fix.y() / kDegree_rad;
  if (dialect == WktDialect::kEsri) {
    return fmt::format(
        R"(PROJCS["pingvox_map",GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",)"
        R"(SPHEROID["WGS_1984",6378137.0,298.257223563]],PRIMEM["Greenwich",0.0],)"
        R"(UNIT["Degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["False_Easting",0.0],)"
        R"(PARAMETER["False_Northing",0.0],PARAMETER["Central_Meridian",{:.12g}],PARAMETER["Scale_Factor",1.0],)"
        R"(PARAMETER["Latitude_Of_Origin",{:.12g}],UNIT["Meter",1.0]])",
        longitude_deg, latitude_deg);
  }
  return fmt::format(
      R"(PROJCS["pingvox map",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563,)"
      R"(AUTHORITY["EPSG","7030"]],AUTHORITY["EPSG","6326"]],PRIMEM["Greenwich",0,AUTHORITY["EPSG","8901"]],)"
      R"(UNIT["degree",0.0174532925199433,AUTHORITY["EPSG","9122"]],AUTHORITY["EPSG","4326"]],)"
      R"(PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",{:.12g}],)"
      R"(PARAMETER["central_meridian",{:.12g}],PARAMETER["scale_factor",1],PARAMETER["false_easting",0],)"
      R"(PARAMETER["false_northing",0],UNIT["metre",1,AUTHORITY["EPSG","9001"]],AXIS["Easting",EAST],)"
      R"(AXIS["Northing",NORTH]])",
      latitude_deg, longitude_deg);
}

}  // namespace pingvox
