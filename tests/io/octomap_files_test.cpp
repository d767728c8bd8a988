#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>
#include <octomap/OcTreeStamped.h>

#include <filesystem>
#include <limits>
#include <sstream>

#include "io/map_samples.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/map/scan_update.hpp"

using namespace pingvox;
using namespace pingvox::samples;
using ::testing::HasSubstr;

namespace {

octomap::OcTreeKey octomap_key(const WideKey& key) {
  const auto word = [](WideWord w) { return static_cast<octomap::key_type>(w); };
  return {word(key.x), word(key.y), word(key.z)};
}

octomap::OcTree octree_of(const std::vector<Update>& updates, double resolution_m) {
  octomap::OcTree tree(resolution_m);
  for (const Update& update : updates) tree.updateNode(octomap_key(update.key), update.log_odds);
  return tree;
}

/// The peer's bytes. Its writeBinary changes the tree that it saves, so it gets a copy.
Bytes written_binary(const octomap::OcTree& tree) {
  octomap::OcTree copy(tree);
  std::ostringstream out;
  EXPECT_TRUE(copy.writeBinary(out));
  return bytes_of(out.str());
}

Bytes written_full(const octomap::AbstractOcTree& tree) {
  std::ostringstream out;
  EXPECT_TRUE(tree.write(out));
  return bytes_of(out.str());
}

std::vector<std::tuple<WideKey, int, std::uint32_t>> leaves_of(const octomap::OcTree& tree) {
  std::vector<std::tuple<WideKey, int, std::uint32_t>> leaves;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    const octomap::OcTreeKey key = leaf.getIndexKey();
    leaves.emplace_back(WideKey{key[0], key[1], key[2]}, static_cast<int>(leaf.getDepth()),
                        std::bit_cast<std::uint32_t>(leaf->getLogOdds()));
  }
  return leaves;
}

std::vector<std::tuple<WideKey, int, std::uint32_t>> sorted(std::vector<std::tuple<WideKey, int, std::uint32_t>> v) {
  std::sort(v.begin(), v.end());
  return v;
}

Bytes bt_of(std::string_view header_lines, std::string_view tree_hex) {
  Bytes bytes = bytes_of("# Octomap OcTree binary file\n" + std::string(header_lines) + "data\n");
  const Bytes tree = bytes_of_hex(tree_hex);
  bytes.insert(bytes.end(), tree.begin(), tree.end());
  return bytes;
}

Bytes ot_of(std::string_view header_lines, std::string_view tree_hex) {
  Bytes bytes = bytes_of("# Octomap OcTree file\n" + std::string(header_lines) + "data\n");
  const Bytes tree = bytes_of_hex(tree_hex);
  bytes.insert(bytes.end(), tree.begin(), tree.end());
  return bytes;
}

constexpr std::string_view kOneVoxelTree =
    "00c0 0300 0300 0300 0300 0300 0300 0300 0300 0300 0300 0300 0300 0300 0300 0200";
constexpr std::string_view kThreeLevelsTree = "0000803f80 0000803f01 0000803f02 0000803f00";

/// Refused with kCorrupt and these words.
void expect_corrupt(const Bytes& bytes, std::string_view words) {
  const auto map = read(bytes);
  ASSERT_FALSE(map) << words;
  EXPECT_EQ(map.error().code, Error::Code::kCorrupt);
  EXPECT_THAT(map.error().message, HasSubstr(std::string(words)));
  EXPECT_THAT(map.error().message, HasSubstr("test file"));
}

TEST(Bt, WritesTheBytesOfLiboctomap) {
  std::size_t bytes = 0, joined = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const double resolution_m = seed % 3 == 0 ? 0.05 : (seed % 3 == 1 ? 0.1 : 0.0125);
    const auto updates = random_updates(random, 16, random() % 3000 + 1);
    const OccupancyMap map = map_of(updates, {.resolution_m = resolution_m});
    const auto before = samples::leaves_of(map);
    const Bytes ours = to_bytes(map, Format::kBt);
    ASSERT_EQ(ours, written_binary(octree_of(updates, resolution_m)));
    EXPECT_EQ(samples::leaves_of(map), before) << "writing changed the map";
    bytes += ours.size();
    joined += static_cast<std::size_t>(
        std::count_if(before.begin(), before.end(), [](const auto& leaf) { return std::get<1>(leaf) < 16; }));
  }
  EXPECT_GT(bytes, 100'000U);
  EXPECT_GT(joined, 500U);
}

