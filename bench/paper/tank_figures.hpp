#pragma once

#include <string>
#include <vector>

#include "pingvox/result.hpp"
#include "pingvox/viewer/picture.hpp"
#include "tank_logs.hpp"

namespace pingvox::bench {

/// A figure of the paper, drawn from a log.
struct TankFigure {
  std::string name;     ///< "figure-2"
  std::string section;  ///< of the paper
  std::string says;     ///< what the paper says of it
  Picture picture;
};

/// Figures 2 to 4 and 13 to 21, from the second sweep of a log.
Result<std::vector<TankFigure>> tank_figures(const TankLog& log);

}  // namespace pingvox::bench
