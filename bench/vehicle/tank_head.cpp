#include "tank_head.hpp"

#include <cstdint>
#include <map>
#include <numbers>
#include <vector>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/sim/scene.hpp"
#include "pingvox/sim/sonar.hpp"

namespace pingvox::bench {

Ping360Emulator::Hear hear_in_tank() {
  return [scene = tank_scene({}), known = std::map<int, std::vector<std::uint8_t>>()](int angle_grad, std::size_t bins,
                                                                                      double bin_length_m) mutable {
    std::vector<std::uint8_t>& heard = known[angle_grad];
    if (heard.size() == bins) return heard;
    SonarOptions sonar;
    sonar.seed = static_cast<std::uint64_t>(angle_grad) + 1;
    sonar.bins = bins;
    sonar.bin_length_m = bin_length_m;
    sonar.beam_width_rad = 2.0 * kDegree_rad;
    sonar.beam_height_rad = 25.0 * kDegree_rad;
    sonar.silent = 0.0;
    sonar.body_from_sensor =
        pose_from_rpy(Eigen::Vector3d::Zero(), 0.0, 0.0, (200.0 - angle_grad) * std::numbers::pi / 200.0);
    SonarSimulator simulator(scene.world, Trajectory::still(Pose::Identity()), sonar, 1);
    if (const auto beam = simulator.next(); beam && *beam) heard = (*beam)->intensities;
    heard.resize(bins);
    return heard;
  };
}

}  // namespace pingvox::bench
