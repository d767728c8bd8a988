#include "pingvox/map/trace_ray.hpp"

#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "geometry/internal/ray_dda.hpp"
#include "pingvox/map/scan_update.hpp"
#include "support/random_segments.hpp"
#include "support/scan_cells.hpp"

using namespace pingvox;
using test::metres;
using test::RandomSegments;

namespace {

TEST(TraceRay, MarksTheCellsThatTheDdaWalksOver) {
  std::size_t marked = 0;
  // Short and long rays, shallow and deep lattices.
  for (const auto& [depth, reach, count] : std::vector<std::tuple<int, std::int64_t, int>>{
           {3, 3, 2'000}, {8, 100, 2'000}, {16, 400, 500}, {16, 30'000, 3}, {21, 1'000, 100}, {22, 300, 100}}) {
    const Lattice lattice(0.25, depth);
    RandomSegments segments(static_cast<std::uint64_t>(depth), reach);
    ScanUpdate scan(lattice);
    for (int i = 0; i < count; ++i) {
      SCOPED_TRACE(testing::Message() << depth << " levels, reach " << reach << ", segment " << i);
      const auto [from, to] = segments.next();
      const Eigen::Vector3d from_m = metres(from, 0.25), to_m = metres(to, 0.25);
      std::map<WideKey, bool> walked;
      const auto ray = dda<WideWord>(lattice, from_m, to_m);
      ASSERT_TRUE(ray);
      for (const WideKey& key : *ray) walked.emplace(key, false);
      scan.clear();
      ASSERT_TRUE(trace_ray(from_m, to_m, RayAlgorithm::kDda, scan));
      ASSERT_TRUE(test::cells_of(scan) == walked);
      marked += walked.size();
    }
  }
  EXPECT_GT(marked, 400'000U);
}

}  // namespace
