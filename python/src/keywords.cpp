#include "keywords.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "echo_options.hpp"
#include "errors.hpp"
#include "live_arguments.hpp"
#include "mapping_options.hpp"
#include "nav_options.hpp"
#include "option_values.hpp"
#include "shared_options.hpp"
#include "slam_options.hpp"

namespace pingvox::python {
namespace {

using app::Option;
using app::OptionTable;
using Names = std::span<const std::string_view>;

constexpr auto kOpen =
    std::to_array<std::string_view>({"--nav", "--nav-offset", "--nav-source", "--nav-mount", "--use-calibration",
                                     "--poses", "--mount", "--device", "--beam-width", "--beam-height", "--sound-speed",
                                     "--water", "--background", "--origin", "--strict", "--topic", "--fields"});
constexpr auto kNewMap = std::to_array<std::string_view>(
    {"--resolution", "--depth", "--clamp", "--parents", "--occupied", "--free", "--memory-limit"});
constexpr auto kOpenMap = std::to_array<std::string_view>({"--occupied", "--free"});
constexpr auto kInsert = std::to_array<std::string_view>({"--hit", "--miss", "--ray", "--max-range"});
constexpr auto kFilter = std::to_array<std::string_view>({"--filter", "--kernel", "--sigma"});
constexpr auto kEcho = std::to_array<std::string_view>({"--min-range", "--min-bin", "--max-range", "--filter",
                                                        "--kernel", "--sigma", "--detect", "--threshold", "--cfar"});
constexpr auto kSlamMap = std::to_array<std::string_view>(
    {"--resolution", "--depth", "--hit", "--miss", "--clamp", "--vote", "--parents", "--threads", "--memory-limit",
     "--occupied", "--free", "--cut-depth", "--beam", "--free-share", "--hit-from", "--silent"});
constexpr auto kMapper = std::to_array<std::string_view>(
    {"--hit", "--miss", "--vote", "--threads", "--mount", "--beam", "--beam-width", "--beam-height", "--device",
     "--free-share", "--ray", "--hit-from", "--silent", "--sound-speed", "--water"});
constexpr auto kSlam = std::to_array<std::string_view>({"--matching", "--causal", "--seed"});
constexpr auto kLocate = std::to_array<std::string_view>({"--start", "--min-z", "--max-z", "--causal", "--seed"});
constexpr auto kRay = std::to_array<std::string_view>({"--ray"});
constexpr auto kFolds = std::to_array<std::string_view>({"--folds"});
/// With options, for the error that names the nearest.
constexpr auto kFunctions = std::to_array<std::string_view>(
    {"open", "Recording.map", "Recording.slam", "Recording.locate", "Recording.evaluate", "SlamResult.map",
     "OccupancyMap", "OccupancyMap.open", "OccupancyMap.insert_points", "BeamMapper", "filter_image", "Beams.echoes",
     "LiveMapping", "LiveMapping.drive"});

/// The targets of all options that a recording, a map and echoes have.
struct Targets {
  app::RecordingArgs recording;
  app::BuildArgs build;
  app::OccupancyArgs occupancy;
  SlamOptions slam;
  LocalizerOptions localizer;
  Estimation estimation = Estimation::kBatch;
  std::optional<StartPose> start;
  std::optional<double> min_z_m, max_z_m;
  std::size_t folds = EvaluateOptions{}.folds;
  app::LiveArgs live;
};

void add(std::vector<Option> options, std::vector<Option>& to) {
  std::ranges::move(options, std::back_inserter(to));
}

/// All rows of the program that a function may take. Of --seed and --causal those of `slam` come first.
std::vector<Option> rows_of(Targets& targets) {
  std::vector<Option> rows;
  add(app::map_group(targets.build).options, rows);
  add(app::tree_options(targets.build), rows);
  add(app::occupancy_options(targets.occupancy), rows);
  add(app::sensor_group(targets.build).options, rows);
  add(app::echo_group(targets.build.echoes, app::WaterOfNav::kYes).options, rows);
  rows.push_back(app::nav_mount_option(targets.recording.nav_mounts));
  rows.push_back(app::origin_option(targets.recording.cloud_origin_m));
  rows.push_back(app::strict_option(targets.recording.damage));
  rows.push_back(app::topic_option(targets.recording.bag));
  rows.push_back(app::fields_option(targets.recording.bag));
  return rows;
}

/// Those of these names, in that order.
std::vector<Option> chosen(std::vector<Option> rows, std::initializer_list<Names> names) {
  std::vector<Option> options;
  for (const Names& some : names) {
    for (const std::string_view name : some) {
      const auto row = std::ranges::find(rows, name, &Option::name);
      if (row != rows.end()) options.push_back(*row);
    }
  }
  return options;
}

/// Options of a function by its name, as in "Recording.map". What they say of options that it does not have is left
/// out.
OptionTable table_of(std::string_view function, std::vector<Option> options) {
  const auto has = [&](const app::Condition& condition) {
    return std::ranges::any_of(options, [&](const Option& option) { return option.name == condition.name; });
  };
  for (Option& option : options) std::erase_if(option.only_with, [&](const auto& one) { return !has(one); });
  OptionTable table;
  table.command = function.substr(function.rfind('.') + 1);
  table.groups.push_back({"Keywords", std::move(options)});
  return table;
}

/// All rows of a run with a device.
std::vector<Option> live_rows(app::LiveArgs& args) {
  std::vector<Option> rows = {app::record_option(args.record)};
  for (OptionTable::Group& group : app::live_groups(args)) add(std::move(group.options), rows);
  return rows;
}

OptionTable table_of(std::string_view function, Targets& targets) {
  std::vector<Option> rows = rows_of(targets);
  std::vector<Option> options;
  if (function == "open") {
    options = chosen(std::move(rows), {kOpen});
  } else if (function == "Recording.map") {
    options = chosen(std::move(rows), {kSlamMap, kRay, kEcho});
  } else if (function == "SlamResult.map") {
    options = chosen(std::move(rows), {kSlamMap});
  } else if (function == "Recording.slam") {
    add(app::slam_options(targets.slam, targets.estimation), rows);
    options = chosen(std::move(rows), {kSlam, kEcho});
  } else if (function == "Recording.locate") {
    rows.push_back(app::start_option(targets.start));
    add(app::height_options(targets.min_z_m, targets.max_z_m), rows);
    add(app::locate_options(targets.localizer, targets.estimation), rows);
    options = chosen(std::move(rows), {kLocate, kEcho});
  } else if (function == "Recording.evaluate") {
    rows.push_back(app::folds_option(targets.folds));
    options = chosen(std::move(rows), {kFolds, kSlamMap, kRay, kEcho});
    std::erase_if(options,
                  [](const Option& option) { return option.name == "--cut-depth" || option.name == "--parents"; });
  } else if (function == "OccupancyMap") {
    options = chosen(std::move(rows), {kNewMap});
  } else if (function == "OccupancyMap.open") {
    options = chosen(std::move(rows), {kOpenMap});
  } else if (function == "OccupancyMap.insert_points") {
    options = chosen(std::move(rows), {kInsert});
  } else if (function == "BeamMapper") {
    options = chosen(std::move(rows), {kMapper, kEcho});
  } else if (function == "LiveMapping") {
    options = live_rows(targets.live);
  } else if (function == "LiveMapping.drive") {
    options = app::head_group(targets.live).options;
  } else if (function == "filter_image") {
    options = chosen(std::move(rows), {kFilter});
  } else if (function == "Beams.echoes" || function == "Sweep.echoes") {
    options = chosen(std::move(rows), {kEcho});
  } else {
    const std::vector<std::string> known(kFunctions.begin(), kFunctions.end());
    raise_usage(fmt::format("function: must be {}, not '{}'{}", fmt::join(known, ", "), function,
                            did_you_mean(function, known)));
  }
  return table_of(function, std::move(options));
}

/// Arrays and scalars of numpy as lists and numbers of Python: an array with one element, or none of its axes, may be
/// taken as a whole number otherwise.
py::object without_numpy(const py::handle& value) {
  if (py::hasattr(value, "tolist")) return value.attr("tolist")();
  return py::reinterpret_borrow<py::object>(value);
}

/// A value as it would be typed.
std::string text_of(const py::handle& given) {
  const py::object value = without_numpy(given);
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  if (py::hasattr(value, "__fspath__")) {
    return py::module_::import("os").attr("fspath")(value).cast<std::string>();
  }
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (PyIndex_Check(value.ptr()) != 0) return py::str(py::int_(value));
  if (PyNumber_Check(value.ptr()) != 0 && !py::hasattr(value, "__len__")) {
    return fmt::format("{}", py::float_(value).cast<double>());
  }
  if (!py::hasattr(value, "__iter__")) {
    throw py::type_error(fmt::format("a value of type {} cannot be an option",
                                     py::str(py::type::handle_of(value).attr("__name__")).cast<std::string>()));
  }
  std::vector<std::string> items;
  const bool is_map = py::isinstance<py::dict>(value);
  for (const py::handle item : value) {
    items.push_back(is_map ? fmt::format("{}={}", text_of(item), text_of(value[item])) : text_of(item));
  }
  return fmt::format("{}", fmt::join(items, ","));
}

/// The values of an option that may be given several times.
std::vector<std::string> texts_of(const py::handle& given) {
  const py::object value = without_numpy(given);
  const bool is_list = py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value);
  if (!is_list && !py::isinstance<py::dict>(value)) return {text_of(value)};
  std::vector<std::string> texts;
  for (const py::handle item : value) {
    texts.push_back(is_list ? text_of(item) : fmt::format("{}={}", text_of(item), text_of(value[item])));
  }
  return texts;
}

/// Keyword arguments as they would be typed: nav_offset=2.5 as "--nav-offset=2.5".
std::vector<std::string> words_of(const OptionTable& table, const py::kwargs& keywords) {
  std::vector<std::string> words;
  const std::vector<Option>& options = table.groups.front().options;
  for (const auto& [key, value] : keywords) {
    if (value.is_none()) continue;
    std::string name = "--" + key.cast<std::string>();
    std::ranges::replace(name, '_', '-');
    const auto option = std::ranges::find(options, name, &Option::name);
    if (option == options.end()) {
      std::vector<std::string> known;
      for (const Option& one : options) known.push_back(one.name);
      raise_usage(
          fmt::format("{}: unknown option '{}'{}", table.command, key.cast<std::string>(), did_you_mean(name, known)));
    }
    if (option->value.empty()) {
      const py::object flag = without_numpy(value);
      if (!py::isinstance<py::bool_>(flag)) {
        raise_usage(fmt::format("{}: {}: must be True or False", table.command, option->name));
      }
      if (flag.cast<bool>()) words.push_back(name);
    } else if (option->repeats == app::Repeats::kEachCounts) {
      for (const std::string& text : texts_of(value)) words.push_back(fmt::format("{}={}", name, text));
    } else {
      words.push_back(fmt::format("{}={}", name, text_of(value)));
    }
  }
  return words;
}

/// Raises an error of options with the function's name in front, as the program has its command's.
template <class T>
T checked(const OptionTable& table, Result<T> result) {
  if (!result && result.error().code == Error::Code::kBadOption && !result.error().message.starts_with(table.command)) {
    result.error().message = fmt::format("{}: {}", table.command, result.error().message);
  }
  return value_of(std::move(result));
}

app::Parsed parse(const OptionTable& table, const py::kwargs& keywords) {
  return value_of(app::parse(table, words_of(table, keywords)));
}

MapKeywords map_options_of(std::string_view function, const py::kwargs& keywords) {
  Targets targets;
  const OptionTable table = table_of(function, targets);
  MapKeywords options;
  options.limited = parse(table, keywords).limited;
  checked(table, targets.build.apply_to(targets.recording, targets.occupancy, options.map, options.build));
  options.cut_depth = targets.occupancy.cut_depth;
  return options;
}

}  // namespace

