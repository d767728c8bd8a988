#include "query_places.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/option_text.hpp"

namespace pingvox::app {

QuestionKind kind_of(Question question) {
  constexpr std::size_t kPoint = 3, kTwoPoints = 6;
  switch (question) {
    case Question::kRay:
      return {question, "--ray", "X,Y,Z,DX,DY,DZ", kTwoPoints};
    case Question::kNearest:
      return {question, "--nearest", "X,Y,Z", kPoint};
    case Question::kClearance:
      return {question, "--clearance", "X,Y,Z", kPoint};
    case Question::kRegion:
      return {question, "--region", "X,Y,Z,X,Y,Z", kTwoPoints};
    case Question::kPoint:
      break;
  }
  return {Question::kPoint, "--point", "X,Y,Z", kPoint};
}

namespace {

constexpr std::string_view kBetween = ", \t\r";

Result<std::vector<double>> numbers_in(std::string_view text) {
  std::vector<double> numbers;
  for (std::size_t from = text.find_first_not_of(kBetween); from != std::string_view::npos;) {
    const std::size_t to = std::min(text.find_first_of(kBetween, from), text.size());
    const Result<double> number = number_from<double>(text.substr(from, to - from));
    if (!number) return tl::unexpected(number.error());
    if (!std::isfinite(*number))
      return fail(Error::Code::kBadOption, fmt::format("'{}' is not finite", text.substr(from, to - from)));
    numbers.push_back(*number);
    from = text.find_first_not_of(kBetween, to);
  }
  return numbers;
}

Result<std::vector<double>> checked(std::vector<double> place, std::string_view text, const QuestionKind& kind) {
  if (place.size() != kind.numbers)
    return fail(Error::Code::kBadOption, fmt::format("'{}': must be {} numbers, {}", text, kind.numbers, kind.value));
  if (kind.question == Question::kRay && std::all_of(place.begin() + 3, place.end(), [](double d) { return d == 0.0; }))
    return fail(Error::Code::kBadOption, fmt::format("'{}': the ray has no direction", text));
  return place;
}

/// A line that begins with a letter.
bool are_names(std::string_view row) {
  const char first = row[row.find_first_not_of(kBetween)];
  return (first >= 'a' && first <= 'z') || (first >= 'A' && first <= 'Z');
}

}  // namespace

Result<std::vector<double>> place_from(std::string_view text, const QuestionKind& kind) {
  return numbers_in(text).and_then([&](std::vector<double> place) { return checked(std::move(place), text, kind); });
}

Result<std::vector<std::vector<double>>> places_from(std::string_view text, const QuestionKind& kind) {
  std::vector<std::vector<double>> places;
  for (std::size_t line = 1; !text.empty(); ++line) {
    const std::string_view row = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(row.size() + 1, text.size()));
    const std::size_t first = row.find_first_not_of(kBetween);
    if (first == std::string_view::npos || row[first] == '#' || (line == 1 && are_names(row))) continue;
    constexpr std::size_t kPoint = 3, kPose = 8;
    Result<std::vector<double>> place = numbers_in(row).and_then([&](std::vector<double> numbers) {
      if (kind.numbers == kPoint && numbers.size() == kPose) numbers = {numbers[1], numbers[2], numbers[3]};
      return checked(std::move(numbers), row, kind);
    });
    if (!place) return fail(Error::Code::kCorrupt, fmt::format("line {}: {}", line, place.error().message));
    places.push_back(*std::move(place));
  }
  return places;
}

}  // namespace pingvox::app
