#include "command_line.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <system_error>
#include <utility>

#include "option_table.hpp"
#include "suggest.hpp"

namespace pingvox::app {
namespace {

using Words = std::vector<std::string>;

constexpr double kDegree_rad = std::numbers::pi / 180.0;
/// What sonar heads assume when they turn times into bin lengths.
constexpr double kAssumedSoundSpeed_m_s = 1500.0;

tl::unexpected<Error> off(std::string what) {
  return fail(Error::Code::kBadOption, std::move(what));
}

// --- Values from text: no locale, nothing left over. ---

template <class Number>
Result<Number> number_from(std::string_view text) {
  std::string_view digits = text;
  if (digits.size() > 1 && digits.front() == '+' && digits[1] != '-') digits.remove_prefix(1);
  Number value{};
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  constexpr bool kReal = std::is_floating_point_v<Number>;
  if (error == std::errc::result_out_of_range) return off(fmt::format("'{}' is out of range", text));
  if (error != std::errc{} || end != digits.data() + digits.size() || digits.empty()) {
    return off(fmt::format("'{}' is no {}", text, kReal ? "number" : "whole number"));
  }
  if constexpr (kReal) {
    if (std::isnan(value)) return off(fmt::format("'{}' is no number", text));
  }
  return value;
}

template <std::size_t N>
Result<std::array<double, N>> numbers_from(std::string_view text) {
  std::array<double, N> values{};
  std::size_t count = 0;
  for (std::string_view rest = text;; ++count) {
    const std::size_t comma = rest.find(',');
    if (count < N) {
      const Result<double> value = number_from<double>(rest.substr(0, comma));
      if (!value) return tl::unexpected(value.error());
      values[count] = *value;
    }
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  if (count + 1 != N) return off(fmt::format("'{}': must be {} numbers with commas between them", text, N));
  return values;
}

Result<std::size_t> bytes_from(std::string_view text) {
  constexpr std::string_view kUnits = "KMGT";
  std::string_view digits = text;
  unsigned shift = 0;
  if (!digits.empty()) {
    const char unit =
        digits.back() >= 'a' && digits.back() <= 'z' ? static_cast<char>(digits.back() - 'a' + 'A') : digits.back();
    if (const std::size_t power = kUnits.find(unit); power != std::string_view::npos) {
      shift = 10 * (static_cast<unsigned>(power) + 1);
      digits.remove_suffix(1);
    }
  }
  const Result<std::size_t> count = number_from<std::size_t>(digits);
  if (!count) return off(fmt::format("'{}' is no number of bytes, as in 512M or 2G", text));
  if (*count > std::numeric_limits<std::size_t>::max() >> shift) return off(fmt::format("'{}' is out of range", text));
  return *count << shift;
}

// --- Options that put a value into its place. ---

Take into(std::string& target) {
  return [&target](const std::string& text) -> Result<void> {
    if (text.empty()) return off("is empty");
    target = text;
    return {};
  };
}

/// A number of any kind; typed in units of `unit`.
template <class Number>
Take into_number(Number& target, Number unit = Number{1}) {
  return [&target, unit](const std::string& text) -> Result<void> {
    const Result<Number> value = number_from<Number>(text);
    if (!value) return tl::unexpected(value.error());
    target = static_cast<Number>(*value * unit);
    return {};
  };
}

template <class Number>
Take into_optional(std::optional<Number>& target) {
  return [&target](const std::string& text) -> Result<void> {
    const Result<Number> value = number_from<Number>(text);
    if (!value) return tl::unexpected(value.error());
    target = *value;
    return {};
  };
}

Take into_probability(LogOdds& target) {
  return [&target](const std::string& text) -> Result<void> {
    const Result<double> value = number_from<double>(text);
    if (!value) return tl::unexpected(value.error());
    if (!(*value > 0.0 && *value < 1.0)) return off(fmt::format("{} is no probability between 0 and 1", text));
    target = LogOdds::from_probability(*value);
    return {};
  };
}

template <class Enum>
struct Word {
  std::string_view word;
  Enum value;
};

template <class Enum, std::size_t N>
std::string words_of(const std::array<Word<Enum>, N>& words) {
  std::string out;
  for (const auto& word : words) out += fmt::format("{}{}", out.empty() ? "" : "|", word.word);
  return out;
}

template <class Enum, std::size_t N>
std::string word_of(const std::array<Word<Enum>, N>& words, Enum value) {
  for (const auto& word : words) {
    if (word.value == value) return std::string(word.word);
  }
  return {};
}

template <class Enum, std::size_t N>
Result<Enum> value_of(const std::array<Word<Enum>, N>& words, const std::string& text) {
  Words known;
  for (const auto& word : words) {
    if (word.word == text) return word.value;
    known.emplace_back(word.word);
  }
  return off(fmt::format("must be {}, not '{}'{}", fmt::join(known, " or "), text, did_you_mean(text, known)));
}

template <class Enum, std::size_t N>
Option choice(std::string name, const std::array<Word<Enum>, N>& words, std::string help, Enum& target) {
  const Take take = [&target, &words](const std::string& text) -> Result<void> {
    const Result<Enum> value = value_of(words, text);
    if (!value) return tl::unexpected(value.error());
    target = *value;
    return {};
  };
  return {std::move(name), 0, words_of(words), std::move(help), word_of(words, target), take};
}

template <class Enum>
Option flag(std::string name, std::string help, Enum& target, Enum value) {
  const Take take = [&target, value](const std::string&) -> Result<void> {
    target = value;
    return {};
  };
  return {std::move(name), 0, "", std::move(help), "", take};
}

std::string shown(double value) {
  return fmt::format("{:.6g}", value);
}

constexpr std::array kFilters = {Word<Filter>{"none", Filter::kNone}, Word<Filter>{"mean", Filter::kMean},
                                 Word<Filter>{"median", Filter::kMedian}, Word<Filter>{"gaussian", Filter::kGaussian}};
constexpr std::array kDetectors = {Word<Detector>{"rise", Detector::kRise}, Word<Detector>{"level", Detector::kLevel},
                                   Word<Detector>{"max", Detector::kMax}, Word<Detector>{"canny", Detector::kCanny},
                                   Word<Detector>{"cfar", Detector::kCfar}};
constexpr std::array kCfars = {Word<CfarOptions::Noise>{"ca", CfarOptions::Noise::kCellAveraging},
                               Word<CfarOptions::Noise>{"so", CfarOptions::Noise::kSmallestOf},
                               Word<CfarOptions::Noise>{"os", CfarOptions::Noise::kOrdered}};
constexpr std::array kShapes = {Word<BeamShape>{"ray", BeamShape::kRay}, Word<BeamShape>{"fan", BeamShape::kFan},
                                Word<BeamShape>{"cone", BeamShape::kCone}};
constexpr std::array kRays = {Word<RayAlgorithm>{"dda", RayAlgorithm::kDda},
                              Word<RayAlgorithm>{"bresenham", RayAlgorithm::kBresenham}};
constexpr std::array kVotes = {Word<Vote>{"sweep", Vote::kPerSweep}, Word<Vote>{"beam", Vote::kPerBeam}};
constexpr std::array kHitsFrom = {Word<HitFrom>{"fixed", HitFrom::kFixed},
                                  Word<HitFrom>{"intensity", HitFrom::kIntensity}};
constexpr std::array kParents = {Word<Parents>{"max", Parents::kMax}, Word<Parents>{"mean", Parents::kMean}};
constexpr std::array kSilents = {Word<Silent>{"nothing", Silent::kNothing}, Word<Silent>{"free", Silent::kFree}};
constexpr std::array kMotions = {Word<Motion>{"still", Motion::kStill}, Word<Motion>{"line", Motion::kLine},
                                 Word<Motion>{"lawn-mower", Motion::kLawnMower}, Word<Motion>{"loop", Motion::kLoop}};
constexpr std::array kPictureViews = {
    Word<PictureView>{"polar", PictureView::kPolar}, Word<PictureView>{"cartesian", PictureView::kCartesian},
    Word<PictureView>{"above", PictureView::kAbove}, Word<PictureView>{"side", PictureView::kSide},
    Word<PictureView>{"slice", PictureView::kSlice}};
constexpr std::array kSides = {Word<MapView>{"right", MapView::kRight}, Word<MapView>{"left", MapView::kLeft},
                               Word<MapView>{"front", MapView::kFront}, Word<MapView>{"behind", MapView::kBehind}};
constexpr std::array kShownImages = {Word<ShownImage>{"raw", ShownImage::kRaw},
                                     Word<ShownImage>{"filtered", ShownImage::kFiltered}};
constexpr std::array kEchoMarks = {Word<EchoMarks>{"on", EchoMarks::kOn}, Word<EchoMarks>{"off", EchoMarks::kOff}};
constexpr std::array kBetweens = {Word<BetweenBeams>{"interpolate", BetweenBeams::kInterpolate},
                                  Word<BetweenBeams>{"nothing", BetweenBeams::kNothing}};
constexpr std::array kProgress = {Word<ShowProgress>{"auto", ShowProgress::kAuto},
                                  Word<ShowProgress>{"always", ShowProgress::kAlways},
                                  Word<ShowProgress>{"never", ShowProgress::kNever}};
constexpr std::array kMapFormats = {Word<Format>{"bt", Format::kBt}, Word<Format>{"ot", Format::kOt},
                                    Word<Format>{"pvx", Format::kPvx}, Word<Format>{"ply", Format::kPly},
                                    Word<Format>{"pcd", Format::kPcd}};
constexpr std::array kLogAndMapFormats = {
    Word<Format>{"csv", Format::kCsv},  Word<Format>{"bt", Format::kBt},     Word<Format>{"ot", Format::kOt},
    Word<Format>{"pvx", Format::kPvx},  Word<Format>{"ply", Format::kPly},   Word<Format>{"pcd", Format::kPcd},
    Word<Format>{"pgm", Format::kGrid}, Word<Format>{"yaml", Format::kGrid}, Word<Format>{"asc", Format::kAsc}};
constexpr std::array kSurfaces = {Word<Surface>{"highest", Surface::kHighest},
                                  Word<Surface>{"lowest", Surface::kLowest}};
constexpr std::array kCsvOnly = {Word<Format>{"csv", Format::kCsv}};
constexpr std::array kPngOnly = {Word<Format>{"png", Format::kPng}};

// --- Groups of options that commands share. ---

Option output_option(std::string& target, std::string help) {
  return {"--output", 'o', "FILE", std::move(help), "", into(target)};
}

Option config_option() {
  // The table reads the file; what is left to take is nothing.
  return {"--config", 0,
          "FILE",     "read options from a TOML file, named as here without the dashes; those of the call win",
          "",         [](const std::string&) -> Result<void> { return {}; }};
}

Option strict_option(Damage& damage) {
  return flag("--strict", "stop at the first damage in a log instead of leaving it out", damage, Damage::kFail);
}

Option json_option(Manner& manner) {
  return flag("--json", "report as one JSON object on standard output", manner.report, Report::kJson);
}

Option quiet_option(Manner& manner) {
  return flag("--quiet", "say nothing but errors", manner.talk, Talk::kQuiet);
}

Take into_sound_speed_ratio(double& ratio) {
  return [&ratio](const std::string& text) -> Result<void> {
    const Result<double> speed = number_from<double>(text);
    if (!speed) return tl::unexpected(speed.error());
    if (!(*speed > 0.0) || !std::isfinite(*speed)) return off(fmt::format("{} is no speed above 0", text));
    ratio = *speed / kAssumedSoundSpeed_m_s;
    return {};
  };
}

/// How echoes are found, as the call says it: what it does not say follows from the detector.
struct EchoWords {
  Filter filter = FilterOptions{}.filter;
  std::optional<int> kernel;
  std::optional<double> sigma;
  EchoOptions echo;

  FilterOptions filter_options() const {
    const FilterOptions usual = usual_filter(echo.detector);
    return {filter, kernel.value_or(usual.kernel), sigma.value_or(usual.sigma)};
  }
};

Take into_min_range(std::optional<double>& target) {
  return [&target](const std::string& text) -> Result<void> {
    if (text != "auto") return into_optional(target)(text);
    target.reset();
    return {};
  };
}

OptionTable::Group echo_group(EchoWords& words, double& sound_speed_ratio, const Take& max_range) {
  EchoOptions& echo = words.echo;
  return {
      "Echoes",
      {{"--min-range", 0, "M|auto", "nearer bins are the head's own ringing, and no evidence; auto: as it is found",
        shown(EchoOptions::kUsualBlanking_m), into_min_range(echo.min_range_m)},
       {"--min-bin", 0, "N", "nor are those before this one, counted from 0", fmt::format("{}", echo.min_bin),
        into_number(echo.min_bin)},
       {"--max-range", 0, "M", "farther bins and cells are left alone", "none", max_range},
       {"--sound-speed", 0, "M/S", "in this water; devices assume 1500 m/s", shown(kAssumedSoundSpeed_m_s),
        into_sound_speed_ratio(sound_speed_ratio)},
       choice("--filter", kFilters, "how sweeps are smoothed before echoes are looked for", words.filter),
       {"--kernel", 0, "N", "edge of the filter's window in beams and bins, odd", "5, canny: 11",
        into_optional(words.kernel)},
       {"--sigma", 0, "S", "standard deviation of the Gaussian in beams and bins", "1, canny: 2.3",
        into_optional(words.sigma)},
       choice("--detect", kDetectors, "how echoes are found", echo.detector),
       {"--threshold", 0, "T", "the rise, level or gradient (canny) that makes an echo", "by the gain",
        into_optional(echo.threshold)},
       choice("--cfar", kCfars, "noise of cfar: cell-averaging, smallest-of or ordered-statistic", echo.cfar.noise)}};
}

Take into_clamp(Clamp& target) {
  return [&target](const std::string& text) -> Result<void> {
    const auto p = numbers_from<2>(text);
    if (!p) return tl::unexpected(p.error());
    const auto& [lowest, highest] = *p;
    if (!(lowest > 0.0 && lowest < highest && highest < 1.0)) {
      return off(fmt::format("'{}': must be two probabilities between 0 and 1, the smaller one first", text));
    }
    target = {LogOdds::from_probability(lowest), LogOdds::from_probability(highest)};
    return {};
  };
}

Take into_bytes(std::size_t& target) {
  return [&target](const std::string& text) -> Result<void> {
    const Result<std::size_t> bytes = bytes_from(text);
    if (!bytes) return tl::unexpected(bytes.error());
    if (*bytes == 0) return off("must be more than 0");
    target = *bytes;
    return {};
  };
}

Take into_mount(Pose& target) {
  return [&target](const std::string& text) -> Result<void> {
    const auto n = numbers_from<6>(text);
    if (!n) return off(n.error().message + ": x,y,z in metres and roll,pitch,yaw in degrees");
    if (!std::all_of(n->begin(), n->end(), [](double v) { return std::isfinite(v); })) {
      return off(fmt::format("'{}': must be finite", text));
    }
    const auto& [x, y, z, roll, pitch, yaw] = *n;
    target = pose_from_rpy({x, y, z}, roll * kDegree_rad, pitch * kDegree_rad, yaw * kDegree_rad);
    return {};
  };
}

/// How a log is mapped, as the call says it.
struct BuildWords {
  MapOptions map;
  BuildOptions build;  ///< filter and echo: see `echoes`
  EchoWords echoes;
  std::string poses;

  BuildOptions build_options() const {
    BuildOptions all = build;
    all.filter = echoes.filter_options();
    all.echo = echoes.echo;
    return all;
  }
};

OptionTable::Group map_group(BuildWords& words) {
  MapOptions& map = words.map;
  BeamModelOptions& model = words.build.model;
  return {
      "Map",
      {{"--resolution", 0, "M", "edge of a cell", shown(map.resolution_m), into_number(map.resolution_m)},
       {"--depth", 0, "N", "levels of the octree, 1..128; .bt and .ot hold 16", fmt::format("{}", map.depth),
        into_number(map.depth)},
       {"--hit", 0, "P", "probability that an echo gives a cell", shown(model.hit.probability()),
        into_probability(model.hit)},
       {"--miss", 0, "P", "probability that sound passing gives a cell", shown(model.miss.probability()),
        into_probability(model.miss)},
       {"--clamp", 0, "P,P", "probabilities beyond which a cell does not go",
        shown(map.clamp.lowest.probability()) + "," + shown(map.clamp.highest.probability()), into_clamp(map.clamp)},
       choice("--vote", kVotes, "one vote a cell and sweep (a hit beats a miss), or one a beam", words.build.vote),
       {"--memory-limit", 0, "BYTES", "stop when the map would grow past it; also 512M, 2G", "none",
        into_bytes(map.memory_limit_bytes)}}};
}

OptionTable::Group sensor_group(BuildWords& words) {
  BeamModelOptions& model = words.build.model;
  return {"Sensor",
          {{"--poses", 0, "FILE", "where the vehicle was, as TUM lines 't x y z qx qy qz qw'", "it stood still",
            into(words.poses)},
           {"--mount", 0, "X,Y,Z,R,P,Y", "the head on the vehicle: metres, then roll, pitch, yaw in degrees",
            "0,0,0,0,0,0", into_mount(words.build.body_from_sensor)},
           choice("--beam", kShapes, "what a beam fills: its axis, its width, or its width and height", model.shape),
           {"--beam-width", 0, "DEG", "horizontally, full angle", shown(model.width_rad / kDegree_rad),
            into_number(model.width_rad, kDegree_rad)},
           {"--beam-height", 0, "DEG", "vertically, full angle", shown(model.height_rad / kDegree_rad),
            into_number(model.height_rad, kDegree_rad)},
           choice("--ray", kRays, "how rays go from cell to cell", model.ray),
           choice("--hit-from", kHitsFrom, "every echo counts the same, or by its intensity", model.hit_from),
           choice("--silent", kSilents, "what a beam without an echo says", model.silent)}};
}

// --- Checks that cost no work. ---

/// The format of an output file: as asked for, else by its suffix. Standard output, devices and pipes have no suffix.
template <std::size_t N>
Result<Format> output_format(const std::string& path, const std::optional<Format>& asked,
                             const std::array<Word<Format>, N>& known) {
  if (path.empty()) return off("-o FILE is missing: where should the result go?");
  if (asked) return *asked;
  const std::optional<Format> by_suffix = format_for_writing(path);
  for (const auto& word : known) {
    if (word.value == by_suffix) return word.value;
  }
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  const bool is_nameless = path == "-" || (std::filesystem::exists(status) && std::filesystem::is_other(status));
  if (is_nameless && !by_suffix) return known.front().value;

  Words suffixes;
  for (const auto& word : known) suffixes.push_back(fmt::format(".{}", word.word));
  const std::string ending = std::filesystem::path(path).extension().string();
  return off(
      fmt::format("{}: its suffix must be {}{}", path, fmt::join(suffixes, " or "), did_you_mean(ending, suffixes)));
}

/// What would fail for sure after the work is better said before it.
Result<void> check_folder_of(const std::string& path) {
  if (path == "-") return {};
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  std::error_code error;
  if (folder.empty() || std::filesystem::is_directory(folder, error)) return {};
  return fail(Error::Code::kIo, fmt::format("{}: there is no folder '{}'", path, folder.string()));
}

Result<void> check_standard_input(const Words& files) {
  if (std::count(files.begin(), files.end(), "-") < 2) return {};
  return off("'-' twice: standard input can be read only once");
}

tl::unexpected<Error> in_command(const OptionTable& table, const Error& error) {
  // A message of the library may begin with the same word: the stage that it is about.
  const bool is_named = error.message.starts_with(table.command + ":");
  if (error.code != Error::Code::kBadOption || is_named) return tl::unexpected(error);
  return tl::unexpected(Error{error.code, fmt::format("{}: {}", table.command, error.message)});
}

/// What every command does with its table: `done` makes the command when the words are right.
template <class Done>
Result<Command> parsed(const OptionTable& table, const Words& words, Done done) {
  const Result<Parsed> result = parse(table, words);
  if (!result) return tl::unexpected(result.error());
  if (*result == Parsed::kHelpWanted) return ShowText{{}, help_of(table)};
  Result<Command> command = done();
  if (!command) return in_command(table, command.error());
  return command;
}

std::string shell_quoted(const std::string& word) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./,=+:@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

// --- The commands. ---

Result<Command> map_command(const Words& words) {
  MapCommand command;
  std::string output;
  std::optional<Format> asked_format;
  BuildWords build;
  MapOptions& map = build.map;
  const Take thread_count = [&](const std::string& text) -> Result<void> {
    int threads = 0;
    if (auto taken = into_number(threads)(text); !taken) return taken;
    if (threads < 1 || threads > 256) return off(fmt::format("{} is not in 1..256", text));
    build.build.threads = static_cast<std::size_t>(threads);
    return {};
  };
  const Take origin = [&](const std::string& text) -> Result<void> {
    const auto n = numbers_from<3>(text);
    if (!n) return tl::unexpected(n.error());
    const Eigen::Vector3d place(n->data());
    if (!place.allFinite()) return off(fmt::format("'{}': must be finite", text));
    command.cloud_origin_m = place;
    return {};
  };
  const Take log = [&](const std::string& text) -> Result<void> {
    command.logs.push_back(text);
    return {};
  };
  const Take format = [&](const std::string& text) -> Result<void> {
    const Result<Format> value = value_of(kMapFormats, text);
    if (!value) return tl::unexpected(value.error());
    asked_format = *value;
    return {};
  };

  OptionTable::Group map_options = map_group(build);
  map_options.options.push_back(choice("--parents", kParents, "what inner nodes say of their children", map.parents));
  map_options.options.push_back({"--threads", 0, "N",
                                 "threads that trace a sweep or scan together, 1..256; the map is the same", "1",
                                 thread_count});
  OptionTable::Group sensor_options = sensor_group(build);
  sensor_options.options.push_back({"--origin", 0, "X,Y,Z", "from where the points of a cloud were seen, in the map",
                                    "0,0,0; a PCD's VIEWPOINT", origin});
  const OptionTable table{
      "map",
      "Turns sonar logs into a 3D occupancy map: reads the LOGs one after another, finds the echoes of each beam, and\n"
      "frees and hits the cells that its sound went through and came back from.",
      {{"LOG", Positional::Count::kMany,
        "beams (MATLAB 5, CSV), point scans (OctoMap's .graph and its text form) or clouds of points, each a scan "
        "(PLY, "
        "PCD, XYZ), told by content; - is standard input",
        log}},
      {{"Output",
        {output_option(output,
                       "the map: .bt or .ot (OctoMap), .pvx (any depth), .ply or .pcd (points); - is standard output"),
         {"--format", 0, words_of(kMapFormats), "format of the map, whatever its name", "by suffix, else bt", format},
         json_option(command.manner),
         quiet_option(command.manner),
         choice("--progress", kProgress, "show on standard error how far the work is; auto: on a terminal",
                command.manner.progress)}},
       map_options,
       sensor_options,
       echo_group(build.echoes, build.build.sound_speed_ratio, into_number(build.build.model.max_range_m)),
       {"Input", {strict_option(command.damage), config_option()}}},
      {"pingvox map tank.mat -o tank.bt --beam cone",
       "pingvox map dive1.csv dive2.csv -o reef.ot --poses nav.txt --mount 0.4,0,-0.2,180,0,0",
       "pingvox map scans.graph -o scans.bt --resolution 0.1 --vote sweep",
       "pingvox map multibeam.ply -o bottom.ot --origin 0,0,-0.5", "pingvox map - -o - < tank.csv > tank.bt"},
      "Point scans and clouds use the options of the map, --ray and --max-range.\n"
      "Exit status: 0 done, 1 could not be done, 2 the words of the call are off."};
  return parsed(table, words, [&]() -> Result<Command> {
    const Result<Format> output_as = output_format(output, asked_format, kMapFormats);
    if (!output_as) return tl::unexpected(output_as.error());
    command.format = *output_as;
    command.map = map;
    command.build = build.build_options();
    if (const auto valid = command.map.validate(); !valid) return tl::unexpected(valid.error());
    if (const auto valid = command.build.validate(); !valid) return tl::unexpected(valid.error());
    if (map.depth != Lattice::kDefaultDepth && (*output_as == Format::kBt || *output_as == Format::kOt)) {
      return off(fmt::format("{}: .{} holds maps of {} levels, not of {}: use .pvx", output, name_of(*output_as),
                             Lattice::kDefaultDepth, map.depth));
    }
    if (output == "-" && command.manner.report == Report::kJson) {
      return off("-o - and --json: both want standard output");
    }
    if (!build.poses.empty()) command.poses = build.poses;
    Words inputs = command.logs;
    inputs.push_back(build.poses);
    if (const auto once = check_standard_input(inputs); !once) return tl::unexpected(once.error());
    if (const auto folder = check_folder_of(output); !folder) return tl::unexpected(folder.error());
    command.output = output;
    command.made_by = "pingvox " PINGVOX_VERSION " map";
    for (const std::string& word : words) command.made_by += " " + shell_quoted(word);
    return command;
  });
}

Result<Command> info_command(const Words& words) {
  InfoCommand command;
  const OptionTable table{
      "info",
      "Says what a file holds: a log of beams or of point scans, a cloud, a map, a mesh, or a trajectory. Told by\n"
      "content, not by name.",
      {{"FILE", Positional::Count::kOne, "what to look at; - is standard input", into(command.file)}},
      {{"Options", {json_option(command.manner), strict_option(command.damage)}}},
      {"pingvox info tank.mat", "pingvox info tank.bt --json"},
      ""};
  return parsed(table, words, [&]() -> Result<Command> { return command; });
}

Result<Command> compare_command(const Words& words) {
  CompareCommand command;
  const OptionTable table{"compare",
                          "Compares two maps cell by cell, at the finest resolution. Cells are the same when their "
                          "log-odds are; when one of\n"
                          "the files is a .bt, which holds no log-odds, when both are free or both are occupied.\n"
                          "Also says how right A is if B is the truth: occupied cells within one cell, and free ones.",
                          {{"A", Positional::Count::kOne, "a map; - is standard input", into(command.a)},
                           {"B", Positional::Count::kOne, "another of the same resolution and depth", into(command.b)}},
                          {{"Options", {json_option(command.manner), quiet_option(command.manner)}}},
                          {"pingvox compare ours.bt theirs.bt", "pingvox compare before.ot after.ot --json"},
                          "Exit status: 0 the same, 1 different, 2 trouble."};
  return parsed(table, words, [&]() -> Result<Command> {
    if (const auto once = check_standard_input({command.a, command.b}); !once) return tl::unexpected(once.error());
    return command;
  });
}

Result<Command> convert_command(const Words& words) {
  ConvertCommand command;
  std::optional<Format> asked_format;
  const Take format = [&](const std::string& text) -> Result<void> {
    const Result<Format> value = value_of(kLogAndMapFormats, text);
    if (!value) return tl::unexpected(value.error());
    asked_format = *value;
    return {};
  };
  std::optional<double> layer_m;
  std::optional<Surface> surface;
  const Take take_surface = [&](const std::string& text) -> Result<void> {
    const Result<Surface> value = value_of(kSurfaces, text);
    if (!value) return tl::unexpected(value.error());
    surface = *value;
    return {};
  };
  const OptionTable table{
      "convert",
      "Writes a file in another format: a log of beams as CSV; a map as another map, as a cloud of points, as a grid\n"
      "for ROS's map_server, or as heights; a mesh as the map of its surface.",
      {{"IN", Positional::Count::kOne, "a log of beams, a map or a mesh (OFF, PLY, STL); - is standard input",
        into(command.input)}},
      {{"Options",
        {output_option(command.output,
                       "what to write: .csv from a log; .bt .ot .pvx from a map or a mesh, and .ply .pcd (points), "
                       ".yaml with its .pgm (map_server), .asc (ESRI grid of heights); - is standard output"),
         {"--format", 0, words_of(kLogAndMapFormats), "format of the output, whatever its name", "by suffix, else csv",
          format},
         strict_option(command.damage),
         quiet_option(command.manner)}},
       {"Meshes",
        {{"--resolution", 0, "M", "edge of a cell", shown(MapOptions{}.resolution_m),
          into_optional(command.resolution_m)}}},
       {"Grids and heights",
        {{"--z", 0, "M", "only the layer of cells that holds this height", "all layers", into_optional(layer_m)},
         {"--min-z", 0, "M", "no layer below", "none", into_optional(command.slice.min_z_m)},
         {"--max-z", 0, "M", "no layer above", "none", into_optional(command.slice.max_z_m)},
         {"--height", 0, words_of(kSurfaces),
          "which occupied cell of a column gives its height, that of its upper face",
          word_of(kSurfaces, command.surface), take_surface}}}},
      {"pingvox convert tank.mat -o tank.csv", "pingvox convert tank.bt -o tank.ply",
       "pingvox convert harbour.bt -o harbour.yaml --min-z -0.5 --max-z 0.5", "pingvox convert seabed.ot -o seabed.asc",
       "pingvox convert hull.stl -o hull.bt --resolution 0.1"},
      "A column of a grid is occupied when any of its cells is, free when one is and none is occupied, else unknown."};
  return parsed(table, words, [&]() -> Result<Command> {
    if (format_for_writing(command.output) == Format::kPng) {
      return off(fmt::format("{}: pictures are drawn by 'pingvox render'", command.output));
    }
    const Result<Format> output_as = output_format(command.output, asked_format, kLogAndMapFormats);
    if (!output_as) return tl::unexpected(output_as.error());
    command.format = *output_as;
    const bool is_grid = command.format == Format::kGrid, is_heights = command.format == Format::kAsc;
    const bool is_sliced = layer_m || command.slice.min_z_m || command.slice.max_z_m;
    if (is_sliced && !is_grid && !is_heights) {
      return off("--z, --min-z and --max-z: only for grids and heights, .yaml, .pgm and .asc");
    }
    if (surface && !is_heights) return off("--height: only for heights, .asc");
    command.surface = surface.value_or(command.surface);
    if (layer_m && (command.slice.min_z_m || command.slice.max_z_m)) return off("--z is both --min-z and --max-z");
    if (layer_m) command.slice = {layer_m, layer_m};
    if (const auto valid = command.slice.validate(); !valid) return tl::unexpected(valid.error());
    if (command.resolution_m) {
      if (const auto lattice = Lattice::make(*command.resolution_m); !lattice) return tl::unexpected(lattice.error());
    }
    if (is_grid && command.output == "-") return off("-o -: of a grid, two files are written: name the first one");
    if (const auto folder = check_folder_of(command.output); !folder) return tl::unexpected(folder.error());
    return command;
  });
}

/// The words of a text, split and unquoted as a shell does it.
Result<Words> split_words(std::string_view text) {
  Words words;
  std::string word;
  char quote = 0;
  bool has_begun = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\\' && quote != '\'' && i + 1 < text.size()) {
      word += text[++i];
      has_begun = true;
    } else if (quote != 0 ? c == quote : c == '\'' || c == '"') {
      quote = quote != 0 ? 0 : c;
      has_begun = true;  // so that '' is a word
    } else if (quote == 0 && (c == ' ' || c == '\t' || c == '\n')) {
      if (has_begun) words.push_back(std::move(word));
      word.clear();
      has_begun = false;
    } else {
      word += c;
      has_begun = true;
    }
  }
  if (quote != 0) return off(fmt::format("{}: a quotation mark is not closed", text));
  if (has_begun) words.push_back(std::move(word));
  return words;
}

/// What one panel of a picture shows, as the call says it. A copy with some options changed is the panel beside it.
struct PanelWords {
  PanelCommand panel;
  MapView from = MapView::kRight;
  std::optional<double> slice_z_m;
  std::optional<std::size_t> size_px;
  BuildWords build;
  std::vector<std::pair<std::string, std::string>> given;  ///< options with their values, those given later behind

