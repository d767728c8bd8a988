#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "io/internal/json.hpp"
#include "map_report.hpp"
#include "option_values.hpp"
#include "pingvox/analysis/region_counts.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/map/nearest_cell.hpp"
#include "query_places.hpp"

namespace pingvox::app {
namespace {

/// An answer: its columns, and what the JSON has.
struct Answer {
  std::string columns;
  JsonObject json;
};

std::string_view word_of(Occupancy what) {
  switch (what) {
    case Occupancy::kOccupied:
      return "occupied";
    case Occupancy::kFree:
      return "free";
    case Occupancy::kUnknown:
      break;
  }
  return "unknown";
}

Eigen::Vector3d vector_at(std::span<const double> place, std::size_t from) {
  return {place[from], place[from + 1], place[from + 2]};
}

std::string text_of(const Eigen::Vector3d& point_m) {
  return fmt::format("{:.6f},{:.6f},{:.6f}", point_m.x(), point_m.y(), point_m.z());
}

Answer point_answer(const OccupancyMap& map, const Eigen::Vector3d& point_m) {
  Answer answer;
  const std::string_view state = word_of(map.classify(point_m));
  answer.json.add("point", point_m).add("state", state);
  if (const auto belief = map.at(point_m)) {
    answer.json.add("probability", belief->probability());
    answer.columns = fmt::format("{},{},{:.6f}", text_of(point_m), state, belief->probability());
  } else {
    answer.json.add_null("probability");
    answer.columns = fmt::format("{},{},", text_of(point_m), state);
  }
  return answer;
}

/// The end of a ray of any length: no map reaches farther than its lattice.
Answer ray_answer(const OccupancyMap& map, const QueryCommand& command, std::span<const double> place) {
  constexpr double kAcross = 2.0;  // more than the root of 3
  const Eigen::Vector3d from_m = vector_at(place, 0), direction = vector_at(place, 3).stableNormalized();
  const double range_m = std::min(command.max_range_m, kAcross * map.lattice().cell_size_m(0));
  const RayEnd end = cast_ray(map, from_m, direction, range_m, command.unknown);
  const std::string_view met = end.what == Occupancy::kFree ? "nothing" : word_of(end.what);
  Answer answer;
  answer.json.add("from", from_m).add("direction", direction).add("met", met);
  if (end.what == Occupancy::kFree) {
    answer.json.add_null("range_m").add_null("end");
    answer.columns = fmt::format("{},{},{},,,,", text_of(from_m), text_of(direction), met);
    return answer;
  }
  const Eigen::Vector3d end_m = from_m + end.range_m * direction;
  answer.json.add("range_m", end.range_m).add("end", end_m);
  answer.columns =
      fmt::format("{},{},{},{:.6f},{}", text_of(from_m), text_of(direction), met, end.range_m, text_of(end_m));
  return answer;
}

Answer near_answer(const OccupancyMap& map, const QueryCommand& command, const Eigen::Vector3d& point_m) {
  const Sought sought = command.question == Question::kNearest ? Sought::kOccupied : Sought::kNotFree;
  const auto found = nearest_cell(map, point_m, command.max_range_m, sought);
  Answer answer;
  answer.json.add("point", point_m);
  if (found) {
    answer.json.add("state", word_of(found->what)).add("range_m", found->range_m).add("nearest", found->point_m);
    answer.columns =
        fmt::format("{},{},{:.6f},{}", text_of(point_m), word_of(found->what), found->range_m, text_of(found->point_m));
  } else {
    answer.json.add("state", "nothing").add_null("range_m").add_null("nearest");
    answer.columns = text_of(point_m) + ",nothing,,,,";
  }
  return answer;
}

Answer region_answer(const OccupancyMap& map, std::span<const double> place) {
  const Eigen::Vector3d a = vector_at(place, 0), b = vector_at(place, 3);
  const Box box{a.cwiseMin(b), a.cwiseMax(b)};
  const RegionCounts counts = counts_in(map, box);
  const std::uint64_t unknown = counts.cells - counts.occupied_cells - counts.free_cells;
  Answer answer;
  answer.json.add("min", box.min)
      .add("max", box.max)
      .add("cells", counts.cells)
      .add("occupied_cells", counts.occupied_cells)
      .add("free_cells", counts.free_cells)
      .add("unknown_cells", unknown);
  answer.columns = fmt::format("{},{},{},{},{},{}", text_of(box.min), text_of(box.max), counts.cells,
                               counts.occupied_cells, counts.free_cells, unknown);
  return answer;
}

Answer answer_to(const OccupancyMap& map, const QueryCommand& command, std::span<const double> place) {
  switch (command.question) {
    case Question::kRay:
      return ray_answer(map, command, place);
    case Question::kNearest:
    case Question::kClearance:
      return near_answer(map, command, vector_at(place, 0));
    case Question::kRegion:
      return region_answer(map, place);
    case Question::kPoint:
      break;
  }
  return point_answer(map, vector_at(place, 0));
}

std::string_view names_of_columns(Question question) {
  switch (question) {
    case Question::kRay:
      return "x,y,z,direction_x,direction_y,direction_z,met,range_m,end_x,end_y,end_z";
    case Question::kNearest:
    case Question::kClearance:
      return "x,y,z,state,range_m,nearest_x,nearest_y,nearest_z";
    case Question::kRegion:
      return "min_x,min_y,min_z,max_x,max_y,max_z,cells,occupied_cells,free_cells,unknown_cells";
    case Question::kPoint:
      break;
  }
  return "x,y,z,state,probability";
}

/// Whether a place is where something is known of the map.
bool is_near(const Box& known, std::span<const double> place, const QuestionKind& kind) {
  Box asked{vector_at(place, 0), vector_at(place, 0)};
  if (kind.question == Question::kRegion) {
    asked.min = asked.min.cwiseMin(vector_at(place, 3));
    asked.max = asked.max.cwiseMax(vector_at(place, 3));
  }
  return (asked.min.array() <= known.max.array()).all() && (asked.max.array() >= known.min.array()).all();
}

/// A .bt says only whether cells are occupied or free.
Result<OccupancyMap> map_to_ask(const QueryCommand& command) {
  Result<MapFile> read = read_file(command.map).and_then([](const FileBytes& file) { return read_map(file); });
  if (!read) return tl::unexpected(read.error());
  if (const auto used = command.occupancy.check(read->format); !used)
    return fail(used.error().code, fmt::format("query: {}: {}", command.map, used.error().message));
  return command.occupancy.apply_to(std::move(read->map));
}

}  // namespace

Result<int> run(const QueryCommand& command, Console& console) {
  const Result<OccupancyMap> map = map_to_ask(command);
  if (!map) return tl::unexpected(map.error());
  std::vector<std::vector<double>> places = command.places;
  if (command.reads_places) {
    const Result<FileBytes> lines = read_file("-");
    if (!lines) return tl::unexpected(lines.error());
    const std::string_view text(reinterpret_cast<const char*>(lines->bytes.data()), lines->bytes.size());
    const Result<std::vector<std::vector<double>>> more = places_from(text, kind_of(command.question));
    if (!more) return fail(more.error().code, fmt::format("{}: {}", name_of_input("-"), more.error().message));
    places.insert(places.end(), more->begin(), more->end());
  }
  const std::optional<Box> known = map->bounds();
  if (!known || std::ranges::none_of(places, [&](const std::vector<double>& place) {
        return is_near(*known, place, kind_of(command.question));
      })) {
    console.say(fmt::format("no place is within what {} knows: {}", command.map, bounds_text(known)));
  }
  const bool is_json = command.output_options.report == Report::kJson;
  std::vector<JsonObject> answers;
  std::string table = std::string(names_of_columns(command.question)) + "\n";
  for (const std::vector<double>& place : places) {
    Answer answer = answer_to(*map, command, place);
    if (is_json) {
      answers.push_back(std::move(answer.json));
    } else {
      table += answer.columns + "\n";
    }
  }
  const auto json = [&] { return JsonObject().add("answers", std::span<const JsonObject>(answers)).text() + "\n"; };
  if (const auto printed = console.print(is_json ? json() : table); !printed) return tl::unexpected(printed.error());
  return 0;
}

}  // namespace pingvox::app
