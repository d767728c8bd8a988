#include "tank_beams.hpp"

#include <filesystem>
#include <memory>
#include <utility>

#include "pingvox/io/beams.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/sim/scene.hpp"
#include "pingvox/sim/sonar.hpp"

namespace pingvox::bench {
namespace {

Result<TankBeams> all_of(std::string input, BeamSource& source) {
  Result<std::vector<Beam>> beams = read_all(source);
  if (!beams) return tl::unexpected(beams.error());
  return TankBeams{std::move(input), std::move(*beams)};
}

}  // namespace

Result<TankBeams> tank_beams() {
  const std::filesystem::path recording =
      std::filesystem::path(PINGVOX_SHARED_DATA) / "tank-static-mat/dataset_static.mat";
  if (std::filesystem::exists(recording)) {
    auto file = read_file(recording.string());
    if (!file) return tl::unexpected(file.error());
    const auto beams = open_beams(std::move(*file));
    if (!beams) return tl::unexpected(beams.error());
    return all_of("recording", **beams);
  }
  SonarSimulator simulator(tank_scene({}).world, Trajectory::still(Pose::Identity()), {}, 28);
  return all_of("simulated", simulator);
}

}  // namespace pingvox::bench
