#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "commands.hpp"
#include "pingvox/result.hpp"

/// The places that `query` is asked about.
namespace pingvox::app {

/// How a question is typed.
struct QuestionKind {
  Question question;
  std::string_view option;  ///< "--point"
  std::string_view value;   ///< of the option: "X,Y,Z"
  std::size_t numbers;      ///< of a place
};
QuestionKind kind_of(Question question);

/// The numbers of a place, with commas, spaces or tabs between them.
/// @return kBadOption when they are too few or too many, or not finite; for a ray without a direction
Result<std::vector<double>> place_from(std::string_view text, const QuestionKind& kind);

/// The places in a text, one on each line: as place_from, or for points as poses (TUM: time, position, quaternion).
/// Empty lines, those that begin with #, and a first line of names are passed over.
/// @return as place_from, with the number of the line
Result<std::vector<std::vector<double>>> places_from(std::string_view text, const QuestionKind& kind);

}  // namespace pingvox::app
