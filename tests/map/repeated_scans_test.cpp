#include <gtest/gtest.h>

#include <random>

#include "geometry/internal/tree_order.hpp"
#include "map/map_access.hpp"
#include "pingvox/map/scan_update.hpp"
#include "support/differences.hpp"
#include "support/oracle_map.hpp"
#include "support/rounds.hpp"

namespace pingvox {
namespace {

using test::OracleMap;
using test::OracleScan;

struct Way {
  int depth;
  Parents parents;
  EarlyDrop early_drop;
};

std::vector<Way> all_ways() {
  std::vector<Way> ways;
  for (const int depth : {2, 3, 4, 5, 16, 65}) {
    for (const Parents parents : {Parents::kMax, Parents::kMean}) {
      for (const EarlyDrop early_drop : {EarlyDrop::kOn, EarlyDrop::kOff}) ways.push_back({depth, parents, early_drop});
    }
  }
  return ways;
}

/// The same cells are missed scan after scan until they are as free as can be. In between some more are, some are hit,
/// and some are set to what no evidence leads to.
class RepeatedScans {
 public:
  RepeatedScans(const Way& way, std::uint64_t seed)
      : way_(way),
        random_(seed),
        edge_(std::min<WideWord>(WideWord{1} << way.depth, 20)),
        corner_(way.depth > 5 ? (WideWord{1} << (way.depth - 1)) - 10 : 0),
        map_({.resolution_m = 1.0, .depth = way.depth, .parents = way.parents}),
        oracle_(way.depth, map_.options().clamp),
        turns_round_(seed % 5 == 0) {
    detail::MapAccess::set_early_drop(map_, way.early_drop);
    const bool is_flat = seed % 2 == 0;
    for (WideWord x = 0; x < edge_; ++x) {
      for (WideWord y = 0; y < edge_; ++y) {
        for (WideWord z = 0; z < (is_flat ? 1 : edge_); ++z) {
          if (random_() % (seed % 3 == 0 ? 16 : 2) != 0) usual_.push_back({corner_ + x, corner_ + y, corner_ + z});
        }
      }
    }
  }

  void run() {
    for (int round = 0; round < 12; ++round) {
      SCOPED_TRACE(round);
      // A miss as evidence for something: what was free is occupied in the end.
      if (turns_round_ && round == 4) scan_ = ScanUpdate(map_.lattice(), LogOdds::from_probability(0.7));
      OracleScan expected{scan_.miss(), {usual_.begin(), usual_.end()}, {}};
      if (round % 3 == 2) expected.missed.insert(any_key());
      if (round % 4 == 3) expected.add_hit(any_key(), LogOdds(0.85F));
      if (round % 6 == 5) expected.add_hit(any_key(), LogOdds(-0.3F));
      apply(expected);
      if (round == 7) set_neighbours(usual_[random_() % usual_.size()]);
      ASSERT_EQ(
          test::first_difference(test::nodes_of(map_), oracle_.nodes(way_.parents, OracleMap::Join::kEqualLeaves)), "");
    }
  }

  const OccupancyMap& map() const { return map_; }
  const std::vector<WideKey>& usual() const { return usual_; }

 private:
  WideKey any_key() { return {corner_ + random_() % edge_, corner_ + random_() % edge_, corner_ + random_() % edge_}; }

  void apply(const OracleScan& expected) {
    scan_.clear();
    for (const WideKey& key : expected.missed) scan_.add_miss(key);
    for (const auto& [key, evidence] : expected.hit) scan_.add_hit(key, evidence);
    const auto report = map_.apply(scan_);
    ASSERT_TRUE(report);
    EXPECT_EQ(report->cells_hit, expected.hit.size());
    std::size_t freed = 0;
    for (const WideKey& key : expected.missed) freed += 1 - expected.hit.count(key);
    EXPECT_EQ(report->cells_freed, freed);
    oracle_.apply(expected);
  }

  // As a mean they are as free as can be.
  void set_neighbours(const WideKey& key) {
    set(key, LogOdds(-9.0F));
    set({key.x ^ 1, key.y, key.z}, LogOdds(-1.5F));
  }

  void set(const WideKey& key, LogOdds belief) {
    map_.edit().set(key, way_.depth, belief);
    oracle_.set(key, way_.depth, belief);
  }

