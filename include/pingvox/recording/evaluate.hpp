#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "pingvox/map/cell_agreement.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/mapping/build_options.hpp"
#include "pingvox/mapping/sweep_coverage.hpp"
#include "pingvox/recording/recording.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

struct EvaluateOptions {
  MapOptions map = {};
  /// As for build_map: size of the beam, mount, speed of sound in known water and background are the recording's.
  BuildOptions build = {};
  std::size_t folds = 5;  ///< that the sweeps are split into, 2..1000
  CountCells cells = CountCells::kNo;

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// Echoes compared with a map of other sweeps, counted by outcome.
struct EchoCounts {
  std::size_t echoes = 0;
  std::size_t judged = 0;  ///< those whose place the map knows; the rest of the counts are of these
  std::size_t within_cell = 0, within_10cm = 0;  ///< predicted as exactly as that
  std::size_t predicted = 0;                     ///< within Evaluation::tolerance_m
  std::size_t too_early = 0;                     ///< the map has something nearer: a false object, or a thick wall
  std::size_t from_free = 0;                     ///< the map is free at the place of the echo

  std::size_t unknown() const { return echoes - judged; }
  /// Share of the echoes that can be judged; 0 without any.
  double coverage() const;
};

/// How well the map of a recording predicts echoes that were held out of it.
struct Evaluation {
  std::size_t beams = 0;      ///< with a pose
  std::size_t folds = 0;      ///< as used: not more than sweeps
  double resolution_m = 0.0;  ///< of the maps
  double tolerance_m = 0.0;   ///< 0.1 m, or a cell where that is more
  EchoCounts all;
  /// Echoes within [from, to).
  struct Part {
    double from = 0.0, to = 0.0;
    EchoCounts counts;
  };
  std::vector<Part> by_range;  ///< in metres; those with echoes
  std::vector<Part> by_time;   ///< in seconds, ten equal parts from the first echo to the last
  SweepCoverage sweeps;
  /// Cells of the map of all sweeps, and of free space, that echoes were compared with, by their keys: how many of
  /// those echoes agree. Cells that are not there were not judged. Empty without CountCells::kYes.
  std::vector<CellAgreement> cells;

  /// Whether enough echoes can be judged for their shares to mean something: at least half of them, and a hundred.
  bool is_judged() const;
};

/// Predicts each echo of a recording by a map of other sweeps. Sweeps are split into folds; the echoes of each fold are
/// compared with the map of the other folds. An echo is predicted where that map has something occupied on its arc,
/// which is as wide and high as the beam detects objects, within the tolerance in range, and nothing before it on the
/// beam's axis. A consistent error, as of a turned frame, is not detected.
/// @param progress  called with the share that is done, in 0..1
/// @return kBadOption when the options do not validate; kUnsupported for logs of scans; errors of Recording::path, of
///         reading and of build_map
Result<Evaluation> evaluate(const Recording& recording, const EvaluateOptions& options = {},
                            const std::function<void(double)>& progress = nullptr);
/// The same along another path, as that of `slam`.
Result<Evaluation> evaluate(const Recording& recording, const VehiclePath& path, const EvaluateOptions& options,
                            const std::function<void(double)>& progress = nullptr);

}  // namespace pingvox
