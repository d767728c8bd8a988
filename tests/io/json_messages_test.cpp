// Messages in JSON in MCAP files: those of Ping Viewer 2, of the recorder of BlueOS, and others by their fields.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "io/bags/ros_message.hpp"
#include "io/internal/mavlink.hpp"
#include "pingvox/io/bag.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/nav.hpp"
#include "support/bag_writer.hpp"
#include "support/logs.hpp"

namespace pingvox {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr std::uint64_t kStart_ns = 1'700'000'000'000'000'000, kSecond_ns = 1'000'000'000;
constexpr double kStart_s = 1.7e9;

std::uint64_t after_ms(unsigned ms) {
  return kStart_ns + std::uint64_t{ms} * 1'000'000;
}

/// A ping as Ping Viewer 2 writes it.
std::string ping_text(unsigned angle_grad, unsigned asked_for, std::string_view data) {
  return fmt::format(
      R"({{"mode":1,"gain_setting":0,"angle":{},"transmit_duration":32,"sample_period":80,"transmit_frequency":750,)"
      R"("start_angle":0,"stop_angle":399,"num_steps":1,"delay":0,"number_of_samples":{},"data_length":{},"data":{}}})",
      angle_grad, asked_for, asked_for, data);
}

std::string vehicle_text(std::string_view roll, std::string_view yaw, std::string_view latitude = "47.5787") {
  return fmt::format(R"({{"roll":{},"pitch":-0.03,"yaw":{},"alt":-1.234,"lat":{},"lon":{}}})", roll, yaw, latitude,
                     latitude == "0.0" ? "0.0" : "-122.4101");
}

/// A file of Ping Viewer 2.
class PingViewer2 {
 public:
  PingViewer2() {
    file_.topic(1, "device_1/Ping360", "bluerobotics_ping::ping360::AutoDeviceDataStruct", "{}", "json");
    file_.topic(2, "device_1/VehicleData", "ping_viewer_next::vehicle::VehicleData", "{}", "json");
    file_.topic(3, "device_1/Ping1D", "bluerobotics_ping::ping1d::ProfileStruct", "{}", "json");
  }
  void ping(unsigned ms, std::string_view text) { file_.text(1, after_ms(ms), text); }
  void vehicle(unsigned ms, std::string_view text) { file_.text(2, after_ms(ms), text); }
  void profile(unsigned ms, std::string_view text) { file_.text(3, after_ms(ms), text); }
  bags::Mcap& file() { return file_; }
  bags::Bytes closed() {
    file_.end_chunk();
    return file_.closed();
  }