  Way way_;
  std::mt19937_64 random_;
  WideWord edge_, corner_;
  OccupancyMap map_;
  OracleMap oracle_;
  bool turns_round_;
  ScanUpdate scan_{map_.lattice(), LogOdds::from_probability(0.2)};
  std::vector<WideKey> usual_;
};

// Kills a brick that is passed by because it looks as free as can be and is not: a cell of it is unknown, another one
// belongs to a wall, a miss is evidence for something, or its parent is a mean. Kills marks of the scan before, too.
TEST(RepeatedScans, GiveWhatEachCellByItselfGives) {
  for (const Way& way : all_ways()) {
    SCOPED_TRACE(testing::Message() << "depth " << way.depth << ", parents " << static_cast<int>(way.parents)
                                    << ", early drop " << static_cast<int>(way.early_drop));
    for (std::uint64_t seed = 1; seed <= test::rounds(6); ++seed) {
      SCOPED_TRACE(seed);
      RepeatedScans scans(way, seed);
      scans.run();
      if (HasFailure()) return;
      const Clamp clamp = scans.map().options().clamp;
      std::size_t clamped = 0;
      for (const WideKey& key : scans.usual())
        clamped += scans.map().at(key) == (seed % 5 == 0 ? clamp.highest : clamp.lowest);
      EXPECT_GE(clamped + 4, scans.usual().size());
    }
  }
}

using Marks = std::map<WideKey, std::optional<float>>;

/// The cells with marks; those that are hit with their evidence.
Marks marks_of(const ScanUpdate& scan) {
  Marks marks;
  for (const std::uint32_t index : scan.pages_in_order()) {
    const ScanUpdate::Page& page = scan.page(index);
    for (std::size_t cell = 0; cell < 4096; ++cell) {
      const std::size_t brick = cell / 64;
      const BasicKey<std::uint64_t> at = detail::key_of_code(cell);
      const bool is_hit = (page.hit[brick] >> (cell % 64) & 1) != 0;
      if (!is_hit && (page.missed[brick] >> (cell % 64) & 1) == 0) continue;
      EXPECT_EQ(page.bricks >> brick & 1, 1U);
      EXPECT_EQ(page.bricks_hit >> brick & 1, page.hit[brick] != 0 ? 1U : 0U);
      std::optional<float> evidence;
      if (is_hit) {
        const ScanUpdate::Hits hits = scan.hits(page, brick);
        evidence = hits.of_cell != nullptr ? hits.of_cell[cell % 64] : hits.all.value();
      }
      const WideKey key{page.lowest.x + at.x, page.lowest.y + at.y, page.lowest.z + at.z};
      EXPECT_TRUE(marks.emplace(key, evidence).second);
    }
  }
  return marks;
}

// Kills a page that is made twice, words of a page that are told at another place, marks that stay in a page for the
// next scan.
TEST(ScanUpdate, WholePagesAndSingleMarksShareTheirPages) {
  ScanUpdate scan(Lattice(1.0));
  std::size_t marks = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    Marks expected;
    for (int part = 0; part < 4; ++part) {
      const WideKey lowest{32'768 + 16 * (random() % 2), 16 * (random() % 3), 65'504};
      const LogOdds evidence(random() % 4 == 0 ? 0.4F : 0.85F);
      const auto key_at = [&](std::uint64_t cell) {
        const BasicKey<std::uint64_t> at = detail::key_of_code(cell);
        return WideKey{lowest.x + at.x, lowest.y + at.y, lowest.z + at.z};
      };
      if (random() % 2 == 0) {
        std::array<std::uint64_t, 64> missed{};
        for (std::uint64_t n = random() % 300; n > 0; --n) {
          const std::uint64_t cell = random() % 4096;
          missed[cell / 64] |= std::uint64_t{1} << (cell % 64);
          expected.emplace(key_at(cell), std::nullopt);
        }
        const std::uint32_t page = scan.page_of(lowest);
        scan.mark_missed_in(page, missed);
        for (std::uint64_t n = random() % 20; n > 0; --n) {
          const std::uint64_t cell = random() % 4096;
          scan.mark_hit_in(page, cell / 64, std::uint64_t{1} << (cell % 64), evidence);
          std::optional<float>& greatest = expected[key_at(cell)];
          greatest = std::max(greatest.value_or(evidence.value()), evidence.value());
        }
      } else {
        for (std::uint64_t n = random() % 100; n > 0; --n) {
          const WideKey key = key_at(random() % 4096);
          scan.add_miss(key);
          expected.emplace(key, std::nullopt);
        }
      }
      if (part == 2) {
        ScanUpdate sum(scan.lattice());
        sum.add(scan);
        sum.add(scan);
        ASSERT_EQ(marks_of(sum), expected);
      }
    }
    ASSERT_EQ(marks_of(scan), expected);
    marks += expected.size();
    scan.clear();
    ASSERT_TRUE(marks_of(scan).empty());
  }
  EXPECT_GT(marks, 20'000U);
}

}  // namespace
}  // namespace pingvox
