#include "io/clouds/lzf.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "support/logs.hpp"

namespace pingvox {
namespace {

/// What comes out, or "broken" when it does not fill `size` bytes exactly.
std::string decompress(std::string_view hex, std::size_t size) {
  const auto compressed = from_hex(hex);
  std::vector<std::uint8_t> out(size);
  if (!lzf_decompress(compressed, out)) return "broken";
  return {out.begin(), out.end()};
}

TEST(Lzf, CopiesWhatStandsThere) {
  EXPECT_EQ(decompress("", 0), "");
  EXPECT_EQ(decompress("00 61", 1), "a");
  EXPECT_EQ(decompress("02 616263 00 64", 4), "abcd");
}

TEST(Lzf, RepeatsWhatWasThere) {
  EXPECT_EQ(decompress("02 616263 20 02", 6), "abcabc") << "three bytes from three back";
  EXPECT_EQ(decompress("01 6162 60 01", 7), "abababa") << "into what it makes itself";
  EXPECT_EQ(decompress("00 61 e0 ff 00", 265), std::string(265, 'a')) << "the longest";
  // From further back than one byte can say.
  const std::string far = "1f" + std::string(64, '1') + "e0 f7 00 21 16 00 62";
  EXPECT_EQ(decompress(far, 32 + 256 + 3 + 1), std::string(32 + 256 + 3, '\x11').append("b"));
}

TEST(Lzf, RefusesWhatIsNotThere) {
  EXPECT_EQ(decompress("20 00", 3), "broken") << "from before the start";
  EXPECT_EQ(decompress("00 61 20 01", 4), "broken") << "one further than the start";
  EXPECT_EQ(decompress("02 616263", 2), "broken") << "longer than there is room";
  EXPECT_EQ(decompress("02 616263", 4), "broken") << "shorter than it should be";
  EXPECT_EQ(decompress("00 61 e0 ff 00", 264), "broken");
  EXPECT_EQ(decompress("02 6162", 3), "broken") << "cut off";
  EXPECT_EQ(decompress("00 61 e0", 265), "broken");
  EXPECT_EQ(decompress("00 61 e0 ff", 265), "broken");
  EXPECT_EQ(decompress("00 61 20", 4), "broken");
}

}  // namespace
}  // namespace pingvox
