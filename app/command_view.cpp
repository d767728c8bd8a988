#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "console.hpp"
#include "evaluation_text.hpp"
#include "input_kinds.hpp"
#include "map_report.hpp"
#include "open_browser.hpp"
#include "open_log.hpp"
#include "open_recording.hpp"
#include "option_values.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/open_log.hpp"
#include "pingvox/recording/evaluate.hpp"
#include "pingvox/recording/navigation.hpp"
#include "pingvox/web/page.hpp"
#include "pingvox/web/scene.hpp"
#include "pingvox/web/server.hpp"
#include "progress.hpp"
#include "recording_report.hpp"
#include "recording_warnings.hpp"
#include "stop_signals.hpp"

namespace pingvox::app {
namespace {

/// The files of a command by what is done with them.
struct ViewedFiles {
  std::vector<InputFile> logs;
  std::vector<std::string> trajectories;
  std::vector<std::string> navs;
  std::vector<FileBytes> others;
  std::vector<std::string> kinds;  ///< that options may be limited to
};

/// Whether a bag has something that is mapped; other bags hold navigation.
bool has_log(const std::string& path, const ViewCommand& command) {
  return InputFile(path)
      .open()
      .and_then([&](ByteStream stream) {
        return open_log(std::move(stream), command.recording.damage, {}, command.recording.bag.beams);
      })
      .has_value();
}

Result<ViewedFiles> sort_files(const ViewCommand& command, Console& console) {
  std::vector<std::string> paths = command.files;
  if (const auto found = expand_folders(paths, console); !found) return tl::unexpected(found.error());
  ViewedFiles files;
  for (const std::string& path : paths) {
    Result<ByteStream> stream = ByteStream::open(path);
    if (!stream) return tl::unexpected(stream.error());
    const Result<Format> format = identify_format(*stream);
    if (!format) return tl::unexpected(format.error());
    FormatKind kind = kind_of(*format);
    const bool is_read_once = InputFile(path).is_read_once();
    if (is_bag(*format) && !is_read_once && !has_log(path, command)) kind = FormatKind::kNav;
    files.kinds.push_back(kind_text(kind));
    if (kind == FormatKind::kNav) {
      files.navs.push_back(path);
      continue;
    }
    if (kind == FormatKind::kTrajectory && !is_read_once) {
      files.trajectories.push_back(path);
      continue;
    }
    const bool is_log = kind == FormatKind::kBeams || kind == FormatKind::kScans;
    if (is_log && !is_read_once) {
      files.logs.emplace_back(path);
      continue;
    }
    Result<FileBytes> bytes = ByteStream::whole(*std::move(stream));
    if (!bytes) return tl::unexpected(bytes.error());
    if (is_log) {
      files.logs.emplace_back(*std::move(bytes));
    } else {
      files.others.push_back(*std::move(bytes));
    }
  }
  return files;
}

/// "map.bt", "map.bt and 2 others"
std::string title_of(const std::vector<std::string>& files) {
  std::string first =
      files.front() == "-" ? name_of_input("-") : std::filesystem::path(files.front()).filename().string();
  if (files.size() == 1) return first;
  return fmt::format("{} and {}", first, counted(files.size() - 1, "other"));
}

/// Something that `map` would say of a log, for the terminal and for the page.
void note(std::string text, web::Scene& scene, Console& console) {
  console.say(text);
  scene.notes.push_back(std::move(text));
}

/// Maps the logs as `map` does.
Result<void> add_map(const Recording& recording, const VehiclePath& path, const ViewCommand& command, web::Scene& scene,
                     Console& console) {
  ProgressBar bar(command.output_options);
  const Progress progress = [&bar](const BuildReport& done) {
    if (bar.is_due()) bar.draw(std::nullopt, counted(done.beams, "beam"));
  };
  Result<RecordingMap> mapped = build_map(recording, path, command.map, command.build, progress);
  if (!mapped) return tl::unexpected(mapped.error());
  bar.clear();
  for (const MappedLog& log : mapped->logs) {
    for (std::string& warning : warnings_of(recording, path, log, mapped->map.lattice())) {
      note(std::move(warning), scene, console);
    }
  }
  web::SceneMap shown{"the map of " + scene.title, "log", std::move(mapped->map), path.axes};
  if (command.agreement == CountCells::kYes) {
    EvaluateOptions options{.map = command.map, .build = command.build, .cells = CountCells::kYes};
    options.map.resolution_m = shown.map.lattice().resolution_m();
    Result<Evaluation> found = evaluate(recording, path, options);
    if (!found) return tl::unexpected(found.error());
    note(fmt::format("the map {}", verdict_text(*found)), scene, console);
    shown.agreement = std::move(found->cells);
  }
  Result<OccupancyMap> map = command.occupancy.apply_to(std::move(shown.map));
  if (!map) return tl::unexpected(map.error());
  shown.map = *std::move(map);
  scene.maps.push_back(std::move(shown));
  return {};
}

Result<void> add_logs(std::vector<InputFile> logs, const ViewCommand& command, web::Scene& scene, Console& console) {
  if (const auto ranges = check_ranges(command.build); !ranges) return ranges;
  const Result<OpenedRecording> opened = open_with_path(std::move(logs), command.recording);
  if (!opened) return tl::unexpected(opened.error());
  const auto& [recording, path] = *opened;
  for (const std::string& warning : warnings_of(recording, path)) note(warning, scene, console);
  if (scene.maps.empty()) {
    if (const auto mapped = add_map(recording, path, command, scene, console); !mapped) return mapped;
  }
  return web::add_recording(recording, path, command.build, scene);
}

/// Maps as they are to be looked at: thresholds and levels of the command line.
Result<void> look_at_maps(const ViewCommand& command, web::Scene& scene) {
  for (web::SceneMap& map : scene.maps) {
    if (map.format == name_of(Format::kBt)) {
      if (const auto used = command.occupancy.check(Format::kBt); !used) return used;
    }
    Result<OccupancyMap> looked_at = command.occupancy.apply_to(std::move(map.map));
    if (!looked_at) return tl::unexpected(looked_at.error());
    map.map = *std::move(looked_at);
  }
  return {};
}

Result<void> add_nav(const std::string& path, const ViewCommand& command, web::Scene& scene) {
  Result<ByteStream> stream = ByteStream::open(path);
  if (!stream) return tl::unexpected(stream.error());
  return read_nav_log(*std::move(stream), command.recording.damage, command.recording.bag.nav)
      .and_then([&](const BagContents& contents) { return positions_of(contents, path, {}); })
      .map([&](VehiclePath found) {
        web::add_path(std::filesystem::path(path).filename().string(), std::move(found.trajectory), scene);
      });
}

Result<web::Scene> scene_of(const ViewCommand& given, Console& console) {
  Result<ViewedFiles> files = sort_files(given, console);
  if (!files) return tl::unexpected(files.error());
  ViewCommand command = given;
  web::Scene scene;
  scene.title = title_of(command.files);
  for (const FileBytes& file : files->others) {
    if (const auto added = web::add_file(file, command.map, command.recording.damage, scene); !added) {
      return tl::unexpected(added.error());
    }
  }
  if (!files->logs.empty() && scene.maps.empty()) files->kinds.emplace_back(kMadeMaps);
  if (command.build.model.shape == BeamShape::kRay) files->kinds.emplace_back(kRayBeams);
  if (const auto used = check_limited(command.limited, files->kinds); !used) return tl::unexpected(used.error());
  if (const auto done = look_at_maps(command, scene); !done) return tl::unexpected(done.error());
  const bool has_path = !files->logs.empty() && files->trajectories.size() == 1 && !command.recording.path.poses &&
                        command.recording.path.navs.empty();
  if (has_path) {
    command.recording.path.poses = files->trajectories.front();
  } else {
    for (const std::string& path : files->trajectories) {
      const Result<void> added = read_file(path).and_then(
          [&](const FileBytes& file) { return web::add_file(file, command.map, command.recording.damage, scene); });
      if (!added) return tl::unexpected(added.error());
    }
  }
  for (const std::string& path : files->navs) {
    if (const auto added = add_nav(path, command, scene); !added) return tl::unexpected(added.error());
  }
  if (!files->logs.empty()) {
    if (const auto added = add_logs(std::move(files->logs), command, scene, console); !added) {
      return tl::unexpected(added.error());
    }
  }
  return scene;
}

Result<int> export_page(web::Scene scene, const web::Page& page, const std::string& output, Console& console) {
  const Result<void> written =
      write_file(output, [&](std::ostream& out) { return web::write_page(std::move(scene), page, out); });
  if (!written) return tl::unexpected(written.error());
  std::error_code error;
  const std::uintmax_t bytes = output == "-" ? 0 : std::filesystem::file_size(output, error);
  const std::string size = bytes > 0 && !error ? ", " + bytes_text(bytes) : "";
  const Result<void> said = console.summarise(fmt::format("{}: a page for any browser{}\n", output, size), output);
  return said.map([] { return 0; });
}

/// Serves until a signal arrives.
Result<int> serve(const web::Page& page, const ViewCommand& command, Console& console) {
  // Before the logs are read: threads that this starts must not take the signals.
  const Result<StopSignals> signals = StopSignals::make();
  if (!signals) return tl::unexpected(signals.error());
  Result<web::Scene> scene = scene_of(command, console);
  if (!scene) return tl::unexpected(scene.error());
  if (signals->has_arrived()) return 0;
  const Result<web::Server> server =
      web::Server::start(web::Answers(*std::move(scene), page),
                         {.address = command.address, .port = command.port, .readers = command.readers});
  if (!server) return fail(server.error().code, "view: " + server.error().message);
  if (const auto printed = console.print(server->url() + "\n"); !printed) return tl::unexpected(printed.error());
  console.say("open this address in a browser; Ctrl-C ends");
  if (command.browser == OpenBrowser::kYes) open_browser(server->url());
  pollfd signal = {signals->descriptor(), POLLIN, 0};
  while (!signals->has_arrived()) {
    if (::poll(&signal, 1, -1) < 0 && errno != EINTR) break;
  }
  return 0;
}

}  // namespace

Result<int> run(const ViewCommand& command, Console& console) {
  const Result<web::Page> page = page_of_build("view");
  if (!page) return tl::unexpected(page.error());
  if (!command.export_to) return serve(*page, command, console);
  Result<web::Scene> scene = scene_of(command, console);
  if (!scene) return tl::unexpected(scene.error());
  return export_page(*std::move(scene), *page, *command.export_to, console);
}

}  // namespace pingvox::app
