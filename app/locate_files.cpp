#include "locate_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <memory>
#include <utility>
#include <variant>

#include "calibration_file.hpp"
#include "console.hpp"
#include "map_log.hpp"
#include "map_report.hpp"
#include "nav_report.hpp"
#include "open_log.hpp"
#include "pingvox/io/beams_in_order.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/maps.hpp"
#include "step_report.hpp"

namespace pingvox::app {

Result<LocateMotion> read_motion(const LocateCommand& command) {
  LocateMotion motion;
  if (command.odometry) {
    Result<Trajectory> odometry = trajectory_of(command.odometry);
    if (!odometry) return tl::unexpected(odometry.error());
    motion.text = fmt::format("{} of {}", counted(odometry->poses().size(), "pose"), on_one_line(*command.odometry));
    // Only the way counts, and a step is none.
    const CutTrajectory cut = cut_at_steps(*odometry);
    for (const std::string& step : step_texts(cut)) {
      motion.warnings.push_back(fmt::format("{}: {}", *command.odometry, step));
    }
    motion.recorded.odometry_from_body = join_at_cuts(cut.trajectory);
    return motion;
  }
  if (command.navs.empty()) return motion;
  const Result<NavFiles> nav =
      read_navs(command.navs, command.damage, command.bag.nav, {.log = {}, .topic = {}, .chosen = command.nav_sources});
  if (!nav) return tl::unexpected(nav.error());
  motion.skipped = nav->damaged;
  motion.warnings = nav->warnings;
  if (command.nav_salinity) {
    const Result<Water> water = water_of(water_around(nav->log), *command.nav_salinity);
    if (!water) return tl::unexpected(water.error());
    motion.water = *water;
  }
  Result<NavOffset> offset =
      nav_offset(command.nav_offset_s, *nav,
                 {command.logs.front(), command.bag.beams, command.localizer.body_from_sonar}, command.damage);
  if (!offset) return tl::unexpected(offset.error());
  OdometryOptions options = command.nav;
  options.offset_s = offset->offset_s;
  options.turns = TurnsBy::kTurnRate;
  motion.clock = *std::move(offset);
  if (command.calibration) {
    const Result<Eigen::Vector3d> moved_m = use_calibration(*command.calibration, options);
    if (!moved_m) return tl::unexpected(moved_m.error());
    motion.sonar_moved_m = *moved_m;
  }
  Result<Odometry> odometry = odometry_of(nav->log, options);
  if (!odometry) {
    return fail(odometry.error().code, fmt::format("{}: {}", fmt::join(command.navs, ", "), odometry.error().message));
  }
  motion.text = odometry->velocity.empty()
                    ? fmt::format("heading of {}, no velocity", on_one_line(odometry->heading))
                    : fmt::format("velocity of {} along the heading of {}", on_one_line(odometry->velocity),
                                  on_one_line(odometry->heading));
  motion.others = NavOthers(nav->log, kMotionQuantities, std::array{odometry->velocity, odometry->heading});
  if (command.localizer.body_from_sonar.matrix().isIdentity(0.0)) {
    const std::string hint = mount_hint(nav->bags, command.logs.front(), command.bag.beams.name);
    if (!hint.empty()) motion.warnings.push_back(hint);
  }
  motion.recorded.odometry_from_body = std::move(odometry->odometry_from_body);
  if (odometry->velocity.empty()) {
    motion.text += ": the vehicle is assumed to move little";
    motion.noise = MotionNoise::turns_only();
  } else {
    motion.recorded.nav = nav->log;
    motion.recorded.nav_options = std::move(options);
  }
  return motion;
}

Result<std::vector<Beam>> read_beams(const LocateCommand& command, std::size_t& skipped) {
  std::vector<Beam> beams;
  for (const std::string& name : command.logs) {
    Result<ByteStream> stream = ByteStream::open(name);
    if (!stream) return tl::unexpected(stream.error());
    const std::string shown = stream->name();
    auto source = open_log(std::move(*stream), command.damage, std::nullopt, command.bag.beams).and_then([&](Log log) {
      return only_beams(std::move(log), shown);
    });
    if (!source) return tl::unexpected(source.error());
    if (!command.navs.empty()) {
      if (const auto has = check_has_times(**source, shown); !has) return tl::unexpected(has.error());
    }
    const std::unique_ptr<BeamSource> ordered = in_order(*std::move(source), shown);
    Result<std::vector<Beam>> read = read_all(*ordered);
    if (!read) return tl::unexpected(read.error());
    skipped += ordered->skipped();
    std::ranges::move(*read, std::back_inserter(beams));
  }
  if (beams.empty()) {
    return fail(Error::Code::kUnsupported, fmt::format("{}: there are no beams", name_of_input(command.logs.front())));
  }
  return beams;
}

Result<OccupancyMap> read_map_file(const std::string& name) {
  const Result<FileBytes> file = read_file(name);
  if (!file) return tl::unexpected(file.error());
  Result<MapFile> map = read_map(*file);
  if (!map) return tl::unexpected(map.error());
  return std::move(map->map);
}

}  // namespace pingvox::app
