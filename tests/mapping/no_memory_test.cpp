// A program of its own: its allocations fail when a test wants them to.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstdarg>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <new>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pingvox/analysis/compare.hpp"
#include "pingvox/map/for_each_leaf.hpp"
#include "pingvox/map/scan_update.hpp"
#include "pingvox/mapping/beam_mapper.hpp"
#include "pingvox/mapping/build_map.hpp"

namespace {

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
std::atomic<std::int64_t> g_made = 0, g_first = kNever, g_last = kNever, g_alive = 0;

/// Whether the allocation that is about to be made has to fail.
bool has_to_fail() {
  const std::int64_t number = ++g_made;
  return number >= g_first && number <= g_last;
}

void* allocate(std::size_t size) {
  void* const place = has_to_fail() ? nullptr : std::malloc(size == 0 ? 1 : size);
  if (place == nullptr) throw std::bad_alloc();
  ++g_alive;
  return place;
}

void release(void* place) {
  if (place == nullptr) return;
  --g_alive;
  std::free(place);
}

}  // namespace

void* operator new(std::size_t size) {
  return allocate(size);
}
void* operator new[](std::size_t size) {
  return allocate(size);
}
void operator delete(void* place) noexcept {
  release(place);
}
void operator delete[](void* place) noexcept {
  release(place);
}
void operator delete(void* place, std::size_t) noexcept {
  release(place);
}
void operator delete[](void* place, std::size_t) noexcept {
  release(place);
}

#if defined(__linux__) && !defined(PINGVOX_SANITIZE_ADDRESS) && !defined(PINGVOX_SANITIZE_THREAD)
// The pools of the tree ask the system itself for room.
extern "C" void* mmap(void* place, std::size_t size, int protection, int flags, int file, off_t offset) noexcept {
  if (has_to_fail()) {
    errno = ENOMEM;
    return MAP_FAILED;
  }
  // NOLINTNEXTLINE(performance-no-int-to-ptr): what the system returns
  return reinterpret_cast<void*>(syscall(SYS_mmap, place, size, protection, flags, file, offset));
}

extern "C" void* mremap(void* place, std::size_t size, std::size_t wanted, int flags, ...) noexcept {
  if (has_to_fail()) {
    errno = ENOMEM;
    return MAP_FAILED;
  }
  // NOLINTNEXTLINE(performance-no-int-to-ptr): what the system returns
  return reinterpret_cast<void*>(syscall(SYS_mremap, place, size, wanted, flags));
}
#endif

