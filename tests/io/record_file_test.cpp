#include "io/internal/record_file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pingvox/io/file.hpp"

namespace pingvox {
namespace {

// A record after one that was cut off followed a hole of zeros.
TEST(RecordFile, GoesOnBehindTheLastWholeRecordAfterAFullDisk) {
  const std::string path =
      (std::filesystem::temp_directory_path() / ("pingvox-record-" + std::to_string(::getpid()))).string();
  Result<RecordFile> file = RecordFile::create(path);
  ASSERT_TRUE(file);
  rlimit before = {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  ASSERT_NE(::signal(SIGXFSZ, SIG_IGN), SIG_ERR);
  rlimit small = before;
  small.rlim_cur = 100;
  const std::vector<std::uint8_t> first(60, 1), cut_off(60, 2), last(30, 3);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const bool has_first = file->append(first).has_value();
  const bool has_second = file->append(cut_off).has_value();
  const bool has_last = file->append(last).has_value();
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  ::signal(SIGXFSZ, SIG_DFL);
  EXPECT_TRUE(has_first);
  EXPECT_FALSE(has_second);
  EXPECT_TRUE(has_last);
  const Result<FileBytes> bytes = read_file(path);
  ASSERT_TRUE(bytes);
  std::vector<std::uint8_t> whole = first;
  whole.insert(whole.end(), last.begin(), last.end());
  EXPECT_EQ(bytes->bytes, whole);
  std::filesystem::remove(path);
}

TEST(RecordFile, IsNeverOverwritten) {
  const std::string path =
      (std::filesystem::temp_directory_path() / ("pingvox-recorded-" + std::to_string(::getpid()))).string();
  ASSERT_TRUE(RecordFile::create(path));
  const Result<RecordFile> again = RecordFile::create(path);
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().message, path + ": exists, and a recording is never overwritten");
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace pingvox
