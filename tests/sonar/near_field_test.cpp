// Walls whose echo begins within the blanking range, ringing that goes on beyond it, and speckle in it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/filters.hpp"
#include "support/rounds.hpp"
#include "support/uniform.hpp"

namespace pingvox {
namespace {

constexpr double kBin_m = 0.025;
constexpr std::size_t kBinsOfNearField = 200;

/// What one beam hears, in units of full scale, to be sampled at a gain.
class Heard {
 public:
  /// Ringing that decays to a third in `decay_m`.
  void add_ringing(double amplitude, double decay_m) {
    for (std::size_t i = 0; i < kBinsOfNearField; ++i) bins_[i] += amplitude * std::exp(-range_of(i) / decay_m);
  }
  /// An echo that rises from `begin_m` to two thirds in 0.1 m, then slowly to its crest, and fades within `fade_m`.
  void add_echo(double begin_m, double crest_m, double fade_m, double amplitude) {
    for (std::size_t i = 0; i < kBinsOfNearField; ++i) {
      const double range_m = range_of(i);
      if (range_m < begin_m || range_m > crest_m + fade_m) continue;
      const double steep = std::min(1.0, (range_m - begin_m) / 0.1) * 2.0 / 3.0;
      const double slow = std::clamp((range_m - begin_m - 0.1) / (crest_m - begin_m - 0.1), 0.0, 1.0) / 3.0;
      const double left = range_m < crest_m ? 1.0 : 1.0 - (range_m - crest_m) / fade_m;
      bins_[i] += amplitude * (steep + slow) * left;
    }
  }
  void set(std::size_t first, std::size_t last, double level) {
    for (std::size_t i = first; i <= last; ++i) bins_[i] = level;
  }
  std::vector<std::uint8_t> at(double gain, std::mt19937_64& random) const {
    std::vector<std::uint8_t> bins;
    for (const double bin : bins_) {
      const double noise = static_cast<double>(random() % 8);
      bins.push_back(static_cast<std::uint8_t>(std::clamp(255.0 * gain * bin + noise, 0.0, 255.0)));
    }
    return bins;
  }

 private:
  static double range_of(std::size_t bin) { return (static_cast<double>(bin) + 0.5) * kBin_m; }

