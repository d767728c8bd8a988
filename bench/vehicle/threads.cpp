#include "threads.hpp"

#include <chrono>
#include <memory>
#include <optional>
#include <utility>

#include "bench/paired_timing.hpp"
#include "bench/speed/tank_echoes.hpp"
#include "pingvox/analysis/compare.hpp"
#include "pingvox/mapping/build_map.hpp"

namespace pingvox::bench {
namespace {

constexpr double kCell_m = 0.0125;

class OneScan : public ScanSource {
 public:
  explicit OneScan(const PointScan& scan) : scan_(&scan) {}
  Result<std::optional<PointScan>> next() override {
    return scan_ == nullptr ? std::nullopt : std::optional(*std::exchange(scan_, nullptr));
  }

 private:
  const PointScan* scan_;
};

double wall_time_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Result<std::vector<Row>> threads(const BenchOptions&) {
  const Result<TankBundles> bundles = tank_bundles(1);
  if (!bundles) return tl::unexpected(bundles.error());
  PointScan scan;
  for (const Eigen::Vector3f& end_m : bundles->scans.front().ends_m) scan.points_m.push_back(end_m.cast<double>());
  const auto side = [&](std::size_t count, std::unique_ptr<OccupancyMap>& map) {
    return Side{[&map] { map = std::make_unique<OccupancyMap>(MapOptions{.resolution_m = kCell_m}); },
                [&map, &scan, count] {
                  BuildOptions options;
                  options.threads = count;
                  OneScan source(scan);
                  (void)build_map(source, Trajectory::still(Pose::Identity()), options, *map);
                }};
  };
  std::unique_ptr<OccupancyMap> by_one, by_two;
  const Side one = side(1, by_one), two = side(2, by_two);
  for (const Side* each : {&one, &two}) {
    each->prepare();
    each->work();
  }
  const auto compared = compare_maps(*by_one, *by_two, Sameness::kLogOdds);
  if (!compared) return tl::unexpected(compared.error());
  if (!compared->equal()) return fail(Error::Code::kCorrupt, "two threads make another map than one");
  // Wall time, since threads do not save CPU time.
  const PairedTimes result = time_in_pairs(two, one, {.clock_s = &wall_time_s});
  Row row;
  row.add("name", "threads")
      .add_truth("checked", true)
      .add("two_threads_s", result.ours_s)
      .add("one_thread_s", result.peer_s)
      .add("ratio", result.ratio)
      .add("ratio_min", result.ratio_min)
      .add("ratio_max", result.ratio_max)
      .add("input", bundles->input);
  return std::vector{row};
}

}  // namespace pingvox::bench
