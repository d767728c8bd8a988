#pragma once

#include "pingvox/slam/pose_graph.hpp"
#include "slam/least_squares/normal_equations.hpp"

namespace pingvox {

/// How much a loop counts, by Cauchy's function: 0..1.
double loop_weight(const PoseEdge& edge, const Pose2& a, const Pose2& b);

/// Adds an edge between knots `a` and `b` with a weight. REQUIRES equations that were made with this pair.
void add_edge(const PoseEdge& edge, const Pose2& a, const Pose2& b, double weight, NormalEquations& equations);
/// The same of an edge whose `b` stays where it is.
void add_edge_to_fixed(const PoseEdge& edge, const Pose2& a, const Pose2& b, double weight, NormalEquations& equations);

}  // namespace pingvox
