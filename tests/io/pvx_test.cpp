#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <filesystem>
#include <sstream>

#include "io/map_samples.hpp"
#include "pingvox/io/file.hpp"

using namespace pingvox;
using namespace pingvox::samples;
using ::testing::HasSubstr;

namespace {

void set_u32(Bytes& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
}

/// With a checksum that fits, so that a test gets past it.
Bytes with_checksum(Bytes bytes) {
  if (bytes.size() < 4) return bytes;
  const std::size_t end = bytes.size() - 4;
  set_u32(bytes, end, static_cast<std::uint32_t>(crc32_z(crc32_z(0, nullptr, 0), bytes.data(), end)));
  return bytes;
}

void expect_refused(const Bytes& bytes, Error::Code code, std::string_view words) {
  const auto map = read(bytes);
  ASSERT_FALSE(map) << words;
  EXPECT_EQ(map.error().code, code) << map.error().message;
  EXPECT_THAT(map.error().message, HasSubstr(std::string(words)));
}

/// Two levels, one cell hit and one octant free.
OccupancyMap tiny_map() {
  OccupancyMap map({.resolution_m = 0.5, .depth = 2, .parents = Parents::kMean});
  Editor editor = map.edit();
  editor.set(BasicKey<std::uint8_t>{0, 0, 0}, 1, LogOdds(-1.0F));
  editor.set(BasicKey<std::uint8_t>{3, 2, 2}, 2, LogOdds(1.0F));
  editor.synchronize();
  return map;
}

Bytes tiny_bytes() {
  return bytes_of_hex(
      "50494e47564f584d 01000000 04000000"   // PINGVOXM, version 1, 4 bytes say how it was made
      "02 01 03 00 00000000"                 // 2 levels, parents by mean, the root is an inner node
      "000000000000e03f"                     // 0.5 m
      "750000c0 bab46040 00000000 00000000"  // clamp, thresholds
      "0200000000000000 0200000000000000"    // 2 inner nodes, 2 leaves
      "74657374"                             // test
      "01c0 000080bf 0400 0000803f"          // octant 0 a leaf, -1; octant 7 inner: its child 1 a leaf, 1
      "d81d478d");
}

TEST(Pvx, GoldenBytes) {
  // Made by hand; the checksum is what Python's zlib.crc32 says of the rest.
  EXPECT_EQ(to_bytes(tiny_map(), Format::kPvx, "test"), tiny_bytes());
  const auto map = read(tiny_bytes());
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->format, Format::kPvx);
  EXPECT_EQ(map->made_by, "test");
  EXPECT_EQ(map->map.options().parents, Parents::kMean);
  EXPECT_EQ(leaves_of(map->map), leaves_of(tiny_map()));
}

TEST(Pvx, KeepsEachBitAtAnyDepth) {
  std::size_t leaves = 0;
  for (const int depth : {1, 2, 3, 8, 16, 17, 32, 33, 64, 65, 128}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      SCOPED_TRACE(::testing::Message() << "depth " << depth << " seed " << seed);
      std::mt19937_64 random(seed);
      const MapOptions options{.resolution_m = 1.0 / static_cast<double>(random() % 1000 + 1),
                               .depth = depth,
                               .clamp = {LogOdds(-1.5F - 1e-6F), LogOdds(4.25F)},
                               .thresholds = {LogOdds(-0.25F), LogOdds(0.125F)},
                               .parents = seed % 2 == 0 ? Parents::kMax : Parents::kMean};
      OccupancyMap map = map_of(random_updates(random, depth, 500), options);
      {
        // Cells all over the lattice, of all sizes, with beliefs of all bits.
        Editor editor = map.edit();
        for (int i = 0; i < 20; ++i) {
          const WideWord mask = depth == 128 ? ~WideWord{0} : (WideWord{1} << depth) - 1;
          const auto word = [&] { return ((WideWord{random()} << 64) | random()) & mask; };
          const WideKey key{word(), word(), word()};
          const int at = std::min(depth, static_cast<int>(random() % 128) + (depth > 2 ? 2 : 1));
          editor.set(key, at, LogOdds(static_cast<float>(random() % 1000003) * 1e-6F - 0.5F));
        }
      }
      const std::string made_by = "depth = " + std::to_string(depth) + "\n";
      const auto again = read(to_bytes(map, Format::kPvx, made_by));
      ASSERT_TRUE(again) << again.error().message;
      EXPECT_EQ(leaves_of(again->map), leaves_of(map));
      EXPECT_EQ(again->made_by, made_by);
      const MapOptions& read_options = again->map.options();
      EXPECT_EQ(read_options.resolution_m, options.resolution_m);
      EXPECT_EQ(read_options.depth, depth);
      EXPECT_EQ(read_options.parents, options.parents);
      EXPECT_EQ(read_options.clamp.lowest, options.clamp.lowest);
      EXPECT_EQ(read_options.clamp.highest, options.clamp.highest);
      EXPECT_EQ(read_options.thresholds.lower, options.thresholds.lower);
      EXPECT_EQ(read_options.thresholds.upper, options.thresholds.upper);
      EXPECT_EQ(to_bytes(again->map, Format::kPvx, made_by), to_bytes(map, Format::kPvx, made_by));
      leaves += leaves_of(map).size();
    }
  }
  EXPECT_GT(leaves, 9'000U);
}

