#include "pingvox/io/format.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "support/logs.hpp"
#include "support/mat5_writer.hpp"

namespace pingvox {
namespace {

std::optional<Format> format_of_text(std::string_view text) {
  return format_of(bytes_of(text));
}

TEST(Format, IsToldByContent) {
  EXPECT_EQ(format_of_text("# Octomap OcTree binary file\nid OcTree\n"), Format::kBt);
  EXPECT_EQ(format_of_text("# Octomap OcTree file of mine\n"), Format::kOt);
  EXPECT_EQ(format_of_text("PINGVOXM..."), Format::kPvx);
  EXPECT_EQ(format_of_text("# beams\n\ntime_s,bearing_rad,bin_length_m,intensities\n"), Format::kCsv);
  EXPECT_EQ(format_of_text("# scans\nNODE 1 2 3 4 5 6\n"), Format::kScanLog);
  EXPECT_EQ(format_of_text("# poses\n1.5 1 2 3 0 0 0 1\n"), Format::kTum);
  EXPECT_EQ(format_of_text("1.5,1,2,3,0,0,0,1\r\n"), Format::kTum);
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    const auto file = mat5_writer::file({}, order);
    EXPECT_EQ(format_of(file), Format::kMat);
  }
  EXPECT_EQ(format_of(from_hex("00000000 00000000")), Format::kScanGraph);
}

TEST(Format, TellsCloudsFromMeshes) {
  const std::string head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n";
  EXPECT_EQ(format_of_text(head + "end_header\n"), Format::kPly);
  EXPECT_EQ(format_of_text(head + "element face 0\nproperty list uchar int vertex_indices\nend_header\n"),
            Format::kPly);
  EXPECT_EQ(format_of_text(head + "element face 1\nproperty list uchar int vertex_indices\nend_header\n"),
            Format::kPlyMesh);
  EXPECT_EQ(format_of_text("ply\r\nelement vertex"), Format::kPly) << "its reader says what is wrong with it";
  EXPECT_EQ(format_of_text("plywood\n"), std::nullopt);
  EXPECT_EQ(format_of_text("# .PCD v.7 - Point Cloud Data file format\n"), Format::kPcd);
  EXPECT_EQ(format_of_text("# mine\nVERSION .5\nCOLUMNS x y z\n"), Format::kPcd);
  EXPECT_EQ(format_of_text("VERSION 3 of my diary\nDear diary\n"), std::nullopt);
  EXPECT_EQ(format_of_text("# a hull\nOFF\n8 6 0\n"), Format::kOff);
  EXPECT_EQ(format_of_text("OFFICE hours\n"), std::nullopt);
  EXPECT_EQ(format_of_text("solid hull\n  facet normal 0 0 1\n"), Format::kStl);
  EXPECT_EQ(format_of_text("solid ground under my feet\nat last\n"), std::nullopt);
  std::vector<std::uint8_t> stl(80 + 4 + 50);
  stl[80] = 1;
  EXPECT_EQ(format_of(stl), Format::kStl);
  stl.push_back(0);
  EXPECT_EQ(format_of(stl), std::nullopt);
  EXPECT_EQ(format_of(std::vector<std::uint8_t>(84)), std::nullopt) << "nothing but zeros";
}

TEST(Format, TellsXyzFromOtherColumnsOfNumbers) {
  EXPECT_EQ(format_of_text("1 2 3\n4 5 6\n"), Format::kXyz);
  EXPECT_EQ(format_of_text("# X,Y,Z\n1,-2.5,3e2,77\n"), Format::kXyz);
  EXPECT_EQ(format_of_text("1\t2\t3\n"), Format::kXyz);
  EXPECT_EQ(format_of_text("1 2\n"), std::nullopt);
  EXPECT_EQ(format_of_text("10 20 30 and I am coming\n"), std::nullopt);
  EXPECT_EQ(format_of_text("10.25,3.14,0.0125,0,43,68,90,1,2,3,4,5,6,7,8,9,10\n"), std::nullopt)
      << "beams without a header";
  EXPECT_EQ(format_of_text("1 0 2 27 28\n1 1 14 27 28 29 30 31 32 33 34 35 36 37 38 39 40\n"), std::nullopt)
      << "the same with a short one first";
  // As many columns as a trajectory has, or one more or less.
  EXPECT_EQ(format_of_text("1 2 3 0.1 200 10 0 77\n1 2 3 0.2 200 10 0 78\n"), Format::kXyz);
  EXPECT_EQ(format_of_text("1 2 3 0 0 1 9\n1 2 3 0 1 0 9\n"), Format::kXyz) << "with normals";
  EXPECT_EQ(format_of_text("1 2 3 0 0 1 255 0 0\n"), Format::kXyz) << "with normals and colours";
  EXPECT_EQ(format_of_text("1.5 1 2 3 0 0 0\n2.5 1 2 3 0 0 0 1\n"), Format::kTum) << "its first line is damaged";
  EXPECT_EQ(format_of_text("1.5 1 2 3 0.5 0.5 0.5 0.5\n"), Format::kTum);
}

TEST(Format, KnowsTheOldestBinaryTree) {
  // i32 3, f64 0.1, u32 9 nodes; a root of eight leaves.
  const auto bytes = from_hex("03000000 9a9999999999b93f 09000000 aaaa");
  EXPECT_EQ(format_of(bytes), Format::kBt);
}

TEST(Format, TellsAGraphOfThreeScansFromTheOldestTree) {
  std::vector<std::uint8_t> bytes = from_hex("03000000 01000000 03000000");
  bytes.resize(bytes.size() + 24 + 28 + 36 + 4);
  bytes[36] = 3;
  bytes[64] = 4;
  EXPECT_EQ(format_of(bytes), Format::kScanGraph);
}

TEST(Format, IsNothingForNothing) {
  EXPECT_EQ(format_of({}), std::nullopt);
  for (int byte = 0; byte < 256; ++byte) {
    const std::uint8_t bytes[] = {static_cast<std::uint8_t>(byte)};
    EXPECT_EQ(format_of(bytes), std::nullopt) << byte;
  }
  EXPECT_EQ(format_of_text("\n\n\n"), std::nullopt);
  EXPECT_EQ(format_of_text("# only a comment"), std::nullopt);
  EXPECT_EQ(format_of_text("hello, world\n"), std::nullopt);
  EXPECT_EQ(format_of_text("NODELIST\n"), std::nullopt);
}

TEST(Format, IsToldWithoutReadingPastTheEndOfWhatBeginsLikeAKind) {
  for (const std::string_view hex :
       {"03000000 9a9999999999b93f 09000000 aaaa", "01000000 01000000 03000000 00000000", "03000000 ffffffff ffffff"}) {
    const auto bytes = from_hex(hex);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      EXPECT_EQ(format_of(std::span(bytes).first(size)),
                bytes[4] == 0x9a && size >= 16 ? std::optional(Format::kBt) : std::nullopt)
          << size;
    }
  }
}