OpenOptions open_options(const std::vector<std::string>& logs, const py::kwargs& keywords) {
  Targets targets;
  const OptionTable table = table_of("open", targets);
  std::vector<app::LimitedOption> limited = parse(table, keywords).limited;
  MapOptions map;
  BuildOptions build;
  checked(table, targets.build.apply_to(targets.recording, map, build));
  targets.recording.logs = logs;
  return {std::move(targets.recording), build.sound_speed_ratio, std::move(limited)};
}

MapKeywords map_options(const py::kwargs& keywords) {
  return map_options_of("Recording.map", keywords);
}

MapKeywords slam_map_options(const py::kwargs& keywords) {
  return map_options_of("SlamResult.map", keywords);
}

SlamKeywords slam_options(const py::kwargs& keywords) {
  Targets targets;
  const OptionTable table = table_of("Recording.slam", targets);
  parse(table, keywords);
  targets.slam.filter = targets.build.echoes.filter_options();
  targets.slam.echo = targets.build.echoes.echo;
  checked(table, targets.slam.validate());
  return {std::move(targets.slam), targets.estimation};
}

RecordingLocateOptions locate_options(const py::kwargs& keywords) {
  Targets targets;
  const OptionTable table = table_of("Recording.locate", targets);
  parse(table, keywords);
  targets.localizer.filter = targets.build.echoes.filter_options();
  targets.localizer.echo = targets.build.echoes.echo;
  checked(table, targets.localizer.validate());
  return {{targets.localizer, targets.start, targets.estimation}, targets.min_z_m, targets.max_z_m, "the map"};
}

