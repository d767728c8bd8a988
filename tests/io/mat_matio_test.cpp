// libmatio as the second oracle of MATLAB's files.

#include <gtest/gtest.h>
#include <matio.h>

#include <filesystem>
#include <numbers>

#include "pingvox/io/file.hpp"
#include "support/folder.hpp"
#include "support/logs.hpp"
#include "support/mat_records.hpp"

namespace pingvox {
namespace {

using mat_records::expect_same;
using mat_records::Record;
using mat_records::some_records;

/// The same beams by libmatio.
std::vector<Record> records_by_matio(const std::string& path) {
  std::vector<Record> records;
  mat_t* const mat = Mat_Open(path.c_str(), MAT_ACC_RDONLY);
  if (mat == nullptr) return records;
  matvar_t* const data = Mat_VarRead(mat, "parsedData");
  if (data != nullptr) {
    for (std::size_t i = 0; i < data->dims[0] * data->dims[1]; ++i) {
      const auto field = [&](const char* name) { return Mat_VarGetStructFieldByName(data, name, i); };
      const auto number = [&](const char* name) { return *static_cast<const float*>(field(name)->data); };
      Record record{number("time"), number("angle"), number("step_dist"), {}};
      const matvar_t* const bins = field("intensities");
      for (std::size_t bin = 0; bin < bins->dims[1]; ++bin) {
        record.intensities.push_back(static_cast<std::uint8_t>(static_cast<const double*>(bins->data)[bin]));
      }
      records.push_back(std::move(record));
    }
    Mat_VarFree(data);
  }
  Mat_Close(mat);
  return records;
}

TEST(Mat, ReadsTheTankRecordingAsLibmatioDoes) {
  const std::string path = PINGVOX_SHARED_DATA "/tank-static-mat/dataset_static.mat";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const auto file = read_file(path);
  ASSERT_TRUE(file) << file.error().message;
  const auto all = all_beams(*file, Damage::kFail);
  EXPECT_EQ(all.error, "");
  EXPECT_EQ(all.skipped, 0U);
  ASSERT_EQ(all.items.size(), 5604U);
  EXPECT_EQ(all.items.front().intensities.size(), 399U);
  EXPECT_EQ(all.items.back().intensities.size(), 186U);
  EXPECT_EQ(all.items.front().bearing_rad, std::numbers::pi);
  expect_same(all.items, records_by_matio(path));
}

TEST(Mat, ReadsWhatLibmatioWrites) {
  const test::Folder folder;
  const std::string path = folder.path("by_matio.mat");
  std::size_t checked = 0;
  for (const matio_compression compression : {MAT_COMPRESSION_NONE, MAT_COMPRESSION_ZLIB}) {
    std::vector<Record> records = some_records(4);
    const char* names[] = {"time", "angle", "step_dist", "intensities"};
    std::size_t dims[] = {records.size(), 1};
    matvar_t* const array = Mat_VarCreateStruct("parsedData", 2, dims, names, 4);
    for (std::size_t i = 0; i < records.size(); ++i) {
      std::size_t one[] = {1, 1};
      std::size_t row[] = {1, records[i].intensities.size()};
      const auto set = [&](const char* name, matio_classes c, matio_types t, std::size_t* extents, void* values) {
        Mat_VarSetStructFieldByName(array, name, i, Mat_VarCreate(nullptr, c, t, 2, extents, values, 0));
      };
      set("time", MAT_C_SINGLE, MAT_T_SINGLE, one, &records[i].time);
      set("angle", MAT_C_SINGLE, MAT_T_SINGLE, one, &records[i].angle);
      set("step_dist", MAT_C_SINGLE, MAT_T_SINGLE, one, &records[i].step_dist);
      set("intensities", MAT_C_UINT8, MAT_T_UINT8, row, records[i].intensities.data());
    }
    mat_t* const mat = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
    ASSERT_NE(mat, nullptr);
    ASSERT_EQ(Mat_VarWrite(mat, array, compression), 0);
    Mat_Close(mat);
    Mat_VarFree(array);

    const auto file = read_file(path);
    ASSERT_TRUE(file) << file.error().message;
    const auto all = all_beams(*file, Damage::kFail);
    EXPECT_EQ(all.error, "");
    expect_same(all.items, records);
    checked += all.items.size();
  }
  EXPECT_EQ(checked, 400U);
}

}  // namespace
}  // namespace pingvox