TEST(Pvx, KeepsEmptyMapsAndSingleLeaves) {
  for (const int depth : {1, 2, 16, 128}) {
    OccupancyMap map({.resolution_m = 0.1, .depth = depth});
    auto again = read(to_bytes(map, Format::kPvx));
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_TRUE(again->map.empty());
    map.edit().set(WideKey{}, 0, LogOdds(-0.75F));
    again = read(to_bytes(map, Format::kPvx));
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(leaves_of(again->map), leaves_of(map));
    EXPECT_EQ(again->map.counts().nodes(), 1U);
  }
}

TEST(Pvx, RefusesEachTruncationAndEachFlippedBit) {
  const Bytes whole = to_bytes(tiny_map(), Format::kPvx, "test");
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(read(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)))) << size;
  }
  for (std::size_t bit = 0; bit < whole.size() * 8; ++bit) {
    Bytes flipped = whole;
    flipped[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    EXPECT_FALSE(read(flipped)) << bit;
  }
  Bytes longer = whole;
  longer.push_back(0);
  expect_refused(longer, Error::Code::kCorrupt, "checksum");
  expect_refused(with_checksum(longer), Error::Code::kCorrupt, "lengths");
}

TEST(Pvx, RefusesALaterVersionByItsNumber) {
  Bytes bytes = tiny_bytes();
  bytes[8] = 2;
  expect_refused(with_checksum(bytes), Error::Code::kUnsupported, "version 2");
}

TEST(Pvx, RefusesSenselessHeadersAndTrees) {
  const auto with = [](std::size_t at, std::string_view hex) {
    Bytes bytes = tiny_bytes();
    const Bytes patch = bytes_of_hex(hex);
    std::copy(patch.begin(), patch.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at));
    return with_checksum(bytes);
  };
  const auto corrupt = Error::Code::kCorrupt;
  expect_refused(with(12, "ffffffff"), corrupt, "lengths");
  expect_refused(with(16, "00"), corrupt, "depth");
  expect_refused(with(16, "81"), corrupt, "depth");
  expect_refused(with(16, "01"), corrupt, "below the last level");
  expect_refused(with(17, "02"), corrupt, "parent rule");
  expect_refused(with(18, "02"), corrupt, "root");
  expect_refused(with(18, "00"), corrupt, "header says");
  expect_refused(with(19, "01"), corrupt, "reserved");
  expect_refused(with(20, "01"), corrupt, "reserved");
  expect_refused(with(24, "0000000000000000"), corrupt, "resolution");
  expect_refused(with(24, "000000000000f87f"), corrupt, "resolution");
  expect_refused(with(32, "0000c07f"), corrupt, "clamp");
  expect_refused(with(40, "0000c07f"), corrupt, "threshold");
  expect_refused(with(48, "ffffffffffffffff"), corrupt, "lengths");
  expect_refused(with(56, "0000000000000080"), corrupt, "lengths");
  // 2 more inner nodes and 1 leaf less are as many bytes.
  expect_refused(with(48, "0400000000000000 0100000000000000"), corrupt, "header says");
  expect_refused(with(68, "0000"), corrupt, "without children");
  expect_refused(with(68, "02c0"), corrupt, "unknown node type");
  expect_refused(with(68, "55c0"), corrupt, "more bytes");
  expect_refused(with(70, "0000c07f"), corrupt, "log-odds of nan");
}

TEST(Maps, RefuseWhatIsNoMap) {
  for (const std::string_view text : {"", "hello", "# Octomap", "PINGVOX"}) {
    const auto map = read(bytes_of(text));
    ASSERT_FALSE(map);
    EXPECT_EQ(map.error().code, Error::Code::kUnsupported);
    EXPECT_THAT(map.error().message, HasSubstr("not a map"));
  }
  std::ostringstream out;
  const auto done = write_map(tiny_map(), Format::kCsv, "", out);
  ASSERT_FALSE(done);
  EXPECT_THAT(done.error().message, HasSubstr(".pvx"));
}

// Else the mutants and the fuzzers start from nothing.
TEST(Maps, CorporaAreRead) {
  std::size_t files = 0;
  for (const std::string_view format : {"bt", "ot", "pvx"}) {
    for (const auto& entry : std::filesystem::directory_iterator(std::string(PINGVOX_FUZZ_CORPUS "/").append(format))) {
      SCOPED_TRACE(entry.path());
      const auto file = read_file(entry.path().string());
      ASSERT_TRUE(file) << file.error().message;
      const auto map = read_map(*file);
      ASSERT_TRUE(map) << map.error().message;
      EXPECT_EQ(name_of(map->format), format);
      ++files;
    }
  }
  EXPECT_GE(files, 9U);
}

TEST(Maps, SayWhenTheStreamIsBad) {
  for (const Format format : {Format::kPvx, Format::kPly}) {
    std::ostringstream out;
    out.setstate(std::ios::badbit);
    const auto done = write_map(tiny_map(), format, "", out);
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().code, Error::Code::kIo);
  }
}

}  // namespace
