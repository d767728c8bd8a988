#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <locale>
#include <numbers>
#include <random>
#include <sstream>

#include "support/logs.hpp"

namespace pingvox {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

ReadResult<Beam> read_csv(std::string_view text, Damage damage = Damage::kSkip) {
  return all_beams({"log.csv", bytes_of(text)}, damage);
}

TEST(Csv, ReadsColumnsInAnyOrderByTheirNames) {
  const auto all = read_csv(
      "# a tank\n"
      "gain,bin_length_m,bearing_rad,time_s,intensities\n"
      "7,0.5,1.25,10,0,43,255\n"
      "\n"
      "8, 0.25 ,\t2.5 , 11 , 1\n"
      "# the end\n"
      "x,0.25,2.5,12\n",
      Damage::kFail);
  EXPECT_EQ(all.error, "");
  ASSERT_EQ(all.items.size(), 3U);
  EXPECT_EQ(all.items[0].time_s, 10.0);
  EXPECT_EQ(all.items[0].bearing_rad, 1.25);
  EXPECT_EQ(all.items[0].bin_length_m, 0.5);
  EXPECT_THAT(all.items[0].intensities, ElementsAre(0, 43, 255));
  EXPECT_THAT(all.items[1].intensities, ElementsAre(1));
  EXPECT_TRUE(all.items[2].intensities.empty());  // a ping without bins is a ping
}

// Spreadsheets of many countries write them.
TEST(Csv, ReadsSemicolonsBetweenColumns) {
  const auto all = read_csv("time_s;bearing_rad;bin_length_m;intensities\n10;1.25;0.5;0;43;255\n", Damage::kFail);
  EXPECT_EQ(all.error, "");
  ASSERT_EQ(all.items.size(), 1U);
  EXPECT_EQ(all.items[0].bearing_rad, 1.25);
  EXPECT_THAT(all.items[0].intensities, ElementsAre(0, 43, 255));
}

TEST(Csv, ReadsBearingsOfEachSenseAndUnit) {
  const auto bearing = [](std::string_view column, std::string_view value) {
    const auto all = read_csv("time_s," + std::string(column) + ",bin_length_m,intensities...\n0," +
                              std::string(value) + ",0.1,1\n");
    return all.items.size() == 1 ? all.items[0].bearing_rad : -1.0;
  };
  EXPECT_EQ(bearing("bearing_rad", "0.5"), 0.5);
  EXPECT_NEAR(bearing("bearing_rad", "-0.5"), 2.0 * std::numbers::pi - 0.5, 1e-15);
  EXPECT_NEAR(bearing("bearing_deg", "90"), 0.5 * std::numbers::pi, 1e-15);
  EXPECT_NEAR(bearing("bearing_cw_deg", "90"), 1.5 * std::numbers::pi, 1e-15);
  EXPECT_EQ(bearing("bearing_cw_deg", "0"), 0.0);
  EXPECT_EQ(bearing("bearing_deg", "360"), 0.0);
}

// Kills a map of a head that jumps by 103 degrees from beam to beam, of which each sweep is one beam.
TEST(Csv, RefusesDegreesInTheColumnOfRadians) {
  const auto read = [](std::string_view column, double step, double turn) {
    std::string text = "time_s," + std::string(column) + ",bin_length_m,intensities\n";
    for (int i = 0; i < 300; ++i) text += fmt::format("{},{},0.1,1,2\n", i, std::fmod(step * i, turn));
    return read_csv(text);
  };
  EXPECT_THAT(read("bearing_rad", 1.8, 360.0).error, HasSubstr("bearing_rad holds degrees, it seems"));
  EXPECT_THAT(read("bearing_rad", -0.9, 360.0).error, HasSubstr("bearing_deg"));
  EXPECT_EQ(read("bearing_deg", 1.8, 360.0).items.size(), 300U);
  EXPECT_THAT(read("bearing_rad", 0.25, 360.0).error, HasSubstr("its numbers go from")) << "a fine step";
  EXPECT_THAT(read("bearing_rad", 2.0, 400.0).error, HasSubstr("bearing_rad holds gradians, it seems"));
  EXPECT_THAT(read("bearing_deg", 0.02, 2.0 * std::numbers::pi).error, HasSubstr("holds radians, it seems"));
  EXPECT_THAT(read("bearing_deg", 16.0, 6400.0).error, HasSubstr("degrees holds something else, it seems"));
  EXPECT_THAT(read("bearing_deg", 16.0, 1e9).error, HasSubstr("its numbers go from")) << "no head turns as far at once";
  EXPECT_EQ(read("bearing_rad", 0.04, 1e9).items.size(), 300U) << "radians that go on from turn to turn";
  EXPECT_EQ(read("bearing_deg", 2.5, 1e9).items.size(), 300U) << "degrees that do";
  EXPECT_EQ(read("bearing_rad", 0.5 * std::numbers::pi, 2.0 * std::numbers::pi).items.size(), 300U) << "four sides";
}

TEST(Csv, TakesLineEndsMarksAndNumbersAsOtherProgramsWriteThem) {
  const auto all = read_csv(
      "\xef\xbb\xbf"
      "time_s,bearing_rad,bin_length_m,intensities\r\n"
      "\r\n"
      "+1.0e+00,1.000000000000000000e+00,1e-1,4.300e+01,0.0\r\n"
      "2,1,0.1,9,8",
      Damage::kFail);
  EXPECT_EQ(all.error, "");
  ASSERT_EQ(all.items.size(), 2U);
  EXPECT_THAT(all.items[0].intensities, ElementsAre(43, 0));
  EXPECT_THAT(all.items[1].intensities, ElementsAre(9, 8));
}

TEST(Csv, LeavesDamagedLinesOutAndNamesTheFirstWhenAsked) {
  const std::string text =
      "time_s,bearing_rad,bin_length_m,intensities\n"
      "1,1,0.1,5\n"
      "2,1,0.1,256\n"
      "3,1,0.1,-1\n"
      "4,1,0.1,1.5\n"
      "5,1,0.1,\n"
      "6,1,0.1,1,\n"
      "7,1\n"
      "8,nan,0.1,5\n"
      "inf,1,0.1,5\n"
      "1e999,1,0.1,5\n"
      "9,1,0,5\n"
      "10,1,-0.1,5\n"
      "11,1,1e5,5\n"
      "12,0x1,0.1,5\n"
      "13,1;0,0.1,5\n"
      "14,,0.1,5\n"
      "15,1,0.1,5\n";
  const auto all = read_csv(text);
  EXPECT_EQ(all.error, "");
  EXPECT_EQ(all.skipped, 15U);
  ASSERT_EQ(all.items.size(), 2U);
  EXPECT_EQ(all.items[1].time_s, 15.0);

  const auto strict = read_csv(text, Damage::kFail);
  EXPECT_EQ(strict.items.size(), 1U);
  EXPECT_EQ(strict.error, "log.csv: line 3: intensity 0, \"256\", is not a whole number in 0..255");
}

// Kills a beam cut off in its midst that counts as one that is short, and a last line that needs an end.
TEST(Csv, LeavesOutABeamThatWasCutOff) {
  const std::string two = "time_s,bearing_rad,bin_length_m,intensities\n1,0,0.1,7,8,9\n2,0,0.1,7,8";
  const auto cut = read_csv(two);
  EXPECT_EQ(cut.items.size(), 1U);
  EXPECT_EQ(cut.skipped, 1U);
  EXPECT_EQ(read_csv(two, Damage::kFail).error,
            "log.csv: line 3: ends after 2 intensities, without an end of the line (the beam before has 3)");
  for (const std::string_view rest : {"\n", "\r\n", "\r", "\n# the end", ",9", ",9\n", ",9,10"}) {
    const auto whole = read_csv(two + std::string(rest), Damage::kFail);
    EXPECT_EQ(whole.error, "");
    EXPECT_EQ(whole.items.size(), 2U);
  }
  // It is the beam before that counts, not the longest.
  EXPECT_EQ(read_csv(two + "\n3,0,0.1,7\n4,0,0.1,7,8", Damage::kFail).items.size(), 4U);
}

TEST(Csv, SaysWhichColumnIsMissing) {
  EXPECT_EQ(read_csv("time_s,bin_length_m,intensities\n").error,
            "log.csv: line 1: the header needs one of the columns bearing_rad, bearing_deg, bearing_cw_deg");
  EXPECT_THAT(read_csv("#\n\nbearing_rad,bin_length_m,intensities\n").error,
              HasSubstr("line 3: the header needs one column time_s"));
  EXPECT_THAT(read_csv("time_s,bearing_rad,intensities\n").error, HasSubstr("bin_length_m"));
  EXPECT_THAT(read_csv("time_s,bearing_rad,bin_length_m\n").error, HasSubstr("intensities"));
  EXPECT_THAT(read_csv("time_s,bearing_rad,intensities,bin_length_m\n").error, HasSubstr("intensities"));
  EXPECT_THAT(read_csv("time_s,bearing_rad,bearing_deg,bin_length_m,intensities\n").error,
              HasSubstr("the header has two of the columns bearing_rad"));
}

TEST(Csv, ReadsBackWhatItWroteToTheLastBit) {
  std::size_t checked = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const auto share = [&random] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    std::vector<Beam> beams(50);
    for (Beam& beam : beams) {
      beam.time_s = (share() - 0.5) * std::pow(10.0, static_cast<double>(random() % 20) - 8.0);
      beam.bearing_rad = share() * 2.0 * std::numbers::pi;
      beam.bin_length_m = share() * std::pow(10.0, -static_cast<double>(random() % 8)) + 1e-300;
      beam.intensities.resize(random() % 500);
      for (auto& intensity : beam.intensities) intensity = static_cast<std::uint8_t>(random());
    }
    beams[0].bearing_rad = std::nextafter(2.0 * std::numbers::pi, 0.0);
    beams[1].time_s = 5e-324;
    BeamsInMemory source(beams);
    std::stringstream text;
    ASSERT_EQ(write_csv(source, text), beams.size());
    const auto all = read_csv(text.str(), Damage::kFail);
    EXPECT_EQ(all.error, "");
    ASSERT_EQ(all.items.size(), beams.size());
    for (std::size_t i = 0; i < beams.size(); ++i) {
      EXPECT_TRUE(same(all.items[i], beams[i])) << i;
      ++checked;
    }
  }
  EXPECT_EQ(checked, 1000U);
}

class DecimalComma : public std::numpunct<char> {
 protected:
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(Csv, ReadsAndWritesTheSameInALocaleWithADecimalComma) {
  const std::string csv = "time_s,bearing_rad,bin_length_m,intensities\n1234.5,1,0.25,3\n";
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new DecimalComma));
  const auto all = read_csv(csv);
  BeamsInMemory source(all.items);
  std::stringstream text;
  EXPECT_TRUE(write_csv(source, text));
  std::locale::global(before);
  EXPECT_EQ(text.str(), csv);
}

TEST(Csv, SaysWhenItCouldNotBeWritten) {
  BeamsInMemory source({Beam{1.0, 1.0, 0.1, {1}}});
  std::stringstream text;
  text.setstate(std::ios::badbit);
  const auto written = write_csv(source, text);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, Error::Code::kIo);
}

}  // namespace
}  // namespace pingvox