  std::vector<double> bins_ = std::vector<double>(kBinsOfNearField);
};

/// Beams 1.8 degrees apart, of a sector or (200) of a turn.
template <class F>
Sweep sweep_of(std::size_t beams, double gain, std::mt19937_64& random, F&& hear) {
  Sweep sweep{.extent = beams == 200 ? Sweep::Extent::kTurn : Sweep::Extent::kCut, .beams = {}};
  for (std::size_t n = 0; n < beams; ++n) {
    Heard heard;
    hear(n, heard);
    sweep.beams.push_back({.time_s = static_cast<double>(n),
                           .bearing_rad = 2.0 * std::numbers::pi * static_cast<double>(n) / 200.0,
                           .bin_length_m = kBin_m,
                           .intensities = heard.at(gain, random)});
  }
  return sweep;
}

std::vector<std::optional<Echo>> near_field_echoes_of(const Sweep& sweep, const EchoOptions& options = {}) {
  return detect_echoes(apply_filter(PolarImage(sweep), {}), sweep, options);
}

/// Range of a flat wall that is nearest in the direction of the beam in the middle of 16.
double wall_m(std::size_t beam, double nearest_m) {
  return nearest_m / std::cos((static_cast<double>(beam) - 7.5) * 1.8 * kDegree_rad);
}

// Kills a search that knows only the bins beyond the blanking range: where the echo is up to two thirds of its crest
// there already, the rest of its rise is none, and the second echo is taken for the wall.
TEST(NearWall, WhoseEchoBeginsWithinTheBlankingRangeIsFoundAtAnyGain) {
  for (const double gain : {0.2, 0.4, 0.6, 1.0}) {
    for (const double nearest_m : {0.85, 0.9, 1.0, 1.2, 1.5}) {
      for (const std::optional<int> threshold : {std::optional<int>{}, std::optional(static_cast<int>(80 * gain))}) {
        SCOPED_TRACE(testing::Message() << "gain " << gain << ", " << nearest_m << " m, threshold "
                                        << threshold.value_or(0));
        std::mt19937_64 random(5);
        const Sweep sweep = sweep_of(16, gain, random, [&](std::size_t n, Heard& heard) {
          const double range_m = wall_m(n, nearest_m);
          heard.add_ringing(0.8, 0.06);
          heard.add_echo(range_m - 0.45, range_m, 0.4, 0.6);
          heard.add_echo(3.0 * range_m - 0.1, 3.0 * range_m + 0.1, 0.3, 0.35);
        });
        const auto echoes = near_field_echoes_of(sweep, {.threshold = threshold});
        for (std::size_t n = 0; n < echoes.size(); ++n) {
          SCOPED_TRACE(n);
          ASSERT_TRUE(echoes[n]);
          EXPECT_NEAR(echoes[n]->range_m, wall_m(n, nearest_m), 0.12);
          EXPECT_GE(echoes[n]->range_m, 0.75);
        }
      }
    }
  }
}

// Kills a near wall of the beams around that is given to beams that do not hear it.
TEST(NearWall, IsNotHeardByTheBeamsBesideIt) {
  std::mt19937_64 random(11);
  const Sweep sweep = sweep_of(40, 1.0, random, [](std::size_t n, Heard& heard) {
    heard.add_ringing(0.8, 0.06);
    if (n >= 18 && n < 22) heard.add_echo(0.7, 0.9, 0.3, 1.0);
  });
  const auto echoes = near_field_echoes_of(sweep);
  for (std::size_t n = 0; n < echoes.size(); ++n) {
    SCOPED_TRACE(n);
    if (n >= 18 && n < 22) {
      ASSERT_TRUE(echoes[n]);
      EXPECT_NEAR(echoes[n]->range_m, 0.9, 0.1);
    }
    if (n < 16 || n >= 24) {  // the filter joins two beams to either side
      EXPECT_FALSE(echoes[n]);
    }
  }
}

// Kills echoes fainter than what makes an echo, of any detector but kCanny, whose threshold is a gradient.
TEST(NearWall, AndAllOtherEchoesAreAsLoudAsTheirThreshold) {
  std::size_t found = 0;
  for (std::uint64_t seed = 1; seed <= test::rounds(200); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937_64 random(seed);
    const auto metres = [&](double low, double high) { return test::uniform(random, low, high); };
    const double ringing_m = metres(0.04, 0.5), wall_m = metres(0.6, 2.5), length_m = metres(0.1, 1.5);
    const double amplitude = metres(0.1, 1.2), share = metres(0.1, 1.0), slant_m = metres(-0.05, 0.05);
    const Sweep sweep = sweep_of(seed % 2 == 0 ? 200 : 40, metres(0.1, 1.5), random, [&](std::size_t n, Heard& heard) {
      heard.add_ringing(0.9, ringing_m);
      if (metres(0.0, 1.0) > share && n % 20 > 7) return;
      const double range_m = wall_m + slant_m * static_cast<double>(n % 20);
      heard.add_echo(range_m - length_m, range_m, metres(0.05, 1.0), amplitude);
    });
    for (const Detector detector : {Detector::kRise, Detector::kLevel, Detector::kMax, Detector::kCfar}) {
      EchoOptions options{.detector = detector};
      if (seed % 3 == 0) options.threshold = static_cast<int>(1 + random() % 120);
      const PolarImage image = apply_filter(PolarImage(sweep), {});
      for (const std::vector<Echo>& of_beam : detect_all_echoes(image, sweep, options)) {
        for (const Echo& echo : of_beam) {
          ++found;
          ASSERT_GE(echo.intensity, echo.threshold) << echo.range_m << " m";
        }
      }
    }
  }
  EXPECT_GT(found, 10'000U);
}

// Kills a near wall whose beam has the end of its neighbours' echoes: what it hears behind its own moves its range.
TEST(NearWall, EndsWhereItsOwnBeamHasFallen) {
  std::mt19937_64 random(12);
  const Sweep sweep = sweep_of(200, 1.0, random, [](std::size_t n, Heard& heard) {
    heard.add_ringing(0.8, 0.06);
    heard.set(24, 31, 0.57);
    heard.set(32, 36, 0.6);
    heard.set(37, 50, 0.57);
    if (n % 9 == 0) heard.set(40, 43, 0.45);
  });
  const auto echoes = detect_echoes(PolarImage(sweep), sweep, {});
  for (std::size_t n = 0; n < echoes.size(); n += 9) {
    SCOPED_TRACE(n);
    ASSERT_TRUE(echoes[n]);
    EXPECT_LT(echoes[n]->last, 40U);
    EXPECT_NEAR(echoes[n]->range_m, 0.85, 0.05);
  }
}

// Kills a near wall that begins where its neighbours' do.
TEST(NearWall, BeginsWhereItsOwnBeamRises) {
  std::mt19937_64 random(13);
  const Sweep sweep = sweep_of(200, 1.0, random, [](std::size_t n, Heard& heard) {
    heard.add_ringing(0.8, 0.06);
    heard.add_echo(n % 9 == 0 ? 0.85 : 0.5, 0.95, 0.4, 0.6);
  });
  const auto echoes = detect_echoes(PolarImage(sweep), sweep, {});
  for (std::size_t n = 0; n < echoes.size(); n += 9) {
    SCOPED_TRACE(n);
    ASSERT_TRUE(echoes[n]);
    EXPECT_GT(kBin_m * static_cast<double>(echoes[n]->first), 0.84);
    EXPECT_NEAR(echoes[n]->range_m, 0.95, 0.1);
  }
}

// Kills a near wall that hides what comes through it: a part of the vehicle does not fill the beam.
TEST(NearWall, IsNotAPartOfTheVehicleThatIsFainterThanTheWallBehind) {
  std::mt19937_64 random(3);
  const Sweep sweep = sweep_of(200, 1.0, random, [](std::size_t n, Heard& heard) {
    heard.add_ringing(0.8, 0.06);
    if (n % 40 < 20) heard.add_echo(0.5, 0.85, 0.2, 0.3);
    heard.add_echo(2.0, 2.15, 0.2, 0.6);
  });
  const auto echoes = near_field_echoes_of(sweep);
  for (const auto& echo : echoes) {
    ASSERT_TRUE(echo);
    EXPECT_NEAR(echo->range_m, 2.1, 0.15);
  }
}

// Kills a second echo taken for the wall where the crest of the first is within the blanking range.
TEST(NearWall, ThatIsNearerThanTheBlankingRangeLeavesItsBeamSilent) {
  std::mt19937_64 random(4);
  const Sweep sweep = sweep_of(16, 1.0, random, [](std::size_t, Heard& heard) {
    heard.add_ringing(0.8, 0.06);
    heard.add_echo(0.5, 0.68, 0.3, 0.8);
    heard.add_echo(2.4, 2.6, 0.15, 0.4);
  });
  for (const auto& echo : near_field_echoes_of(sweep)) EXPECT_FALSE(echo);
}

// Kills ringing that is taken for a near wall, or for something near that hides the walls behind.
TEST(NearField, OfRingingBeyondTheBlankingRangeHidesNoFainterWalls) {
  std::mt19937_64 random(6);
  const Sweep sweep = sweep_of(200, 1.0, random, [](std::size_t, Heard& heard) {
    heard.add_ringing(1.0, 0.9);
    heard.add_echo(2.9, 3.0, 0.15, 0.3);
  });
  std::size_t at_wall = 0;
  for (const auto& echo : near_field_echoes_of(sweep)) {
    if (!echo) continue;
    EXPECT_NEAR(echo->range_m, 3.0, 0.15);
    ++at_wall;
  }
  EXPECT_GE(at_wall, 190U);
}

// Kills a wall taken for speckle of the beams around: its own beam is quiet before it.
TEST(NearField, OfTheBeamsAroundHidesNoWallOfAQuietBeam) {
  std::mt19937_64 random(14);
  for (const double quiet_m : {0.6, 0.9}) {  // the beam is quiet where the blanking range ends, or soon behind
    SCOPED_TRACE(quiet_m);
    const Sweep sweep = sweep_of(40, 1.0, random, [&](std::size_t n, Heard& heard) {
      heard.set(0, static_cast<std::size_t>((n % 10 == 5 ? quiet_m : 1.6) / kBin_m), 0.7);
      if (n % 10 == 5) heard.add_echo(1.25, 1.4, 0.1, 0.6);
    });
    const auto echoes = detect_echoes(PolarImage(sweep), sweep, {});
    for (std::size_t n = 5; n < echoes.size(); n += 10) {
      SCOPED_TRACE(n);
      ASSERT_TRUE(echoes[n]);
      EXPECT_NEAR(echoes[n]->range_m, 1.4, 0.1);
    }
  }
}

// Kills walls in bins that are loud far beyond any near field, where a long echo rises and falls.
TEST(NearField, HoldsNoWallsFarBehindTheBlankingRange) {
  for (const double crest_m : {2.75, 3.0, 3.3}) {
    SCOPED_TRACE(crest_m);
    std::mt19937_64 random(15);
    const Sweep sweep = sweep_of(200, 1.0, random, [&](std::size_t, Heard& heard) {
      heard.set(0, 145, 0.5);
      heard.add_echo(crest_m - 0.3, crest_m, 0.2, 0.4);
    });
    for (const auto& echo : near_field_echoes_of(sweep)) EXPECT_FALSE(echo);
  }
}

/// A head whose near field is saturated up to 1.25 m but for dips of single beams, before a wall.
Sweep saturated_turn(double wall_amplitude) {
  std::mt19937_64 random(7);
  return sweep_of(200, 1.0, random, [&](std::size_t, Heard& heard) {
    heard.set(0, 49, 1.1);
    const std::size_t dip = 32 + random() % 12;
    if (random() % 4 == 0) heard.set(dip, dip + 2, 0.2);
    heard.add_echo(2.3, 2.5, 0.2, wall_amplitude);
  });
}

// Kills speckle in a saturated near field that is taken for a wall before the wall.
TEST(NearField, ThatIsSaturatedHoldsNoWalls) {
  std::size_t at_wall = 0;
  for (const auto& echo : near_field_echoes_of(saturated_turn(1.2))) {
    if (!echo) continue;
    EXPECT_NEAR(echo->range_m, 2.5, 0.15);
    ++at_wall;
  }
  EXPECT_GE(at_wall, 190U);
}

// Kills beams that free what is before an echo fainter than a near field that may hide its wall.
TEST(NearField, WithSpeckleSaysNothingAboutWhatIsFainter) {
  std::size_t silent = 0;
  for (const auto& echo : near_field_echoes_of(saturated_turn(0.5))) {
    silent += echo ? 0U : 1U;
    if (echo) {
      EXPECT_NEAR(echo->range_m, 2.5, 0.15);
    }
  }
  EXPECT_GT(silent, 30U);
}

/// Ringing from 0.75 to 0.9 m around the head, before walls of a room.
void hear_arc(std::size_t n, Heard& heard, std::mt19937_64& random) {
  heard.add_ringing(0.9, 0.08);
  heard.add_echo(0.7, 0.81 + 0.02 * static_cast<double>(random() % 3), 0.1, 0.4);
  const double range_m = 2.6 + 0.6 * std::cos(static_cast<double>(n) * 4.0 * std::numbers::pi / 200.0);
  heard.add_echo(range_m - 0.1, range_m + 0.02, 0.2, 0.6);
}

// Kills a measured blanking range that ends before an arc of ringing: it is at the same range in all directions.
TEST(RingingArc, IsWithinTheMeasuredBlankingRange) {
  std::mt19937_64 random(8);
  const Sweep sweep = sweep_of(200, 1.0, random, [&](std::size_t n, Heard& heard) { hear_arc(n, heard, random); });
  const auto echoes = near_field_echoes_of(sweep, {.min_range_m = std::nullopt});
  std::size_t found = 0;
  for (const auto& echo : echoes) {
    if (!echo) continue;
    EXPECT_GT(echo->range_m, 1.1);
    ++found;
  }
  EXPECT_GE(found, 190U);
}

// Kills an arc that needs no directions: to a head that looks one way, a wall ahead looks the same.
TEST(RingingArc, IsNoWallBeforeAHeadThatLooksIntoASector) {
  std::mt19937_64 random(9);
  const Sweep sweep = sweep_of(40, 1.0, random, [](std::size_t, Heard& heard) {
    heard.add_ringing(0.9, 0.08);
    heard.add_echo(0.7, 0.85, 0.1, 0.4);
  });
  for (const auto& echo : near_field_echoes_of(sweep, {.min_range_m = std::nullopt})) {
    ASSERT_TRUE(echo);
    EXPECT_NEAR(echo->range_m, 0.85, 0.1);
  }
}

// Kills an arc that half of the directions make: walls of a narrow passage.
TEST(RingingArc, IsInNearlyAllDirections) {
  std::mt19937_64 random(10);
  const Sweep sweep = sweep_of(200, 1.0, random, [](std::size_t n, Heard& heard) {
    heard.add_ringing(0.9, 0.08);
    const double range_m = n % 100 < 70 ? 0.85 : 2.5;
    heard.add_echo(range_m - 0.15, range_m, 0.1, 0.4);
  });
  const auto echoes = near_field_echoes_of(sweep, {.min_range_m = std::nullopt});
  std::size_t near = 0;
  for (const auto& echo : echoes) near += echo && echo->range_m < 1.0 ? 1U : 0U;
  EXPECT_GE(near, 130U);
}

}  // namespace
}  // namespace pingvox
