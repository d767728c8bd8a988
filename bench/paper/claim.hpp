#pragma once

#include <optional>
#include <string>

#include "bench/report.hpp"

namespace pingvox::bench {

/// Whether what the paper says is what we find.
enum class Holds { kYes, kNo, kNotJudged };

/// One thing that the paper says, and what we get. The reasons at length are in docs/paper.md, under the claim's name.
struct Claim {
  std::string name;     ///< section or table first, as in "table-1-leaves-pruned"
  std::string section;  ///< of the paper
  std::string unit;     ///< of the numbers; "" for words
  Value paper = {};     ///< nothing: the paper has no number for it
  Value ours = {};
  Value octomap = {};  ///< what liboctomap gets; nothing: it has nothing of the kind
  Holds holds = Holds::kNotJudged;
  bool checked = false;  ///< our result was held against something that knows: liboctomap, exact arithmetic, the truth
  std::string why = {};  ///< in a few words
};

/// {name, section, unit, paper, ours, octomap, holds, checked, why}
Row row_of(const Claim& claim);

/// A share in per cent, to one decimal; 0 of nothing.
double per_cent(std::size_t part, std::size_t whole);

}  // namespace pingvox::bench
