// ROS bags: beams and navigation in one file.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "call.hpp"
#include "tests/support/bag_writer.hpp"

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

TEST(Bags, ARecordingOfPingViewer2HasBeamsAndTheVehicle) {
  const Workplace here;
  const std::string file = PINGVOX_SOURCE_DIR "/fuzz/corpus/mcap/ping_viewer_2";
  const Outcome info = here.call({"info", file, "--json"});
  ASSERT_EQ(info.status, 0) << info.err;
  for (const char* part : {R"("format": "mcap", "beams": 4)", R"("skipped": 1)",
                           R"({"name": "d/Ping360", "type": "P", "messages": 5, "read_as": "beams"})",
                           R"({"name": "d/VehicleData", "type": "V", "messages": 4, "read_as": "navigation"})",
                           R"("name": "d/Ping1D", "quantity": "range", "samples": 1)"}) {
    EXPECT_THAT(info.out, HasSubstr(part));
  }
  const Outcome recorder = here.call({"info", PINGVOX_SOURCE_DIR "/fuzz/corpus/mcap/recorder"});
  ASSERT_EQ(recorder.status, 0) << recorder.err;
  for (const char* part : {"ATTITUDE", "GPS_RAW_INT", "VISION_POSITION_DELTA 255/0",
                           "services/x/log: timestamp.sec float64, timestamp.nsec float64, level float64"}) {
    EXPECT_THAT(recorder.out, HasSubstr(part));
  }
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
              HasSubstr("did not move; to use the navigation in the bag, give --nav"));
  for (const char* command : {"evaluate", "render"}) {
    std::vector<std::string> words = {command, kBag};
    if (command == std::string("render")) words.insert(words.end(), {"--view", "above", "-o", "net.png"});
    EXPECT_THAT(here.call(words).err, HasSubstr("did not move; to use the navigation in the bag, give --nav"))
        << command;
    words.insert(words.end(), {"--nav", kBag});
    EXPECT_THAT(here.call(words).err, Not(HasSubstr("did not move"))) << command;
  }
  expect_error(here.call({"slam", kBag, "-o", "o.tum"}), 1, {"to use the navigation in the bag, give --nav"});
  EXPECT_THAT(here.call({"map", kBag, "--nav", kBag, "-o", "net.bt"}).err, Not(HasSubstr("did not move")));
  const std::string without = PINGVOX_SOURCE_DIR "/fuzz/corpus/mcap/image_without_chunk";
  EXPECT_THAT(here.call({"map", without, "-o", "net.bt"}).err, Not(HasSubstr("--nav")));
}

TEST(Bags, ABagWithFixesAndNoAttitudeNamesWhatIsMissing) {
  const std::string bag = PINGVOX_SHARED_DATA "/micron-ratzeburg-bag/RatzeburgerSee-2019-01-22-15-05-01-short.bag";
  if (!std::filesystem::exists(bag)) GTEST_SKIP() << bag << " is not there";
  const Workplace here;
  EXPECT_THAT(here.call({"map", bag, "-o", "lake.bt"}).err,
              HasSubstr("did not move; the bag has positions (/xsens/gps), but no attitude"));
}

