#include "map_writer.hpp"

#include <fmt/core.h>

#include <chrono>
#include <new>
#include <system_error>

#include "pingvox/io/maps.hpp"

namespace pingvox::app {

Result<void> MapWriter::write_file_of(const OccupancyMap& map) const {
  try {
    return write_map(map, command_.format, command_.made_by, command_.output);
  } catch (const std::bad_alloc&) {
    return fail(Error::Code::kNoMemory, fmt::format("{}: not written: out of memory", command_.output));
  }
}

Result<void> MapWriter::write(const OccupancyMap& map) {
  Result<void> last;
  if (written_.valid()) {
    if (written_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return {};
    last = written_.get();
  }
  try {
    written_ = std::async(std::launch::async, [this, copy = map] { return write_file_of(copy); });
  } catch (const std::bad_alloc&) {
    return fail(Error::Code::kNoMemory, fmt::format("{}: not written: out of memory for a copy", command_.output));
  } catch (const std::system_error& error) {
    return fail(Error::Code::kIo, fmt::format("{}: not written: no thread: {}", command_.output, error.what()));
  }
  return last;
}

Result<void> MapWriter::finish(const OccupancyMap& map) {
  if (written_.valid()) written_.wait();
  return write_file_of(map);
}

}  // namespace pingvox::app
