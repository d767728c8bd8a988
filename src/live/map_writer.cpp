#include "pingvox/live/map_writer.hpp"

#include <fmt/core.h>

#include <chrono>
#include <new>
#include <system_error>

#include "pingvox/io/maps.hpp"

namespace pingvox {

Result<void> MapWriter::File::write(const OccupancyMap& map) const {
  try {
    return format ? write_map(map, *format, made_by, path) : write_map(map, path, made_by);
  } catch (const std::bad_alloc&) {
    return fail(Error::Code::kNoMemory, fmt::format("{}: not written: out of memory", path));
  }
}

Result<void> MapWriter::write(const OccupancyMap& map) {
  Result<void> last;
  if (written_.valid()) {
    if (written_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return {};
    last = written_.get();
  }
  try {
    written_ = std::async(std::launch::async, [file = file_, copy = map] { return file.write(copy); });
  } catch (const std::bad_alloc&) {
    return fail(Error::Code::kNoMemory, fmt::format("{}: not written: out of memory for a copy", file_.path));
  } catch (const std::system_error& error) {
    return fail(Error::Code::kIo, fmt::format("{}: not written: no thread: {}", file_.path, error.what()));
  }
  return last;
}

Result<void> MapWriter::finish(const OccupancyMap& map) {
  if (written_.valid()) written_.wait();
  return file_.write(map);
}

}  // namespace pingvox