TEST(Format, IsNothingForNoise) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 10'000; ++i) {
    std::vector<std::uint8_t> bytes(random() % 300);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    EXPECT_EQ(format_of(bytes), std::nullopt) << i;
  }
}

// What a pipe begins with decides whether it is read on.
TEST(Format, MayBeKnownByTheBeginningOfALongFile) {
  constexpr std::size_t kBeginning = std::size_t{1} << 16;
  std::mt19937_64 random(2);
  std::vector<std::uint8_t> noise(kBeginning), zeros(kBeginning);
  for (auto& byte : noise) byte = static_cast<std::uint8_t>(random());
  EXPECT_FALSE(may_be_known(noise));
  EXPECT_FALSE(may_be_known(zeros));
  std::string text;
  while (text.size() < kBeginning) text += "y\n";
  EXPECT_FALSE(may_be_known(bytes_of(text)));
  std::string points;
  while (points.size() < kBeginning) points += "1.5 -2 3\n";
  EXPECT_TRUE(may_be_known(bytes_of(points)));

  // A binary STL of 2000 facets, which is longer.
  std::vector<std::uint8_t> stl = zeros;
  constexpr std::uint32_t kFacets = 2000;
  std::memcpy(&stl[80], &kFacets, 4);
  EXPECT_TRUE(may_be_known(stl));
  const float infinite = std::numeric_limits<float>::infinity();
  std::memcpy(&stl[84 + 50 * 1000 + 44], &infinite, 4);
  EXPECT_FALSE(may_be_known(stl)) << "a corner that is nowhere";
}

TEST(Format, OfAFileToBeWrittenIsItsSuffix) {
  EXPECT_EQ(format_for_writing("a/b.c/map.bt"), Format::kBt);
  EXPECT_EQ(format_for_writing("map.OT"), Format::kOt);
  EXPECT_EQ(format_for_writing("map.pvx"), Format::kPvx);
  EXPECT_EQ(format_for_writing("map.ply"), Format::kPly);
  EXPECT_EQ(format_for_writing("log.csv"), Format::kCsv);
  EXPECT_EQ(format_for_writing("dive.tum"), Format::kTum);
  EXPECT_EQ(format_for_writing("picture.png"), Format::kPng);
  EXPECT_EQ(format_for_writing("cloud.pcd"), Format::kPcd);
  EXPECT_EQ(format_for_writing("grid.yaml"), Format::kGrid);
  EXPECT_EQ(format_for_writing("grid.pgm"), Format::kGrid);
  EXPECT_EQ(format_for_writing("bottom.ASC"), Format::kAsc);
  EXPECT_EQ(format_for_writing("bottom.tif"), Format::kTif);
  EXPECT_EQ(format_for_writing("bottom.tiff"), Format::kTif);
  EXPECT_EQ(format_for_writing("map.las"), Format::kLas);
  EXPECT_EQ(format_for_writing("map.glb"), Format::kGlb);
  EXPECT_EQ(format_for_writing("map.mcap"), Format::kMcap);
  EXPECT_EQ(format_for_writing("dive.geojson"), Format::kGeoJson);
  EXPECT_EQ(format_for_writing("log.mat"), std::nullopt);
  EXPECT_EQ(format_for_writing("bt"), std::nullopt);
  EXPECT_EQ(format_for_writing("-"), std::nullopt);
  EXPECT_EQ(format_for_writing(""), std::nullopt);
}

TEST(Open, SaysWhatAFileIsInstead) {
  const auto beams = open_beams({"tank.mat", bytes_of("# Octomap OcTree binary file\n")});
  ASSERT_FALSE(beams);
  EXPECT_EQ(beams.error().code, Error::Code::kUnsupported);
  EXPECT_EQ(beams.error().message, "tank.mat: is a map (.bt), not a log of beams");
  EXPECT_EQ(open_scans({"a", bytes_of("1 0 0 0 0 0 0 1\n")}).error().message,
            "a: is a trajectory (.tum), not a log of scans");
  EXPECT_EQ(open_beams({"a", bytes_of("GIF89a")}).error().message, "a: not a log of beams that we know");
  EXPECT_EQ(open_beams({"a", {}}).error().message, "a: is empty");
  EXPECT_EQ(open_scans({"a", {}}).error().message, "a: is empty");
}

}  // namespace
}  // namespace pingvox
