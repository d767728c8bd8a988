#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "pingvox/io/beams.hpp"

/// Recordings of devices in a folder of the test's own.
namespace pingvox::test {

/// A folder of its own, gone with the test.
class Folder {
 public:
  Folder() {
    std::string path = (std::filesystem::temp_directory_path() / "pingvox-device-XXXXXX").string();
    if (!::mkdtemp(path.data())) ADD_FAILURE() << "no folder for the test";
    path_ = path;
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::string path(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

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
