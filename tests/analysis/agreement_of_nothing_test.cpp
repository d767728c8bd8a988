#include <gtest/gtest.h>

#include "pingvox/analysis/map_agreement.hpp"

namespace pingvox {
namespace {

// Kills shares of nothing, and of counts that are not known.
TEST(AgreementOfNothing, HasNoShares) {
  MapAgreement nothing;
  nothing.a_near_b = nothing.found_by_a = nothing.free_near = 0;
  EXPECT_FALSE(nothing.precision());
  EXPECT_FALSE(nothing.recall());
  EXPECT_FALSE(nothing.free_true());
  EXPECT_FALSE(nothing.free_true_near());

  MapAgreement not_known;
  not_known.occupied_a = not_known.to_find = not_known.free_a = 5;
  EXPECT_FALSE(not_known.precision());
  EXPECT_FALSE(not_known.recall());
  EXPECT_FALSE(not_known.free_true_near());
  EXPECT_EQ(not_known.free_true(), 0.0);
}

}  // namespace
}  // namespace pingvox