TEST(Bt, WritesTheBytesOfLiboctomapAfterScans) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    OccupancyMap map({.resolution_m = 0.1});
    octomap::OcTree tree(0.1);
    for (int n = 0; n < 10; ++n) {
      ScanUpdate scan{map.lattice(), LogOdds(tree.getProbMissLog())};
      octomap::KeySet hits, misses;
      for (const Update& update : random_updates(random, 16, 500)) {
        if (update.log_odds > 0.0F) {
          scan.add_hit(update.key, LogOdds(tree.getProbHitLog()));
          hits.insert(octomap_key(update.key));
        } else {
          scan.add_miss(update.key);
          misses.insert(octomap_key(update.key));
        }
      }
      ASSERT_TRUE(map.apply(scan));
      for (const auto& key : misses) {
        if (hits.count(key) == 0) tree.updateNode(key, false);
      }
      for (const auto& key : hits) tree.updateNode(key, true);
    }
    ASSERT_EQ(to_bytes(map, Format::kBt), written_binary(tree));
    ASSERT_EQ(to_bytes(map, Format::kOt), written_full(tree));
  }
}

// Kills a brick that is taken for free by the maximum that its node had before an editor raised a cell of it.
TEST(Bt, WritesWhatAnEditorHasNotSynchronizedYet) {
  std::size_t different = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const MapOptions options{.parents = seed % 4 == 0 ? Parents::kMean : Parents::kMax};
    OccupancyMap changed(options), synchronized(options);
    Editor lazy = changed.edit(seed % 3 == 0 ? Pruning::kNever : Pruning::kLazy);
    Editor eager = synchronized.edit(Pruning::kEachUpdate);
    Bytes last;
    for (int step = 0; step < 200; ++step) {
      const auto word = [&] { return WideWord{32768 + random() % 6}; };
      const WideKey key{word(), word(), word()};
      const LogOdds evidence(random() % 3 == 0 ? 4.0F : -4.0F);
      const int depth = 13 + static_cast<int>(random() % 4);
      const bool is_set = random() % 8 == 0;
      for (Editor* editor : {&lazy, &eager}) {
        is_set ? editor->set(key, depth, evidence) : editor->update(key, evidence);
      }
      const Bytes ours = to_bytes(changed, Format::kBt);
      ASSERT_EQ(ours, to_bytes(synchronized, Format::kBt)) << step;
      different += ours != last ? 1 : 0;
      last = ours;
    }
  }
  EXPECT_GT(different, 1000U);
}

TEST(Ot, WritesTheBytesOfLiboctomap) {
  std::size_t bytes = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const auto updates = random_updates(random, 16, random() % 3000 + 1);
    const Bytes ours = to_bytes(map_of(updates, {.resolution_m = 0.05}), Format::kOt);
    ASSERT_EQ(ours, written_full(octree_of(updates, 0.05)));
    bytes += ours.size();
  }
  EXPECT_GT(bytes, 400'000U);
}

TEST(Bt, ReadsWhatLiboctomapReads) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const Bytes bytes = written_binary(octree_of(random_updates(random, 16, 2000), 0.1));
    const auto ours = read(bytes);
    ASSERT_TRUE(ours) << ours.error().message;
    EXPECT_EQ(ours->format, Format::kBt);
    octomap::OcTree theirs(1.0);
    std::istringstream in(std::string(bytes.begin(), bytes.end()));
    ASSERT_TRUE(theirs.readBinary(in));
    EXPECT_EQ(sorted(samples::leaves_of(ours->map)), sorted(leaves_of(theirs)));
    EXPECT_EQ(to_bytes(ours->map, Format::kBt), bytes);
  }
}

TEST(Ot, ReadsWhatLiboctomapWrites) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const octomap::OcTree theirs = octree_of(random_updates(random, 16, 2000), 0.1);
    const Bytes bytes = written_full(theirs);
    const auto ours = read(bytes);
    ASSERT_TRUE(ours) << ours.error().message;
    EXPECT_EQ(ours->format, Format::kOt);
    EXPECT_EQ(sorted(samples::leaves_of(ours->map)), sorted(leaves_of(theirs)));
    EXPECT_EQ(to_bytes(ours->map, Format::kOt), bytes);
  }
}

