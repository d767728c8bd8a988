#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pingvox/result.hpp"
#include "report.hpp"

namespace pingvox::bench {

/// Groups of benchmarks.
enum class Family {
  kSpeed,     ///< compared with liboctomap; part of `pingvox bench all`
  kVehicle,   ///< real time, growth, start-up; part of `all`
  kAccuracy,  ///< compared with ground truth; not in `all`
  kPaper,     ///< the paper's tables and figures; not in `all`
};

struct BenchOptions {
  /// Folder for pictures (charts, the paper's figures), created if missing. nullopt: none are drawn.
  std::optional<std::string> pictures;
  /// Prints a line of progress.
  void (*say)(std::string_view line) = nullptr;
};

/// One benchmark. Its input comes from a seed or from recordings; its result is checked before it is timed.
struct Bench {
  std::string_view name;
  std::string_view what;  ///< in a few words
  Family family;
  /// The rows; an error when its input is missing or its check failed.
  Result<std::vector<Row>> (*run)(const BenchOptions& options);
};

/// All benchmarks, in the order of `all`.
std::span<const Bench> benches();

}  // namespace pingvox::bench