// A lidar's scans are of the type of a sonar's beams. Kills a bag whose navigation nobody can list.
TEST(Bags, InfoOfALidarAndNavigationTellsTheNavigation) {
  const Workplace here;
  bags::Mcap mcap;
  mcap.topic(1, "/scan", "lab_msgs/msg/LaserScan",
             "float64 angle_min\nfloat64 angle_max\nfloat64 range_max\nfloat64[] intensities\n");
  mcap.topic(2, "/depth", "std_msgs/msg/Float64", "");
  bags::Bytes scan = {0, 1, 0, 0}, depth = {0, 1, 0, 0};
  for (const double number : {-1.0, 1.0, 30.0}) bags::put(scan, number);
  bags::put(scan, std::uint64_t{0});
  bags::put(depth, 2.5);
  mcap.message(1, 1'000'000'000'000U, scan);
  mcap.message(2, 1'001'000'000'000U, depth);
  mcap.end_chunk();
  const bags::Bytes file = mcap.closed();
  here.write("lidar.mcap", std::string(file.begin(), file.end()));
  const Outcome info = here.call({"info", "lidar.mcap", "--json"});
  ASSERT_EQ(info.status, 0) << info.err;
  EXPECT_THAT(info.out, HasSubstr(R"("kind": "nav")"));
  EXPECT_THAT(info.out, HasSubstr(R"("name": "/depth", "quantity": "depth", "samples": 1)"));
  EXPECT_THAT(info.out, HasSubstr(R"("no_beams": "lidar.mcap: )"));
  expect_error(here.call({"info", "lidar.mcap", "--topic", "/scan"}), 1,
               {"lidar.mcap: has no beams or scans in the topic /scan"});
  expect_error(here.call({"map", "lidar.mcap", "-o", "o.bt"}), 1, {"without beams"});
}

TEST(Bags, MessagesInAnotherEncodingAreNamed) {
  const Workplace here;
  bags::Mcap mcap;
  mcap.topic(1, "/echo", "lab.Echo", "", "protobuf");
  mcap.message(1, 1'000'000'000'000U, {1, 2});
  mcap.end_chunk();
  const bags::Bytes file = mcap.closed();
  here.write("device.mcap", std::string(file.begin(), file.end()));
  const std::string text = "device.mcap: holds messages in the encoding 'protobuf', which is not read";
  const Outcome info = here.call({"info", "device.mcap", "--json"});
  EXPECT_EQ(info.status, 0) << info.err;
  EXPECT_THAT(info.out, HasSubstr("\"no_beams\": \"" + text));
  expect_error(here.call({"map", "device.mcap", "-o", "o.bt"}), 1, {text});
  expect_error(here.call({"map", "device.mcap", "-o", "o.bt", "--topic", "/echo", "--fields",
                          "angle=angle,bin=sample_period,intensities=data"}),
               1, {text});
}

/// The beginning of a message in CDR, with an empty frame.
bags::Bytes header_at(std::uint32_t seconds) {
  bags::Bytes header = {0, 1, 0, 0};
  for (const std::uint32_t number : {seconds, 0U, 1U, 0U}) bags::put(header, number);  // a NUL and padding at the end
  return header;
}

/// A LaserScan at 1000 s, 0.5 rad from range to range.
bags::Bytes laser_scan(std::initializer_list<float> ranges_m) {
  bags::Bytes scan = header_at(1000);
  const float last_rad = 0.5F * static_cast<float>(ranges_m.size());  // one direction further: a single one is a beam
  for (const float number : {0.0F, last_rad, 0.5F, 0.0F, 0.0F, 0.1F, 30.0F}) bags::put(scan, number);
  bags::put(scan, static_cast<std::uint32_t>(ranges_m.size()));
  for (const float range_m : ranges_m) bags::put(scan, range_m);
  bags::put(scan, std::uint32_t{0});
  return scan;
}

/// A head that turns in gradians where its messages mean radians.
std::string bag_in_gradians() {
  bags::Mcap mcap;
  mcap.topic(1, "/sonar", "lab_msgs/msg/SonarEcho", "float64 angle\nfloat64 range\nuint8[] intensities\n");
  for (unsigned i = 0; i < 500; ++i) {
    bags::Bytes message = {0, 1, 0, 0};
    bags::put(message, static_cast<double>(i % 400));
    bags::put(message, 4.0);
    bags::put(message, std::uint32_t{4});
    message.insert(message.end(), {0, 10, 200, 255});
    mcap.message(1, 1'000'000'000'000U + i * 100'000'000ULL, message);
  }
  mcap.end_chunk();
  const bags::Bytes file = mcap.closed();
  return {file.begin(), file.end()};
}

TEST(Bags, AnglesInAnotherUnitAreReadAndNamed) {
  const Workplace here;
  here.write("dive.mcap", bag_in_gradians());
  const std::string note = "the angles in /sonar, from 0 to 399, cannot be radians, as is documented: read as gradians";
  EXPECT_THAT(here.call({"info", "dive.mcap"}).out, HasSubstr("note        " + note));
  EXPECT_THAT(here.call({"info", "dive.mcap", "--json"}).out, HasSubstr(R"("sweeps": 1, )"));
  EXPECT_THAT(here.call({"map", "dive.mcap", "-o", "o.bt"}).err, HasSubstr("dive.mcap: " + note));
}

// A LaserScan of one range, and angles of a whole turn.
TEST(Bags, ScansWhoseNumbersContradictEachOtherAreRefused) {
  const Workplace here;
  bags::Mcap mcap;
  mcap.topic(1, "/scan", "sensor_msgs/msg/LaserScan", "");
  bags::Bytes scan = header_at(1000);
  for (const float number : {0.0F, 6.25F, 0.015625F, 0.0F, 0.0F, 0.1F, 30.0F}) bags::put(scan, number);
  bags::put(scan, std::uint32_t{1});
  bags::put(scan, 4.0F);
  bags::put(scan, std::uint32_t{0});
  mcap.message(1, 1'000'000'000'000U, scan);
  mcap.end_chunk();
  const bags::Bytes file = mcap.closed();
  here.write("dive.mcap", {file.begin(), file.end()});
  const std::string why = "1 range does not fit angle_min 0, angle_max 6.25 and angle_increment 0.015625";
  expect_error(here.call({"map", "dive.mcap", "-o", "o.bt"}), 1, {"dive.mcap", why});
  EXPECT_THAT(here.call({"info", "dive.mcap"}).out, HasSubstr(why));
}

/// A bag of one LaserScan in four directions at 1000 s, without beams, and its poses.
std::string bag_of_a_scan() {
  bags::Mcap mcap;
  mcap.topic(1, "/scan", "sensor_msgs/msg/LaserScan", "");
  mcap.topic(2, "/pose", "geometry_msgs/msg/PoseStamped", "");
  for (const std::uint32_t seconds : {999U, 1001U}) {
    bags::Bytes pose = header_at(seconds);
    for (const double number : {10.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0}) bags::put(pose, number);
    mcap.message(2, seconds * 1'000'000'000ULL, pose);
  }
  mcap.message(1, 1'000'000'000'000U, laser_scan({2.02F, 3.0F, 4.0F, 50.0F}));
  mcap.end_chunk();
  const bags::Bytes file = mcap.closed();
  return {file.begin(), file.end()};
}

// Kills a bag of a multibeam or lidar that nobody can map, and scans that are mapped where the vehicle was not.
TEST(Bags, ScansAreMappedAlongTheNavigation) {
  const Workplace here;
  here.write("scan.mcap", bag_of_a_scan());
  const Outcome info = here.call({"info", "scan.mcap", "--json"});
  for (const char* part : {R"("kind": "scans", "format": "mcap", "scans": 1, "points": 3)", R"("duration_s": 0)",
                           R"("messages": 1, "read_as": "scans")", R"("nav": {"clock": "unix", "records": 2)"}) {
    EXPECT_THAT(info.out, HasSubstr(part));
  }
  const Outcome map = here.call({"map", "scan.mcap", "--nav", "scan.mcap", "-o", "scan.xyz", "--json"});
  ASSERT_EQ(map.status, 0) << map.err;
  EXPECT_THAT(map.out, HasSubstr(R"("beams": 3)"));
  EXPECT_THAT(map.out, HasSubstr(R"("from": "assumed to be one clock")")) << "of a computer whose clock was not set";
  EXPECT_THAT(here.read("scan.xyz"), HasSubstr("12.025 0.025 0.025"));
  ASSERT_EQ(here.call({"map", "scan.mcap", "--nav", "scan.mcap", "--mount", "0,0,0,0,0,180", "-o", "scan.xyz"}).status,
            0);
  EXPECT_THAT(here.read("scan.xyz"), HasSubstr("7.975 0.025 0.025"));
  EXPECT_THAT(here.call({"map", "scan.mcap", "-o", "scan.bt"}).err, HasSubstr("--nav scan.mcap"));
  const Outcome late = here.call({"map", "scan.mcap", "--nav", "scan.mcap", "--nav-offset", "60", "-o", "scan.bt"});
  expect_error(late, 1, {"nothing could be mapped", "3 of 3 points outside the time of the poses"});
}

// Kills a bag of two lidars of which nobody can list the topics.
TEST(Bags, InfoListsSeveralTopicsWithScans) {
  const Workplace here;
  bags::Mcap mcap;
  for (const std::uint16_t id : {std::uint16_t{1}, std::uint16_t{2}}) {
    mcap.topic(id, id == 1 ? "/left" : "/right", "sensor_msgs/msg/LaserScan", "");
    mcap.message(id, 1'000'000'000'000U, laser_scan({2.0F}));
  }
  mcap.end_chunk();
  const bags::Bytes file = mcap.closed();
  here.write("two.mcap", std::string(file.begin(), file.end()));
  const Outcome info = here.call({"info", "two.mcap", "--json"});
  ASSERT_EQ(info.status, 0) << info.err;
  EXPECT_THAT(
      info.out,
      HasSubstr(R"({"name": "/right", "type": "sensor_msgs/msg/LaserScan", "messages": 1, "read_as": "scans"})"));
  expect_error(here.call({"map", "two.mcap", "-o", "two.bt"}), 2, {"choose one with --topic"});
  expect_error(here.call({"map", "two.mcap", "--topic", "/nope", "-o", "two.bt"}), 1, {"only in /left"});
}

TEST(Bags, ScansOfAPipeNeedTheirTopic) {
  const Workplace here;
  const std::string bag = bag_of_a_scan();
  expect_error(here.call({"map", "-", "-o", "scan.bt"}, {.in = bag}), 2,
               {"choose the topic of its scans with --topic"});
  EXPECT_EQ(here.call({"map", "-", "--topic", "/scan", "-o", "scan.bt"}, {.in = bag}).status, 0);
}

TEST(Bags, ScansHaveNoBeams) {
  const Workplace here;
  here.write("scan.mcap", bag_of_a_scan());
  EXPECT_EQ(here.call({"render", "scan.mcap", "--view", "above", "-o", "scan.png"}).status, 0);
  expect_error(here.call({"render", "scan.mcap", "-o", "scan.png"}), 1,
               {"holds scans of points, not beams of a sonar: --view above"});
  expect_error(here.call({"slam", "scan.mcap", "-o", "scan.tum"}), 1, {"its scans have no poses to begin with"});
  expect_error(here.call({"map", "scan.mcap", "--threshold", "5", "-o", "scan.bt"}), 2, {"--threshold: has no effect"});
}

// Kills beams that are mapped twice, and a bag of points alone that has "no beams".
TEST(Bags, PointsOfAMicronAreBeamsWhereTheyAreChosen) {
  const Workplace here;
  bags::Ros1 bag;
  bag.topic(0, "/tritech_micron/scan", "sensor_msgs/PointCloud",
            "geometry_msgs/Point32[] points\nChannelFloat32[] channels\n================\nMSG: geometry_msgs/Point32\n"
            "float32 x\nfloat32 y\nfloat32 z\n================\nMSG: sensor_msgs/ChannelFloat32\nstring name\n"
            "float32[] values\n");
  bags::Bytes cloud;
  bags::put(cloud, std::uint32_t{4});
  for (const float range_m : {0.5F, 1.0F, 1.5F, 2.0F}) {
    for (const float number : {range_m, 0.0F, 0.0F}) bags::put(cloud, number);
  }
  bags::put(cloud, std::uint32_t{1});
  bags::put_text(cloud, "intensity");
  bags::put(cloud, std::uint32_t{4});
  for (const float intensity : {1.0F, 2.0F, 200.0F, 4.0F}) bags::put(cloud, intensity);
  bag.message(0, 1000, 0, cloud);
  bag.end_chunk();
  here.write("points.bag", std::string(bag.file().begin(), bag.file().end()));
  expect_error(here.call({"convert", "points.bag", "-o", "beams.csv"}), 1,
               {"points.bag: choose the topic of its beams with --topic: /tritech_micron/scan"});
  ASSERT_EQ(here.call({"convert", "points.bag", "--topic", "/tritech_micron/scan", "-o", "beams.csv"}).status, 0);
  EXPECT_THAT(here.read("beams.csv"), HasSubstr("1000,3.141592653589793,0.5,1,2,200,4\n")) << "astern";
}

TEST(Bags, ATopicIsChosenByName) {
  const Workplace here;
  EXPECT_EQ(here.call({"convert", kMcap, "-o", "echoes.csv", "--topic", "/echo"}).status, 0);
  EXPECT_EQ(here.call({"render", kMcap, "-o", "echoes.png", "--topic", "/echo"}).status, 0);
  expect_error(here.call({"map", kMcap, "-o", "map.bt", "--topic", "/other"}), 1, {"lz4", "/other", "/echo"});
  const std::string refused = "scan.csv: --topic: has no effect on a log of beams (.csv), only on ROS bags";
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "scan.csv", "--turns", "1"}).status, 0);
  expect_error(here.call({"map", "scan.csv", "-o", "map.bt", "--topic", "/echo"}), 2, {refused});
  expect_error(here.call({"slam", "scan.csv", "-o", "scan.tum", "--topic", "/echo"}), 2, {refused});
  expect_error(here.call({"info", "scan.csv", "--topic", "/echo"}), 2, {refused});
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
  for (const char* wrong : {"angle=a,range=b", "angle=a,range=b,intensities=c,unit=turns", "angle=", "heading=a"}) {
    expect_error(here.call({"map", kMcap, "-o", "map.bt", "--topic", "/echo", "--fields", wrong}), 2, {"--fields"});
  }
}

