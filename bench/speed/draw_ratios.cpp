#include "draw_ratios.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <ostream>
#include <string_view>
#include <system_error>
#include <variant>

#include "bench/draw/chart.hpp"
#include "pingvox/io/file.hpp"

namespace pingvox::bench {
namespace {

template <class T>
const T* field(const Row& row, std::string_view name) {
  for (const auto& [key, value] : row.fields()) {
    if (key == name) return std::get_if<T>(&value);
  }
  return nullptr;
}

}  // namespace

Result<void> draw_ratios(const std::vector<Row>& rows, const std::string& folder) {
  Chart chart{.kind = Chart::Kind::kBars, .title = "Work per CPU second, OctoMap = 1"};
  chart.y_label = "times OctoMap";
  chart.y_spacing = Spacing::kLogarithmic;
  chart.y_mark = 1.0;
  chart.width = 2400;
  Series series{.name = "pingvox", .y = {}};
  for (const Row& row : rows) {
    const auto* const name = field<std::string>(row, "name");
    const auto* const ratio = field<double>(row, "ratio");
    if (name == nullptr || ratio == nullptr || field<double>(row, "octomap_s") == nullptr) continue;
    chart.categories.push_back(*name);
    series.y.push_back(*ratio);
  }
  if (series.y.empty()) return {};
  chart.series.push_back(std::move(series));
  if (auto valid = chart.validate(); !valid) return valid;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail(Error::Code::kIo, fmt::format("{}: {}", folder, error.message()));
  return write_file((std::filesystem::path(folder) / "speed.png").string(),
                    [&](std::ostream& out) { return write_png(render_chart(chart), out); });
}

}  // namespace pingvox::bench
