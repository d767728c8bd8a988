#include "accuracy/draw_accuracy.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <ostream>
#include <string_view>
#include <system_error>
#include <utility>

#include "bench/draw/chart.hpp"
#include "pingvox/io/file.hpp"

namespace pingvox::bench {
namespace {

const Value* field(const Row& row, std::string_view name) {
  for (const auto& [key, value] : row.fields()) {
    if (key == name) return &value;
  }
  return nullptr;
}

bool says(const Row& row, std::string_view name, std::string_view text) {
  const Value* value = field(row, name);
  const auto* found = value ? std::get_if<std::string>(value) : nullptr;
  return found && *found == text;
}

double number(const Row& row, std::string_view name) {
  const Value* value = field(row, name);
  const auto* found = value ? std::get_if<double>(value) : nullptr;
  return found ? *found : 0.0;
}

/// A recording that a chart shows, and its name there.
struct Shown {
  std::string_view world, poses, label;
};

constexpr Shown kShown[] = {{"tank", "still", "tank, still"},
                            {"tank", "loop", "tank, loop"},
                            {"harbour", "loop", "harbour"},
                            {"seabed", "loop", "seabed"},
                            {"cave", "loop", "cave"}};

/// A series of a chart: one number of one row of each recording.
struct Column {
  std::string name, key;
  std::vector<std::pair<std::string_view, std::string_view>> where;
};

Chart bars(const std::vector<Row>& rows, std::string title, const std::vector<Column>& columns) {
  Chart chart{.kind = Chart::Kind::kBars, .title = std::move(title), .y_label = "per cent"};
  chart.width = 1400;
  for (const Shown& shown : kShown) chart.categories.emplace_back(shown.label);
  for (const Column& column : columns) {
    Series series{.name = column.name, .y = {}};
    for (const Shown& shown : kShown) {
      double value = 0.0;
      for (const Row& row : rows) {
        bool is_it = says(row, "world", shown.world) && says(row, "poses", shown.poses);
        for (const auto& [key, text] : column.where) is_it = is_it && says(row, key, text);
        const Value* resolution = field(row, "resolution_m");
        if (is_it && (!resolution || number(row, "resolution_m") == 0.05)) value = 100.0 * number(row, column.key);
      }
      series.y.push_back(value);
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

Result<void> write(const Chart& chart, const std::filesystem::path& path) {
  if (auto valid = chart.validate(); !valid) return valid;
  return write_file(path.string(), [&](std::ostream& out) { return write_png(render_chart(chart), out); });
}

}  // namespace

Result<void> draw_accuracy(const std::vector<Row>& rows, const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail(Error::Code::kIo, fmt::format("{}: {}", folder, error.message()));
  const Chart echoes = bars(rows, "Echoes: share of beams within 5 cm of the surface on the axis",
                            {{"default", "axis_5cm", {{"name", "accuracy-echoes"}, {"detector", "default"}}},
                             {"rise 70", "axis_5cm", {{"name", "accuracy-echoes"}, {"detector", "rise 70"}}},
                             {"paper: rise 70, first bin", "axis_5cm", {{"detector", "paper"}}},
                             {"default, false", "echoes_false", {{"detector", "default"}}}});
  if (auto written = write(echoes, std::filesystem::path(folder) / "accuracy-echoes.png"); !written) return written;
  const auto in_plane = [](std::string name, std::string key, std::string_view source) {
    return Column{std::move(name), std::move(key), {{"where", "plane"}, {"beam", "ray"}, {"echoes", source}}};
  };
  const Chart maps =
      bars(rows, "Maps in the plane of the head, cells of 5 cm, ray",
           {in_plane("precision", "precision", "default"), in_plane("recall", "recall", "default"),
            in_plane("truly free", "free_true", "default"), in_plane("precision, paper", "precision", "paper"),
            in_plane("recall, paper", "recall", "paper"), in_plane("truly free, paper", "free_true", "paper")});
  return write(maps, std::filesystem::path(folder) / "accuracy-maps.png");
}

}  // namespace pingvox::bench
