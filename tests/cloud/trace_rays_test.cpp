#include "cloud/internal/trace_rays.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "support/scan_cells.hpp"
#include "support/uniform.hpp"

namespace pingvox {
namespace {

using test::uniform;

// Kills rays that begin where another one does (also of another block), a window that leaves out some of the
// beginnings, rays that are left out under another one's number, marks of one scan that come with the next, and a ray
// along Bresenham's cells that is walked by DDA.
TEST(RayTracer, MarksWhatTraceRayMarks) {
  std::size_t cells = 0, left_out = 0;
  for (const RayAlgorithm algorithm : {RayAlgorithm::kDda, RayAlgorithm::kBresenham}) {
    RayTracer tracer(algorithm);  // for all scans: its memory is kept
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
      SCOPED_TRACE(seed);
      std::mt19937_64 random(seed);
      // Of the small lattice parts are outside; of the one of four levels a page is more than all.
      const Lattice lattice(0.1, std::array{4, 6, 16, 40}[seed % 4]);
      const auto point = [&](double reach_m) {
        return Eigen::Vector3d(uniform(random, -reach_m, reach_m), uniform(random, -reach_m, reach_m),
                               uniform(random, -reach_m, reach_m));
      };
      const double way_m = seed % 3 == 0 ? 0.0 : 3.0;  // the head's own
      std::vector<Eigen::Vector3d> from_m, to_m;
      // Now and then more rays than are prepared together.
      for (auto n = seed % 20 == 2 ? 1200 : random() % 60; n > 0; --n) {
        from_m.push_back(point(way_m));
        to_m.push_back(from_m.back() + point(4.0));
      }
      if (seed % 5 == 0) {
        from_m.emplace_back(0.0, 0.0, 0.0);
        to_m.emplace_back(std::nan(""), 0.0, 0.0);
      }
      if (seed % 7 == 0) {
        from_m.emplace_back(0.0, std::numeric_limits<double>::infinity(), 0.0);
        to_m.emplace_back(0.0, 0.0, 0.0);
      }
      ScanUpdate one_by_one(lattice), together(lattice);
      std::vector<std::size_t> expected;
      for (std::size_t i = 0; i < to_m.size(); ++i) {
        if (!trace_ray(from_m[i], to_m[i], algorithm, one_by_one)) expected.push_back(i);
      }
      EXPECT_EQ(tracer.trace(from_m, to_m, together), expected);
      EXPECT_EQ(test::cells_of(together), test::cells_of(one_by_one));
      cells += test::cells_of(together).size();
      left_out += expected.size();
    }
  }
  EXPECT_GT(cells, 50'000U);
  EXPECT_GT(left_out, 300U);
}

}  // namespace
}  // namespace pingvox
