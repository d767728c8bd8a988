#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pingvox/slam/pose_graph.hpp"
#include "slam/smoother/slam_solver.hpp"

/// Loops of a scanning sonar that are beyond the reach of pairs of echoes.
namespace pingvox {

struct SweepLoops {
  std::size_t found = 0;  ///< submaps of nine sweeps that look like one of an earlier time
  std::size_t kept = 0;   ///< those that agree with each other
};

/// Finds loops by correlation of submaps, in ever smaller windows, and solves without pairs after each search, from the
/// solver's present poses, which are taken to be those of dead reckoning. The loops are temporary: pairs of echoes give
/// more, once they are found.
/// @return those of the last search. nullopt: the problem does not determine its unknowns
std::optional<SweepLoops> close_sweep_loops(SlamSolver& solver);

/// As on board: compares the newest sweeps with earlier ones, also with those that left the problem, and solves without
/// pairs where the poses are farther from the loops than pairs of echoes lead back. The loops stay.
/// @return none where nothing was moved. nullopt: the problem does not determine its unknowns
std::optional<SweepLoops> close_new_loops(SlamSolver& solver);

}  // namespace pingvox
