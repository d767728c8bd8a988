#include "base/suggest.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

namespace pingvox {
namespace {

TEST(NearestWord, IsTheOneThatWasMeantOrNone) {
  const std::vector<std::string> words = {"--resolution", "--min-range", "--max-range", "--ray", "map", "none"};
  EXPECT_EQ(nearest_word("--resoluton", words), "--resolution");
  EXPECT_EQ(nearest_word("--reslution", words), "--resolution");
  EXPECT_EQ(nearest_word("--min_range", words), "--min-range");
  EXPECT_EQ(nearest_word("-ray", words), "--ray");
  EXPECT_EQ(nearest_word("amp", words), "map");
  EXPECT_EQ(nearest_word("--reso", words), "--resolution");
  EXPECT_EQ(nearest_word("gaussian", words), std::nullopt);
  EXPECT_EQ(nearest_word("", words), std::nullopt);
  EXPECT_EQ(nearest_word(std::string(100'000, 'a'), words), std::nullopt);
}

}  // namespace
}  // namespace pingvox
