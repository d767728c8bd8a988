#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "pingvox/nav/nav_log.hpp"

namespace pingvox {

/// What the first numbers of a source are like. Outliers, up to a hundredth of them, are left out.
struct NumberExtent {
  double lowest = 0.0, highest = 0.0;
  double speed_s = 0.0;  ///< by how much they change in a second, but for the fastest tenth
};

/// Whether a sample is valid and not 0, which sensors send before they answer.
bool is_answer(const NavSample& sample);

/// Of the samples that are answers. nullopt: there are none.
std::optional<NumberExtent> extent_of(const NavSource& source);

/// The first numbers of two sources at the same times, within a second, of up to a thousand samples of the first; both
/// in order of time.
std::vector<std::pair<double, double>> numbers_together(const NavSource& one, const NavSource& other);

}  // namespace pingvox
