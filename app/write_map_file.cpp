#include "write_map_file.hpp"

#include <fmt/core.h>

#include "pingvox/io/file.hpp"
#include "pingvox/io/maps.hpp"

namespace pingvox::app {

Result<void> write_map_file(const std::string& path, const OccupancyMap& map, Format format,
                            const std::string& made_by) {
  return write_file(path, [&](std::ostream& out) -> Result<void> {
    const Result<void> written = write_map(map, format, made_by, out);
    if (written) return {};
    // The writer knows a stream and no name.
    return fail(written.error().code, fmt::format("{}: {}", path, written.error().message));
  });
}

}  // namespace pingvox::app
