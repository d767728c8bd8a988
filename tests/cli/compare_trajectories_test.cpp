#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "call.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;

constexpr const char* kPath = "0 0 0 0 0 0 0 1\n1 10 0 0 0 0 0 1\n2 10 10 0 0 0 0 1\n";
/// The same, turned by 90 degrees and shifted, known for half a second longer.
constexpr const char* kTurned = "0 5 5 0 0 0 0 1\n1 5 15 0 0 0 0 1\n2 -5 15 0 0 0 0 1\n2.5 -5 15 0 0 0 0 1\n";

TEST(CompareTrajectories, ReportsAllThreeAlignments) {
  const Workplace here;
  here.write("a.tum", kTurned);
  here.write("b.tum", kPath);
  const Outcome found = here.call({"compare", "a.tum", "b.tum", "--json"});
  EXPECT_EQ(found.status, 1) << found.err;
  for (const char* part :
       {R"("poses": 3, "outside": 0)", R"("ate": {"none": {"mean": )", R"("first_fix": {"mean": )",
        R"("translation": {)", R"("se2": {"mean": )", R"("rotation_deg": -90)", R"("rpe": {"per_m": )"}) {
    EXPECT_THAT(found.out, HasSubstr(part));
  }
  const Outcome text = here.call({"compare", "b.tum", "a.tum"});
  EXPECT_EQ(text.status, 1);
  EXPECT_THAT(text.out, HasSubstr("at 3 poses of B, 1 of B outside"));
  EXPECT_THAT(text.out, HasSubstr("turned by 90 deg"));
}

TEST(CompareTrajectories, IsZeroOnlyForTheSamePositionsAtTheSameTimes) {
  const Workplace here;
  here.write("a.tum", kPath);
  here.write("b.tum", kPath);
  EXPECT_EQ(here.call({"compare", "a.tum", "b.tum"}).status, 0);
  std::string longer = kPath;
  longer += "3 10 10 0 0 0 0 1\n";
  here.write("longer.tum", longer);
  EXPECT_EQ(here.call({"compare", "a.tum", "longer.tum"}).status, 1);
}

TEST(CompareTrajectories, RefusesMapsOptionsOfMapsAndOtherTimes) {
  const Workplace here;
  here.write("a.tum", kPath);
  here.write("later.tum", "100 0 0 0 0 0 0 1\n");
  here.write("points.xyz", "1 2 3\n");
  expect_error(here.call({"compare", "a.tum", "later.tum"}), 2,
               {"later.tum", "never known at the same time", "the trajectory is from ", "the reference from "});
  here.write("far.tum", "0 0 0 0 0 0 0 1\n1 1e300 0 0 0 0 0 1\n");
  expect_error(here.call({"compare", "far.tum", "a.tum"}), 2, {"so far apart"});
  expect_error(here.call({"compare", "a.tum", "points.xyz"}), 2, {"points.xyz", "a trajectory (TUM)"});
  expect_error(here.call({"compare", "a.tum", "a.tum", "--layer", "0"}), 2, {"--layer", "maps"});
}

}  // namespace
}  // namespace pingvox::test