namespace pingvox {
namespace {

/// How long memory lacks.
enum class Shortage { kOnce, kFromThenOn };

/// Calls f, whose n-th allocation (counted from 1) fails, and maybe all that follow.
template <class F>
auto with_shortage(std::int64_t n, Shortage shortage, F&& f) {
  g_made = 0;
  g_last = shortage == Shortage::kOnce ? n : kNever;
  g_first = n;
  auto result = f();
  g_first = kNever;
  return result;
}

/// Calls trial(n) for each n until one succeeds.
template <class Trial>
void until_it_succeeds(Trial&& trial) {
  std::int64_t n = 1;
  while (!testing::Test::HasFatalFailure() && !trial(n)) {
    ASSERT_LT(++n, 100'000);
  }
#if defined(PINGVOX_SANITIZE_ADDRESS) || defined(PINGVOX_SANITIZE_THREAD)
  if (n <= 5) GTEST_SKIP() << "the sanitizer keeps mmap to itself, so that the pools' room cannot run out";
#else
  EXPECT_GT(n, 5) << "hardly anything was allocated";
#endif
}

ScanUpdate scan_of_box(const Lattice& lattice, std::uint16_t from, std::uint16_t to) {
  ScanUpdate scan(lattice);
  for (std::uint16_t x = from; x < to; ++x) {
    for (std::uint16_t y = from; y < to; ++y) {
      for (std::uint16_t z = from; z < to; ++z) {
        const Key key{static_cast<std::uint16_t>(x * 3), static_cast<std::uint16_t>(y * 700), z};
        if ((x + y + z) % 3 == 0) {
          scan.add_hit(key, LogOdds(0.1F * static_cast<float>(x % 7 + 1)));
        } else {
          scan.add_miss(key);
        }
      }
    }
  }
  return scan;
}

bool are_equal(const OccupancyMap& a, const OccupancyMap& b) {
  const auto compared = compare_maps(a, b, Sameness::kLogOdds);
  return compared && compared->equal() && a.counts().nodes() == b.counts().nodes();
}

/// Each cell is as in one map or as in the other, and the map is one that a scan can be applied to.
void expect_between(const OccupancyMap& map, const OccupancyMap& before, const OccupancyMap& after) {
  std::size_t neither = 0;
  for_each_leaf(map, [&](const Leaf& leaf) {
    neither += leaf.belief != before.at(leaf.key) && leaf.belief != after.at(leaf.key) ? 1 : 0;
  });
  EXPECT_EQ(neither, 0U);
  OccupancyMap synchronized = map;
  ASSERT_TRUE(synchronized.apply(ScanUpdate(map.lattice())));
  EXPECT_TRUE(are_equal(synchronized, map));
}

/// Whether a change of a map succeeds though its n-th allocation fails. Else it has to say why, and to lose no memory.
template <class Change>
bool succeeds(std::int64_t n, Shortage shortage, OccupancyMap& map, Change&& change) {
  const std::int64_t alive = g_alive;
  const auto code = with_shortage(n, shortage, [&]() -> std::optional<Error::Code> {
    const auto done = change(map);
    return done ? std::nullopt : std::optional(done.error().code);
  });
  EXPECT_EQ(g_alive, alive);
  if (code) {
    EXPECT_EQ(*code, Error::Code::kNoMemory);
  }
  return !code;
}

class NoMemory : public testing::TestWithParam<Shortage> {};

TEST_P(NoMemory, AScanIsTakenInInPartAtMostAndTheMapStaysWhole) {
  OccupancyMap before;
  ASSERT_TRUE(before.apply(scan_of_box(before.lattice(), 2, 9)));
  const ScanUpdate scan = scan_of_box(before.lattice(), 5, 14);
  OccupancyMap after = before;
  ASSERT_TRUE(after.apply(scan));
  const auto change = [&](OccupancyMap& map) { return map.apply(scan); };
  until_it_succeeds([&](std::int64_t n) {
    SCOPED_TRACE(n);
    OccupancyMap map = before;
    const bool is_done = succeeds(n, GetParam(), map, change);
    if (is_done) {
      EXPECT_TRUE(are_equal(map, after));
    } else {
      expect_between(map, before, after);
    }
    return is_done;
  });
}

TEST_P(NoMemory, ABatchIsTakenInInPartAtMost) {
  OccupancyMap before;
  ASSERT_TRUE(before.apply(scan_of_box(before.lattice(), 2, 9)));
  std::vector<Key> keys;
  for (std::uint16_t i = 0; i < 900; ++i) {
    keys.push_back({static_cast<std::uint16_t>(i * 5), static_cast<std::uint16_t>(i % 30 * 700), 7});
  }
  OccupancyMap after = before;
  ASSERT_TRUE(after.update(std::span<const Key>(keys), LogOdds(0.4F)));
  const auto change = [&](OccupancyMap& map) { return map.update(std::span<const Key>(keys), LogOdds(0.4F)); };
  until_it_succeeds([&](std::int64_t n) {
    SCOPED_TRACE(n);
    OccupancyMap map = before;
    const bool is_done = succeeds(n, GetParam(), map, change);
    if (is_done) {
      EXPECT_TRUE(are_equal(map, after));
    } else {
      expect_between(map, before, after);
    }
    return is_done;
  });
}

TEST_P(NoMemory, MapsThatAreNotMergedStayAsTheyWere) {
  OccupancyMap before, other;
  ASSERT_TRUE(before.apply(scan_of_box(before.lattice(), 2, 9)));
  ASSERT_TRUE(other.apply(scan_of_box(other.lattice(), 5, 14)));
  until_it_succeeds([&](std::int64_t n) {
    SCOPED_TRACE(n);
    OccupancyMap map = before;
    const bool is_done = succeeds(n, GetParam(), map, [&](OccupancyMap& changed) { return changed.merge(other); });
    if (!is_done) {
      EXPECT_TRUE(are_equal(map, before));
    }
    return is_done;
  });
}

/// Two turns of 36 beams with a wall at 2 m.
std::vector<Beam> two_turns() {
  std::vector<Beam> beams;
  for (int n = 0; n < 73; ++n) {
    Beam beam{.time_s = 0.1 * n,
              .bearing_rad = 2.0 * std::numbers::pi * (n % 36) / 36.0,
              .bin_length_m = 0.05,
              .intensities = std::vector<std::uint8_t>(60, 4)};
    for (std::size_t i = 40; i < 43; ++i) beam.intensities[i] = 200;
    beams.push_back(std::move(beam));
  }
  return beams;
}

struct Way {
  BeamShape shape;
  Vote vote;
  Timing timing;
  std::size_t threads;
};

// Kills an exception that gets out of a thread or of the mapper, and memory that is lost by the way.
TEST_P(NoMemory, AMapperSaysSoAndThrowsNothing) {
  for (const Way& way : {Way{BeamShape::kRay, Vote::kPerSweep, Timing::kBySweep, 1},
                         Way{BeamShape::kCone, Vote::kPerSweep, Timing::kBySweep, 2},
                         Way{BeamShape::kCone, Vote::kPerBeam, Timing::kByBeam, 1}}) {
    SCOPED_TRACE(static_cast<int>(way.shape) * 100 + static_cast<int>(way.timing) * 10 + static_cast<int>(way.threads));
    BuildOptions options;
    options.filter.filter = Filter::kNone;
    options.echo.threshold = 70;
    options.model.shape = way.shape;
    options.vote = way.vote;
    options.timing = way.timing;
    options.threads = way.threads;
    const std::vector<Beam> beams = two_turns();
    until_it_succeeds([&](std::int64_t n) {
      SCOPED_TRACE(n);
      std::vector<Beam> fresh = beams;
      OccupancyMap map({.resolution_m = 0.2});
      const std::int64_t alive = g_alive;
      std::int64_t gone = 0;  // what the mapper took over
      const auto code = with_shortage(n, GetParam(), [&]() -> std::optional<Error::Code> {
        auto mapper = BeamMapper::make(options, map);
        if (!mapper) return mapper.error().code;
        for (Beam& beam : fresh) {
          ++gone;
          if (const auto added = mapper->add(std::move(beam), Pose::Identity()); !added) return added.error().code;
        }
        if (const auto finished = mapper->finish(); !finished) return finished.error().code;
        return std::nullopt;
      });
      EXPECT_EQ(g_alive, alive - gone);
      EXPECT_EQ(code.value_or(Error::Code::kNoMemory), Error::Code::kNoMemory);
      return !code;
    });
  }
}

// Kills a mapper whose state is half of one sweep and half of another after an error.
TEST(NoMemoryOnce, AMapperGoesOn) {
  BuildOptions options;
  options.model.shape = BeamShape::kRay;
  options.filter.filter = Filter::kNone;
  options.echo.threshold = 70;
  const std::vector<Beam> beams = two_turns();
  OccupancyMap expected;
  {
    auto mapper = BeamMapper::make(options, expected);
    ASSERT_TRUE(mapper);
    for (const Beam& beam : beams) ASSERT_TRUE(mapper->add(beam, Pose::Identity()));
    ASSERT_TRUE(mapper->finish());
  }
  for (std::int64_t n = 1; n < 40; ++n) {
    SCOPED_TRACE(n);
    OccupancyMap map;
    auto mapper = BeamMapper::make(options, map);
    ASSERT_TRUE(mapper);
    std::vector<Beam> fresh = beams;
    const bool failed = with_shortage(n, Shortage::kOnce, [&] {
      for (std::size_t i = 0; i < 20; ++i) {
        if (!mapper->add(std::move(fresh[i]), Pose::Identity())) return true;
      }
      return false;
    });
    ASSERT_TRUE(failed);
    ASSERT_TRUE(map.empty());
    for (const Beam& beam : beams) ASSERT_TRUE(mapper->add(beam, Pose::Identity()));
    ASSERT_TRUE(mapper->finish());
    EXPECT_TRUE(are_equal(map, expected));
  }
}

INSTANTIATE_TEST_SUITE_P(Shortages, NoMemory, testing::Values(Shortage::kOnce, Shortage::kFromThenOn),
                         [](const auto& shortage) {
                           return shortage.param == Shortage::kOnce ? "once" : "from_then_on";
                         });

}  // namespace
}  // namespace pingvox
