#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <random>

#include "io/beams/mat5.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/file.hpp"
#include "support/logs.hpp"
#include "support/mat5_writer.hpp"
#include "support/mat_records.hpp"

namespace pingvox {
namespace {

using mat5_writer::Bytes;
using mat5_writer::Record;
using mat_records::expect_same;
using mat_records::some_records;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::endian kLittle = std::endian::little;

/// Two records (10.25 s, 180 deg, 0.0125 m, [0 43 68 90]) and (10.29297 s, 181.8 deg, 0.0125 m, [0 17]), written out by
/// hand and read by libmatio.
Bytes golden() {
  std::string header = "MATLAB 5.0 MAT-file";
  header.resize(116, ' ');
  Bytes bytes = bytes_of(header);
  const std::string number_head =
      "0e00000030000000 0600000008000000 0700000000000000 0500000008000000 0100000001000000 0100000000000000 07000400 ";
  const std::string samples_head = "0e00000030000000 0600000008000000 0600000000000000 0500000008000000 01000000 ";
  const Bytes rest = from_hex(
      "0000000000000000 0001 494d"
      "0e00000038020000 0600000008000000 0200000000000000 0500000008000000 0100000002000000"
      "010000000a000000 70617273656444617461000000000000 050004000c000000 0100000030000000"
      "74696d650000000000000000 616e676c6500000000000000 737465705f64697374000000 696e74656e73697469657300" +
      number_head + "00002441" + number_head + "00003443" + number_head + "cdcc4c3c" +  //
      samples_head + "04000000 0100000000000000 02000400 002b445a" +                    //
      number_head + "00b02441" + number_head + "cdcc3543" + number_head + "cdcc4c3c" +  //
      samples_head + "02000000 0100000000000000 02000200 00110000");
  bytes.insert(bytes.end(), rest.begin(), rest.end());
  return bytes;
}

TEST(Mat, ReadsTheGoldenBytes) {
  const Bytes bytes = golden();
  ASSERT_EQ(bytes.size(), 704U);
  const auto all = all_beams({"golden.mat", bytes}, Damage::kFail);
  EXPECT_EQ(all.error, "");
  ASSERT_EQ(all.items.size(), 2U);
  EXPECT_EQ(all.items[0].time_s, 10.25);
  EXPECT_EQ(all.items[0].bearing_rad, std::numbers::pi);
  EXPECT_EQ(all.items[0].bin_length_m, static_cast<double>(0.0125F));
  EXPECT_THAT(all.items[0].intensities, ElementsAre(0, 43, 68, 90));
  // The head turns clockwise: 181.8 degrees is 178.2 degrees counter-clockwise.
  EXPECT_NEAR(all.items[1].bearing_rad, 178.2 * kDegree_rad, 1e-6);
  EXPECT_THAT(all.items[1].intensities, ElementsAre(0, 17));
}

TEST(Mat, TurnsClockwiseAnglesAround) {
  std::vector<Record> records(1, {1.0F, 90.0F, 0.01F, {1}});
  const auto all = all_beams({"a.mat", mat5_writer::file({mat5_writer::parsed_data(records, kLittle)}, kLittle)});
  ASSERT_EQ(all.items.size(), 1U);
  EXPECT_NEAR(all.items[0].bearing_rad, 1.5 * std::numbers::pi, 1e-12);  // to the right
}

// Kills fractions that are cut off: averaged recordings would be half a step too dark.
TEST(Mat, RoundsFractionsOfIntensities) {
  const Bytes one = mat5_writer::numbers<float>(7, 7, {1.0F}, kLittle);
  const Bytes averaged = mat5_writer::numbers<double>(6, 9, {0.4, 0.6, 16.5, 254.6}, kLittle);
  const Bytes array = mat5_writer::struct_array("parsedData", {"time", "angle", "step_dist", "intensities"}, 1,
                                                {one, one, one, averaged}, kLittle);
  const auto all = all_beams({"a.mat", mat5_writer::file({array}, kLittle)}, Damage::kFail);
  ASSERT_EQ(all.items.size(), 1U) << all.error;
  EXPECT_THAT(all.items[0].intensities, ElementsAre(0, 1, 17, 255));
}

TEST(Mat, ReadsBothByteOrdersCompressedAndNot) {
  const std::vector<Record> records = some_records(1);
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    const Bytes matrix = mat5_writer::parsed_data(records, order);
    for (const Bytes& element : {matrix, mat5_writer::compressed(matrix, order)}) {
      const auto all = all_beams({"a.mat", mat5_writer::file({element}, order)}, Damage::kFail);
      EXPECT_EQ(all.error, "");
      expect_same(all.items, records);
    }
  }
}

TEST(Mat, FindsItsVariableAmongOthers) {
  const std::vector<Record> records = some_records(2, 3);
  const Bytes ours = mat5_writer::compressed(mat5_writer::parsed_data(records, kLittle), kLittle);
  const Bytes other = mat5_writer::element(14, mat5_writer::matrix_head(6, {0, 0}, "other", kLittle), kLittle);
  const Bytes large = mat5_writer::compressed(
      mat5_writer::struct_array("large", {"x"}, 1, {mat5_writer::numbers<double>(6, 9, {1.0}, kLittle)}, kLittle),
      kLittle);
  const auto all = all_beams({"a.mat", mat5_writer::file({other, large, ours}, kLittle)}, Damage::kFail);
  EXPECT_EQ(all.error, "");
  expect_same(all.items, records);
  EXPECT_EQ(all_beams({"a.mat", mat5_writer::file({other, large}, kLittle)}).error,
            "a.mat: holds no variable parsedData (but other, large)");
}

TEST(Mat, ConvertsFromEachTypeInWhichNumbersAreStored) {
  const auto read_as = []<class T>(std::uint32_t stored_type, T value) {
    const Bytes time = mat5_writer::numbers<T>(6, stored_type, {value}, kLittle);
    const Bytes one = mat5_writer::numbers<float>(7, 7, {1.0F}, kLittle);
    const Bytes array = mat5_writer::struct_array("parsedData", {"intensities", "time", "step_dist", "angle"}, 1,
                                                  {one, time, one, one}, kLittle);
    const auto all = all_beams({"a.mat", mat5_writer::file({array}, kLittle)});
    return all.items.size() == 1 ? all.items[0].time_s : std::nan("");
  };
  EXPECT_EQ(read_as(1, std::int8_t{-3}), -3.0);
  EXPECT_EQ(read_as(2, std::uint8_t{200}), 200.0);
  EXPECT_EQ(read_as(3, std::int16_t{-300}), -300.0);
  EXPECT_EQ(read_as(4, std::uint16_t{60000}), 60000.0);
  EXPECT_EQ(read_as(5, std::int32_t{-70000}), -70000.0);
  EXPECT_EQ(read_as(6, std::uint32_t{4000000000}), 4e9);
  EXPECT_EQ(read_as(7, 0.5F), 0.5);
  EXPECT_EQ(read_as(9, 0.1), 0.1);
  EXPECT_EQ(read_as(12, std::int64_t{-5000000000}), -5e9);
  EXPECT_EQ(read_as(13, std::uint64_t{5000000000}), 5e9);
}

TEST(Mat, LeavesDamagedRecordsOutAndNamesTheFirstWhenAsked) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto number = [](float value) { return mat5_writer::numbers<float>(7, 7, {value}, kLittle); };
  const auto bins = [](const std::vector<float>& values) { return mat5_writer::numbers<float>(7, 7, values, kLittle); };
  const Bytes empty = mat5_writer::element(14, {}, kLittle);
  Bytes too_few = mat5_writer::matrix_head(7, {1, 2}, "", kLittle);
  mat5_writer::append(too_few, mat5_writer::element(7, {0, 0, 0, 0}, kLittle));
  const std::vector<std::vector<Bytes>> records = {
      {number(1), number(2), number(0.1F), bins({1, 2})},
      {empty, number(2), number(0.1F), bins({1, 2})},
      {number(nan), number(2), number(0.1F), bins({1, 2})},
      {number(1), number(2), number(0), bins({1, 2})},
      {number(1), number(2), number(0.1F), bins({1, 256})},
      {number(1), number(2), number(0.1F), bins({-1})},
      {number(1), number(2), number(0.1F), bins({nan})},
      {number(1), number(2), number(0.1F), bins({})},
      {bins({1, 2}), number(2), number(0.1F), bins({1, 2})},
      {number(1), number(std::numeric_limits<float>::infinity()), number(0.1F), bins({1, 2})},
      {number(1), number(2), number(9000), bins({1, 2})},
      {number(1), mat5_writer::element(14, too_few, kLittle), number(0.1F), bins({1})},
      {number(5), number(2), number(0.1F), bins({1, 2.4F, 3})},
  };
  std::vector<Bytes> arrays;
  for (const auto& record : records) arrays.insert(arrays.end(), record.begin(), record.end());
  const Bytes bytes =
      mat5_writer::file({mat5_writer::struct_array("parsedData", {"time", "angle", "step_dist", "intensities"},
                                                   records.size(), arrays, kLittle)},
                        kLittle);

