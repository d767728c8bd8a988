#pragma once

#include <fmt/core.h>

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "pingvox/web/scene.hpp"

namespace pingvox::web {

/// Collects points, and thins them to as many as are shown.
class PointCollector {
 public:
  void add(const Eigen::Vector3d& point_m) {
    if (seen_++ % each_ != 0) return;
    points_m_.push_back(point_m);
    if (points_m_.size() <= kMaxPoints) return;
    for (std::size_t i = 0; 2 * i < points_m_.size(); ++i) points_m_[i] = points_m_[2 * i];
    points_m_.resize((points_m_.size() + 1) / 2);
    each_ *= 2;
  }

  void finish(const std::string& name, Scene& scene) {
    if (points_m_.empty()) return;
    if (each_ > 1) scene.notes.push_back(fmt::format("{}: one of {} of its {} points is shown", name, each_, seen_));
    scene.points.push_back({name, std::move(points_m_)});
  }

 private:
  std::vector<Eigen::Vector3d> points_m_;
  std::size_t seen_ = 0, each_ = 1;
};

}  // namespace pingvox::web
