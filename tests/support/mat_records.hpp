#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "pingvox/sonar/beam.hpp"
#include "support/mat5_writer.hpp"

/// What stands in a recording of the tank, and the beams that it has to be read as.
namespace pingvox::mat_records {

using mat5_writer::Record;

/// 200 records that cannot be confused with one another.
inline std::vector<Record> some_records(std::uint64_t seed, std::size_t count = 200) {
  std::mt19937_64 random(seed);
  std::vector<Record> records(count);
  for (std::size_t i = 0; i < count; ++i) {
    records[i].time = static_cast<float>(i) * 0.043F + 10.0F;
    records[i].angle = static_cast<float>(random() % 3600) * 0.1F;
    records[i].step_dist = static_cast<float>(1 + random() % 1000) * 0.001F;
    records[i].intensities.resize(1 + random() % 50);
    for (auto& intensity : records[i].intensities) intensity = static_cast<std::uint8_t>(random());
  }
  return records;
}

inline void expect_same(const std::vector<Beam>& beams, const std::vector<Record>& records) {
  ASSERT_EQ(beams.size(), records.size());
  for (std::size_t i = 0; i < beams.size(); ++i) {
    SCOPED_TRACE(i);
    EXPECT_EQ(beams[i].time_s, static_cast<double>(records[i].time));
    EXPECT_EQ(beams[i].bearing_rad, wrap_bearing(-static_cast<double>(records[i].angle) * (std::numbers::pi / 180.0)));
    EXPECT_EQ(beams[i].bin_length_m, static_cast<double>(records[i].step_dist));
    EXPECT_EQ(beams[i].intensities, records[i].intensities);
  }
}

}  // namespace pingvox::mat_records
