#include "sonar/internal/echo_stream.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>

#include "support/rounds.hpp"
#include "support/tank_recording.hpp"

namespace pingvox {
namespace {

struct Way {
  FilterOptions filter;
  EchoOptions echo;
};

/// Each filter with each detector, with thresholds by the gain and given.
std::vector<Way> all_ways() {
  std::vector<Way> ways;
  for (const Filter filter : {Filter::kNone, Filter::kMean, Filter::kMedian, Filter::kGaussian}) {
    for (const Detector detector :
         {Detector::kRise, Detector::kLevel, Detector::kMax, Detector::kCanny, Detector::kCfar}) {
      for (const std::optional<int> threshold : {std::optional<int>{}, std::optional<int>{60}}) {
        Way way{.filter = default_filter(detector), .echo = {}};
        way.filter.filter = filter;
        way.echo.detector = detector;
        way.echo.threshold = threshold;
        ways.push_back(way);
      }
    }
  }
  return ways;
}

bool same(const std::optional<Echo>& a, const std::optional<Echo>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return a->first == b->first && a->peak == b->peak && a->last == b->last && a->range_m == b->range_m &&
         a->intensity == b->intensity;
}

struct Count {
  std::size_t beams = 0;
  std::size_t echoes = 0;
  std::size_t beyond = 0;
  std::size_t early = 0;  ///< returned before their sweep was finished
};

/// Streams the beams, and holds what comes back against whole sweeps. Beams are told apart by their time, which is
/// their number.
Count check(const std::vector<Beam>& beams, const Way& way) {
  std::map<double, std::optional<Echo>> wanted, wanted_beyond;
  EchoOptions anywhere = way.echo;
  anywhere.max_range_m = std::numeric_limits<double>::infinity();
  for (const Sweep& sweep : sweeps_of(beams)) {
    const auto echoes = detect_echoes(apply_filter(PolarImage(sweep), way.filter), sweep, way.echo);
    const auto all = detect_echoes(apply_filter(PolarImage(sweep), way.filter), sweep, anywhere);
    for (std::size_t n = 0; n < echoes.size(); ++n) {
      wanted[sweep.beams[n].time_s] = echoes[n];
      const bool is_beyond = !echoes[n] && all[n] && all[n]->range_m > way.echo.max_range_m;
      wanted_beyond[sweep.beams[n].time_s] = is_beyond ? all[n] : std::nullopt;
    }
  }
  Count count;
  EchoStream stream(way.filter, way.echo);
  const auto judge = [&](const std::vector<EchoStream::BeamWithEcho>& heard) {
    for (const auto& [number, beam, echo, beyond] : heard) {
      EXPECT_EQ(static_cast<double>(number), beam.time_s);
      const auto found = wanted.find(beam.time_s);
      if (found == wanted.end()) {
        ADD_FAILURE() << "beam " << beam.time_s << " came twice, or never was";
        continue;
      }
      EXPECT_TRUE(same(echo, found->second)) << "beam " << beam.time_s;
      EXPECT_TRUE(same(beyond, wanted_beyond[beam.time_s])) << "beam " << beam.time_s;
      count.echoes += echo ? 1U : 0U;
      count.beyond += beyond ? 1U : 0U;
      ++count.beams;
      wanted.erase(found);
    }
  };
  for (const Beam& beam : beams) {
    const std::vector<EchoStream::BeamWithEcho> heard = stream.add(beam);
    judge(heard);
    if (heard.empty()) continue;
    // The last one of a batch is the one in time, if any is.
    const double late = beam.time_s - heard.back().beam.time_s;
    count.early += stream.delay_beams() && late == static_cast<double>(*stream.delay_beams()) ? 1U : 0U;
  }
  judge(stream.finish());
  EXPECT_TRUE(wanted.empty()) << wanted.size() << " beams never came back";
  EXPECT_TRUE(stream.finish().empty());
  return count;
}

/// A head that turns or sweeps a sector over walls with noise, in beams of different lengths. In a third of the cases
/// the near field is loud beyond the blanking range, with a wall in it or without.
std::vector<Beam> random_beams(std::mt19937_64& random) {
  std::vector<Beam> beams;
  const std::size_t loud_bins = random() % 3 == 0 ? 18 + random() % 8 : 8;
  const double near_wall = random() % 2 == 0 ? 18.0 : 1000.0;
  const std::size_t per_turn = 90 + random() % 60;
  const std::size_t count = 2 * per_turn + random() % per_turn;
  const bool sector = random() % 3 == 0;
  const std::size_t width = per_turn * 2 / 3;
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t to_and_fro = n % (2 * width) < width ? n % (2 * width) : 2 * width - 1 - n % (2 * width);
    const double turn = static_cast<double>(sector ? to_and_fro : n) / static_cast<double>(per_turn);
    Beam beam{.time_s = static_cast<double>(n),
              .bearing_rad = wrap_bearing(-2.0 * std::numbers::pi * turn),
              .bin_length_m = 0.05,
              .intensities = {}};
    const std::size_t bins = random() % 8 == 0 ? random() % 60 : 58 + random() % 3;
    const double wall = 35.0 + 10.0 * std::cos(3.0 * beam.bearing_rad);
    for (std::size_t i = 0; i < bins; ++i) {
      const double off = (static_cast<double>(i) - wall) / 2.0;
      const double near = (static_cast<double>(i) - near_wall) / 5.0;
      const double clean = 100.0 * std::exp(-0.5 * off * off) + (i < loud_bins ? 60.0 : 0.0) +
                           (loud_bins > 8 ? 60.0 * std::exp(-0.5 * near * near) : 0.0);
      beam.intensities.push_back(static_cast<std::uint8_t>(clean + static_cast<double>(random() % 30)));
    }
    beams.push_back(std::move(beam));
  }
  return beams;
}

TEST(EchoStream, GivesTheEchoesOfWholeSweepsWithEachFilterAndDetector) {
  const std::vector<Way> ways = all_ways();
  ASSERT_EQ(ways.size(), 40U);
  Count all;
  for (std::uint64_t seed = 1; seed <= 80; ++seed) {
    const std::size_t at = seed % ways.size();
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", way " << at);
    std::mt19937_64 random(seed);
    Way way = ways[at];
    const std::vector<Beam> beams = random_beams(random);
    // Half way along the beams: what is heard farther away is beyond.
    if (seed > ways.size()) {
      const Beam& some = beams[beams.size() / 2];
      way.echo.max_range_m = std::max(0.5 * static_cast<double>(some.intensities.size()) * some.bin_length_m,
                                      2.0 * way.echo.min_range_m.value_or(0.1));
    }
    const Count count = check(beams, way);
    all.early += count.early;
    all.beyond += count.beyond;
    all.beams += count.beams;
    all.echoes += count.echoes;
  }
  EXPECT_GT(all.beams, 15'000U);
  EXPECT_GT(all.echoes, 8'000U);
  EXPECT_GT(all.beyond, 100U);
  EXPECT_GT(all.early, 8'000U) << "all waited for their sweeps";
}

TEST(EchoStream, GivesTheEchoesOfWholeSweepsOfTheTankRecording) {
  PINGVOX_SKIP_UNDER_SANITIZERS();
  std::vector<Beam> beams = test::TankRecording::beams(PINGVOX_SHARED_DATA);
  if (beams.empty()) GTEST_SKIP() << "no tank recording in " << PINGVOX_SHARED_DATA;
  beams.erase(beams.begin() + 450, beams.end() - 50);  // two turns, a part of one, and the short beam at the end
  for (std::size_t n = 0; n < beams.size(); ++n) beams[n].time_s = static_cast<double>(n);
  std::size_t at = 0;
  for (const Way& way : all_ways()) {
    SCOPED_TRACE(at++);
    const Count count = check(beams, way);
    EXPECT_EQ(count.beams, 500U);
    EXPECT_GT(count.early, 300U - 4 * 40U);
  }
}

TEST(EchoStream, ReturnsABeamAfterItsDelayAndTheEndsWithTheSweep) {
  const Way way{.filter = {}, .echo = {.threshold = 70}};
  EchoStream stream(way.filter, way.echo);
  EXPECT_EQ(stream.delay_beams(), 8U);
  EXPECT_EQ(EchoStream({.filter = Filter::kNone}, way.echo).delay_beams(), 4U);
  EXPECT_EQ(EchoStream({}, {}).delay_beams(), 20U);
  EXPECT_EQ(EchoStream(default_filter(Detector::kCanny), {.detector = Detector::kCanny}).delay_beams(), 36U);
  for (std::size_t n = 0; n <= 100; ++n) {
    SCOPED_TRACE(n);
    const Beam beam{.time_s = static_cast<double>(n),
                    .bearing_rad = wrap_bearing(0.02 * std::numbers::pi * static_cast<double>(n)),
                    .bin_length_m = 0.1,
                    .intensities = std::vector<std::uint8_t>(20)};
    const auto heard = stream.add(beam);
    ASSERT_EQ(heard.size(), n < 16 ? 0U : n < 100 ? 1U : 16U);
    if (heard.size() == 1) {
      EXPECT_EQ(heard[0].beam.time_s, static_cast<double>(n - 8));
    } else if (heard.size() == 16) {
      EXPECT_EQ(heard[0].beam.time_s, 0.0);
      EXPECT_EQ(heard[15].beam.time_s, 99.0);
    }
  }
  EXPECT_EQ(stream.finish().size(), 1U);
}

TEST(EchoStream, WaitsForTheSweepWhenTheBlankingRangeIsToBeFound) {
  std::mt19937_64 random(3);
  const std::vector<Beam> beams = random_beams(random);
  const Way way{.filter = {}, .echo = {.min_range_m = std::nullopt}};
  EXPECT_FALSE(EchoStream(way.filter, way.echo).delay_beams());
  const Count count = check(beams, way);
  EXPECT_EQ(count.beams, beams.size());
  EXPECT_EQ(count.early, 0U);
}

}  // namespace
}  // namespace pingvox