EvaluateOptions evaluate_options(const py::kwargs& keywords) {
  Targets targets;
  const OptionTable table = table_of("Recording.evaluate", targets);
  parse(table, keywords);
  EvaluateOptions options;
  options.folds = targets.folds;
  checked(table, targets.build.apply_to(targets.recording, targets.occupancy, options.map, options.build));
  return options;
}

MapOptions new_map_options(const py::kwargs& keywords) {
  Targets targets;
  const OptionTable table = table_of("OccupancyMap", targets);
  parse(table, keywords);
  checked(table, targets.occupancy.validate());
  MapOptions options = targets.build.map;
  options.thresholds = targets.occupancy.apply_to(options.thresholds);
  return options;
}

app::OccupancyArgs open_map_options(const py::kwargs& keywords) {
  Targets targets;
  const OptionTable table = table_of("OccupancyMap.open", targets);
  parse(table, keywords);
  checked(table, targets.occupancy.validate());
  return targets.occupancy;
}

BuildOptions insert_options(const py::kwargs& keywords) {
  Targets targets;
  const OptionTable table = table_of("OccupancyMap.insert_points", targets);
  parse(table, keywords);
  BuildOptions options = targets.build.build_options();
  checked(table, options.validate_for_points());
  return options;
}

BuildOptions mapper_options(const py::kwargs& keywords) {
  Targets targets;
  const OptionTable table = table_of("BeamMapper", targets);
  parse(table, keywords);
  checked(table, targets.build.echoes.validate());
  BuildOptions options = targets.build.build_options();
  checked(table, options.validate());
  return options;
}

