#include "nav/internal/source_names.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace pingvox {
namespace {

using Words = std::span<const std::string_view>;

constexpr auto kCommands = std::to_array<std::string_view>(
    {"goal",      "goals",     "setpoint", "setpoints", "initialpose", "initial", "target",    "targets",
     "waypoint",  "waypoints", "clicked",  "cmd",       "cmds",        "cmdvel",  "command",   "commands",
     "commanded", "desired",   "des",      "demand",    "demanded",    "wanted",  "reference", "ref",
     "plan",      "planned",   "planner",  "max",       "min",         "limit",   "limits"});
constexpr auto kMarkers =
    std::to_array<std::string_view>({"marker", "markers", "aruco", "charuco", "apriltag", "tag", "tags"});
constexpr auto kThings = std::to_array<std::string_view>({"ship", "mothership", "home", "buoy", "dock", "docking",
                                                          "obj", "object", "objects", "obstacle", "diver", "gimbal",
                                                          "wind", "anemometer", "seafloor", "seabed"});
/// Base stations of receivers; odometry may be of a mobile base.
constexpr auto kThingsWithFix = std::to_array<std::string_view>({"base", "station", "basestation"});
constexpr auto kDepthsOfWater = std::to_array<std::string_view>({"water", "bottom"});
constexpr auto kInsides = std::to_array<std::string_view>(
    {"hull", "internal", "inside", "enclosure", "housing", "cabin", "air", "atmospheric"});
constexpr auto kSensors = std::to_array<std::string_view>({"camera", "cam"});
constexpr auto kSensorFrames = std::to_array<std::string_view>({"camera", "cam", "optical", "sonar"});

/// "/rov1/desiredDepth" -> "rov", "desired", "depth"
std::vector<std::string> words_of(std::string_view name) {
  std::vector<std::string> words(1);
  char before = '\0';
  const auto is = [](int (*kind)(int), char c) { return kind(static_cast<unsigned char>(c)) != 0; };
  for (const char c : name) {
    if (!is(std::isalpha, c)) {
      words.emplace_back();
    } else {
      if (is(std::isupper, c) && is(std::islower, before)) words.emplace_back();
      words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    before = c;
  }
  return words;
}

bool has_one_of(const std::vector<std::string>& words, Words wanted) {
  return std::ranges::any_of(words,
                             [&](const std::string& word) { return std::ranges::find(wanted, word) != wanted.end(); });
}

bool gives_turning(NavQuantity quantity) {
  return quantity == NavQuantity::kAttitude || quantity == NavQuantity::kHeading || quantity == NavQuantity::kTurnRate;
}

}  // namespace

std::string_view other_by_name(const NavSource& source, bool is_alone) {
  constexpr std::string_view kCommand = "a goal, command or plan by its name", kOther = "of something else by its name";
  const NavQuantity quantity = source.quantity;
  if (quantity == NavQuantity::kTemperature || quantity == NavQuantity::kRange) return {};
  const std::vector<std::string> words = words_of(source.name), child = words_of(source.child);
  const auto has = [&](Words wanted) { return has_one_of(words, wanted) || has_one_of(child, wanted); };
  if (has(kCommands)) return kCommand;
  if (has(kThings)) return kOther;
  if (source.subject == NavSubject::kUncertain && has(kMarkers)) return kOther;
  if (quantity == NavQuantity::kFix && has(kThingsWithFix)) return kOther;
  if (quantity == NavQuantity::kDepth && has(kDepthsOfWater)) return kOther;
  if (quantity == NavQuantity::kPressure && has(kInsides)) return "not of the water by its name";
  if (is_alone && gives_turning(quantity) && (has(kSensors) || has_one_of(child, kSensorFrames))) {
    return "of a sensor that may point elsewhere, by its name";
  }
  return {};
}

}  // namespace pingvox