  /// What an option was given, last of all; nullopt: nothing.
  std::optional<std::string> given_to(std::string_view name) const {
    for (auto it = given.rbegin(); it != given.rend(); ++it) {
      if (it->first == name) return it->second;
    }
    return std::nullopt;
  }
};

/// Makes the options also note what they are given.
void note_in(std::vector<std::pair<std::string, std::string>>& given, std::vector<OptionTable::Group>& groups) {
  for (auto& group : groups) {
    for (Option& option : group.options) {
      option.take = [&given, name = option.name, take = option.take](const std::string& text) -> Result<void> {
        Result<void> taken = take(text);
        if (taken) given.emplace_back(name, text);
        return taken;
      };
    }
  }
}

/// The options that may differ from panel to panel.
std::vector<OptionTable::Group> panel_groups(PanelWords& words) {
  PanelCommand& panel = words.panel;
  const Take view = [&panel](const std::string& text) -> Result<void> {
    const Result<PictureView> value = value_of(kPictureViews, text);
    if (!value) return tl::unexpected(value.error());
    panel.view = *value;
    return {};
  };
  std::vector<OptionTable::Group> groups = {
      {"Picture",
       {{"--view", 0, words_of(kPictureViews),
         "a log as it was heard; or a map, also that of a log, from one of its sides, or one layer of cells",
         "polar of a log, above of a map", view},
        choice("--from", kSides, "of --view side: where one stands, as seen from the vehicle", words.from),
        {"--z", 0, "M", "of --view slice: a height in the layer", "none", into_optional(words.slice_z_m)},
        {"--min-z", 0, "M", "of a map, draw nothing below", "none", into_optional(panel.map_picture.min_z_m)},
        {"--max-z", 0, "M", "of a map, draw nothing above", "none", into_optional(panel.map_picture.max_z_m)},
        {"--sweep", 0, "N", "of a log, draw only this sweep, counted from 1", "all; cartesian: the first complete one",
         into_optional(panel.sweep)},
        choice("--show", kShownImages, "the intensities as heard, or as --filter makes them", panel.image),
        choice("--echoes", kEchoMarks, "a mark on each echo", panel.marks),
        choice("--between", kBetweens, "of --view cartesian: what is drawn between the beams", panel.between),
        {"--size", 0, "PX", "about as long is the longer side of the picture, or of each", "1000; of several 640",
         into_optional(words.size_px)},
        {"--caption", 0, "TEXT", "below the picture", "what differs from those beside it", into(panel.caption)}}},
      echo_group(words.build.echoes, words.build.build.sound_speed_ratio,
                 into_number(words.build.build.model.max_range_m)),
      map_group(words.build),
      sensor_group(words.build)};
  note_in(words.given, groups);
  return groups;
}

/// What of the options that differ between panels this one has.
std::string caption_of(const PanelWords& words, const std::vector<PanelWords>& all) {
  // Its own table says how its options are called and what they are when they are not given.
  PanelWords defaults;
  std::string caption;
  for (const auto& group : panel_groups(defaults)) {
    for (const Option& option : group.options) {
      const auto value = words.given_to(option.name);
      const bool differs = std::any_of(all.begin(), all.end(),
                                       [&](const PanelWords& other) { return other.given_to(option.name) != value; });
      if (!differs || option.name == "--caption" || option.name == "--size") continue;
      caption +=
          fmt::format("{}{} {}", caption.empty() ? "" : ", ", option.name.substr(2), value.value_or(option.standard));
    }
  }
  return caption;
}

/// The panel with everything in its place.
Result<PanelCommand> panel_command(const PanelWords& words, std::size_t usual_size_px) {
  PanelCommand panel = words.panel;
  panel.map = words.build.map;
  panel.build = words.build.build_options();
  if (!words.build.poses.empty()) panel.poses = words.build.poses;
  panel.map_picture.target_px = panel.echo_picture.target_px = words.size_px.value_or(usual_size_px);
  if (panel.view == PictureView::kSide) panel.map_picture.view = words.from;
  if (panel.view == PictureView::kSlice) {
    if (!words.slice_z_m) return off("--view slice: at which height? (--z M)");
    panel.map_picture.layer_z_m = words.slice_z_m;
  }
  if (panel.sweep == 0U) return off("--sweep: counts from 1");
  if (const auto valid = panel.map_picture.validate(); !valid) return tl::unexpected(valid.error());
  if (const auto valid = panel.map.validate(); !valid) return tl::unexpected(valid.error());
  if (const auto valid = panel.build.validate(); !valid) return tl::unexpected(valid.error());
  const CartesianPictureOptions cartesian{panel.echo_picture, panel.between, panel.build.model.width_rad};
  if (const auto valid = cartesian.validate(); !valid) return tl::unexpected(valid.error());
  return panel;
}

/// An option that no panel has use for would silently change nothing.
Result<void> check_use(const std::vector<PanelWords>& panels, std::string_view option, PictureView view) {
  const auto any = [&](auto&& says) { return std::any_of(panels.begin(), panels.end(), says); };
  if (!any([&](const PanelWords& words) { return words.given_to(option).has_value(); })) return {};
  if (any([&](const PanelWords& words) { return words.panel.view == view; })) return {};
  return off(fmt::format("{}: is of --view {}", option, word_of(kPictureViews, view)));
}

Result<Command> render_command(const Words& words) {
  RenderCommand command;
  Words inputs, beside;
  PanelWords first;
  const auto into_list = [](Words& list) -> Take {
    return [&list](const std::string& text) -> Result<void> {
      list.push_back(text);
      return {};
    };
  };
  OptionTable table{
      "render",
      "Draws a PNG: of a log of beams what was heard, with a mark on each echo; of a map (or a log, mapped as by\n"
      "'pingvox map') what is where. Several FILEs, and several settings of one, stand side by side.",
      {{"FILE", Positional::Count::kMany, "a log or a map, told by content; - is standard input", into_list(inputs)}},
      panel_groups(first),
      {"pingvox render tank.mat -o echoes.png --sweep 3 --threshold 50",
       "pingvox render tank.mat -o sweep.png --view cartesian --show filtered", "pingvox render tank.bt -o map.png",
       "pingvox render tank.bt -o layer.png --view slice --z 0.5",
       "pingvox render before.bt after.bt -o both.png --view side --from behind",
       "pingvox render tank.mat -o thresholds.png --view above --threshold 20 --beside '--threshold 70'"},
      "Beams, echoes and cells differ in lightness, not only in colour.\n"
      "Exit status: 0 done, 1 could not be done, 2 the words of the call are off."};
  auto& options = table.groups.front().options;
  options.insert(options.begin(), output_option(command.output, "the picture, .png; - is standard output"));
  options.push_back({"--beside", 0, "OPTIONS",
                     "the same again beside it with these options changed, as in '--filter none'; may be repeated",
                     "none", into_list(beside), Repeats::kEachCounts});
  options.push_back({"--title", 0, "TEXT", "above the picture", "none", into(command.title)});
  options.push_back(strict_option(command.damage));
  options.push_back(quiet_option(command.manner));
  options.push_back(config_option());
  return parsed(table, words, [&]() -> Result<Command> {
    const Result<Format> output_as = output_format(command.output, std::nullopt, kPngOnly);
    if (!output_as) return tl::unexpected(output_as.error());
    std::vector<PanelWords> settings = {first};
    for (const std::string& text : beside) {
      const Result<Words> changed = split_words(text);
      if (!changed) return off("--beside: " + changed.error().message);
      PanelWords next = first;
      next.panel.caption.clear();
      const Result<Parsed> taken = parse({"render: --beside", "", {}, panel_groups(next), {}, ""}, *changed);
      if (!taken) return tl::unexpected(taken.error());
      if (*taken == Parsed::kHelpWanted) return off("--beside: takes no --help");
      settings.push_back(std::move(next));
    }
    for (const auto& [option, view] :
         {std::pair("--z", PictureView::kSlice), std::pair("--from", PictureView::kSide)}) {
      if (const auto used = check_use(settings, option, view); !used) return tl::unexpected(used.error());
    }
    const std::size_t panels = settings.size() * inputs.size();
    for (const PanelWords& setting : settings) {
      const Result<PanelCommand> panel = panel_command(setting, panels > 1 ? 640 : 1000);
      if (!panel) return tl::unexpected(panel.error());
      for (const std::string& input : inputs) {
        command.panels.push_back(*panel);
        command.panels.back().input = input;
        std::string& caption = command.panels.back().caption;
        if (!caption.empty()) continue;
        caption = caption_of(setting, settings);
        if (inputs.size() > 1) {
          if (!caption.empty()) caption.insert(0, ": ");
          caption.insert(0, std::filesystem::path(input).filename().string());
        }
      }
    }
    Words files = inputs;
    for (const PanelWords& setting : settings) {
      if (setting.build.poses == "-") files.emplace_back("-");
    }
    if (const auto once = check_standard_input(files); !once) return tl::unexpected(once.error());
    if (const auto folder = check_folder_of(command.output); !folder) return tl::unexpected(folder.error());
    return command;
  });
}

Result<Command> simulate_command(const Words& words) {
  SimulateCommand command;
  TankOptions& tank = command.tank;
  SonarOptions& sonar = command.sonar;
  const Take world = [&](const std::string& text) -> Result<void> {
    const Words known = {"tank", "harbour", "seabed", "cave"};
    std::error_code error;
    const bool is_known = std::find(known.begin(), known.end(), text) != known.end();
    if (!is_known && !std::filesystem::path(text).has_extension() && !std::filesystem::exists(text, error)) {
      return off(fmt::format("there is no world '{}', only: {}, or a mesh (.off, .ply, .stl){}", text,
                             fmt::join(known, ", "), did_you_mean(text, known)));
    }
    command.world = text;
    return {};
  };
  std::string poses, truth;
  const OptionTable table{
      "simulate",
      "Makes the log of a turning sonar in a world of your choice, and tells the truth about it if asked. The same\n"
      "options give the same bytes.",
      {{"WORLD", Positional::Count::kOne,
        "tank (square, with a floater), harbour (quay walls, piles, a hull), seabed (a slope with boulders), cave (a "
        "tunnel), or the file of a mesh in metres (OFF, PLY, STL)",
        world}},
      {{"Output",
        {output_option(command.output,
                       "the log, .csv; - is standard output. Of a vehicle that moves, a .tum beside it holds where it "
                       "reports to have been"),
         {"--truth", 0, "DIR",
          "write there what is true: poses.tum, ranges.csv, and the world as world.ply (a mesh) and world.bt (a map)",
          "none", into(truth)},
         {"--resolution", 0, "M", "edge of a cell of world.bt", shown(command.truth_resolution_m),
          into_number(command.truth_resolution_m)},
         quiet_option(command.manner)}},
       {"World and vehicle",
        {{"--side", 0, "M", "of the square tank", shown(tank.side_m), into_number(tank.side_m)},
         choice("--trajectory", kMotions, "what the vehicle does; still is at 0,0,0", command.motion),
         {"--poses", 0, "FILE", "its way as TUM lines, instead of a trajectory of ours", "none", into(poses)},
         {"--speed", 0, "M/S", "of the vehicle", shown(command.travel.speed_m_s),
          into_number(command.travel.speed_m_s)},
         {"--turns", 0, "N", "how often the head turns round", "5; of a vehicle that moves, until it has arrived",
          into_optional(command.turns)},
         {"--drift", 0, "M", "how far reported positions stray in a minute (standard deviation)",
          shown(command.drift.position_m), into_number(command.drift.position_m)},
         {"--heading-drift", 0, "DEG", "how far reported headings stray in a minute",
          shown(command.drift.heading_rad / kDegree_rad), into_number(command.drift.heading_rad, kDegree_rad)}}},
       {"Sonar",
        {{"--seed", 0, "N", "of speckle, noise, dropouts and drift", fmt::format("{}", sonar.seed),
          into_number(sonar.seed)},
         {"--range", 0, "M", "to the end of the last bin", "by world", into_optional(command.range_m)},
         {"--bins", 0, "N", "of a beam", fmt::format("{}", sonar.bins), into_number(sonar.bins)},
         {"--bin-length", 0, "M", "of a bin, instead of --range", "by world", into_optional(command.bin_length_m)},
         {"--beams-per-turn", 0, "N", "directions of the head", fmt::format("{}", sonar.beams_per_turn),
          into_number(sonar.beams_per_turn)},
         {"--beam-width", 0, "DEG", "horizontally, between the points of half power",
          shown(sonar.beam_width_rad / kDegree_rad), into_number(sonar.beam_width_rad, kDegree_rad)},
         {"--beam-height", 0, "DEG", "the same vertically", shown(sonar.beam_height_rad / kDegree_rad),
          into_number(sonar.beam_height_rad, kDegree_rad)},
         {"--side-lobes", 0, "S", "0 none, 1 those of a plain rectangular face", shown(sonar.side_lobes),
          into_number(sonar.side_lobes)},
         {"--gain", 0, "G", "share of the loss with range that is made up for, 0..1", shown(sonar.gain),
          into_number(sonar.gain)},
         {"--compression", 0, "C", "exponent by which amplitudes become 8 bits: 1 linear, less brings out the faint",
          shown(sonar.compression), into_number(sonar.compression)},
         {"--absorption", 0, "DB/M", "by the water, one way", shown(sonar.absorption_db_per_m),
          into_number(sonar.absorption_db_per_m)},
         {"--ringing", 0, "M", "up to which the head hears itself", shown(sonar.ringing_m),
          into_number(sonar.ringing_m)},
         {"--speckle", 0, "S", "0 none, 1 full fading of each bin", shown(sonar.speckle), into_number(sonar.speckle)},
         {"--noise", 0, "N", "mean amplitude of the background near the head, of 255", shown(sonar.noise),
          into_number(sonar.noise)},
         {"--multipath", 0, "S", "share of what surfaces mirror that goes on, 0..1", shown(sonar.multipath),
          into_number(sonar.multipath)},
         {"--bubbles", 0, "S", "share of beams in which nothing is heard but noise", shown(sonar.silent),
          into_number(sonar.silent)},
         {"--lost", 0, "S", "share of beams that are missing in the log", shown(sonar.lost), into_number(sonar.lost)},
         config_option()}}},
      {"pingvox simulate tank -o tank.csv", "pingvox simulate tank -o - --seed 7 | pingvox map - -o tank.bt",
       "pingvox simulate harbour -o harbour.csv --trajectory loop --truth harbour-truth",
       "pingvox simulate wreck.stl -o wreck.csv --poses dive.tum --drift 0.3 --truth wreck-truth"},
      ""};
  return parsed(table, words, [&]() -> Result<Command> {
    const Result<Format> output_as = output_format(command.output, std::nullopt, kCsvOnly);
    if (!output_as) return tl::unexpected(output_as.error());
    if (!poses.empty()) command.poses = poses;
    if (!truth.empty()) command.truth = truth;
    command.drift.seed = sonar.seed;
    if (command.range_m && command.bin_length_m) return off("--range and --bin-length: say one of the two");
    if (command.poses && command.motion != Motion::kStill) return off("--poses and --trajectory: say one of the two");
    if (command.output == "-" && (command.poses || command.motion != Motion::kStill)) {
      return off("-o -: of a vehicle that moves, two files are written: name the first one");
    }
    if (command.turns && !(*command.turns >= 1 && *command.turns <= 10'000)) {
      return off(fmt::format("--turns: must be 1..10000, is {}", *command.turns));
    }
    if (const auto lattice = Lattice::make(command.truth_resolution_m); !lattice) {
      return tl::unexpected(lattice.error());
    }
    // Of the sonar all but the bin length, which waits for the world.
    SonarOptions set = sonar;
    set.bin_length_m = command.range_m ? *command.range_m / static_cast<double>(std::max<std::size_t>(sonar.bins, 1))
                                       : command.bin_length_m.value_or(sonar.bin_length_m);
    if (const auto valid = set.validate(); !valid) return tl::unexpected(valid.error());
    if (const auto valid = tank.validate(); !valid) return tl::unexpected(valid.error());
    if (const auto valid = command.travel.validate(); !valid) return tl::unexpected(valid.error());
    if (const auto valid = command.drift.validate(); !valid) return tl::unexpected(valid.error());
    if (const auto once = check_standard_input({command.world, poses}); !once) return tl::unexpected(once.error());
    if (const auto folder = check_folder_of(command.output); !folder) return tl::unexpected(folder.error());
    return command;
  });
}

Result<Command> bench_command(const Words& words) {
  return BenchCommand{{}, words};
}

Result<Command> view_command(const Words&) {
  return fail(
      Error::Code::kUnsupported,
      "view: not in this version: 'pingvox render MAP -o map.png' draws a map, 'pingvox convert MAP -o map.ply' "
      "makes a cloud for other viewers");
}

struct CommandName {
  std::string_view name, purpose;
  Result<Command> (*parse)(const Words&);
};

/// `view` is known, so that nobody is told to have misspelt it, but not offered.
constexpr std::array kCommands = {
    CommandName{"map", "logs to a map", &map_command},
    CommandName{"info", "what a log, a cloud, a map or a mesh holds", &info_command},
    CommandName{"compare", "two maps, cell by cell", &compare_command},
    CommandName{"convert", "a log to CSV, a map to another format, a cloud or a grid, a mesh to a map",
                &convert_command},
    CommandName{"render", "a picture of a log with its echoes, or of a map", &render_command},
    CommandName{"simulate", "the log of a sonar in a world of your choice", &simulate_command},
    CommandName{"bench", "measurements, when pingvox-bench is installed", &bench_command},
    CommandName{"view", "", &view_command},
};

std::string overview() {
  std::string out = "Usage: pingvox COMMAND [WORD]...\nTurns sonar logs into 3D occupancy maps.\n\nCommands:\n";
  for (const CommandName& command : kCommands) {
    if (!command.purpose.empty()) out += fmt::format("  {:<10}{}\n", command.name, command.purpose);
  }
  return out +
         "\n  -h, --help     this text; behind a command, all about it\n"
         "      --version  the version\n"
         "\nExamples:\n"
         "  pingvox simulate tank -o tank.csv\n"
         "  pingvox map tank.csv -o tank.bt --beam cone\n"
         "  pingvox render tank.bt -o tank.png\n"
         "\nExit status: 0 done, 1 could not be done, 2 the words of the call are off.\n";
}

}  // namespace

Result<Command> parse_command_line(const Words& words) {
  if (words.empty()) return off("a command is missing (see 'pingvox --help')");
  const std::string& first = words.front();
  if (first == "--help" || first == "-h") return ShowText{{}, overview()};
  if (first == "--version") return ShowText{{}, "pingvox " PINGVOX_VERSION "\n"};

  Words rest(words.begin() + 1, words.end());
  if (first == "help") {
    if (rest.empty()) return ShowText{{}, overview()};
    return parse_command_line({rest.front(), "--help"});
  }
  Words known = {"--help", "--version"};
  for (const CommandName& command : kCommands) {
    if (command.name == first) return command.parse(rest);
    if (!command.purpose.empty()) known.emplace_back(command.name);
  }
  const std::string kind = first.starts_with("-") ? "option" : "command";
  const std::string hint = did_you_mean(first, known);
  return off(fmt::format("unknown {} '{}'{}", kind, first, hint.empty() ? " (see 'pingvox --help')" : hint));
}

}  // namespace pingvox::app