 private:
  bags::Mcap file_;
};

Result<BagContents> contents_of(bags::Bytes bytes, const std::vector<NavFields>& fields = {}) {
  return read_bag(ByteStream(FileBytes{"dive.mcap", std::move(bytes)}), Damage::kSkip, fields);
}

const NavSource* source_of(const NavLog& log, std::string_view name, NavQuantity quantity) {
  const auto found = std::ranges::find_if(
      log.sources(), [&](const NavSource& source) { return source.name == name && source.quantity == quantity; });
  return found == log.sources().end() ? nullptr : &*found;
}

TEST(PingViewer2, PingsAreBeamsOfAPing360) {
  PingViewer2 log;
  log.ping(100, ping_text(200, 3, "[0,128,255]"));
  log.ping(200, ping_text(100, 3, "[1,2,3]"));
  const auto read = all_beams({"dive.mcap", log.closed()});
  EXPECT_EQ(read.error, "");
  EXPECT_EQ(read.skipped, 0U);
  ASSERT_THAT(read.items, SizeIs(2));
  EXPECT_DOUBLE_EQ(read.items[0].time_s, kStart_s + 0.1);
  EXPECT_EQ(read.items[0].bearing_rad, 0.0) << "200 is ahead";
  EXPECT_NEAR(read.items[1].bearing_rad, std::numbers::pi / 2.0, 1e-12) << "angles count clockwise";
  EXPECT_DOUBLE_EQ(read.items[0].bin_length_m, 1500.0 * 80 * 25e-9 / 2.0);
  EXPECT_THAT(read.items[0].intensities, ElementsAre(0, 128, 255));
}

// Kills logs that are refused for the fields of their first message, which is often an answer without samples.
TEST(PingViewer2, APingWithoutSamplesIsSkippedAndMoreFollow) {
  PingViewer2 log;
  log.ping(0, ping_text(244, 3, "[]"));
  log.ping(100, ping_text(244, 3, "[66,132,169]"));
  log.ping(200, ping_text(244, 3, "[66]"));
  log.ping(300, ping_text(243, 3, "[1,2]"));
  const auto read = all_beams({"dive.mcap", log.closed()});
  EXPECT_EQ(read.error, "");
  EXPECT_EQ(read.skipped, 2U);
  ASSERT_THAT(read.items, SizeIs(2));
  EXPECT_THAT(read.items[1].intensities, ElementsAre(1, 2)) << "less than was asked for";
}

TEST(PingViewer2, ImpossiblePingsAreSkippedAndTheFirstIsNamed) {
  for (const auto& [text, reason] : std::vector<std::pair<std::string, std::string>>{
           {ping_text(401, 3, "[1,2,3]"), "angle 401"},
           {ping_text(1, 2, "[1,2,3]"), "number_of_samples 2 does not fit 3 data"},
           {ping_text(1, 3, "[1,2,256]"), "samples that are not of 8 bits"},
           {ping_text(1, 3, "[0.5,0.25,1]"), "samples that are not of 8 bits"},
           {ping_text(1, 3, "\"AQID\""), "ping without samples"},
           {"{\"mode\":1", "message that does not fit its definition"}}) {
    PingViewer2 log;
    log.ping(0, ping_text(1, 3, "[1,2,3]"));
    log.ping(100, text);
    auto source = open_beams(FileBytes{"dive.mcap", log.closed()});
    ASSERT_TRUE(source) << source.error().message;
    EXPECT_TRUE((*source)->next().value());
    EXPECT_FALSE((*source)->next().value());
    EXPECT_EQ((*source)->skipped(), 1U) << text;
    EXPECT_THAT((*source)->first_damage(), HasSubstr(reason)) << text;
  }
}

// Kills poses that are taken for measured anew with each ping, and go on when the autopilot is gone.
TEST(PingViewer2, APoseThatIsRepeatedIsOneSample) {
  PingViewer2 log;
  log.vehicle(0, vehicle_text("0.0125", "-1.5"));
  log.vehicle(7, vehicle_text("0.0125", "-1.5"));
  log.vehicle(100, vehicle_text("0.0125", "-1.498"));
  for (unsigned ms = 200; ms <= 2000; ms += 100) log.vehicle(ms, vehicle_text("0.01", "-1.25"));
  const auto contents = contents_of(log.closed());
  ASSERT_TRUE(contents) << contents.error().message;
  const NavSource* attitude = source_of(contents->nav.log, "device_1/VehicleData", NavQuantity::kAttitude);
  ASSERT_NE(attitude, nullptr);
  ASSERT_THAT(attitude->samples, SizeIs(3));
  EXPECT_DOUBLE_EQ(attitude->samples[0].time_s, kStart_s);
  EXPECT_DOUBLE_EQ(attitude->samples[2].time_s, kStart_s + 0.2) << "the first of the same";
  // Roll right down and pitch bow up of a body in north-east-down, as of MAVLink.
  EXPECT_EQ(attitude->samples[0].value, from_ned::attitude({0.0125F, -0.03F, -1.5F}));
  ASSERT_THAT(contents->nav.notes, SizeIs(1));
  EXPECT_THAT(contents->nav.notes[0],
              HasSubstr("device_1/VehicleData repeats one pose for 1.8 s, from 1700000000.200 s"));
}

TEST(PingViewer2, TheAltitudeIsNoDepth) {
  for (const bool has_position : {false, true}) {
    PingViewer2 log;
    log.vehicle(0, vehicle_text("0.0125", "-1.5", has_position ? "47.5787" : "0.0"));
    log.vehicle(100, vehicle_text("0.0125", "-1.4", has_position ? "47.5787" : "0.0"));
    const auto contents = contents_of(log.closed());
    ASSERT_TRUE(contents);
    EXPECT_FALSE(depth_source(contents->nav.log));
    const NavSource* fix = source_of(contents->nav.log, "device_1/VehicleData", NavQuantity::kFix);
    ASSERT_NE(fix, nullptr);
    EXPECT_EQ(std::ranges::count(fix->samples, true, &NavSample::valid), has_position ? 2 : 0);
  }
}

TEST(PingViewer2, DistancesOfAnEchosounderAreRanges) {
  PingViewer2 log;
  for (const unsigned confidence : {0U, 97U}) {
    log.profile(confidence, fmt::format(R"({{"distance":26717,"confidence":{},"transmit_duration":1052,)"
                                        R"("ping_number":5106,"scan_start":0,"scan_length":39392,"gain_setting":6,)"
                                        R"("profile_data_length":2,"profile_data":[253,253]}})",
                                        confidence));
  }
  const auto contents = contents_of(log.closed());
  ASSERT_TRUE(contents);
  const NavSource* range = source_of(contents->nav.log, "device_1/Ping1D", NavQuantity::kRange);
  ASSERT_NE(range, nullptr);
  ASSERT_THAT(range->samples, SizeIs(2));
  EXPECT_DOUBLE_EQ(range->samples[0].value.x(), 26.717);
  EXPECT_FALSE(range->samples[0].valid);
  EXPECT_TRUE(range->samples[1].valid);
}

// Kills a dive that is lost because its last chunk, often the only one, has no length yet.
TEST(PingViewer2, AFileOfAKilledProgramGivesItsWholeMessages) {
  PingViewer2 log;
  for (unsigned i = 0; i < 10; ++i) log.ping(100 * i, ping_text(200 + i, 3, "[1,2,3]"));
  log.file().end_chunk();
  for (unsigned i = 10; i < 20; ++i) log.ping(100 * i, ping_text(200 + i, 3, "[1,2,3]"));
  for (const std::uint64_t later : {std::uint64_t{0}, ~std::uint64_t{0}}) {
    auto bytes = log.file().killed(later);
    const auto whole = all_beams({"dive.mcap", bytes});
    EXPECT_THAT(whole.items, SizeIs(20)) << later;
    EXPECT_EQ(whole.skipped, 1U) << "it was not closed";
    bytes.resize(bytes.size() - 40);
    const auto cut = all_beams({"dive.mcap", bytes});
    EXPECT_THAT(cut.items, SizeIs(19)) << later;
    EXPECT_EQ(cut.skipped, 1U);
  }
  auto other = log.file().killed(5);
  EXPECT_THAT(all_beams({"dive.mcap", other}).items, SizeIs(10)) << "a length that is none";
}

TEST(PingViewer2, OtherMessagesOfItsTopicsAreNoBeams) {
  PingViewer2 log;
  log.ping(0, R"({"angle":200,"data":[1,2,3]})");
  EXPECT_THAT(all_beams({"dive.mcap", log.closed()}).error, HasSubstr("without beams of a sonar that we know"));
  PingViewer2 broken;
  broken.ping(0, "[1,2,3]");
  broken.ping(0, "{\"angle\":");
  const auto contents = contents_of(broken.closed());
  ASSERT_TRUE(contents);
  ASSERT_THAT(contents->nav.damage, SizeIs(1));
  EXPECT_EQ(contents->nav.damage[0].what, "message that is not a JSON object");
  EXPECT_EQ(contents->nav.damage[0].count, 2U);
}

// Built from the logs of a real head and the structure of the program, by another writer: what they hold is known.
TEST(PingViewer2, BuiltFilesGiveTheSamplesOfTheirLogs) {
  const std::filesystem::path folder = PINGVOX_SHARED_DATA "/pingviewer2-built";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  struct Known {
    std::string name;
    std::size_t beams, samples, skipped;
    unsigned long sum;
    unsigned first_angle_grad;
  };
  for (const Known& known :
       {Known{"device_00000000-0000-0000-1b2c-3d4e5f607182_20210619_213537.mcap", 60, 39'960, 1, 1'822'258, 244},
        Known{"device_00000000-0000-0000-9a8b-7c6d5e4f3021_20210829_005536.mcap", 40, 48'000, 0, 152'630, 201}}) {
    auto file = read_file((folder / known.name).string());
    ASSERT_TRUE(file);
    const auto read = all_beams(*file);
    EXPECT_EQ(read.skipped, known.skipped);
    ASSERT_THAT(read.items, SizeIs(known.beams));
    std::size_t samples = 0;
    unsigned long sum = 0;
    for (const Beam& beam : read.items) {
      samples += beam.intensities.size();
      for (const std::uint8_t intensity : beam.intensities) sum += intensity;
    }
    EXPECT_EQ(samples, known.samples);
    EXPECT_EQ(sum, known.sum);
    EXPECT_NEAR(read.items[0].bearing_rad, (600.0 - known.first_angle_grad) * std::numbers::pi / 200.0, 1e-12);
  }
  auto file = read_file((folder / "device_00000000-0000-0000-1b2c-3d4e5f607182_20210619_213537.mcap").string());
  ASSERT_TRUE(file);
  const auto contents = read_bag(ByteStream(*file));
  ASSERT_TRUE(contents);
  const std::string name = "device_00000000-0000-0000-1b2c-3d4e5f607182/VehicleData";
  const NavSource* attitude = source_of(contents->nav.log, name, NavQuantity::kAttitude);
  ASSERT_NE(attitude, nullptr);
  EXPECT_THAT(attitude->samples, SizeIs(31));
  EXPECT_EQ(attitude->samples[0].time_s, 1624138538.145);
}

TEST(JsonMessages, TheirFieldsHaveThePathsOfTheFirstOne) {
  const auto layout = RosLayout::of_json(
      R"({"a":1,"b":{"c":[1.5,null],"d":"x"},"e":true,"f":null,"g":[{"x":1,"y":2},{"x":3,"y":4}],"h":[],"i":[[1],[2]]})");
  ASSERT_TRUE(layout);
  std::vector<std::string> fields;
  for (const RosField& field : layout->fields()) fields.push_back(field.path + " " + field.type);
  EXPECT_THAT(fields, ElementsAre("a float64", "b.c float64[]", "b.d string", "e bool", "f float64", "g.x float64[]",
                                  "g.y float64[]", "h float64[]", "i float64[][]"));
  RosMessage message;
  ASSERT_TRUE(message.read(
      *layout,
      bytes_of(R"({"f":-0.5,"b":{"d":"a\u0041","c":[7,8]},"g":[{"x":1.5,"y":2},{"x":3,"y":4}],"a":"no","z":1})")));
  EXPECT_EQ(message.number(4), -0.5);
  EXPECT_EQ(message.number(1, 1), 8.0);
  EXPECT_THAT(message.byte_array(1), ElementsAre(7, 8));
  EXPECT_EQ(message.text(2), "aA");
  EXPECT_TRUE(std::isnan(message.number(0))) << "of another type";
  EXPECT_EQ(message.count(0), 0U);
  EXPECT_EQ(message.number(5, 1), 3.0);
  EXPECT_EQ(message.number(6, 0), 2.0);
  ASSERT_TRUE(message.read(*layout, bytes_of(R"({"g":[{"x":1.5,"y":2},{"x":3,"y":4}]})"), 1));
  EXPECT_EQ(message.count(5), 1U);
  EXPECT_EQ(message.number(5), 3.0) << "of the second one";
  EXPECT_FALSE(RosLayout::of_json("[1]"));
  EXPECT_FALSE(RosLayout::of_json("{\"a\":1"));
}

// 1.00000005960464477540 is nearer to the next float, but its double lies in the middle and would be rounded to 1.
TEST(JsonMessages, SinglePrecisionIsRoundedOnce) {
  const auto layout = RosLayout::of_json(R"({"a":1})");
  RosMessage message;
  ASSERT_TRUE(message.read(*layout, bytes_of(R"({"a":1.00000005960464477540})")));
  EXPECT_EQ(message.single(0), std::nextafterf(1.0F, 2.0F));
  EXPECT_EQ(static_cast<float>(message.number(0)), 1.0F) << "rounded twice";
}

TEST(JsonMessages, UnknownTypesAreReadByTheirFields) {
  bags::Mcap file;
  file.topic(1, "lab/sonar", "Echo", "{}", "json");
  file.topic(2, "lab/depth", "Depth", "{}", "json");
  for (unsigned i = 0; i < 80; ++i) {
    file.text(1, after_ms(100 * i), fmt::format(R"({{"head":{{"deg":{}}},"reach":10,"echo":[1,2,{}]}})", 4.5 * i, i));
    file.text(2, after_ms(100 * i),
              fmt::format(R"({{"timestamp":{{"sec":{},"nsec":500000000}},"z":[0,{}],"name":"d"}})",
                          1'700'000'000 + i / 10, -0.5 * i));
  }
  file.end_chunk();
  const bags::Bytes bytes = file.closed();
  BeamTopic topic;
  topic.name = "lab/sonar";
  topic.fields = BeamFields{"head.deg", "reach", "echo", BeamFields::Length::kBeam, std::numbers::pi / 180.0, 0.0};
  auto log = open_bag_log(ByteStream(FileBytes{"dive.mcap", bytes}), Damage::kSkip, topic);
  ASSERT_TRUE(log) << log.error().message;
  const auto beams = read_all(*std::get<std::unique_ptr<BeamSource>>(*log));
  ASSERT_TRUE(beams) << beams.error().message;
  ASSERT_THAT(*beams, SizeIs(80));
  EXPECT_NEAR((*beams)[20].bearing_rad, std::numbers::pi / 2.0, 1e-12);
  EXPECT_THAT((*beams)[20].intensities, ElementsAre(1, 2, 20));

  NavFields depth;
  depth.topic = "lab/depth";
  depth.quantity = NavQuantity::kDepth;
  depth.values = {"-z[1]"};
  const auto contents = contents_of(bytes, {depth});
  ASSERT_TRUE(contents) << contents.error().message;
  const NavSource* source = source_of(contents->nav.log, "lab/depth", NavQuantity::kDepth);
  ASSERT_NE(source, nullptr);
  ASSERT_THAT(source->samples, SizeIs(80));
  EXPECT_DOUBLE_EQ(source->samples[20].time_s, kStart_s + 2.5) << "by the stamp";
  EXPECT_DOUBLE_EQ(source->samples[20].value.x(), 10.0);

  depth.values = {"name"};
  const auto wrong = contents_of(bytes, {depth});
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().message, HasSubstr("'name' is text"));
}

/// MAVLink in JSON.
std::string mavlink_text(unsigned system, unsigned component, std::string_view message) {
  return fmt::format(R"({{"header":{{"system_id":{},"component_id":{},"sequence":7}},"message":{}}})", system,
                     component, message);
}

/// As the recorder writes numbers: the shortest decimals, without exponent.
std::string number_text(float value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value < 0.0F ? "-Infinity" : "Infinity";
  for (int digits = 0; digits < 60; ++digits) {
    std::string text = fmt::format("{:.{}f}", value, digits);
    if (std::strtof(text.c_str(), nullptr) == value) return text;
  }
  return "0";
}

/// The messages of a drive, as a telemetry log has them and as the recorder does.
struct Drive {
  std::vector<std::uint8_t> tlog;
  bags::Mcap each, all, both;

  Drive() {
    for (bags::Mcap* file : {&each, &both}) {
      file->topic(1, "mavlink/1/1/ATTITUDE", "mavlink.1.1.ATTITUDE", "{}", "json");
      file->topic(2, "mavlink/1/1/GLOBAL_POSITION_INT", "mavlink.1.1.GLOBAL_POSITION_INT", "{}", "json");
      file->topic(3, "mavlink/255/0/VISION_POSITION_DELTA", "x", "{}", "json");
      file->topic(4, "mavlink/1/1/HEARTBEAT", "x", "{}", "json");
      file->topic(5, "mavlink/1/1/HEARTBEAT/base_mode", "x", "{}", "json");
      file->topic(6, "mavlink/in", "x", "{}", "json");
    }
    for (bags::Mcap* file : {&all, &both}) file->topic(7, "mavlink/out", "mavlink.out", "{}", "json");
    std::mt19937 random(5);
    std::uniform_real_distribution<float> angle(-1.5F, 1.5F);
    for (unsigned i = 0; i < 200; ++i) {
      const unsigned ms = 50 * i;
      add(ms, 4, 0, {1, 1}, R"({"type":"HEARTBEAT","custom_mode":0,"mavtype":{"type":"MAV_TYPE_SUBMARINE"}})", {});
      each.text(5, after_ms(ms), R"({"type":"MAV_MODE_FLAG_SAFETY_ARMED"})");
      each.text(6, after_ms(ms), mavlink_text(1, 1, R"({"type":"ATTITUDE","roll":9})"));
      bags::Bytes attitude;
      bags::put(attitude, std::uint32_t{100'000 + ms});
      std::string text = fmt::format(R"({{"type":"ATTITUDE","time_boot_ms":{})", 100'000 + ms);
      for (const char* name : {"roll", "pitch", "yaw", "rollspeed", "pitchspeed", "yawspeed"}) {
        const float value = i == 20 && std::string_view(name) == "yawspeed" ? std::nanf("") : angle(random);
        bags::put(attitude, value);
        text += fmt::format(R"(,"{}":{})", name, number_text(value));
      }
      add(ms, 1, 30, {1, 1}, text + "}", attitude);
      bags::Bytes position;
      const auto depth_mm = static_cast<std::int32_t>(100 * i);
      for (const std::int32_t number :
           {static_cast<std::int32_t>(100'000 + ms), 475'787'000, -1'224'101'000, -100, -depth_mm}) {
        bags::put(position, number);
      }
      position.resize(28);
      add(ms + 10, 2, 33, {1, 1},
          fmt::format(
              R"({{"type":"GLOBAL_POSITION_INT","time_boot_ms":{},"lat":475787000,"lon":-1224101000,"alt":-100,)"
              R"("relative_alt":{},"vx":0,"vy":0,"vz":0,"hdg":0}})",
              100'000 + ms, -depth_mm),
          position);
      bags::Bytes delta;
      bags::put(delta, std::uint64_t{0});
      bags::put(delta, std::uint64_t{125'000});
      for (const float number : {0.0F, 0.0F, 0.0F, 0.0125F, -0.003F, 0.1F, 99.0F}) bags::put(delta, number);
      add(ms + 20, 3, 11011, {255, 0},
          R"({"type":"VISION_POSITION_DELTA","time_usec":0,"time_delta_usec":125000,"angle_delta":[0,0,0],)"
          R"("position_delta":[0.0125,-0.003,0.1],"confidence":99})",
          delta);
    }
    for (bags::Mcap* file : {&each, &all, &both}) file->end_chunk("zstd");
  }

 private:
  void add(unsigned ms, std::uint16_t topic, std::uint32_t number, std::pair<std::uint8_t, std::uint8_t> sender,
           const std::string& text, const bags::Bytes& payload) {
    const std::string json = mavlink_text(sender.first, sender.second, text);
    const bags::Bytes bytes(json.begin(), json.end());
    // It is written some milliseconds after it came.
    for (bags::Mcap* file : {&all, &both}) file->message(7, after_ms(ms) + 3'000'000, after_ms(ms), bytes);
    for (bags::Mcap* file : {&each, &both}) file->message(topic, after_ms(ms) + 4'000'000, after_ms(ms), bytes);
    if (payload.empty()) return;
    for (unsigned shift = 64; shift > 0; shift -= 8) {
      tlog.push_back(static_cast<std::uint8_t>(after_ms(ms) / 1000 >> (shift - 8)));
    }
    const auto frame = make_mavlink_frame(number, payload, {0, sender.first, sender.second});
    tlog.insert(tlog.end(), frame.begin(), frame.end());
  }
};

void expect_same(const NavLog& a, const NavLog& b) {
  ASSERT_EQ(a.sources().size(), b.sources().size());
  for (const NavSource& source : a.sources()) {
    const NavSource* other = source_of(b, source.name, source.quantity);
    ASSERT_NE(other, nullptr) << source.name;
    ASSERT_EQ(source.samples.size(), other->samples.size()) << source.name;
    for (std::size_t i = 0; i < source.samples.size(); ++i) {
      EXPECT_NEAR(source.samples[i].time_s, other->samples[i].time_s, 1e-6) << source.name << i;
      EXPECT_EQ(source.samples[i].value, other->samples[i].value) << source.name << i;
      EXPECT_EQ(source.samples[i].valid, other->samples[i].valid) << source.name << i;
    }
  }
}

// Kills numbers that are rounded twice, messages that count twice, and times of the recorder.
TEST(BlueosRecorder, MavlinkIsThatOfATelemetryLogToTheBit) {
  const Drive drive;
  const auto tlog = read_nav({"dive.tlog", drive.tlog});
  ASSERT_TRUE(tlog) << tlog.error().message;
  ASSERT_EQ(tlog->log.sources().size(), 5U);
  for (const bags::Mcap* file : {&drive.each, &drive.all, &drive.both}) {
    const auto contents = contents_of(file->closed());
    ASSERT_TRUE(contents) << contents.error().message;
    EXPECT_THAT(contents->nav.damage, IsEmpty());
    EXPECT_EQ(contents->nav.records, 800U);
    expect_same(tlog->log, contents->nav.log);
  }
}

TEST(BlueosRecorder, TopicsAreReadAsNavigation) {
  const auto contents = contents_of(Drive().both.closed());
  ASSERT_TRUE(contents);
  using Use = BagTopicSummary::Use;
  for (const BagTopicSummary& topic : contents->topics) {
    const bool is_used = topic.name != "mavlink/1/1/HEARTBEAT";
    EXPECT_EQ(topic.use, is_used ? Use::kNavigation : Use::kNone) << topic.name;
  }
}

TEST(BlueosRecorder, WhatLacksItsNumbersIsDamage) {
  for (
      const char* message :
      {R"({"type":"ATTITUDE","time_boot_ms":1,"roll":0,"pitch":0,"yaw":0,"rollspeed":0,"pitchspeed":0})",
       R"({"type":"ATTITUDE","time_boot_ms":1,"roll":"0","pitch":0,"yaw":0,"rollspeed":0,"pitchspeed":0,"yawspeed":0})",
       R"({"type":"ATTITUDE","time_boot_ms":-1,"roll":0,"pitch":0,"yaw":0,"rollspeed":0,"pitchspeed":0,"yawspeed":0})",
       R"({"type":"ATTITUDE","time_boot_ms":1,"roll":1e99,"pitch":0,"yaw":0,"rollspeed":0,"pitchspeed":0,"yawspeed":0})",
       R"({"type":"VISION_POSITION_DELTA","time_delta_usec":1,"position_delta":[1,2]})",
       R"({"type":"GPS_RAW_INT","lat":1,"lon":1,"alt":1,"fix_type":{"type":"GPS_FIX_TYPE_NEW"}})",
       R"({"type":"VFR_HUD","heading":40000})"}) {
    bags::Mcap file;
    file.topic(1, "mavlink/1/1/X", "x", "{}", "json");
    file.text(1, kStart_ns, mavlink_text(1, 1, message));
    file.end_chunk();
    const auto contents = contents_of(file.closed());
    ASSERT_TRUE(contents);
    ASSERT_THAT(contents->nav.damage, SizeIs(1)) << message;
    EXPECT_EQ(contents->nav.damage[0].what, "message that does not fit its definition");
  }
}

TEST(BlueosRecorder, NullIsANumberThatIsNotFiniteAndFixesHaveNames) {
  bags::Mcap file;
  file.topic(1, "mavlink/1/1/AHRS2", "x", "{}", "json");
  file.topic(2, "mavlink/1/1/GPS_RAW_INT", "x", "{}", "json");
  file.text(1, kStart_ns, mavlink_text(1, 1, R"({"type":"AHRS2","roll":null,"pitch":0,"yaw":0})"));
  file.text(1, kStart_ns + kSecond_ns, mavlink_text(1, 1, R"({"type":"AHRS2","roll":0.5,"pitch":0,"yaw":-0})"));
  for (const char* fix : {"GPS_FIX_TYPE_NO_FIX", "GPS_FIX_TYPE_3D_FIX"}) {
    file.text(
        2, kStart_ns,
        mavlink_text(
            1, 1, fmt::format(R"({{"type":"GPS_RAW_INT","fix_type":{{"type":"{}"}},"lat":1,"lon":2,"alt":3}})", fix)));
  }
  file.end_chunk();
  const auto contents = contents_of(file.closed());
  ASSERT_TRUE(contents);
  EXPECT_THAT(contents->nav.damage, IsEmpty());
  const NavSource* attitude = source_of(contents->nav.log, "AHRS2", NavQuantity::kAttitude);
  ASSERT_NE(attitude, nullptr);
  EXPECT_THAT(attitude->samples, SizeIs(1));
  const NavSource* fix = source_of(contents->nav.log, "GPS_RAW_INT", NavQuantity::kFix);
  ASSERT_NE(fix, nullptr);
  ASSERT_THAT(fix->samples, SizeIs(2));
  EXPECT_FALSE(fix->samples[0].valid);
  EXPECT_TRUE(fix->samples[1].valid);
}

}  // namespace
}  // namespace pingvox
