#include "pingvox/recording/vehicle_path.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "base/words.hpp"
#include "nav/internal/upright.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/tum.hpp"
#include "pingvox/nav/nav_trajectory.hpp"
#include "pingvox/nav/trajectory_steps.hpp"
#include "pingvox/slam/odometry.hpp"

namespace pingvox {
namespace {

bool has(const NavLog& nav, NavQuantity quantity) {
  return nav.best(quantity) != nullptr;
}

/// What a log has and was not used: "; not taken: /aruco/pose (580 samples: ...) (nav_sources takes one)"
std::string unused_text(const NavLog& nav) {
  std::vector<std::string> taken;
  for (const NavSource& source : nav.sources()) {
    const bool is_taken = std::ranges::none_of(nav.sources(), [&](const NavSource& other) {
      return other.name == source.name && other.subject == NavSubject::kOther;
    });
    if (is_taken) taken.push_back(source.name);
  }
  constexpr std::array kAll = {NavQuantity::kPosition, NavQuantity::kFix, NavQuantity::kAttitude, NavQuantity::kHeading,
                               NavQuantity::kVelocity};
  const std::string others = text_of(other_sources(nav, kAll, taken));
  return others.empty() ? "" : fmt::format("; not taken: {} (nav_sources takes one)", others);
}

std::string unused_text(const NavFiles& nav) {
  std::string text = unused_text(nav.log);
  for (const auto& [file, note] : nav.left_out) text += fmt::format("; {}: {}", file, on_one_line(note));
  for (const auto& [file, note] : nav.not_joined) text += fmt::format("; {}: {}", file, on_one_line(note));
  return text;
}

/// How the frame of a position was read.
std::string frame_note_of(const NavLog& nav, const std::string& position) {
  for (const NavSource& source : nav.sources()) {
    if (source.name == position && source.quantity == NavQuantity::kPosition) return source.note;
  }
  return {};
}

VehiclePath::Nav sources_of(const NavTrajectory& made, const NavLog& nav) {
  std::vector<NavQuantity> quantities(kPathQuantities.begin(), kPathQuantities.end());
  if (made.origin_fix) quantities.push_back(NavQuantity::kDepth);
  if (made.origin_fix && made.depth.empty()) quantities.push_back(NavQuantity::kPressure);
  return {.attitude = made.attitude,
          .position = made.position,
          .origin_fix = made.origin_fix,
          .others = other_sources(nav, quantities, std::array{made.attitude, made.position, made.depth}),
          .depth = made.depth,
          .frame_note = frame_note_of(nav, made.position)};
}

Error named(const std::string& name, Error error) {
  error.message = fmt::format("{}: {}", name, error.message);
  return error;
}

Result<VehiclePath> reckon(const NavFiles& nav, const std::string& names, double offset_s,
                           const std::optional<CalibrationFile>& calibration) {
  OdometryOptions options{.body_from_source = {}, .offset_s = offset_s};
  Eigen::Vector3d sonar_moved_m = Eigen::Vector3d::Zero();
  if (calibration) {
    options.body_from_source = calibration->body_from_source;
    options.calibration = calibration->calibration;
    sonar_moved_m = sonar_moved_by(calibration->calibration);
  }
  Result<Odometry> odometry = odometry_of(nav.log, options);
  if (!odometry) {
    Error error = named(names, odometry.error());
    error.message += unused_text(nav);
    return tl::unexpected(std::move(error));
  }
  VehiclePath::Nav by{
      .attitude = odometry->heading,
      .position = {},
      .velocity = odometry->velocity,
      .others = other_sources(nav.log, kMotionQuantities, std::array{odometry->heading, odometry->velocity})};
  return VehiclePath{std::move(odometry->odometry_from_body), std::move(by), sonar_moved_m};
}

}  // namespace

VehiclePath still_path() {
  return {.trajectory = Trajectory::still(Pose::Identity())};
}

Result<Trajectory> read_trajectory(const InputFile& file) {
  const Result<FileBytes> bytes = file.open().and_then(ByteStream::whole);
  if (!bytes) return tl::unexpected(bytes.error());
  Result<Trajectory> trajectory = read_tum(*bytes);
  if (trajectory) return trajectory;
  // A damaged trajectory may look like points as text.
  const std::optional<Format> format = format_of(bytes->view());
  if (!format || *format == Format::kTum || *format == Format::kXyz) return trajectory;
  return fail(Error::Code::kUnsupported,
              fmt::format("{}: is {}, not a trajectory", bytes->name, description_of(*format)));
}

Result<VehiclePath> read_path(const InputFile& file) {
  return read_trajectory(file).and_then([&](const Trajectory& trajectory) -> Result<VehiclePath> {
    std::string doubt;
    for (const NavSource& source : sources_of_poses(trajectory)) {
      if (!source.fault.empty()) return fail(Error::Code::kCorrupt, fmt::format("{}: {}", file.name(), source.fault));
      if (!source.doubt.empty()) doubt += (doubt.empty() ? "" : "; ") + source.doubt;
    }
    CutTrajectory cut = cut_at_steps(trajectory);
    return VehiclePath{
        .trajectory = std::move(cut.trajectory), .steps = std::move(cut.steps), .doubt = std::move(doubt)};
  });
}

bool has_position(const NavLog& nav) {
  return has(nav, NavQuantity::kPosition) || has(nav, NavQuantity::kFix);
}

bool has_turns(const NavLog& nav) {
  return has(nav, NavQuantity::kAttitude) || has(nav, NavQuantity::kHeading) || has(nav, NavQuantity::kTurnRate);
}

bool tells_path(const NavLog& nav) {
  return has(nav, has_position(nav) ? NavQuantity::kAttitude : NavQuantity::kVelocity);
}

Result<VehiclePath> path_of(const NavFiles& nav, const std::string& names, double offset_s,
                            const std::optional<CalibrationFile>& calibration) {
  if (!tells_path(nav.log)) {
    if (const std::string faults = faults_text(nav.log); !faults.empty()) {
      return fail(Error::Code::kCorrupt, fmt::format("{}: {}", names, faults));
    }
    return fail(Error::Code::kUnsupported,
                fmt::format("{}: gives no path: it has no valid {}{}{}", names,
                            has_position(nav.log) ? "attitude" : "position or velocity",
                            has_turns(nav.log) ? "" : ", and no heading; another log may have them", unused_text(nav)));
  }
  if (!has_position(nav.log)) return reckon(nav, names, offset_s, calibration);
  if (calibration) {
    return fail(Error::Code::kBadOption,
                "calibration: has no effect where the navigation has positions, only on dead reckoning by velocity and "
                "heading");
  }
  return nav_trajectory(nav.log, offset_s)
      .map([&](NavTrajectory made) {
        VehiclePath::Nav by = sources_of(made, nav.log);
        return VehiclePath{std::move(made.trajectory), std::move(by)};
      })
      .map_error([&](const Error& error) { return named(names, error); });
}

Result<VehiclePath> positions_of(const BagContents& contents, const std::string& name,
                                 std::span<const NamedSource> chosen) {
  Result<NavLog> log = contents.nav.log;
  if (!chosen.empty()) log = choose_sources(contents.nav.log, chosen);
  if (!log) return fail(log.error().code, fmt::format("{}: nav_sources: {}", name, log.error().message));
  constexpr std::array kOfTurns = {NavQuantity::kAttitude};
  if (const auto checked = check_sources(*log, kOfTurns); !checked) return tl::unexpected(named(name, checked.error()));
  Result<NavTrajectory> made = has(*log, NavQuantity::kAttitude) ? nav_trajectory(*log) : nav_positions(*log);
  if (!made) {
    std::string notes;
    for (const std::string& note : contents.notes) notes += "; " + on_one_line(note);
    return fail(made.error().code, fmt::format("{}: {}{}{}", name, made.error().message, unused_text(*log), notes));
  }
  VehiclePath::Nav by = sources_of(*made, *log);
  return VehiclePath{std::move(made->trajectory), std::move(by)};
}

}  // namespace pingvox
