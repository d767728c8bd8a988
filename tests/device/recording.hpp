#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "pingvox/io/beams.hpp"
#include "support/folder.hpp"

/// Recordings of devices in a folder of the test's own.
namespace pingvox::test {

/// The beams of a recording.
inline std::vector<Beam> beams_in(const std::string& path) {
  Result<ByteStream> stream = ByteStream::open(path);
  if (!stream) return {};
  Result<std::unique_ptr<BeamSource>> log = open_beams(std::move(*stream));
  if (!log) {
    ADD_FAILURE() << log.error().message;
    return {};
  }
  return read_all(**log).value_or(std::vector<Beam>{});
}

inline void expect_equal(const std::vector<Beam>& a, const std::vector<Beam>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].time_s, b[i].time_s) << i;
    EXPECT_EQ(a[i].bearing_rad, b[i].bearing_rad) << i;
    EXPECT_EQ(a[i].bin_length_m, b[i].bin_length_m) << i;
    EXPECT_EQ(a[i].intensities, b[i].intensities) << i;
  }
}

}  // namespace pingvox::test