LiveOptions live_options(const std::string& head, const py::kwargs& keywords) {
  Targets targets;
  const OptionTable table = table_of("LiveMapping", targets);
  const app::Parsed parsed = parse(table, keywords);
  Result<void> taken = app::store_head(targets.live.live.head)(head);
  if (!taken) taken.error().message = "head: " + taken.error().message;
  checked(table, std::move(taken));
  checked(table, app::check_limited(parsed.limited, targets.live.live.head.kind));
  return checked(table, targets.live.options());
}

LiveHead head_options(const LiveHead& head, const py::kwargs& keywords) {
  Targets targets;
  const OptionTable table = table_of("LiveMapping.drive", targets);
  targets.live.live.head.kind = head.kind;
  targets.live.live.head.address = head.address;
  const app::Parsed parsed = parse(table, keywords);
  checked(table, app::check_limited(parsed.limited, head.kind));
  return checked(table, targets.live.head());
}

EchoKeywords echo_options(const py::kwargs& keywords) {
  Targets targets;
  const OptionTable table = table_of("Beams.echoes", targets);
  parse(table, keywords);
  const EchoKeywords options{targets.build.echoes.filter_options(), targets.build.echoes.echo};
  checked(table, options.filter.validate());
  checked(table, options.echo.validate());
  return options;
}

FilterOptions filter_options(const py::kwargs& keywords) {
  Targets targets;
  const OptionTable table = table_of("filter_image", targets);
  parse(table, keywords);
  const FilterOptions options = targets.build.echoes.filter_options();
  checked(table, options.validate());
  return options;
}

std::vector<Keyword> keywords_of(std::string_view function) {
  Targets targets;
  std::vector<Keyword> keywords;
  const OptionTable table = table_of(function, targets);
  for (const Option& option : table.groups.front().options) {
    keywords.push_back({with_keyword_names(option.name), option.value, with_keyword_names(option.help),
                        with_keyword_names(option.standard)});
  }
  return keywords;
}

std::string docstring(std::string_view text, std::string_view function) {
  std::string all = fmt::format("{}\n\nOptions, as of the program:\n", text);
  for (const Keyword& keyword : keywords_of(function)) {
    all += fmt::format("    {}{}: {}{}\n", keyword.name, keyword.value.empty() ? "" : "=" + keyword.value, keyword.help,
                       keyword.standard.empty() ? "" : fmt::format(" [{}]", keyword.standard));
  }
  return all;
}

}  // namespace pingvox::python