// A file for an unknown driver: here the topics of a bag that we know, read by its fields.
TEST(Bags, AFileNamesTheFieldsOfBeamsAndNavigation) {
  const Workplace here;
  here.write("driver.toml",
             "# A sonar and a pose.\n"
             "[[beams]]\ntopic = \"/scan_line\"\nangle = \"angle\"\nunit = \"deg\"\nturn = \"cw\"\n"
             "bin = \"bin_distance_step\"\nintensities = \"bins.intensity\"\n\n"
             "[[nav]]\ntopic = \"/pose\"\nquantity = \"position\"\n"
             "fields = \"pose.position.x, pose.position.y, pose.position.z\"\n\n"
             "[[nav]]\ntype = \"geometry_msgs/PoseStamped\"\nquantity = \"attitude\"\n"
             "fields = \"pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w\"\n");
  const Outcome known = here.call({"map", kBag, "--nav", kBag, "-o", "known.bt", "--json"});
  const Outcome named = here.call(
      {"map", kBag, "--nav", kBag, "--fields", "driver.toml", "-o", "named.bt", "--device", "micron", "--json"});
  ASSERT_EQ(named.status, 0) << named.err;
  EXPECT_THAT(named.out, HasSubstr(R"("attitude": "/pose", "position": "/pose", "poses": 6)"));
  const auto tree_of = [&here](const char* map) {
    const std::string bytes = here.read(map);
    return bytes.substr(bytes.find("\nid "));  // a comment says whether the frame has a north
  };
  EXPECT_TRUE(tree_of("named.bt") == tree_of("known.bt")) << known.err;
  const Outcome info = here.call({"info", kBag, "--fields", "driver.toml", "--json"});
  EXPECT_THAT(info.out, HasSubstr(R"("messages": 6, "read_as": "beams")"));
  EXPECT_THAT(info.out, HasSubstr(R"("records": 12)")) << "the depths by their type";
  for (const char* output : {"named.tum", "named.csv"}) {
    EXPECT_EQ(here.call({"convert", kBag, "--fields", "driver.toml", "-o", output}).status, 0);
  }
  // Not enough to go by for these two, but they have read it.
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"slam", kBag, "-o", "slam.tum"},
        std::vector<std::string>{"locate", kBag, "--map", "known.bt", "-o", "locate.tum"}}) {
    std::vector<std::string> words = command;
    words.insert(words.end(), {"--nav", kBag, "--fields", "other.toml"});
    here.write("other.toml", "[[nav]]\ntopic = \"/pose\"\nquantity = \"depth\"\nfields = \"pose.z\"\n");
    expect_error(here.call(words), 2, {"/pose (geometry_msgs/PoseStamped)", "no field 'pose.z'", "pose.position.z"});
  }
}

