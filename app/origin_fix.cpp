#include "origin_fix.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include "option_values.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/input_file.hpp"
#include "pingvox/recording/map_origin.hpp"
#include "pingvox/recording/navigation.hpp"
#include "pingvox/recording/vehicle_path.hpp"

namespace pingvox::app {

Take store_origin(std::optional<Eigen::Vector3d>& target) {
  return [&target](const std::string& text) -> Result<void> {
    constexpr double kPole_deg = 90.0, kHalfTurn_deg = 180.0;
    const auto degrees = numbers_from<2>(text);
    if (!degrees) return tl::unexpected(degrees.error());
    const auto [latitude_deg, longitude_deg] = *degrees;
    // At a pole no direction is east.
    if (!(std::fabs(latitude_deg) < kPole_deg) || !(std::fabs(longitude_deg) <= kHalfTurn_deg)) {
      return usage_error(
          fmt::format("must be a latitude between -90 and 90 and a longitude of -180 to 180 degrees, is {}", text));
    }
    target = Eigen::Vector3d(latitude_deg * kDegree_rad, longitude_deg * kDegree_rad, 0.0);
    return {};
  };
}

Result<std::optional<Eigen::Vector3d>> origin_fix_of(const ConvertCommand& command, MapAxes axes) {
  if (command.origin.empty()) return std::nullopt;
  if (axes == MapAxes::kRightAhead) {
    return fail(Error::Code::kBadOption,
                fmt::format("{}: its x and y are right and ahead of the vehicle at the start, not east and north: it "
                            "cannot be placed on the earth",
                            command.input));
  }
  if (command.origin.fix) return command.origin.fix;
  const std::vector<InputFile> files(command.origin.navs.begin(), command.origin.navs.end());
  const Result<NavFiles> nav =
      read_navigation(files, {.damage = command.damage, .fields = command.bag.nav, .chosen = command.nav_sources});
  if (!nav) return tl::unexpected(nav.error());
  const std::string names = fmt::format("{}", fmt::join(command.origin.navs, ", "));
  const Result<VehiclePath> path = path_of(*nav, names, 0.0);
  if (!path) {
    Error error = path.error();
    error.message += "; --nav has to name all navigation that the map was made with, or --origin says where 0, 0 is";
    return tl::unexpected(std::move(error));
  }
  const std::optional<MapOrigin> origin = map_origin(*path, nav->log, 0.0);
  if (origin) return origin->fix;
  return fail(
      Error::Code::kUnsupported,
      fmt::format("{}: its positions are in metres, without fixes of the same time: --origin says where 0, 0 is",
                  names));
}

std::string place_text(const std::optional<Eigen::Vector3d>& origin_fix, MapAxes axes) {
  if (!origin_fix) return "; in metres of the map, not placed on the earth (--origin)";
  return fmt::format("; 0, 0 at latitude {:.7f}, longitude {:.7f} degrees{}", origin_fix->x() / kDegree_rad,
                     origin_fix->y() / kDegree_rad,
                     axes == MapAxes::kEastNorth ? "" : ", x taken as east and y as north, which the map does not say");
}

std::string prj_file(const std::string& output) {
  return std::filesystem::path(output).replace_extension(".prj").string();
}

std::string world_file(const std::string& output) {
  return std::filesystem::path(output).replace_extension(".pgw").string();
}

}  // namespace pingvox::app
