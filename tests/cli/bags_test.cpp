// ROS bags: beams and navigation in one file.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "call.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A bag of 6 lines of a Micron, with depths and poses.
const std::string kBag = PINGVOX_SOURCE_DIR "/fuzz/corpus/bag/none";
/// A bag of a DVL's velocities and echoes of a Ping360.
const std::string kMcap = PINGVOX_SOURCE_DIR "/fuzz/corpus/mcap/lz4";

TEST(Bags, InfoListsTopicsAndWhatTheyAreReadAs) {
  const Workplace here;
  const Outcome outcome = here.call({"info", kBag, "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* part :
       {R"("kind": "log", "format": "bag", "beams": 6)", R"("skipped": 0)",
        R"({"name": "/scan_line", "type": "micron_driver_ros/ScanLine", "messages": 6, "read_as": "beams"})",
        R"("nav": {"clock": "unix", "records": 12)"}) {
    EXPECT_THAT(outcome.out, HasSubstr(part));
  }
  const Outcome piped = here.call({"info", "-", "--json"}, {.in = here.read(kBag)});
  EXPECT_EQ(piped.out, outcome.out);
}

TEST(Bags, OneFileIsTheLogAndItsNavigation) {
  const Workplace here;
  const Outcome outcome = here.call({"map", kBag, "--nav", kBag, "-o", "net.bt", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr(R"("beams": 6)"));
  EXPECT_THAT(outcome.out, HasSubstr(R"("attitude": "/pose", "position": "/pose", "poses": 6)"));
  ASSERT_EQ(here.call({"convert", kBag, "-o", "poses.tum"}).status, 0);
  EXPECT_THAT(here.read("poses.tum"), HasSubstr("1005.000000000 5 2 3 0 0 0 1"));
}

TEST(Bags, ABagMappedWithoutItsNavigationNamesTheOption) {
  const Workplace here;
  EXPECT_THAT(here.call({"map", kBag, "-o", "net.bt"}).err,
              HasSubstr("did not move; navigation in the bag is used with --nav"));
  EXPECT_THAT(here.call({"map", kBag, "--nav", kBag, "-o", "net.bt"}).err, Not(HasSubstr("did not move")));
  const std::string without = PINGVOX_SOURCE_DIR "/fuzz/corpus/mcap/image_without_chunk";
  EXPECT_THAT(here.call({"map", without, "-o", "net.bt"}).err, Not(HasSubstr("--nav")));
}

TEST(Bags, ATopicIsChosenByName) {
  const Workplace here;
  EXPECT_EQ(here.call({"convert", kMcap, "-o", "echoes.csv", "--topic", "/echo"}).status, 0);
  EXPECT_EQ(here.call({"render", kMcap, "-o", "echoes.png", "--topic", "/echo"}).status, 0);
  expect_error(here.call({"map", kMcap, "-o", "map.bt", "--topic", "/other"}), 1, {"lz4", "/other", "/echo"});
}

/// The lines of a text, without comments, as numbers between blanks or commas; words are left out.
std::vector<std::vector<double>> rows_of(std::string text) {
  std::ranges::replace(text, ',', ' ');
  std::istringstream lines(text);
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::vector<double> row;
    for (double number = 0.0; words >> number;) row.push_back(number);
    if (row.size() >= 2) rows.push_back(std::move(row));
  }
  return rows;
}

TEST(Bags, BeamsOfAnUnknownDriverAreReadByTheirFields) {
  const Workplace here;
  // As if we did not know it.
  const char* fields = "angle=angle,turn=cw,ahead=3.14159265358979,range=range,intensities=intensities";
  ASSERT_EQ(here.call({"convert", kMcap, "-o", "known.csv", "--topic", "/echo"}).status, 0);
  ASSERT_EQ(here.call({"convert", kMcap, "-o", "fields.csv", "--topic", "/echo", "--fields", fields}).status, 0);
  const auto known = rows_of(here.read("known.csv")), read = rows_of(here.read("fields.csv"));
  ASSERT_EQ(read.size(), known.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    ASSERT_EQ(read[i].size(), known[i].size());
    for (std::size_t k = 0; k < read[i].size(); ++k) EXPECT_NEAR(read[i][k], known[i][k], 1e-9);
  }
  here.write("driver.toml", "topic = \"/echo\"\nfields = \"angle=angle,bin=range,intensities=intensities\"\n");
  const Outcome mapped = here.call({"map", kMcap, "-o", "map.bt", "--config", "driver.toml"});
  EXPECT_EQ(mapped.status, 0) << mapped.err;
  expect_error(
      here.call({"map", kMcap, "-o", "map.bt", "--topic", "/echo", "--fields", "angle=a,range=b,intensities=c"}), 2,
      {"/echo", "lacks a field", "transmit_frequency"});
  expect_error(here.call({"map", kMcap, "-o", "map.bt", "--fields", fields}), 2, {"--topic"});
  for (const char* wrong : {"angle=a,range=b", "angle=a,range=b,intensities=c,unit=turns", "angle", "heading=a"}) {
    expect_error(here.call({"map", kMcap, "-o", "map.bt", "--topic", "/echo", "--fields", wrong}), 2, {"--fields"});
  }
}

// The DVL of this vehicle looks ahead: at the net of a fish farm, 1.02 m to 1.06 m away while the head looks there.
TEST(Bags, MapsANetWhereTheDvlMeasuresIt) {
  const std::string bag = PINGVOX_SOURCE_DIR "/../shared/data/solaqua-ping360-dvl/sintef_dataset_ros2_bag_fixed.db3";
  if (!std::filesystem::exists(bag)) GTEST_SKIP() << bag << " is not there";
  const Workplace here;
  const Outcome mapped = here.call({"map", bag, "--nav", bag, "-o", "net.bt"});
  ASSERT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_THAT(mapped.out, HasSubstr("+0.000 s: both have dates\n"));
  for (const char* file : {"beams.csv", "path.tum"}) ASSERT_EQ(here.call({"convert", bag, "-o", file}).status, 0);
  ASSERT_EQ(here.call({"convert", "net.bt", "-o", "net.xyz"}).status, 0);

  constexpr double kAhead_rad = 0.25;
  double from_s = std::numeric_limits<double>::infinity(), to_s = 0.0;
  for (const auto& beam : rows_of(here.read("beams.csv"))) {
    if (std::abs(std::remainder(beam[1], 2.0 * std::numbers::pi)) > kAhead_rad) continue;
    from_s = std::min(from_s, beam[0]);
    to_s = std::max(to_s, beam[0]);
  }
  const auto cells = rows_of(here.read("net.xyz"));
  std::vector<double> distances_m;
  for (const auto& pose : rows_of(here.read("path.tum"))) {
    if (pose[0] < from_s || pose[0] > to_s) continue;
    const Eigen::Quaterniond turn(pose[7], pose[4], pose[5], pose[6]);
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const auto& cell : cells) {
      const Eigen::Vector3d at =
          turn.conjugate() * Eigen::Vector3d(cell[0] - pose[1], cell[1] - pose[2], cell[2] - pose[3]);
      const bool is_ahead = at.x() > 0.8 && std::abs(at.y()) < 0.15 * at.x() && std::abs(at.z()) < 0.1;
      if (is_ahead) nearest_m = std::min(nearest_m, at.x());
    }
    distances_m.push_back(nearest_m);
  }
  ASSERT_GT(distances_m.size(), 5U);
  const auto middle = distances_m.begin() + static_cast<std::ptrdiff_t>(distances_m.size() / 2);
  std::ranges::nth_element(distances_m, middle);
  // How far the two are apart in the vehicle is not known.
  EXPECT_NEAR(*middle, 1.04, 0.15);
  RecordProperty("net_m", std::to_string(*middle));
}

}  // namespace
}  // namespace pingvox::test
