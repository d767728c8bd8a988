#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "device/recording.hpp"
#include "live/dive.hpp"
#include "pingvox/geometry/lattice.hpp"
#include "pingvox/live/map_writer.hpp"

namespace pingvox::test {
namespace {

std::string content_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(MapWriter, TheLastMapIsTheOneInTheFile) {
  const Folder folder;
  const std::string path = folder.path("map.pvx");
  MapWriter writer(path);
  OccupancyMap map({.resolution_m = 0.1});
  for (int i = 0; i < 20; ++i) {
    map.edit().update(*map.lattice().key_of(Eigen::Vector3d(0.1 * i, 0.0, 0.0)), LogOdds::from_probability(0.9));
    EXPECT_TRUE(writer.write(map));
  }
  EXPECT_TRUE(writer.finish(map));
  EXPECT_EQ(content_of(path), bytes_of(map));
}

TEST(MapWriter, TellsThatTheLastOneWasNotWritten) {
  const Folder folder;
  MapWriter writer(folder.path("none/map.pvx"));
  const OccupancyMap map({.resolution_m = 0.1});
  EXPECT_TRUE(writer.write(map)) << "it is only begun";
  Result<void> last;
  while (last) last = writer.write(map);
  EXPECT_EQ(last.error().code, Error::Code::kIo);
  const Result<void> finished = writer.finish(map);
  ASSERT_FALSE(finished);
  EXPECT_THAT(finished.error().message, testing::HasSubstr("none/map.pvx"));
}

}  // namespace
}  // namespace pingvox::test