TEST(Ot, ReadsColouredAndStampedTrees) {
  std::mt19937_64 random(7);
  const auto updates = random_updates(random, 16, 1000);
  octomap::ColorOcTree coloured(0.1);
  octomap::OcTreeStamped stamped(0.1);
  for (const Update& update : updates) {
    coloured.updateNode(octomap_key(update.key), update.log_odds);
    stamped.updateNode(octomap_key(update.key), update.log_odds);
  }
  // Without colours and times, in which they may differ within a joined leaf.
  const auto expected = samples::leaves_of(map_of(updates, {.resolution_m = 0.1}));
  const auto from_coloured = read(written_full(coloured));
  ASSERT_TRUE(from_coloured) << from_coloured.error().message;
  EXPECT_EQ(samples::leaves_of(from_coloured->map), expected);
  const auto from_stamped = read(written_full(stamped));
  ASSERT_TRUE(from_stamped) << from_stamped.error().message;
  EXPECT_EQ(samples::leaves_of(from_stamped->map), expected);
}

TEST(Ot, RefusesATreeOfAnotherKindByName) {
  const auto map = read(ot_of("id CountingOcTree\nsize 4\nres 0.1\n", kThreeLevelsTree));
  ASSERT_FALSE(map);
  EXPECT_EQ(map.error().code, Error::Code::kUnsupported);
  EXPECT_THAT(map.error().message, HasSubstr("CountingOcTree"));
}

