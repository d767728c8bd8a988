#include "io/internal/record_file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <string>
#include <vector>

#include "pingvox/io/file.hpp"
#include "support/folder.hpp"

namespace pingvox {
namespace {

// A record after one that was cut off followed a hole of zeros.
TEST(RecordFile, GoesOnBehindTheLastWholeRecordAfterAFullDisk) {
  const test::Folder folder;
  const std::string path = folder.path("record");
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
}

TEST(RecordFile, IsNeverOverwritten) {
  const test::Folder folder;
  const std::string path = folder.path("record");
  ASSERT_TRUE(RecordFile::create(path));
  const Result<RecordFile> again = RecordFile::create(path);
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().message, path + ": exists, and a recording is never overwritten");
}

}  // namespace
}  // namespace pingvox
