#include "pingvox/io/g2o.hpp"

#include <fmt/format.h>

namespace pingvox {

Result<void> write_g2o(const PoseGraph& graph, std::ostream& out) {
  for (const auto& [number, pose] : graph.nodes) {
    out << fmt::format("VERTEX_SE2 {} {} {} {}\n", number, pose.place_m.x(), pose.place_m.y(), pose.yaw_rad);
  }
  for (const auto& [a, b, a_from_b, information] : graph.edges) {
    const Eigen::Matrix3d& i = information;
    out << fmt::format("EDGE_SE2 {} {} {} {} {} {} {} {} {} {} {}\n", graph.nodes[a].number, graph.nodes[b].number,
                       a_from_b.place_m.x(), a_from_b.place_m.y(), a_from_b.yaw_rad, i(0, 0), i(0, 1), i(0, 2), i(1, 1),
                       i(1, 2), i(2, 2));
  }
  if (!out.flush()) return fail(Error::Code::kIo, "the graph could not be written");
  return {};
}

}  // namespace pingvox