TEST(Bt, ReadsTheFreiburgCorridor) {
  const std::string path = PINGVOX_SHARED_DATA "/octomap-share/geb079.bt";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const auto file = read_file(path);
  ASSERT_TRUE(file) << file.error().message;
  const auto map = read_map(*file);
  ASSERT_TRUE(map) << map.error().message;
  const MapCounts counts = map->map.counts();
  EXPECT_EQ(counts.nodes(), 532'566U);
  std::size_t occupied = 0, free = 0;
  for_each_leaf(map->map, {}, [&](const Leaf& leaf) { ++(leaf.belief > LogOdds(0.0F) ? occupied : free); });
  EXPECT_EQ(occupied, 143'729U);
  EXPECT_EQ(free, 284'415U);
  EXPECT_EQ(map->map.lattice().resolution_m(), 0.08);
  EXPECT_EQ(to_bytes(map->map, Format::kBt), file->bytes);
}

TEST(Bt, GoldenVoxelIsItsCell) {
  const Bytes bytes = bt_of("id OcTree\nsize 17\nres 0.1\n", kOneVoxelTree);
  ASSERT_EQ(bytes.size(), 92U);
  const auto map = read(bytes);
  ASSERT_TRUE(map) << map.error().message;
  const MapCounts counts = map->map.counts();
  EXPECT_EQ(counts.leaves, 1U);
  EXPECT_EQ(counts.inner, 16U);
  EXPECT_EQ(map->map.at(Key{32768, 32768, 32768}), Clamp{}.highest);
}

TEST(Bt, GoldenChildOrderIsXFastest) {
  std::string tree = "3f03";
  for (const auto& [middle, last] :
       {std::pair{"00c0", "0080"}, std::pair{"0030", "0010"}, std::pair{"000c", "0008"}, std::pair{"c000", "4000"}}) {
    for (int i = 0; i < 14; ++i) tree += middle;
    tree += last;
  }
  const Bytes bytes = bt_of("id OcTree\nsize 65\nres 0.1\n", tree);
  const auto map = read(bytes);
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->map.counts().leaves, 4U);
  EXPECT_EQ(map->map.at(Key{32767, 32767, 32767}), Clamp{}.highest);
  EXPECT_EQ(map->map.at(Key{32768, 32767, 32767}), Clamp{}.lowest);
  EXPECT_EQ(map->map.at(Key{32767, 32768, 32767}), Clamp{}.highest);
  EXPECT_EQ(map->map.at(Key{32767, 32767, 32768}), Clamp{}.lowest);
}

TEST(Ot, GoldenLeafAtDepthThreeIsItsCube) {
  const Bytes bytes = ot_of("id OcTree\nsize 4\nres 0.1\n", kThreeLevelsTree);
  ASSERT_EQ(bytes.size(), 72U);
  const auto map = read(bytes);
  ASSERT_TRUE(map) << map.error().message;
  const auto leaves = samples::leaves_of(map->map);
  ASSERT_EQ(leaves.size(), 1U);
  EXPECT_EQ(std::get<1>(leaves[0]), 3);
  const auto box = map->map.bounds();
  EXPECT_TRUE(box->min.isApprox(Eigen::Vector3d(819.2, 0.0, 0.0)));
  EXPECT_TRUE(box->max.isApprox(Eigen::Vector3d(1638.4, 819.2, 819.2)));
  EXPECT_EQ(map->map.at(Eigen::Vector3d(1228.8, 409.6, 409.6)), LogOdds(1.0F));
}

TEST(Bt, ReadsItsOldestForm) {
  Bytes bytes = bytes_of_hex("03000000 9a9999999999b93f 11000000");
  const Bytes tree = bytes_of_hex(kOneVoxelTree);
  bytes.insert(bytes.end(), tree.begin(), tree.end());
  const auto map = read(bytes);
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->map.lattice().resolution_m(), 0.1);
  EXPECT_EQ(map->map.at(Key{32768, 32768, 32768}), Clamp{}.highest);
  bytes.pop_back();
  expect_corrupt(bytes, "ends inside of the tree");
}

TEST(OctomapHeader, TakesWhatLiboctomapTakes) {
  for (const std::string_view header :
       {"id OcTree\r\nsize 17\r\nres 0.1\r\n", "res 0.1 size 17\nid Anything\n",
        "# a comment: data\nid OcTree\nsize 17\nres 1e-1\n", "id OcTree\nmade by hand\nsize 17\nres 0.1 # fine\n",
        "id OcTree size 17 res 0.1\n  "}) {
    SCOPED_TRACE(header);
    const auto map = read(bt_of(header, kOneVoxelTree));
    ASSERT_TRUE(map) << map.error().message;
    EXPECT_EQ(map->map.counts().nodes(), 17U);
    EXPECT_EQ(map->map.lattice().resolution_m(), 0.1);
  }
}

TEST(OctomapHeader, RefusesWhatIsMissingOrSenseless) {
  std::size_t cases = 0;
  for (const auto& [header, words] :
       {std::pair{"size 17\nres 0.1\n", "names no id"}, std::pair{"id OcTree\nres 0.1\n", "names no size"},
        std::pair{"id OcTree\nsize 17\n", "names no res"}, std::pair{"id OcTree\nsize 17\nres 0\n", "resolution"},
        std::pair{"id OcTree\nsize 17\nres -0.1\n", "resolution"}, std::pair{"id OcTree\nsize 17\nres nan\n", "res"},
        std::pair{"id OcTree\nsize 17\nres 1e-320\n", "res"}, std::pair{"id OcTree\nsize -17\nres 0.1\n", "size"},
        std::pair{"id OcTree\nsize 99999999999999999999\nres 0.1\n", "size"},
        std::pair{"id OcTree\nsize 17\nres 0.1x\n", "res"}}) {
    SCOPED_TRACE(header);
    expect_corrupt(bt_of(header, kOneVoxelTree), words);
    expect_corrupt(ot_of(header, kThreeLevelsTree), words);
    ++cases;
  }
  EXPECT_EQ(cases, 10U);
  expect_corrupt(bytes_of("# Octomap OcTree binary file\nid OcTree\nsize 17\nres 0.1\n"), "data");
  expect_corrupt(bytes_of("# Octomap OcTree file"), "data");
}

TEST(Bt, RefusesDamage) {
  const Bytes whole = bt_of("id OcTree\nsize 17\nres 0.1\n", kOneVoxelTree);
  for (std::size_t size = 60; size < whole.size(); ++size) {
    SCOPED_TRACE(size);
    expect_corrupt(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)), "ends inside of the tree");
  }
  Bytes longer = whole;
  longer.push_back(0);
  expect_corrupt(longer, "after the tree");
  expect_corrupt(bt_of("id OcTree\nsize 18\nres 0.1\n", kOneVoxelTree), "17 nodes and the header says 18");
  expect_corrupt(bt_of("id OcTree\nsize 2\nres 0.1\n", "0300 0000"), "without children");
  expect_corrupt(bt_of("id OcTree\nsize 1\nres 0.1\n", "0000"), "without children");
  expect_corrupt(bt_of("id OcTree\nsize 0\nres 0.1\n", kOneVoxelTree), "after the tree");
  std::string deep;
  for (int i = 0; i < 17; ++i) deep += "0300";
  expect_corrupt(bt_of("id OcTree\nsize 18\nres 0.1\n", deep), "below the 16th level");
  // A size that nothing backs takes no memory.
  expect_corrupt(bt_of("id OcTree\nsize 18446744073709551615\nres 0.1\n", kOneVoxelTree), "17 nodes");
}

