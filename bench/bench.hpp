#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pingvox/result.hpp"
#include "report.hpp"

namespace pingvox::bench {

/// Which benchmarks a name stands for.
enum class Family {
  kSpeed,     ///< one row, beside liboctomap; all of them are `pingvox bench all`
  kVehicle,   ///< what a vehicle asks for: real time, growth, start-up; in `all`, too
  kAccuracy,  ///< against simulated truth; a command of its own
  kPaper,     ///< the paper's tables and figures; a command of its own
};

struct BenchOptions {
  /// Where to put pictures (charts, the paper's figures): a folder, made if it is not there. nullopt: none are drawn.
  std::optional<std::string> pictures;
  /// Says a line about what is going on, for a person who waits. Never the result.
  void (*say)(std::string_view line) = nullptr;
};

/// One benchmark. It makes its input from a seed, or takes it from the real recordings, and checks its result before it
/// times anything.
struct Bench {
  std::string_view name;
  std::string_view what;  ///< in a few words
  Family family;
  /// The rows; an error when its input is not there or its own check failed.
  Result<std::vector<Row>> (*run)(const BenchOptions& options);
};

/// All benchmarks, in the order of `all`.
std::span<const Bench> benches();

}  // namespace pingvox::bench
