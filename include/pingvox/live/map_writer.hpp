#pragma once

#include <future>
#include <optional>
#include <string>
#include <utility>

#include "pingvox/io/format.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Writes a growing map repeatedly, in a thread of its own: a disk may take seconds, in which the buffers of the
/// devices would overflow.
class MapWriter {
 public:
  /// @param format   nullopt: by the suffix of the path
  /// @param made_by  as for write_map
  explicit MapWriter(std::string path, std::optional<Format> format = std::nullopt, std::string made_by = {})
      : file_{std::move(path), format, std::move(made_by)} {}

  /// Begins to write a copy of the map, unless the last one is still being written.
  /// @return error of the last one, or kNoMemory or kIo when this one cannot be begun
  Result<void> write(const OccupancyMap& map);
  /// Writes the last map, and waits for it. @return its error
  Result<void> finish(const OccupancyMap& map);

 private:
  struct File {
    std::string path;
    std::optional<Format> format;
    std::string made_by;

    Result<void> write(const OccupancyMap& map) const;
  };

  File file_;
  std::future<Result<void>> written_;
};

}  // namespace pingvox
