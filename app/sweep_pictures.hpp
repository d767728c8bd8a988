#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/sweep.hpp"
#include "pingvox/viewer/picture.hpp"

/// Pictures of the sonar's echoes, for 'render': sweeps are added one by one, in the order of recording.
namespace pingvox::app {

/// A picture and its description.
struct Drawn {
  Picture picture;
  std::string what;
};

/// Collects the beams of a polar picture.
class PolarCollector {
 public:
  /// @param panel  outlives the collector
  explicit PolarCollector(const PanelCommand& panel) : panel_(panel) {}

  /// @param number  of the sweep, from 1
  void add(std::size_t number, Sweep sweep);
  /// nullopt: nothing was added that the panel shows. @param skipped  damaged records, for the description
  std::optional<Drawn> draw(std::size_t skipped);

 private:
  const PanelCommand& panel_;
  std::vector<Beam> beams_;
  std::vector<std::optional<Echo>> echoes_;
};

/// Selects the sweep of a Cartesian picture: as requested, else the one that shows most: directions times range. A head
/// that begins with some short pings before a dive is not drawn by these.
class CartesianCollector {
 public:
  explicit CartesianCollector(const PanelCommand& panel) : panel_(panel) {}

  void add(std::size_t number, Sweep sweep);
  std::optional<Drawn> draw(std::size_t skipped) const;

 private:
  const PanelCommand& panel_;
  std::optional<std::pair<std::size_t, Sweep>> chosen_;
  std::pair<double, std::size_t> fullness_;  ///< directions times range, and beams, of the chosen one
};

}  // namespace pingvox::app
