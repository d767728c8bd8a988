#include <array>

#include "accuracy/accuracy.hpp"
#include "bench.hpp"
#include "drives/locate.hpp"
#include "drives/on_board.hpp"
#include "drives/slam.hpp"
#include "paper/bits.hpp"
#include "paper/bytes.hpp"
#include "paper/early_drop.hpp"
#include "paper/echoes.hpp"
#include "paper/figures.hpp"
#include "paper/key_width.hpp"
#include "paper/maps.hpp"
#include "paper/paper.hpp"
#include "paper/parents.hpp"
#include "paper/rays.hpp"
#include "paper/table_1.hpp"
#include "speed/command.hpp"
#include "speed/cone.hpp"
#include "speed/cube.hpp"
#include "speed/map_files.hpp"
#include "speed/memory.hpp"
#include "speed/points.hpp"
#include "speed/queries.hpp"
#include "speed/rays.hpp"
#include "speed/scans.hpp"
#include "vehicle/day.hpp"
#include "vehicle/growth.hpp"
#include "vehicle/live.hpp"
#include "vehicle/log_reading.hpp"
#include "vehicle/merge.hpp"
#include "vehicle/realtime.hpp"
#include "vehicle/startup.hpp"
#include "vehicle/threads.hpp"

namespace pingvox::bench {

std::span<const Bench> benches() {
  static constexpr std::array kBenches = {
      Bench{"cube-each", "the paper's cube, parents right and pruned after each update", Family::kSpeed, &cube_each},
      Bench{"cube-lazy", "the paper's cube as one batch, parents updated and pruned at its end", Family::kSpeed,
            &cube_lazy},
      Bench{"points-5000", "a million points far apart, one update each", Family::kSpeed, &points_5000},
      Bench{"points-50", "the same a hundred times as near to each other", Family::kSpeed, &points_50},
      Bench{"points-5", "the same in so few cells that most updates change nothing", Family::kSpeed, &points_5},
      Bench{"tank-2d", "28 sweeps in a tank, each beam a ray, cells of 1.25 cm", Family::kSpeed, &tank_2d},
      Bench{"tank-3d", "3 sweeps, each beam a bundle of 32 x 64 rays, cells of 5 cm", Family::kSpeed, &tank_3d},
      Bench{"tank-3d-cells", "the same, end points made cells first", Family::kSpeed, &tank_3d_cells},
      Bench{"tank-fine", "one sweep of bundles in cells of 1.25 cm", Family::kSpeed, &tank_fine},
      Bench{"tank-cone", "3 sweeps, each beam a cone by geometry against a bundle of rays", Family::kSpeed, &tank_cone},
      Bench{"multibeam", "300 pings of 256 beams over a seabed, cells of 10 cm", Family::kSpeed, &multibeam},
      Bench{"lidar-16", "4 turns of 16 x 1800 rays in a harbour, cells of 10 cm", Family::kSpeed, &lidar_16},
      Bench{"lidar-128", "1 turn of 128 x 1024 rays, the same cells", Family::kSpeed, &lidar_128},
      Bench{"rays", "131,072 random rays made keys", Family::kSpeed, &rays},
      Bench{"look-up", "what a million keys are in the map of tank-3d", Family::kSpeed, &look_up},
      Bench{"cast-ray", "what 100,000 rays hit in the map of tank-3d", Family::kSpeed, &cast_rays},
      Bench{"leaves", "once over all leaves of the map of tank-3d", Family::kSpeed, &leaves},
      Bench{"bt-write", "the map of tank-3d as .bt, to memory", Family::kSpeed, &bt_write},
      Bench{"bt-read", "the same from memory", Family::kSpeed, &bt_read},
      Bench{"memory", "what the map of tank-3d takes in memory", Family::kSpeed, &memory},
      Bench{"command", "a million points in 20 scans: pingvox map against graph2tree", Family::kSpeed, &command},
      Bench{"realtime", "the tank recording beam by beam: time until each is in the map", Family::kVehicle, &realtime},
      Bench{"live", "beams of a Ping360 at a socket: time from the last byte of each until the mapper is done with it",
            Family::kVehicle, &live},
      Bench{"day", "24 hours of a Ping360 at a socket, in accelerated time: beams and memory", Family::kVehicle, &day},
      Bench{"growth", "an ever larger map, up to 100 million cells: time of a small scan", Family::kVehicle, &growth},
      Bench{"merge", "a map of ten million cells added to another one: as it is, moved, in larger cells",
            Family::kVehicle, &merge},
      Bench{"threads", "the bundles of tank-fine by two threads against one", Family::kVehicle, &threads},
      Bench{"log-reading", "sonar logs from memory to beams, megabytes a second", Family::kVehicle, &log_reading},
      Bench{"startup", "pingvox info of a small map, from start to end", Family::kVehicle, &startup},
      Bench{"accuracy", "echoes and maps of simulated recordings, compared with ground truth", Family::kAccuracy,
            &accuracy},
      Bench{"slam", "trajectories of slam, compared with where the vehicle was", Family::kAccuracy, &slam},
      Bench{"slam-on-board", "the recorded marina at 20 times its speed through what live --slam runs",
            Family::kAccuracy, &slam_on_board},
      Bench{"locate", "where locate finds a vehicle in a map, compared with where it was", Family::kAccuracy, &locate},
      Bench{"paper", "what the paper says and what we get, all of it; with --pictures its figures", Family::kPaper,
            &paper},
      Bench{"paper-maps", "section 3: grid, lines and octree, and how well a vehicle is followed in each",
            Family::kPaper, &paper_maps},
      Bench{"paper-keys", "section 5.1: keys of 8 to 128 bits", Family::kPaper, &paper_key_width},
      Bench{"paper-drop", "figure 8: updates dropped early, by density", Family::kPaper, &paper_early_drop},
      Bench{"paper-parents", "section 5.3.1: max and mean, seen by a planner", Family::kPaper, &paper_parents},
      Bench{"paper-table-1", "table 1: nodes and times of the cube", Family::kPaper, &paper_table_1},
      Bench{"paper-bytes", "section 5.6: bytes of the pruned cube", Family::kPaper, &paper_bytes},
      Bench{"paper-rays", "figures 9 to 12: DDA and Bresenham against exact arithmetic", Family::kPaper, &paper_rays},
      Bench{"paper-bits", "section 7: the bits of a .bt file", Family::kPaper, &paper_bits},
      Bench{"paper-smooth", "figures 13 to 16: echoes after each filter", Family::kPaper, &paper_smoothing},
      Bench{"paper-edges", "figures 17 to 20: thresholds, falling edges, silent beams", Family::kPaper,
            &paper_thresholds},
      Bench{"paper-canny", "figure 21", Family::kPaper, &paper_canny},
      Bench{"paper-figures", "the figures only, into --pictures DIR", Family::kPaper, &paper_figures},
  };
  return kBenches;
}

}  // namespace pingvox::bench