  const auto all = all_beams({"a.mat", bytes});
  EXPECT_EQ(all.error, "");
  EXPECT_EQ(all.skipped, records.size() - 2);
  ASSERT_EQ(all.items.size(), 2U);
  EXPECT_THAT(all.items[1].intensities, ElementsAre(1, 2, 3));

  const auto strict = all_beams({"a.mat", bytes}, Damage::kFail);
  EXPECT_EQ(strict.items.size(), 1U);
  EXPECT_EQ(strict.error, "a.mat: parsedData(2): time is missing, empty or no array of numbers");
}

TEST(Mat, RefusesEachTruncation) {
  const Bytes matrix = mat5_writer::parsed_data(some_records(3, 20), kLittle);
  for (const Bytes& element : {matrix, mat5_writer::compressed(matrix, kLittle)}) {
    const Bytes bytes = mat5_writer::file({element}, kLittle);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      SCOPED_TRACE(size);
      const auto all = all_beams({"a.mat", Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size))});
      EXPECT_TRUE(all.items.empty());
      EXPECT_NE(all.error, "");
    }
  }
}

TEST(Mat, RefusesVersion73WithAWayOut) {
  Bytes bytes = bytes_of("MATLAB 7.3 MAT-file, Platform: GLNXA64");
  bytes.resize(124, ' ');
  bytes.insert(bytes.end(), {0x00, 0x02, 'I', 'M'});
  bytes.resize(512);
  const auto opened = open_beams({"new.mat", bytes});
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, Error::Code::kUnsupported);
  EXPECT_THAT(opened.error().message, HasSubstr("new.mat: is a MATLAB 7.3 file (HDF5); save it with -v7"));
}

