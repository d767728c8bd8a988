#include "pingvox/io/folder_logs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "support/folder.hpp"

namespace pingvox::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class FolderOfLogs : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(path("deeper")); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
  std::string path(const std::string& name) const { return folder_.path(name); }

  const Folder folder_;
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
  const auto found = logs_in_folder(folder_.path().string());
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_THAT(found->logs, ElementsAre(path("a.txt"), path("b.csv")));
  EXPECT_THAT(found->nav, ElementsAre(path("nav.csv")));
  EXPECT_THAT(found->others, ElementsAre("cloud.xyz", "notes.md"));
  EXPECT_THAT(found->folders, ElementsAre("deeper"));
}

TEST_F(FolderOfLogs, TimesBesideALogAreAPartOfIt) {
  write("dive_hits.txt", "# turn beam count bin\n1 1 1 50\n");
  write("dive_IS_timestamps.log", "times\n");
  const std::string times = path("dive_IS_timestamps.log");
  EXPECT_THAT(files_beside_log(path("dive_hits.txt")), ElementsAre(times));
  write("b.csv", beams_);
  EXPECT_THAT(files_beside_log(path("b.csv")), IsEmpty());
  EXPECT_THAT(logs_in_folder(folder_.path().string())->others, IsEmpty());
  EXPECT_THAT(logs_below_folder(folder_.path().string())->unknown, IsEmpty());
}

TEST_F(FolderOfLogs, MayHaveNoneOrNotBeThere) {
  write("notes.md", "hello\n");
  const auto found = logs_in_folder(folder_.path().string());
  ASSERT_TRUE(found);
  EXPECT_THAT(found->logs, IsEmpty());
  EXPECT_EQ(logs_in_folder(path("missing")).error().code, Error::Code::kIo);
}

TEST_F(FolderOfLogs, IsLookedThroughWithTheFoldersInIt) {
  write("b.csv", beams_);
  write("notes.md", "hello\n");
  write("cloud.xyz", "1 2 3\n4 5 6\n");
  write("deeper/c.csv", beams_);
  write("deeper/nav.csv", "time_s,source,quantity,x,y,z\n0,compass,heading,1,,\n");
  write("deeper/.hidden.csv", beams_);
  std::filesystem::create_directories(path("deeper/bag"));
  write("deeper/bag/dive.mcap", "\x89MCAP0\r\n");
  std::filesystem::create_directory_symlink("..", path("deeper/again"));
  std::filesystem::create_symlink("nowhere.csv", path("lost.csv"));
  const auto found = logs_below_folder(folder_.path().string());
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_THAT(found->logs, ElementsAre(path("b.csv"), path("deeper/c.csv")));
  EXPECT_THAT(found->nav, ElementsAre(path("deeper/nav.csv")));
  EXPECT_THAT(found->bags, ElementsAre(path("deeper/bag")));
  EXPECT_THAT(found->unknown, ElementsAre(path("notes.md")));
  EXPECT_TRUE(found->unreadable.empty());
  EXPECT_EQ(logs_below_folder(path("missing")).error().code, Error::Code::kIo);
}

TEST_F(FolderOfLogs, NamesWhatCannotBeRead) {
  write("closed.csv", beams_);
  std::filesystem::create_directories(path("locked"));
  std::filesystem::permissions(path("closed.csv"), std::filesystem::perms::none);
  std::filesystem::permissions(path("locked"), std::filesystem::perms::none);
  if (std::ifstream(path("closed.csv"))) GTEST_SKIP() << "root may read everything";
  const auto found = logs_below_folder(folder_.path().string());
  ASSERT_TRUE(found);
  ASSERT_EQ(found->unreadable.size(), 2U);
  EXPECT_EQ(found->unreadable[0].path, path("closed.csv"));
  EXPECT_EQ(found->unreadable[1].path, path("locked"));
}

}  // namespace
}  // namespace pingvox::test
