#include "claim.hpp"

#include <cmath>
#include <variant>

namespace pingvox::bench {

Row row_of(const Claim& claim) {
  Row row;
  row.add("name", claim.name)
      .add("section", claim.section)
      .add("unit", claim.unit)
      .add_value("paper", claim.paper)
      .add_value("ours", claim.ours)
      .add_value("octomap", claim.octomap);
  if (claim.holds == Holds::kNotJudged) {
    row.add_nothing("holds");
  } else {
    row.add_truth("holds", claim.holds == Holds::kYes);
  }
  row.add_truth("checked", claim.checked).add("why", claim.why);
  return row;
}

double per_cent(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : std::round(1000.0 * static_cast<double>(part) / static_cast<double>(whole)) / 10.0;
}

}  // namespace pingvox::bench
