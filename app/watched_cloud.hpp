#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "pingvox/geometry/lattice.hpp"
#include "pingvox/map/point_scan.hpp"

namespace pingvox::app {

/// A cloud on its way to the map, which notes how far its points are from where they were seen: a cloud far from 0, 0,
/// 0 needs --origin. Rays that would take all memory are an error that says so.
class WatchedCloud final : public ScanSource {
 public:
  /// @param lattice  of the map
  WatchedCloud(std::unique_ptr<ScanSource> source, double max_range_m, const Lattice& lattice)
      : source_(std::move(source)), max_range_m_(max_range_m), lattice_(lattice) {}

  Result<std::optional<PointScan>> next() override;
  std::size_t skipped() const override { return source_->skipped(); }
  std::string first_damage() const override { return source_->first_damage(); }
  std::optional<double> share_read() const override { return source_->share_read(); }

  /// "seen from 0, 0, 0, 4130 km away: --origin is where a cloud was seen from". REQUIRES points.
  std::string origin_text() const;
  /// Whether the points are so far away for their extent that they were hardly seen from there.
  bool is_far() const;

 private:
  std::unique_ptr<ScanSource> source_;
  double max_range_m_;
  Lattice lattice_;
  Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero();
  std::size_t points_ = 0;
  double nearest_m_ = 0.0;  ///< to the origin
  double extent_m_ = 0.0;   ///< diagonal of the box around the points
};

}  // namespace pingvox::app
