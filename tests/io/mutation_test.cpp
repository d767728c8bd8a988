#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "fuzz/bodies/bag.hpp"
#include "fuzz/bodies/beams.hpp"
#include "fuzz/bodies/maps.hpp"
#include "fuzz/bodies/mesh.hpp"
#include "fuzz/bodies/nav.hpp"
#include "fuzz/bodies/scans.hpp"
#include "fuzz/bodies/tum.hpp"
#include "pingvox/io/file.hpp"
#include "support/mutants.hpp"
#include "support/rounds.hpp"

// Each fuzz body on its corpus and on some thousand damaged copies of it.
namespace pingvox {
namespace {

struct Reader {
  const char* name;                                    ///< of its folder in fuzz/corpus
  std::size_t (*body)(std::span<const std::uint8_t>);  ///< throws at a broken promise; what it could read
};

class Mutation : public testing::TestWithParam<Reader> {};

TEST_P(Mutation, KeepsItsPromises) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(PINGVOX_FUZZ_CORPUS "/") + GetParam().name)) {
    paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  std::vector<std::vector<std::uint8_t>> seeds;
  for (const auto& path : paths) {
    SCOPED_TRACE(path);
    auto file = read_file(path.string());
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_NO_THROW(GetParam().body(file->view()));
    seeds.push_back(std::move(file->bytes));
  }
  ASSERT_FALSE(seeds.empty());

  std::size_t readable = 0;
  constexpr std::size_t kMutants = test::rounds(10'000);
  for (std::size_t i = 0; i < kMutants; ++i) {
    std::mt19937_64 random(i);
    const auto& seed = seeds[i % seeds.size()];
    const auto bytes = mutant(seed, seeds[random() % seeds.size()], random);
    EXPECT_NO_THROW(readable += GetParam().body(bytes) > 0 ? 1 : 0) << "mutant " << i;
  }
  // What is refused at the door tests the door only.
  EXPECT_GT(readable, kMutants / 20);
}

INSTANTIATE_TEST_SUITE_P(
    Readers, Mutation,
    testing::Values(Reader{"mat", fuzz::beams}, Reader{"csv", fuzz::beams}, Reader{"pingviewer", fuzz::beams},
                    Reader{"svlog", fuzz::beams}, Reader{"pingtext", fuzz::beams}, Reader{"seanet", fuzz::beams},
                    Reader{"v4log", fuzz::beams}, Reader{"dumplog", fuzz::beams}, Reader{"bag", fuzz::bag},
                    Reader{"db3", fuzz::bag}, Reader{"mcap", fuzz::bag}, Reader{"graph", fuzz::scans},
                    Reader{"log", fuzz::scans}, Reader{"ply", fuzz::scans}, Reader{"pcd", fuzz::scans},
                    Reader{"xtf", fuzz::scans}, Reader{"xyz", fuzz::scans}, Reader{"mesh", fuzz::mesh},
                    Reader{"tum", fuzz::tum}, Reader{"tlog", fuzz::nav}, Reader{"dataflash", fuzz::nav},
                    Reader{"navcsv", fuzz::nav}, Reader{"a50", fuzz::nav}, Reader{"nmea", fuzz::nav},
                    Reader{"ictineu", fuzz::nav}, Reader{"ictineu_is", fuzz::beams}, Reader{"bt", fuzz::maps},
                    Reader{"ot", fuzz::maps}, Reader{"pvx", fuzz::pvx}),
    [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace pingvox
