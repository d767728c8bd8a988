#include "io/bags/unpack.hpp"

#include <bzlib.h>
#include <gtest/gtest.h>
#include <lz4frame.h>
#include <zstd.h>

#include <array>
#include <random>
#include <string>
#include <vector>

namespace pingvox {
namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr std::array kAll = {Compression::kBz2, Compression::kLz4, Compression::kZstd};

Bytes packed_bz2(const Bytes& bytes) {
  Bytes packed(bytes.size() + bytes.size() / 100 + 600);
  auto size = static_cast<unsigned>(packed.size());
  Bytes copy = bytes;
  EXPECT_EQ(BZ2_bzBuffToBuffCompress(reinterpret_cast<char*>(packed.data()), &size,
                                     reinterpret_cast<char*>(copy.data()), static_cast<unsigned>(copy.size()), 9, 0, 0),
            BZ_OK);
  packed.resize(size);
  return packed;
}

Bytes packed_by(Compression compression, const Bytes& bytes) {
  if (compression == Compression::kBz2) return packed_bz2(bytes);
  Bytes packed(compression == Compression::kLz4 ? LZ4F_compressFrameBound(bytes.size(), nullptr)
                                                : ZSTD_compressBound(bytes.size()));
  packed.resize(compression == Compression::kLz4
                    ? LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), nullptr)
                    : ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 3));
  return packed;
}

/// A megabyte that packs well, and some that hardly does.
Bytes recorded() {
  std::mt19937_64 random(1);
  Bytes bytes(1'000'000);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::uint8_t>(i < 900'000 ? i / 5000 : random());
  }
  return bytes;
}

TEST(Unpack, GivesBackWhatWasPacked) {
  const Bytes bytes = recorded();
  for (const Compression compression : kAll) {
    UnpackBudget budget;
    Bytes to;
    EXPECT_TRUE(unpack(compression, packed_by(compression, bytes), bytes.size(), budget, to).is_whole);
    EXPECT_TRUE(to == bytes);
    EXPECT_FALSE(unpack(compression, packed_by(compression, bytes), bytes.size() + 1, budget, to).is_whole)
        << "one byte is missing";
    EXPECT_TRUE(to == bytes);
  }
}

// Kills a loop that ends when the room is full for the first time: frames one behind the other are one chunk.
TEST(Unpack, ReadsFramesBehindEachOther) {
  const Bytes bytes = recorded();
  for (const Compression compression : {Compression::kLz4, Compression::kZstd}) {
    const Bytes packed = packed_by(compression, bytes);
    UnpackBudget budget;
    Bytes twice = packed, to;
    twice.insert(twice.end(), packed.begin(), packed.end());
    EXPECT_TRUE(unpack(compression, twice, 2 * bytes.size(), budget, to).is_whole);
    EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), to.begin() + 1'000'000));
  }
}

// Kills memory for what a damaged size claims.
TEST(Unpack, TakesNoMemoryForBytesThatAreNotThere) {
  const Bytes bytes = recorded();
  for (const Compression compression : kAll) {
    const Bytes packed = packed_by(compression, bytes);
    UnpackBudget budget;
    Bytes to;
    EXPECT_FALSE(unpack(compression, packed, 900 * packed.size(), budget, to).is_whole);
    EXPECT_LT(to.capacity(), 4 * bytes.size());
    EXPECT_TRUE(unpack(compression, packed, 2000 * packed.size(), budget, to).is_refused) << "out of proportion";
    EXPECT_TRUE(to.empty());
  }
}

TEST(Unpack, KeepsTheBeginningOfDamagedData) {
  const Bytes bytes = recorded();
  for (const Compression compression : kAll) {
    Bytes packed = packed_by(compression, bytes);
    packed.resize(packed.size() - packed.size() / 4);
    UnpackBudget budget;
    Bytes to;
    EXPECT_FALSE(unpack(compression, packed, bytes.size(), budget, to).is_whole);
    ASSERT_LT(to.size(), bytes.size());
    EXPECT_TRUE(std::equal(to.begin(), to.end(), bytes.begin()));
  }
}

// Kills a file of many small chunks that each unpack to little enough.
TEST(Unpack, AllChunksOfAFileShareWhatItMayUnpackTo) {
  UnpackBudget budget;
  constexpr std::uint64_t kPacked = 100'000, kUnpacked = 80'000'000;
  std::size_t unpacked = 0;
  for (int chunk = 0; chunk < 20; ++chunk) {
    if (budget.limit(kPacked) < kUnpacked) continue;
    budget.add(kPacked, kUnpacked);
    ++unpacked;
  }
  EXPECT_EQ(unpacked, 1U);
  // Chunks that were refused do not pay for later ones, and usual ones are always allowed.
  EXPECT_LT(budget.limit(kPacked), kUnpacked);
  for (int chunk = 0; chunk < 10'000; ++chunk) {
    ASSERT_GE(budget.limit(100'000), 1'000'000U);
    budget.add(100'000, 1'000'000);
  }
}

// Kills frames of other writers, which do not say what they unpack to, and cut ones that pass for whole.
TEST(Unpack, AFrameOfUnknownSizeIsWholeAtItsEnd) {
  const Bytes bytes = recorded();
  Bytes packed(ZSTD_compressBound(bytes.size()));
  ZSTD_CCtx* const context = ZSTD_createCCtx();
  ZSTD_CCtx_setParameter(context, ZSTD_c_contentSizeFlag, 0);
  packed.resize(ZSTD_compress2(context, packed.data(), packed.size(), bytes.data(), bytes.size()));
  ZSTD_freeCCtx(context);
  ASSERT_TRUE(begins_zstd(packed));
  UnpackBudget budget;
  Bytes to;
  EXPECT_TRUE(unpack_zstd_frame(packed, budget, to).is_whole);
  EXPECT_TRUE(to == bytes);
  packed.resize(packed.size() - 3);
  EXPECT_FALSE(unpack_zstd_frame(packed, budget, to).is_whole);
}

}  // namespace
}  // namespace pingvox
