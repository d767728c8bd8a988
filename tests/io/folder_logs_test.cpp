#include "pingvox/io/folder_logs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace pingvox::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class FolderOfLogs : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_ / "deeper");
  }
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  const std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) / "folder_of_logs";
  const std::string beams_ = "time_s,bearing_rad,bin_length_m,intensities\n0,0,0.1,1,2,3\n";
};

TEST_F(FolderOfLogs, HasItsLogsInOrderAndNamesTheRest) {
  write("b.csv", beams_);
  write("a.txt", beams_);
  write("nav.csv", "time_s,source,quantity,x,y,z\n0,compass,heading,1,,\n");
  write("notes.md", "hello\n");
  write("cloud.xyz", "1 2 3\n4 5 6\n");
  write(".hidden.csv", beams_);
  write("deeper/c.csv", beams_);
  const auto found = logs_in_folder(folder_.string());
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_THAT(found->logs, ElementsAre(path("a.txt"), path("b.csv")));
  EXPECT_THAT(found->nav, ElementsAre(path("nav.csv")));
  EXPECT_THAT(found->others, ElementsAre("cloud.xyz", "notes.md"));
}

TEST_F(FolderOfLogs, MayHaveNoneOrNotBeThere) {
  write("notes.md", "hello\n");
  const auto found = logs_in_folder(folder_.string());
  ASSERT_TRUE(found);
  EXPECT_THAT(found->logs, IsEmpty());
  EXPECT_EQ(logs_in_folder(path("missing")).error().code, Error::Code::kIo);
}

}  // namespace
}  // namespace pingvox::test