TEST(Ot, RefusesDamage) {
  const Bytes whole = ot_of("id OcTree\nsize 4\nres 0.1\n", kThreeLevelsTree);
  for (std::size_t size = 52; size < whole.size(); ++size) {
    SCOPED_TRACE(size);
    expect_corrupt(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)), "ends inside of the tree");
  }
  Bytes longer = whole;
  longer.push_back(0);
  expect_corrupt(longer, "after the tree");
  expect_corrupt(ot_of("id OcTree\nsize 5\nres 0.1\n", kThreeLevelsTree), "4 nodes and the header says 5");
  expect_corrupt(ot_of("id OcTree\nsize 1\nres 0.1\n", "0000c07f00"), "log-odds of nan");
  expect_corrupt(ot_of("id OcTree\nsize 1\nres 0.1\n", "0000807f00"), "log-odds of inf");
  expect_corrupt(ot_of("id OcTree\nsize 2\nres 0.1\n", "000080ff01 0000803f00"), "log-odds of -inf");
  std::string deep;
  for (int i = 0; i < 17; ++i) deep += "0000803f01";
  expect_corrupt(ot_of("id OcTree\nsize 18\nres 0.1\n", deep + "0000803f00"), "below the 16th level");
}

TEST(Octomap, EmptyMapsGoBothWays) {
  const OccupancyMap empty({.resolution_m = 0.1});
  octomap::OcTree tree(0.1);
  EXPECT_EQ(to_bytes(empty, Format::kBt), written_binary(tree));
  EXPECT_EQ(to_bytes(empty, Format::kOt), written_full(tree));
  for (const Format format : {Format::kBt, Format::kOt}) {
    const auto map = read(to_bytes(empty, format));
    ASSERT_TRUE(map) << map.error().message;
    EXPECT_TRUE(map->map.empty());
  }
  const Bytes bytes = to_bytes(empty, Format::kBt);
  std::istringstream in(std::string(bytes.begin(), bytes.end()));
  EXPECT_TRUE(tree.readBinary(in));
  EXPECT_EQ(tree.size(), 0U);
}

// liboctomap writes such a tree so that it reads it back as solid rock.
TEST(Bt, FreeSpaceOfASingleLeafStaysFree) {
  OccupancyMap map({.resolution_m = 0.1});
  map.edit().set(Key{}, 0, LogOdds(-1.0F));
  const Bytes bytes = to_bytes(map, Format::kBt);
  std::istringstream in(std::string(bytes.begin(), bytes.end()));
  octomap::OcTree tree(1.0);
  ASSERT_TRUE(tree.readBinary(in));
  EXPECT_EQ(tree.size(), 9U);
  EXPECT_FALSE(tree.isNodeOccupied(tree.search(octomap::OcTreeKey(40000, 1, 60000))));
  const auto again = read(bytes);
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->map.at(Key{40000, 1, 60000}), Clamp{}.lowest);
}

TEST(Bt, LeavesOutWhatIsBetweenTheThresholds) {
  OccupancyMap map({.resolution_m = 0.1, .thresholds = {LogOdds(-0.5F), LogOdds(0.5F)}});
  {
    Editor editor = map.edit();
    editor.set(Key{32768, 32768, 32768}, 16, LogOdds(1.0F));
    editor.set(Key{32769, 32768, 32768}, 16, LogOdds(0.1F));
    editor.set(Key{100, 32768, 32768}, 16, LogOdds(0.1F));
    editor.set(Key{32768, 32769, 32768}, 16, LogOdds(-1.0F));
  }
  const auto again = read(to_bytes(map, Format::kBt));
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->map.counts().leaves, 2U);
  EXPECT_EQ(again->map.at(Key{32768, 32768, 32768}), Clamp{}.highest);
  EXPECT_EQ(again->map.at(Key{32768, 32769, 32768}), Clamp{}.lowest);
}

