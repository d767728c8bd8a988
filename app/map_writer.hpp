#pragma once

#include <future>

#include "commands.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox::app {

/// Writes the map of `live` in a thread of its own: a disk may take seconds, in which the lines' buffers would
/// overflow.
class MapWriter {
 public:
  explicit MapWriter(const LiveCommand& command) : command_(command) {}

  /// Writes a copy of the map, unless the last one is still being written.
  /// @return error of the last one, or kNoMemory or kIo when this one cannot be begun
  Result<void> write(const OccupancyMap& map);
  /// Writes the last map. @return its error
  Result<void> finish(const OccupancyMap& map);

 private:
  Result<void> write_file_of(const OccupancyMap& map) const;

  const LiveCommand& command_;
  std::future<Result<void>> written_;
};

}  // namespace pingvox::app
