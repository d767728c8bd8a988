#include "web/live_log.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "web/page_columns.hpp"

namespace pingvox::web {
namespace {

using test::NumberReader;

constexpr std::size_t kBins = 6, kBeamsPerTurn = 64;

Beam beam_of(std::size_t number) {
  Beam beam{.time_s = 0.1 * static_cast<double>(number),
            .bearing_rad = wrap_bearing(0.1 * static_cast<double>(number % kBeamsPerTurn)),
            .bin_length_m = 0.5,
            .intensities = std::vector<std::uint8_t>(kBins)};
  for (std::size_t i = 0; i < kBins; ++i) beam.intensities[i] = static_cast<std::uint8_t>(7 * number + 40 * i);
  return beam;
}

std::vector<std::uint8_t> bins_of_beams(std::size_t from, std::size_t to) {
  std::vector<std::uint8_t> bins;
  for (std::size_t n = from; n < to; ++n) {
    const std::vector<std::uint8_t> row = beam_of(n).intensities;
    bins.insert(bins.end(), row.begin(), row.end());
  }
  return bins;
}

/// Number of the first beam that the columns say, and their times.
std::pair<std::size_t, std::vector<double>> times_in(const Bytes& columns) {
  NumberReader reader(columns);
  reader.take<std::uint32_t>();
  const auto count = reader.take<std::uint32_t>();
  EXPECT_EQ(reader.take<std::uint32_t>(), kBins);
  const auto first = reader.take<std::uint32_t>();
  return {first, reader.take<double>(count)};
}

// Kills beams that are found at the number of another one, as soon as the first have gone.
TEST(LiveLog, KeepsTheLastBeamsByTheirNumbers) {
  LiveLog log({}, 1000.0);
  const std::size_t beams = LiveLog::kMaxBeams + 500;
  for (std::size_t n = 0; n < beams; ++n) {
    log.add(beam_of(n));
    ASSERT_EQ(log.end(), n + 1);
    ASSERT_LE(log.end() - log.first(), LiveLog::kMaxBeams);
    ASSERT_LE(log.first(), log.settled());
    ASSERT_LE(log.settled(), log.end());
  }
  EXPECT_EQ(log.first(), 500U);
  EXPECT_EQ(log.bins(), kBins);
  EXPECT_EQ(log.bins_of(500, beams), bins_of_beams(500, beams));
  EXPECT_EQ(log.bins_of(700, 701), bins_of_beams(700, 701));
  EXPECT_EQ(log.bins_of(499, 501), std::nullopt);
  EXPECT_EQ(log.bins_of(beams - 1, beams + 1), std::nullopt);
  for (const std::size_t from : {std::size_t{0}, std::size_t{500}, std::size_t{3000}, beams}) {
    const auto [first, times] = times_in(log.beams_from(from));
    EXPECT_EQ(first, std::max<std::size_t>(from, 500));
    ASSERT_EQ(times.size(), beams - first);
    for (std::size_t i = 0; i < times.size(); ++i) EXPECT_EQ(times[i], 1000.0 + beam_of(first + i).time_s);
  }
  EXPECT_GT(log.settled(), beams - 3 * kBeamsPerTurn) << "all but the last sweep and those that wait for it";
}

}  // namespace
}  // namespace pingvox::web
