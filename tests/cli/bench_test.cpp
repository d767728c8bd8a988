// The measuring program, called through `pingvox bench`. What it measures is not judged here.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>

#include "call.hpp"
#include "json_reader.hpp"

namespace pingvox::test {
namespace {

using ::testing::HasSubstr;

bool is_built() {
  return std::filesystem::exists(std::filesystem::path(tested_program()).parent_path() / "pingvox-bench");
}

/// The first word of each line of `pingvox bench list`.
std::vector<std::string> listed(const Workplace& here) {
  const Outcome outcome = here.call({"bench", "list"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  std::vector<std::string> names;
  std::istringstream lines(outcome.out);
  for (std::string line; std::getline(lines, line);) names.push_back(line.substr(0, line.find(' ')));
  return names;
}

TEST(Bench, WithoutItsProgramSaysWhatIsMissing) {
  if (is_built()) GTEST_SKIP() << "pingvox-bench is there";
  expect_error(Workplace().call({"bench", "list"}), 1, {"pingvox-bench", "liboctomap-dev"});
}

TEST(Bench, ListsEachNameOnceAndTheManPageKnowsIt) {
  if (!is_built()) GTEST_SKIP() << "pingvox-bench is not there";
  const std::vector<std::string> names = listed(Workplace());
  EXPECT_GT(names.size(), 10U);
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
  std::ifstream in(PINGVOX_SOURCE_DIR "/docs/man/pingvox.1");
  std::string page{std::istreambuf_iterator<char>(in), {}};
  std::erase(page, '\\');  // of escaped hyphens
  for (const std::string& name : names) EXPECT_THAT(page, HasSubstr("\n.B " + name + "\n")) << name;
}

TEST(Bench, RefusesWordsThatItDoesNotKnow) {
  if (!is_built()) GTEST_SKIP() << "pingvox-bench is not there";
  const Workplace here;
  expect_error(here.call({"bench", "nonsense"}), 2, {"bench", "'nonsense'", "bench list"});
  expect_error(here.call({"bench", "tank3d"}), 2, {"did you mean 'tank-3d'?"});
  expect_error(here.call({"bench", "cube-each", "--jsn"}), 2, {"did you mean '--json'?"});
  expect_error(here.call({"bench", "cube-each", "--pictures"}), 2, {"--pictures"});
}

TEST(Bench, ExplainsItself) {
  if (!is_built()) GTEST_SKIP() << "pingvox-bench is not there";
  const Workplace here;
  const Outcome outcome = here.call({"bench", "--help"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.out, HasSubstr("Usage: pingvox bench"));
  EXPECT_THAT(outcome.out, HasSubstr("Examples:\n  pingvox bench"));
  EXPECT_EQ(here.call({"help", "bench"}).out, outcome.out);
}

TEST(Bench, PrintsOneObjectOfWhatWasCheckedAndMeasured) {
  if (!is_built()) GTEST_SKIP() << "pingvox-bench is not there";
  const Outcome outcome = Workplace().call({"bench", "cube-each", "--json", "--quiet"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const auto json = flat_json(outcome.out);
  ASSERT_TRUE(json) << outcome.out;
  for (const std::string key : {"ours_s", "octomap_s", "ratio", "ratio_min", "ratio_max"}) {
    ASSERT_TRUE(json->contains(key)) << key;
    EXPECT_GT(std::stod(json->at(key)), 0.0) << key;
  }
  EXPECT_EQ(json->at("name"), "\"cube-each\"");
  EXPECT_EQ(json->at("checked"), "true");
  EXPECT_TRUE(json->contains("ours_bytes") && json->contains("octomap_bytes"));
}

// Kills: a limit that the programs which a benchmark starts do not know of, and one that is taken without a word.
TEST(Bench, LeavesOutWiderVectorsWhenAsked) {
  if (!is_built()) GTEST_SKIP() << "pingvox-bench is not there";
  const Workplace here;
  ASSERT_EQ(::setenv("PINGVOX_VECTORS", "nonsense", 1), 0);
  const Outcome refused = here.call({"info", "none"});
  expect_error(refused, 2, {"PINGVOX_VECTORS: must be one of ", "'nonsense'"});
  const std::size_t end = refused.err.find(", is '");
  const std::size_t begin = std::max(refused.err.rfind(", ", end - 1), refused.err.rfind("of ", end - 1));
  ASSERT_NE(end, std::string::npos);
  const std::string narrowest = refused.err.substr(begin, end - begin).substr(refused.err[begin] == ',' ? 2 : 3);
  ASSERT_EQ(::setenv("PINGVOX_VECTORS", narrowest.c_str(), 1), 0);
  const Outcome outcome = here.call({"bench", "startup", "--json", "--quiet"});
  ASSERT_EQ(::unsetenv("PINGVOX_VECTORS"), 0);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("\"vectors\": \"" + narrowest + "\""));
}

TEST(Bench, GathersSeveralRowsInOneObject) {
  if (!is_built()) GTEST_SKIP() << "pingvox-bench is not there";
  const Outcome outcome = Workplace().call({"bench", "startup", "startup", "--json", "--quiet"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, ::testing::MatchesRegex("\\{\"benches\": \\[\n\\{\"name\": \"startup\".*\\},\n"
                                                   "\\{\"name\": \"startup\".*\\}\n\\]\\}\n"));
}

}  // namespace
}  // namespace pingvox::test
