// Units of angles, lengths and counts in drivers' messages.

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/beams/angle_units.hpp"
#include "pingvox/io/beam_topic.hpp"
#include "pingvox/io/beams.hpp"
#include "support/bag_writer.hpp"
#include "support/logs.hpp"
#include "support/ros_messages.hpp"

namespace pingvox {
namespace {

using testing::HasSubstr;

constexpr std::string_view kEcho =
    "float64 angle\nfloat64 range\nuint16 number_of_samples\nuint16 speed_of_sound\nuint8[] intensities\n";

struct EchoMessage {
  double angle = 0.0, range_m = 8.0;
  std::uint16_t number_of_samples = 4;
};

bags::Bytes bag_of(const std::vector<EchoMessage>& echoes, std::string_view type = "lab_msgs/msg/SonarEcho") {
  bags::Mcap mcap;
  mcap.topic(1, "/sonar", type, kEcho);
  for (std::size_t i = 0; i < echoes.size(); ++i) {
    bags::Bytes message = {0, 1, 0, 0};
    bags::put(message, echoes[i].angle);
    bags::put(message, echoes[i].range_m);
    bags::put(message, echoes[i].number_of_samples);
    bags::put(message, std::uint16_t{1500});
    bags::put(message, std::uint32_t{4});
    message.insert(message.end(), {1, 2, 3, 4});
    mcap.message(1, 1'000'000'000'000U + i * 100'000'000U, message);
  }
  mcap.end_chunk();
  return mcap.closed();
}

/// A head's angles: `turn` is one turn of it.
std::vector<EchoMessage> turns_of(double from, double step, double turn, std::size_t count) {
  std::vector<EchoMessage> echoes;
  for (std::size_t i = 0; i < count; ++i) echoes.push_back({std::fmod(from + step * static_cast<double>(i), turn)});
  return echoes;
}

struct BeamsRead {
  std::vector<Beam> beams;
  std::size_t skipped = 0;
  std::string note, first_damage, error;
};

BeamsRead beams_in(bags::Bytes file, const BeamTopic& topic = {}) {
  const auto source = open_beams(FileBytes{"dive.mcap", std::move(file)}, Damage::kSkip, topic);
  if (!source) return {{}, 0, "", "", source.error().message};
  BeamsRead read;
  read.note = (*source)->note();
  auto beams = read_all(**source);
  if (!beams) return {{}, 0, "", "", beams.error().message};
  read.beams = *std::move(beams);
  read.skipped = (*source)->skipped();
  read.first_damage = (*source)->first_damage();
  return read;
}

constexpr double kTurn = 2.0 * std::numbers::pi;

// A known driver writes gradians where its message says radians: the beams were spread over all bearings at random.
TEST(BagAngles, GradiansAndDegreesWhereRadiansAreMeantAreRead) {
  const auto radians = beams_in(bag_of(turns_of(1.0, kTurn / 400, kTurn, 400)));
  ASSERT_EQ(radians.beams.size(), 400U) << radians.error;
  EXPECT_EQ(radians.note, "");
  for (const double turn : {400.0, 360.0}) {
    for (const std::size_t count : {400U, 2000U}) {
      const auto read = beams_in(bag_of(turns_of(turn / kTurn, turn / 400, turn, count)));
      ASSERT_EQ(read.beams.size(), count) << read.error;
      EXPECT_THAT(read.note, HasSubstr(turn == 400.0 ? "cannot be radians, as is documented: read as gradians"
                                                     : "cannot be radians, as is documented: read as degrees"));
      for (std::size_t i = 0; i < count; ++i) {
        const double off_rad = read.beams[i].bearing_rad - radians.beams[i % 400].bearing_rad;
        ASSERT_NEAR(std::remainder(off_rad, kTurn), 0.0, 1e-6) << i;
        ASSERT_NEAR(read.beams[i].time_s, 1000.0 + 0.1 * static_cast<double>(i), 1e-6);
      }
    }
  }
}

// Kills a guess: 100 to 259 are a sector in both units.
TEST(BagAngles, AreRefusedWhereTheirUnitIsNotKnown) {
  EXPECT_EQ(beams_in(bag_of(turns_of(100.0, 1.0, 1e9, 160))).error,
            "dive.mcap: the angles in /sonar, from 100 to 259, cannot be radians: they may be degrees or gradians, "
            "which is ambiguous");
  EXPECT_THAT(beams_in(bag_of(turns_of(200.0, 0.0, 1e9, 10))).error, HasSubstr("from 200 to 200"));
}

// Kills a log that is refused, or turned, because of one damaged number.
TEST(BagAngles, OneOfManyThatIsDamagedIsLeftOut) {
  auto echoes = turns_of(0.0, kTurn / 200, kTurn, 300);
  echoes[20].angle = 390.0;
  echoes[200].angle = -1e7;
  const auto read = beams_in(bag_of(echoes));
  EXPECT_EQ(read.beams.size(), 298U) << read.error;
  EXPECT_EQ(read.skipped, 2U);
  EXPECT_EQ(read.note, "");
}

TEST(BagAngles, RadiansMayCountTurns) {
  const auto read = beams_in(bag_of(turns_of(0.0, kTurn / 400, 1e9, 2000)));
  EXPECT_EQ(read.beams.size(), 2000U) << read.error;
  EXPECT_EQ(read.note, "");
}

TEST(BagAngles, AgainstAStatedUnitAreRefused) {
  const bags::Bytes gradians = bag_of(turns_of(0.0, 1.0, 400.0, 800), "lab_msgs/msg/Own");
  BeamTopic topic{"/sonar", BeamFields{"angle", "range", "intensities", BeamFields::Length::kBeam, 1.0, 0.0}};
  EXPECT_THAT(beams_in(gradians, topic).error, HasSubstr("cannot be radians, as is stated: they seem to be gradians"));
  topic.fields->angle_unit_rad = kTurn / 360;
  EXPECT_THAT(beams_in(gradians, topic).error, HasSubstr("cannot be degrees, as is stated: they seem to be gradians"));
  topic.fields->angle_unit_rad = kTurn / 400;
  EXPECT_EQ(beams_in(gradians, topic).beams.size(), 800U);
  const bags::Bytes radians = bag_of(turns_of(0.0, kTurn / 400, kTurn, 800), "lab_msgs/msg/Own");
  topic.fields->angle_unit_rad = kTurn / 360;
  EXPECT_THAT(beams_in(radians, topic).error, HasSubstr("cannot be degrees, as is stated: they seem to be radians"));
}

TEST(BagAngles, AMessageWhoseNumbersContradictEachOtherIsLeftOut) {
  auto echoes = turns_of(0.0, 0.1, kTurn, 20);
  echoes[3].number_of_samples = 200;
  const auto read = beams_in(bag_of(echoes));
  EXPECT_EQ(read.beams.size(), 19U) << read.error;
  EXPECT_THAT(read.first_damage, HasSubstr("number_of_samples 200 does not fit 4 intensities"));
  for (EchoMessage& echo : echoes) echo.number_of_samples = 200;
  EXPECT_THAT(beams_in(bag_of(echoes)).error,
              testing::AllOf(HasSubstr("none of its messages can be used as a beam: 20 x numbers that contradict"),
                             HasSubstr("number_of_samples 200 does not fit 4 intensities")));
}

// Kills ranges in millimetres, and beams without a length.
TEST(BagAngles, ARangeThatNoHeadHearsIsRefused) {
  for (const double range_m : {8000.0, 0.0, -8.0}) {
    auto echoes = turns_of(0.0, 0.1, kTurn, 20);
    for (EchoMessage& echo : echoes) echo.range_m = range_m;
    EXPECT_THAT(beams_in(bag_of(echoes)).error,
                HasSubstr(fmt::format("a range of {:.6g} m is too long for a scanning sonar", range_m)));
  }
}

TEST(AngleUnits, AStatedUnitStandsWhereNothingSpeaksAgainstIt) {
  for (const AngleUnit stated : {AngleUnit::kRadian, AngleUnit::kDegree, AngleUnit::kGradian}) {
    AngleUnits still(stated), sides(stated);
    for (int i = 0; i < 10; ++i) {
      still.add(0.5);
      sides.add(1.5 * (i % 4));
    }
    EXPECT_EQ(still.unit(), stated);
    EXPECT_EQ(sides.unit(), stated);
  }
}

// A head that waits, then turns by 0.9 degrees a beam. Kills a unit that is decided while degrees are still small.
TEST(AngleUnits, DegreesMayBeSmallForSomeTime) {
  AngleUnits units(AngleUnit::kRadian);
  for (int i = 0; !units.are_enough(); ++i) units.add(std::fmod(0.9 * (i < 100 ? i / 20 : i - 95), 360.0));
  EXPECT_EQ(units.unit(), AngleUnit::kDegree);
}

/// Messages of a LaserScan that looks in one direction, of ten bins.
bags::Bytes scan_with(float range_max_m, const std::vector<float>& ranges_m, const std::vector<float>& intensities) {
  bags::Mcap mcap;
  mcap.topic(1, "/scan", "sensor_msgs/msg/LaserScan", "");
  for (std::size_t i = 0; i < 20; ++i) {
    const double time_s = 1000.0 + 0.1 * static_cast<double>(i);
    const float angle_rad = 0.1F * static_cast<float>(i);
    bags::Cdr scan;
    scan.header(time_s, "sonar");
    for (const float number : {angle_rad, angle_rad, 0.0F, 0.0F, 0.0F, 0.0F, range_max_m}) scan.number(number);
    for (const std::vector<float>& values : {ranges_m, intensities}) {
      scan.number(static_cast<std::uint32_t>(values.size()));
      for (const float value : values) scan.number(value);
    }
    mcap.message(1, bags::nanoseconds(time_s), scan.bytes());
  }
  mcap.end_chunk();
  return mcap.closed();
}

/// `count` numbers from a first one on.
std::vector<float> even(float first, float step, std::size_t count) {
  std::vector<float> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(first + step * static_cast<float>(i));
  return values;
}

// Kills intensities that are cut off at 255, and an empty map of those of 0 to 1.
TEST(BagBeams, IntensitiesOfAnotherScaleAreRefusedByName) {
  const auto error_of = [](const std::vector<float>& intensities) {
    return beams_in(scan_with(8.0F, {}, intensities)).error;
  };
  EXPECT_THAT(error_of(even(0.0F, 0.2F, 5)), HasSubstr("intensities are 0 to 0.8, but 0 to 255 are expected"));
  EXPECT_THAT(error_of(even(0.0F, 1000.0F, 5)), HasSubstr("intensities are 0 to 4000, but 0 to 255 are expected"));
  EXPECT_THAT(error_of(even(-80.0F, 1.0F, 5)), HasSubstr("intensities are -80 to -76"));
  EXPECT_EQ(beams_in(scan_with(8.0F, {}, even(0.0F, 60.0F, 5))).beams.size(), 20U);
  EXPECT_EQ(beams_in(scan_with(8.0F, {}, even(0.0F, 0.0F, 5))).beams.size(), 20U) << "silence";
  EXPECT_EQ(beams_in(scan_with(8.0F, {}, even(0.0F, 60.0F, 2))).beams.size(), 20U) << "two bins are a beam";
  EXPECT_EQ(beams_in(scan_with(8.0F, {}, even(0.0F, 60.0F, 1))).beams.size(), 0U);
}

TEST(BagBeams, TheRangesOfAScanTellWhereItsBinsAre) {
  const std::vector<float> some = even(0.0F, 20.0F, 10);
  const auto plain = beams_in(scan_with(8.0F, even(0.8F, 0.8F, 10), some));
  ASSERT_EQ(plain.beams.size(), 20U) << plain.error;
  EXPECT_EQ(plain.beams[0].intensities.size(), 10U);
  EXPECT_NEAR(plain.beams[0].bin_length_m, 0.8, 1e-6);
  const auto later = beams_in(scan_with(8.0F, even(2.6F, 0.6F, 10), some));
  ASSERT_EQ(later.beams.size(), 20U) << later.error;
  EXPECT_NEAR(later.beams[0].bin_length_m, 0.6, 1e-6);
  EXPECT_EQ(later.beams[0].intensities.size(), 14U) << "the first bin ends 2.6 m away";
  EXPECT_THAT(beams_in(scan_with(100.0F, even(0.8F, 0.8F, 10), some)).error,
              HasSubstr("range_max 100 does not fit ranges up to 8"));
}

/// Echoes of a Ping360, two a second, of stamps and frames.
bags::Bytes echoes_of(double (*stamp_s)(double), std::string_view (*frame)(std::size_t)) {
  bags::Mcap mcap;
  mcap.topic(1, "/echo", "ping360_sonar_msgs/msg/SonarEcho", "");
  for (std::size_t i = 0; i < 40; ++i) {
    const double time_s = 1000.0 + 0.5 * static_cast<double>(i);
    mcap.message(1, bags::nanoseconds(time_s),
                 bags::sonar_echo(stamp_s(time_s), frame(i), 0.015F * static_cast<float>(i), 10));
  }
  mcap.end_chunk();
  return mcap.closed();
}

std::string_view one_frame(std::size_t) {
  return "sonar";
}

// Kills a dive whose beams are all at the place of one moment.
TEST(BagBeams, StampsThatStandStillAreNone) {
  for (const auto stamp_s :
       {+[](double) { return 990.0; }, +[](double time_s) { return std::floor(time_s / 5) * 5; }}) {
    const auto read = beams_in(echoes_of(stamp_s, one_frame));
    ASSERT_EQ(read.beams.size(), 40U) << read.error;
    for (std::size_t i = 0; i < 40; ++i) EXPECT_EQ(read.beams[i].time_s, 1000.0 + 0.5 * static_cast<double>(i)) << i;
    EXPECT_THAT(read.note, HasSubstr("the stamps of /echo do not change"));
  }
  const auto seconds = beams_in(echoes_of([](double time_s) { return std::floor(time_s); }, one_frame));
  ASSERT_EQ(seconds.beams.size(), 40U);
  EXPECT_EQ(seconds.beams[3].time_s, 1001.0) << "whole seconds are times";
  EXPECT_EQ(seconds.note, "");
  const auto before = beams_in(echoes_of([](double time_s) { return time_s - 0.25; }, one_frame));
  ASSERT_EQ(before.beams.size(), 40U);
  EXPECT_EQ(before.beams[39].time_s, 1019.25) << "the last one, too";
}

// Kills two pictures in one.
TEST(BagBeams, OfTwoHeadsInATopicTheFirstIsKept) {
  const auto read = beams_in(echoes_of([](double time_s) { return time_s; },
                                       [](std::size_t i) -> std::string_view { return i % 2 == 0 ? "fore" : "aft"; }));
  EXPECT_EQ(read.beams.size(), 20U) << read.error;
  EXPECT_EQ(read.skipped, 20U);
  EXPECT_THAT(read.first_damage, HasSubstr("a beam of aft, where the first are of fore"));
}

}  // namespace
}  // namespace pingvox