TEST(Bt, JoinsWhatTheMapWasToldNotToJoin) {
  OccupancyMap unjoined({.resolution_m = 0.1}), joined({.resolution_m = 0.1});
  for (OccupancyMap* const map : {&unjoined, &joined}) {
    Editor editor = map->edit(map == &joined ? Pruning::kLazy : Pruning::kNever);
    for (int i = 0; i < 4096; ++i) {
      const auto word = [&](int shift) { return static_cast<std::uint16_t>(32768 + ((i >> shift) & 15)); };
      editor.update(Key{word(0), word(4), word(8)}, LogOdds(0.85F));
    }
  }
  ASSERT_EQ(unjoined.counts().leaves, 4096U);
  EXPECT_EQ(to_bytes(unjoined, Format::kBt), to_bytes(joined, Format::kBt));
}

// A writer need not join equal cells. Kills a block that is all occupied and is read as free.
TEST(Bt, ReadsBlocksThatAreOccupiedOrFreeAsAWhole) {
  constexpr std::string_view kDownToTheBlock = "00c0 0300 0300 0300 0300 0300 0300 0300 0300 0300 0300 0300 0300 0300";
  const auto repeated = [](std::string_view word) {
    std::string words;
    for (int i = 0; i < 8; ++i) words += word;
    return words;
  };
  for (const auto& [word, value] : {std::pair("aaaa", Clamp{}.highest), std::pair("5555", Clamp{}.lowest)}) {
    for (const std::string& block : {std::string(word), "ffff" + repeated(word)}) {
      SCOPED_TRACE(block);
      const std::string header = fmt::format("id OcTree\nsize {}\nres 0.1\n", block == word ? 23 : 87);
      const auto map = read(bt_of(header, std::string(kDownToTheBlock) + block));
      ASSERT_TRUE(map) << map.error().message;
      EXPECT_EQ(map->map.counts().leaves, 1U);
      for (const int cell : {0, 1, 2, 3}) {
        const auto at = static_cast<std::uint16_t>(32768 + cell);
        EXPECT_EQ(map->map.at(Key{at, 32768, 32771}), value);
      }
      EXPECT_EQ(map->map.at(Key{32772, 32768, 32768}), std::nullopt);
    }
  }
}

TEST(Octomap, ResolutionSurvives) {
  for (const double resolution_m : {0.05, 0.1, 0.0123456789012345, 1e-7, 1.0 / 3.0, 123456789.0}) {
    OccupancyMap map({.resolution_m = resolution_m});
    map.edit().set(Key{1, 2, 3}, 16, LogOdds(1.0F));
    for (const Format format : {Format::kBt, Format::kOt}) {
      const Bytes bytes = to_bytes(map, format);
      const auto again = read(bytes);
      ASSERT_TRUE(again) << again.error().message;
      EXPECT_EQ(again->map.lattice().resolution_m(), resolution_m);
      std::istringstream in(std::string(bytes.begin(), bytes.end()));
      if (format == Format::kBt) {
        octomap::OcTree tree(1.0);
        ASSERT_TRUE(tree.readBinary(in));
        EXPECT_EQ(tree.getResolution(), resolution_m);
      }
    }
  }
}

TEST(Octomap, RefusesMapsOfOtherDepthsAndNamesAFormatForThem) {
  for (const int depth : {1, 15, 17, 128}) {
    const OccupancyMap map({.resolution_m = 0.1, .depth = depth});
    for (const Format format : {Format::kBt, Format::kOt}) {
      std::ostringstream out;
      const auto done = write_map(map, format, "", out);
      ASSERT_FALSE(done);
      EXPECT_EQ(done.error().code, Error::Code::kUnsupported);
      EXPECT_THAT(done.error().message, HasSubstr(".pvx"));
      EXPECT_THAT(done.error().message, HasSubstr("16 levels"));
      EXPECT_EQ(out.str(), "");
    }
  }
}

TEST(Octomap, StopsAtTheMemoryLimit) {
  std::mt19937_64 random(3);
  const OccupancyMap map = map_of(random_updates(random, 16, 20000), {.resolution_m = 0.1});
  for (const Format format : {Format::kBt, Format::kOt, Format::kPvx}) {
    const Bytes bytes = to_bytes(map, format);
    const auto refused = read(bytes, map.memory_bytes() / 2);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Error::Code::kLimit);
    EXPECT_TRUE(read(bytes, map.memory_bytes() * 2));
  }
}

}  // namespace
