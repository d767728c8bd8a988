#include "pingvox/io/g2o.hpp"

#include <gtest/gtest.h>

#include <sstream>

namespace pingvox::test {
namespace {

TEST(G2o, WritesNodesByTheirNumbersAndTheUpperTriangleOfTheInformation) {
  PoseGraph graph;
  graph.nodes = {{7, {{1.5, -2.0}, 0.25}}, {9, {{0.1, 0.0}, -3.0}}};
  Eigen::Matrix3d information;
  information << 4.0, 0.5, 0.25, 0.5, 5.0, -1.0, 0.25, -1.0, 6.0;
  graph.edges = {{1, 0, {{1.0, 2.0}, 0.5}, information}};
  std::ostringstream out;
  ASSERT_TRUE(write_g2o(graph, out));
  EXPECT_EQ(out.str(),
            "VERTEX_SE2 7 1.5 -2 0.25\n"
            "VERTEX_SE2 9 0.1 0 -3\n"
            "EDGE_SE2 9 7 1 2 0.5 4 0.5 0.25 5 -1 6\n");
  out.setstate(std::ios::badbit);
  EXPECT_FALSE(write_g2o(graph, out));
}

}  // namespace
}  // namespace pingvox::test