TEST(Mat, RefusesABombBeforeItGrows) {
  // 64 MB of zeros in 64 kB.
  Bytes matrix = mat5_writer::matrix_head(2, {1, 1}, "parsedData", kLittle);
  matrix.resize(std::size_t{64} << 20);
  const Bytes bytes =
      mat5_writer::file({mat5_writer::compressed(mat5_writer::element(14, matrix, kLittle), kLittle)}, kLittle);
  ASSERT_LT(bytes.size(), 100'000U);
  EXPECT_THAT(all_beams({"bomb.mat", bytes}).error, HasSubstr("inflate to more than"));
}

TEST(Mat, RefusesCountsThatTheBytesDoNotHold) {
  // Two thousand million records of four fields in a few bytes.
  Bytes array = mat5_writer::struct_array("parsedData", {"time", "angle", "step_dist", "intensities"}, 2'000'000'000,
                                          {}, kLittle);
  EXPECT_THAT(all_beams({"a.mat", mat5_writer::file({array}, kLittle)}).error, HasSubstr("do not fit"));
  // No fields at all would make the loop over them free, and endless.
  array = mat5_writer::struct_array("parsedData", {}, 2'000'000'000, {}, kLittle);
  EXPECT_NE(all_beams({"a.mat", mat5_writer::file({array}, kLittle)}).error, "");
}

TEST(Mat, NamesTheFieldThatIsNotThere) {
  const Bytes one = mat5_writer::numbers<float>(7, 7, {1.0F}, kLittle);
  const Bytes array = mat5_writer::struct_array("parsedData", {"time", "angle"}, 1, {one, one}, kLittle);
  EXPECT_EQ(all_beams({"a.mat", mat5_writer::file({array}, kLittle)}).error,
            "a.mat: parsedData has no field step_dist");
}

// Kills radians and gradians that are read as degrees: a fan of 6 degrees, or a sweep that is turned.
TEST(Mat, AnglesInAnotherUnitAreRefused) {
  const auto error_of = [](float turn) {
    std::vector<Record> records(400);
    for (std::size_t i = 0; i < records.size(); ++i) {
      records[i] = {static_cast<float>(i), turn * static_cast<float>(i) / 400.0F, 0.01F, {1, 2}};
    }
    const auto all = all_beams({"a.mat", mat5_writer::file({mat5_writer::parsed_data(records, kLittle)}, kLittle)});
    return all.items.size() == records.size() ? "none" : all.error;
  };
  EXPECT_EQ(error_of(360.0F), "none");
  EXPECT_THAT(error_of(6.2832F),
              HasSubstr("the field angle, in degrees, holds radians, it seems: its numbers go from"));
  EXPECT_THAT(error_of(400.0F), HasSubstr("holds gradians"));
  EXPECT_THAT(error_of(6400.0F), HasSubstr("holds something else"));
}

TEST(Mat, BinsThatAreTooLongAreDamage) {
  std::vector<Record> records(1, {1.0F, 90.0F, 2.0F, std::vector<std::uint8_t>(400, 1)});
  EXPECT_THAT(
      all_beams({"a.mat", mat5_writer::file({mat5_writer::parsed_data(records, kLittle)}, kLittle)}, Damage::kFail)
          .error,
      HasSubstr("a range of 800 m is too long for a scanning sonar"));
}

}  // namespace
}  // namespace pingvox
