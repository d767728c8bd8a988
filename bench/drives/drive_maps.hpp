#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "accuracy/ground_truth.hpp"
#include "drives/drive.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sim/scene.hpp"
#include "report.hpp"

namespace pingvox::bench {

/// Judges maps of one simulated drive by the ground truth of its world.
class DriveMaps {
 public:
  /// @param drive  of `scene`; has to outlive this
  static Result<DriveMaps> make(std::string_view world, const Scene& scene, const Drive& drive, std::uint64_t seed,
                                double cell_m);

  /// A row for the map of each beam shape along a trajectory, which is turned and shifted onto the true one first: a
  /// trajectory's frame is its own. @param body_from_sonar  that goes with the trajectory
  Result<std::vector<Row>> judge(std::string_view method, const Trajectory& trajectory,
                                 const Pose& body_from_sonar) const;

 private:
  DriveMaps(std::string_view world, const Drive& drive, std::uint64_t seed, double cell_m, GroundTruth truth)
      : world_(world), drive_(&drive), seed_(seed), cell_m_(cell_m), truth_(std::move(truth)) {}
  std::string_view world_;
  const Drive* drive_;
  std::uint64_t seed_;
  double cell_m_;
  GroundTruth truth_;
};

/// A map of a drive whose poses were some metres off is rebuilt along the true trajectory: the time. It has to be the
/// map of build_map to the bit.
Result<Row> rebuild_map(std::string_view world, const Drive& drive, BeamShape shape, double cell_m);

}  // namespace pingvox::bench
