#pragma once

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cstdint>

namespace pingvox::test {

/// Calls f() once for each kind of kernels that this machine can run, which are then those that run. The narrowest
/// are scalar.
template <class F>
void for_each_kernel(F&& f) {
  int kinds = 0;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    SCOPED_TRACE(hwy::TargetName(target));
    f();
    ++kinds;
  }
  hwy::SetSupportedTargetsForTest(0);
  EXPECT_GE(kinds, 1);
}

}  // namespace pingvox::test
