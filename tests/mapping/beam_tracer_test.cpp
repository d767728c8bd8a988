#include "mapping/internal/beam_tracer.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <map>
#include <random>
#include <vector>

#include "pingvox/geometry/degree.hpp"
#include "support/uniform.hpp"
#include "tests/support/scan_cells.hpp"

namespace pingvox {
namespace {

using test::uniform;

using HitCells = std::map<WideKey, float>;

/// The hits of a scan and their evidence.
HitCells hits_in(const ScanUpdate& scan) {
  HitCells hits;
  for (const std::uint32_t index : scan.pages_in_order()) {
    const ScanUpdate::Page& page = scan.page(index);
    for (unsigned n = 0; n < 4096; ++n) {
      const WideKey key{page.lowest.x + n / 256, page.lowest.y + n / 16 % 16, page.lowest.z + n % 16};
      const std::size_t cell = ScanUpdate::cell_in_page(key);
      if ((page.hit[cell / 64] >> (cell % 64) & 1) == 0) continue;
      const ScanUpdate::Hits evidence = scan.hits(page, cell / 64);
      hits[key] = evidence.of_cell == nullptr ? evidence.all.value() : evidence.of_cell[cell % 64];
    }
  }
  return hits;
}

// Kills evidence of another ray than the strongest one, an end in the cell beside it, elevations kept for another
// number of rays, and the places of one lattice taken for those of another.
TEST(BeamTracer, HitsAreTheStrongestOfTheRaysThatEndInACell) {
  std::size_t hits = 0, outside = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    // From three levels, of which a page is more than all, to more than a word has bits; some beams leave the lattice.
    constexpr std::array<int, 7> kDepths{3, 6, 8, 16, 32, 64, 100};
    const Lattice lattice(uniform(random, 0.02, 0.08), kDepths[seed % kDepths.size()]);
    const Pose map_from_sensor =
        pose_from_rpy({uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)}, uniform(random, -3, 3),
                      uniform(random, -1.5, 1.5), uniform(random, -3, 3));
    BeamModelOptions options;
    options.shape = seed % 5 == 0 ? BeamShape::kFan : (seed % 6 == 0 ? BeamShape::kRay : BeamShape::kCone);
    options.width_rad = uniform(random, 0.1, 10) * kDegree_rad;
    options.height_rad = uniform(random, 1, 60) * kDegree_rad;
    BeamTracer tracer(options);
    for (int n = 0; n < 8; ++n) {
      // The second half takes the same numbers of rays again; one has more than are kept.
      const double range = n == 3 ? 12.0 : 0.2 + 0.5 * (n % 4);
      Beam beam;
      beam.bearing_rad = uniform(random, -7, 7);
      Echo echo;
      echo.range_m = range;
      echo.intensity = static_cast<std::uint8_t>(random());
      ScanUpdate scan(lattice);
      const std::size_t left_out = tracer.trace(map_from_sensor, beam, echo, scan);

      HitCells expected;
      std::size_t expected_out = 0;
      const LogOdds evidence = evidence_of_intensity(echo.intensity, options.hit);
      for (const BundleRay& ray : beam_bundle(options, beam.bearing_rad, range, lattice.resolution_m())) {
        const auto key = lattice.key_of<WideWord>(map_from_sensor * (ray.direction * range));
        expected_out += !key;
        if (!key) continue;
        const float share = evidence.value() * static_cast<float>(ray.share);
        const auto [at, is_new] = expected.emplace(*key, share);
        if (!is_new) at->second = std::max(at->second, share);
      }
      EXPECT_EQ(hits_in(scan), expected);
      EXPECT_EQ(left_out, expected_out);
      hits += expected.size();
      outside += expected_out;
    }
  }
  EXPECT_GT(hits, 10'000U);
  EXPECT_GT(outside, 1000U);
}

// Kills a ray that begins at another beam's pose, a beam that is left out under another one's number, silent beams that
// shift the numbers of those behind them, and marks that stay for the next scan.
TEST(BeamTracer, BeamsOfAScanAreTracedAsEachByItself) {
  std::size_t cells = 0, outside = 0;
  for (const BeamShape shape : {BeamShape::kRay, BeamShape::kFan, BeamShape::kCone}) {
    BeamModelOptions options;
    options.shape = shape;
    BeamTracer tracer(options);
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", shape " << static_cast<int>(shape));
      std::mt19937_64 random(seed);
      const Lattice lattice(0.1, seed % 2 == 0 ? 6 : 16);  // the smaller one ends at 3.2 m
      std::vector<PlacedBeam> beams(40);
      for (PlacedBeam& beam : beams) {
        beam.map_from_sensor =
            pose_from_rpy({uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)},
                          uniform(random, -3, 3), uniform(random, -1.5, 1.5), uniform(random, -3, 3));
        beam.bearing_rad = uniform(random, -3, 3);
        beam.bin_length_m = 0.05;
        beam.bins = 80;
        if (random() % 4 == 0) continue;  // silent
        beam.echo.emplace();
        beam.echo->first = random() % 80;
        beam.echo->range_m = 0.05 * static_cast<double>(beam.echo->first) + 0.02;
        beam.echo->intensity = static_cast<std::uint8_t>(random());
      }
      ScanUpdate together(lattice), one_by_one(lattice);
      std::vector<std::size_t> expected;
      for (const PlacedBeam& beam : beams) {
        const Beam alone{0.0, beam.bearing_rad, beam.bin_length_m, std::vector<std::uint8_t>(beam.bins)};
        expected.push_back(trace_beam(beam.map_from_sensor, alone, beam.echo, options, one_by_one));
        outside += expected.back() > 0;
      }
      EXPECT_EQ(tracer.trace(beams, together), expected);
      EXPECT_EQ(test::cells_of(together), test::cells_of(one_by_one));
      EXPECT_EQ(hits_in(together), hits_in(one_by_one));
      cells += test::cells_of(together).size();
    }
  }
  EXPECT_GT(cells, 50'000U);
  EXPECT_GT(outside, 50U);
}

}  // namespace
}  // namespace pingvox
