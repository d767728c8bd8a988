#include "pingvox/io/maps.hpp"

#include <fmt/core.h>

#include <new>
#include <optional>
#include <utility>

#include "io/clouds/pcd.hpp"
#include "io/clouds/ply.hpp"
#include "io/clouds/xyz.hpp"
#include "io/maps/octomap_bt.hpp"
#include "io/maps/octomap_header.hpp"
#include "io/maps/octomap_ot.hpp"
#include "io/maps/pvx.hpp"
#include "pingvox/io/file.hpp"

namespace pingvox {
namespace {

Result<MapFile> octomap_file(Format format, const FileBytes& file, Result<OccupancyMap> map) {
  if (!map) return tl::unexpected(std::move(map).error());
  return MapFile{format, *std::move(map), {}, octomap_axes(file)};
}

}  // namespace

Result<MapFile> read_map(const FileBytes& file, std::size_t memory_limit_bytes) {
  const std::optional<Format> format = format_of(file.view());
  try {
    if (format == Format::kBt) return octomap_file(*format, file, read_bt(file, memory_limit_bytes));
    if (format == Format::kOt) return octomap_file(*format, file, read_ot(file, memory_limit_bytes));
    if (format == Format::kPvx) return read_pvx(file, memory_limit_bytes);
  } catch (const std::bad_alloc&) {
    return fail(Error::Code::kNoMemory, fmt::format("{}: out of memory: the map was not read", file.name));
  }
  const std::string what = format               ? std::string(description_of(*format))
                           : file.bytes.empty() ? "empty"
                                                : "of unknown content";
  return fail(Error::Code::kUnsupported, fmt::format("{}: not a map (.bt, .ot or .pvx) but {}", file.name, what));
}

Result<void> write_map(const OccupancyMap& map, Format format, std::string_view made_by, std::ostream& out,
                       MapAxes axes) {
  switch (format) {
    case Format::kBt:
      return write_bt(map, axes, out);
    case Format::kOt:
      return write_ot(map, axes, out);
    case Format::kPvx:
      return write_pvx(map, made_by, axes, out);
    case Format::kPly:
      return write_ply(map, out);
    case Format::kPcd:
      return write_pcd(map, out);
    case Format::kXyz:
      return write_xyz(map, out);
    default:
      break;
  }
  return fail(
      Error::Code::kUnsupported,
      fmt::format("a map cannot be written as .{}: .bt, .ot, .pvx, .ply, .pcd and .xyz can hold it", name_of(format)));
}

Result<void> write_map(const OccupancyMap& map, const std::string& path, std::string_view made_by) {
  const std::optional<Format> format = format_for_writing(path);
  if (!format) {
    return fail(Error::Code::kUnsupported,
                fmt::format("{}: its suffix must be .bt, .ot, .pvx, .ply, .pcd or .xyz", path));
  }
  return write_map(map, *format, made_by, path);
}

Result<void> write_map(const OccupancyMap& map, Format format, std::string_view made_by, const std::string& path,
                       MapAxes axes) {
  return write_file(path, [&](std::ostream& out) -> Result<void> {
    const Result<void> written = write_map(map, format, made_by, out, axes);
    if (written) return {};
    return fail(written.error().code, fmt::format("{}: {}", path, written.error().message));
  });
}

}  // namespace pingvox
