#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/bench.hpp"
#include "pingvox/mapping/build_map.hpp"
#include "pingvox/sonar/sweep.hpp"

namespace pingvox::bench {

/// A log of a sonar that stands still in the square tank, and how far its walls are.
struct TankLog {
  std::string name;  ///< "simulated" or "recorded"
  std::vector<Beam> beams;
  std::vector<Sweep> sweeps;  ///< the same beams, cut into sweeps
  /// Range [m] at which the middle of a beam meets a wall; nullopt: not known well enough to judge an echo by it.
  std::optional<double> (*wall_m)(double bearing_rad);
};

/// What `pingvox simulate tank` makes: ten turns, seed 1.
TankLog simulated_tank();

/// The paper's recording, if the shared data is beside the project; nullopt when it is not. Its walls were fitted to
/// the strongest ridge of the mean of all sweeps; bearings more than 33 degrees off a wall's normal, and those of the
/// floater, are not judged.
Result<std::optional<TankLog>> recorded_tank();

/// The simulated tank, and the recorded one where it is there.
Result<std::vector<TankLog>> tank_logs();

/// Echoes of a log compared with its walls.
struct EchoJudgement {
  std::size_t judged = 0;  ///< beams whose wall is known
  std::size_t right = 0;   ///< echo within 10 cm of it
  std::size_t wrong = 0;   ///< echo elsewhere
  std::size_t missed = 0;  ///< no echo
  void add(std::optional<double> wall_m, std::optional<double> echo_m);
};

/// Evaluates a filter and a detector.
EchoJudgement judge_echoes(const TankLog& log, const FilterOptions& filter, const EchoOptions& echo);

}  // namespace pingvox::bench
