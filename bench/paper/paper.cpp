#include "paper.hpp"

#include <array>

#include "bits.hpp"
#include "bytes.hpp"
#include "early_drop.hpp"
#include "echoes.hpp"
#include "figures.hpp"
#include "key_width.hpp"
#include "maps.hpp"
#include "parents.hpp"
#include "rays.hpp"
#include "table_1.hpp"

namespace pingvox::bench {

Result<std::vector<Row>> paper(const BenchOptions& options) {
  constexpr std::array kSections = {&paper_maps,      &paper_key_width,  &paper_early_drop, &paper_parents,
                                    &paper_table_1,   &paper_bytes,      &paper_rays,       &paper_bits,
                                    &paper_smoothing, &paper_thresholds, &paper_canny};
  std::vector<Row> rows;
  for (const auto section : kSections) {
    Result<std::vector<Row>> found = section(options);
    if (!found) return found;
    rows.insert(rows.end(), found->begin(), found->end());
  }
  if (!options.pictures) return rows;
  Result<std::vector<Row>> figures = paper_figures(options);
  if (!figures) return figures;
  rows.insert(rows.end(), figures->begin(), figures->end());
  return rows;
}

}  // namespace pingvox::bench