// Kills an example that nobody can copy.
TEST(Bags, TheFileInTheDocumentationIsOne) {
  std::ifstream page(PINGVOX_SOURCE_DIR "/docs/formats.md");
  std::string example;
  for (std::string line; std::getline(page, line);) {
    const bool is_indented = line.starts_with("    ") || (line.empty() && !example.empty());
    if (example.empty() ? line.starts_with("    # dive.toml") : is_indented) {
      example += (line.empty() ? line : line.substr(4)) + "\n";
    } else if (!example.empty()) {
      break;
    }
  }
  const Workplace here;
  here.write("dive.toml", example);
  expect_error(here.call({"info", kBag, "--fields", "dive.toml"}), 2,
               {"dive.toml: line 10: there is no topic '/dvl', but /scan_line"});
}

TEST(Bags, WhatIsWrongInAFileOfFieldsIsNamed) {
  const Workplace here;
  const std::string depth = "[[nav]]\ntopic = \"/pose\"\nquantity = \"depth\"\nfields = \"-pose.position.z\"\n";
  const auto error = [&](const std::string& text, int status, const std::vector<std::string>& texts) {
    SCOPED_TRACE(text);
    here.write("driver.toml", text);
    expect_error(here.call({"info", kBag, "--fields", "driver.toml"}), status, texts);
  };
  error(depth + "units = \"m\"\n", 1, {"driver.toml: line 5: units: is unknown"});
  error(depth + "unit = \"deg\"\n", 1, {"driver.toml: line 5: unit: must be m or cm or mm, not 'deg'"});
  error(depth + "frame = \"ned\"\n", 1, {"line 5: frame: depth has none"});
  error(depth + "time-unit = \"us\"\n", 1, {"line 5: time-unit: needs time"});
  error(depth + "sd = \"a\"\nvariance = \"a\"\n", 1, {"line 6: variance: excludes sd"});
  error("[[nav]]\ntopic = \"/pose\"\nquantity = \"depht\"\nfields = \"z\"\n", 1,
        {"line 3: quantity: must be velocity or", "did you mean 'depth'"});
  error("[[nav]]\ntopic = \"/pose\"\nquantity = \"velocity\"\nfields = \"z\"\n", 1,
        {"line 1: velocity must be of 2 or 3 fields, not of 1"});
  error("[[nav]]\nquantity = \"depth\"\nfields = \"z\"\n", 1, {"line 1:", "neither a topic nor a type"});
  error("[[nav]]\ntopic = \"/pose\"\nquantity = \"attitude\"\nfields = \"x,y,z,w\"\nunit = \"deg\"\n", 1,
        {"line 5: unit: a quaternion has none"});
  error("[[nav]]\ntopic = \"/pose\"\nquantity = \"depth\"\nfields = 3\n", 1, {"line 4: fields: must be a text"});
  error("[[beams]]\ntopic = \"/s\"\nangle = \"a\"\nrange = \"r\"\n", 1, {"line 1: [[beams]]: must name the fields"});
  error("[[beams]]\nangle = \"a\"\nrange = \"r\"\nintensities = \"i\"\n", 1, {"line 1: topic: is missing"});
  error("[[beams]]\ntopic = \"/s\"\nturn = \"left\"\n", 1, {"line 3: turn: must be ccw or cw, not 'left'"});
  error("[[imu]]\n", 1, {"line 1: [[imu]]: is unknown: must be [[beams]] or [[nav]]"});
  error("topic = \"/pose\"\n", 1, {"line 1: keys must be below [[beams]] or [[nav]]"});
  error("# nothing\n", 1, {"has neither [[beams]] nor [[nav]]"});
  error("[[nav]]\ntopic = \"/dvl\"\nquantity = \"depth\"\nfields = \"z\"\n", 2,
        {"none: driver.toml: line 1: there is no topic '/dvl', but", "/pose (geometry_msgs/PoseStamped)"});
  error("[[nav]]\ntopic = \"/pose\"\nquantity = \"depth\"\nfields = \"z\"\n", 2,
        {"driver.toml: line 1: fields: there is no field 'z', but pose.position.x float64"});
  expect_error(here.call({"info", kBag, "--fields", "missing.toml"}), 1, {"missing.toml"});
  here.write("driver.toml", "[[beams]]\ntopic = \"/s\"\nangle = \"a\"\nrange = \"r\"\nintensities = \"i\"\n");
  expect_error(here.call({"info", kBag, "--fields", "driver.toml", "--topic", "/other"}), 2,
               {"are of /s, not of --topic"});
  // A topic may be in any of the logs of a dive.
  here.write("driver.toml", depth);
  EXPECT_EQ(here.call({"map", kBag, "--nav", kBag, "--nav", kMcap, "--fields", "driver.toml", "-o", "m.bt"})
                .err.find("there is no topic"),
            std::string::npos);
}

// The DVL of this vehicle looks ahead: at the net of a fish farm, 1.02 m to 1.06 m away while the head looks there.
TEST(Bags, MapsANetWhereTheDvlMeasuresIt) {
  const std::string bag = PINGVOX_SOURCE_DIR "/../shared/data/solaqua-ping360-dvl/sintef_dataset_ros2_bag_fixed.db3";
  if (!std::filesystem::exists(bag)) GTEST_SKIP() << bag << " is not there";
  const Workplace here;
  const Outcome mapped = here.call({"map", bag, "--nav", bag, "-o", "net.bt"});
  ASSERT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_THAT(mapped.out, HasSubstr("+0.000 s: both have dates; not checked by the sonar\n"));
  EXPECT_THAT(here.call({"map", bag, "--nav", bag, "-o", "net.bt", "--json"}).out,
              HasSubstr(R"("warnings": ["the map cannot be sharp: )"));
  // The head stood still most of the time, which neither speed nor range would mend.
  EXPECT_THAT(mapped.err, HasSubstr("the map cannot be sharp: "));
  EXPECT_THAT(
      mapped.err,
      HasSubstr(
          "; a head without pauses (it made 16 of 4.09 s (median), 65.2 s in all; without them a sweep takes 21 s), "));
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
