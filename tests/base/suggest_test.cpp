#include "base/suggest.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <random>
#include <string>
#include <string_view>
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

/// Fewest steps from one word to the other, by trying all: no letter is touched twice.
std::size_t steps_between(std::string_view a, std::string_view b) {
  if (a.empty() || b.empty()) return a.size() + b.size();
  const std::size_t replaced = steps_between(a.substr(1), b.substr(1)) + (a[0] == b[0] ? 0 : 1);
  std::size_t fewest = std::min({steps_between(a.substr(1), b) + 1, steps_between(a, b.substr(1)) + 1, replaced});
  if (a.size() > 1 && b.size() > 1 && a[0] == b[1] && a[1] == b[0]) {
    fewest = std::min(fewest, steps_between(a.substr(2), b.substr(2)) + 1);
  }
  return fewest;
}

TEST(EditDistance, IsTheFewestSteps) {
  std::mt19937_64 random(5);
  const auto word = [&random] {
    std::string letters(random() % 6, ' ');
    for (char& letter : letters) letter = static_cast<char>('a' + random() % 3);
    return letters;
  };
  for (int i = 0; i < 500; ++i) {
    const std::string a = word(), b = word();
    EXPECT_EQ(detail::edit_distance(a, b), steps_between(a, b)) << "'" << a << "' '" << b << "' of seed 5";
  }
}

}  // namespace
}  // namespace pingvox
