#include "pingvox/io/grids.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <string>

#include "io/maps/local_crs.hpp"

namespace pingvox {
namespace {

constexpr char kOccupied = '\0', kFree = '\xfe', kUnknown = '\xcd';  // 0, 254, 205

Result<void> check_stream(std::ostream& out) {
  if (!out.flush()) return fail(Error::Code::kIo, "the grid could not be written");
  return {};
}

/// A length to 12 digits, without rounding errors.
std::string length(double value_m) {
  return fmt::format("{:.12g}", value_m);
}

/// The same without an exponent, which some YAML readers take for a string.
std::string decimal(double value_m) {
  const std::string text = length(value_m);
  return text.find('e') == std::string::npos ? text : fmt::format("{:.20f}", value_m);
}

/// A YAML string.
std::string quote(std::string_view name) {
  std::string out = "\"";
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f) {
      out += fmt::format("\\x{:02X}", byte);
      continue;
    }
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

bool is_plain(std::string_view name) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./-";
  return !name.empty() && name.front() != '-' && name.find_first_not_of(kPlain) == std::string_view::npos;
}

}  // namespace

Result<void> write_grid_pgm(const Raster<Occupancy>& slice, std::ostream& out) {
  out << fmt::format("P5\n# pingvox, {} m a pixel\n{} {}\n255\n", length(slice.cell_m), slice.columns, slice.rows);
  std::string line(slice.columns, kUnknown);
  for (std::size_t row = slice.rows; row-- > 0;) {
    for (std::size_t column = 0; column < slice.columns; ++column) {
      const Occupancy value = slice.at(column, row);
      line[column] = value == Occupancy::kOccupied ? kOccupied : value == Occupancy::kFree ? kFree : kUnknown;
    }
    out.write(line.data(), static_cast<std::streamsize>(line.size()));
  }
  return check_stream(out);
}

Result<void> write_grid_yaml(const Raster<Occupancy>& slice, std::string_view image, std::ostream& out) {
  // map_server and nav2: a pixel p is free when (255 - p) / 255 < free_thresh; unknown, 205, is 0.19608.
  out << fmt::format(
      "image: {}\nmode: trinary\nresolution: {}\norigin: [{}, {}, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n"
      "free_thresh: 0.196\n",
      is_plain(image) ? std::string(image) : quote(image), decimal(slice.cell_m), decimal(slice.corner_m.x()),
      decimal(slice.corner_m.y()));
  return check_stream(out);
}

Raster<float> occupancy_numbers(const Raster<Occupancy>& slice) {
  Raster<float> numbers{slice.columns, slice.rows, slice.cell_m, slice.corner_m, {}};
  numbers.values.reserve(slice.values.size());
  for (const Occupancy value : slice.values) {
    numbers.values.push_back(value == Occupancy::kOccupied ? 1.0F
                             : value == Occupancy::kFree   ? 0.0F
                                                           : std::numeric_limits<float>::quiet_NaN());
  }
  return numbers;
}

Result<void> write_prj(const Eigen::Vector3d& origin_fix, std::ostream& out) {
  out << local_crs_wkt(origin_fix, WktDialect::kEsri) << '\n';
  return check_stream(out);
}

Result<void> write_heights_asc(const Raster<float>& heights, std::ostream& out) {
  float lowest = std::numeric_limits<float>::infinity();
  for (const float height : heights.values) lowest = std::fmin(lowest, height);
  // The usual value, unless it could be a height.
  const float nodata = lowest > -9999.0F ? -9999.0F : -3.4e38F;
  out << fmt::format("ncols {}\nnrows {}\nxllcorner {}\nyllcorner {}\ncellsize {}\nNODATA_value {}\n", heights.columns,
                     heights.rows, length(heights.corner_m.x()), length(heights.corner_m.y()), length(heights.cell_m),
                     nodata);
  fmt::memory_buffer line;
  for (std::size_t row = heights.rows; row-- > 0;) {
    line.clear();
    for (std::size_t column = 0; column < heights.columns; ++column) {
      const float height = heights.at(column, row);
      fmt::format_to(std::back_inserter(line), "{}{}", column > 0 ? " " : "", std::isnan(height) ? nodata : height);
    }
    line.push_back('\n');
    out.write(line.data(), static_cast<std::streamsize>(line.size()));
  }
  return check_stream(out);
}

Result<void> write_world_file(const Raster<float>& raster, PictureUp up, std::ostream& out) {
  // Six lines: x and y of a step to the right, of a step down, and of the middle of the upper left pixel.
  const double cell_m = raster.cell_m;
  const Eigen::Vector2d size_m =
      cell_m * Eigen::Vector2d(static_cast<double>(raster.columns), static_cast<double>(raster.rows));
  const Eigen::Vector2d upper_right_m = raster.corner_m + size_m;
  const bool is_y_up = up == PictureUp::kY;
  const Eigen::Vector2d right_m = is_y_up ? Eigen::Vector2d(cell_m, 0.0) : Eigen::Vector2d(0.0, -cell_m);
  const Eigen::Vector2d down_m = is_y_up ? Eigen::Vector2d(0.0, -cell_m) : Eigen::Vector2d(-cell_m, 0.0);
  const Eigen::Vector2d upper_left_m =
      (is_y_up ? Eigen::Vector2d(raster.corner_m.x(), upper_right_m.y()) : upper_right_m) + 0.5 * (right_m + down_m);
  for (const double number : {right_m.x(), right_m.y(), down_m.x(), down_m.y(), upper_left_m.x(), upper_left_m.y()}) {
    out << decimal(number) << '\n';
  }
  return check_stream(out);
}

}  // namespace pingvox
