#pragma once

#include <optional>
#include <string>

#include "bench/report.hpp"

namespace pingvox::bench {

/// Whether our result confirms the paper.
enum class Holds { kYes, kNo, kNotJudged };

/// A claim of the paper and our result. docs/paper.md explains it under the same name.
struct Claim {
  std::string name;     ///< section or table first, as in "table-1-leaves-pruned"
  std::string section;  ///< of the paper
  std::string unit;     ///< of the numbers; "" for words
  Value paper = {};     ///< empty: no number in the paper
  Value ours = {};
  Value octomap = {};  ///< result of liboctomap; empty: not applicable
  Holds holds = Holds::kNotJudged;
  bool checked = false;  ///< our result was compared with liboctomap, exact arithmetic or ground truth
  std::string why = {};  ///< short reason
};

/// {name, section, unit, paper, ours, octomap, holds, checked, why}
Row row_of(const Claim& claim);

/// Percentage to one decimal; 0 if whole is 0.
double per_cent(std::size_t part, std::size_t whole);

}  // namespace pingvox::bench
