#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <sstream>
#include <utility>

#include "io/map_samples.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/points.hpp"
#include "support/logs.hpp"

namespace pingvox {
namespace {

using Eigen::Vector3d;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

FileBytes sample(const std::string& name) {
  auto file = read_file(PINGVOX_FUZZ_CORPUS "/" + name);
  EXPECT_TRUE(file) << name;
  return file.value_or(FileBytes{});
}

/// The one scan of a cloud. kFail: nothing in it may be damaged.
PointScan cloud_in(const FileBytes& file, Damage damage = Damage::kFail) {
  const auto all = all_scans(file, damage);
  EXPECT_EQ(all.error, "") << file.name;
  EXPECT_EQ(all.items.size(), 1U) << file.name;
  return all.items.empty() ? PointScan{} : all.items[0];
}

std::string cloud_error_of(std::string_view text) {
  return all_scans({"bad", bytes_of(text)}, Damage::kFail).error;
}

double as_float(float value) {
  return value;
}

TEST(PlyCloud, IsReadInAllThreeForms) {
  const std::vector<Vector3d> points = {
      {as_float(0.1F), 0.1, -3.0}, {1.0, 2.0, 3.0}, {-1000.0, 4.5, 7.0}};  // x is a float, y is a double
  for (const std::string name : {"text", "little", "big"}) {
    SCOPED_TRACE(name);
    const PointScan cloud = cloud_in(sample("ply/" + name));
    EXPECT_EQ(cloud.points_m, points);
    EXPECT_EQ(cloud.origin_m, Vector3d::Zero());
  }
}

// Kills points that nobody misses: a header of an older, shorter cloud.
TEST(Clouds, WithMorePointsThanTheirHeaderSaysAreDamaged) {
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n", lines = "1 2 3\n4 5 6\n7 8 9\n";
  const std::string ply = "ply\nformat ascii 1.0\nelement vertex 2\n" + xyz;
  const std::string pcd = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nPOINTS 2\nDATA ";
  EXPECT_THAT(cloud_error_of(ply + "end_header\n" + lines), HasSubstr("end: 1 further lines are after its 2 points"));
  EXPECT_EQ(cloud_error_of(ply + "element edge 1\nproperty uchar a\nend_header\n1 2 3\n4 5 6\n7\n"), "");
  EXPECT_THAT(cloud_error_of(pcd + "ascii\n" + lines), HasSubstr("1 further lines are after its 2 points"));
  const std::string point(12, '\1'), zeros(4096, '\0');
  EXPECT_THAT(cloud_error_of(pcd + "binary\n" + point + point + point), HasSubstr("12 further bytes are after"));
  EXPECT_EQ(cloud_error_of(pcd + "binary\n" + point + point + zeros), "") << "of a page";
  EXPECT_EQ(cloud_error_of(pcd + "binary\n" + point + point + "\n"), "");
}

TEST(PlyCloud, LeavesOutDamagedPointsAndNamesTheFirstWhenAsked) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  const std::string body = "1 2 3\n1 2\nnan 2 3\n1 2 1e39\n4 5 6\n";
  const auto all = all_scans({"bad", bytes_of(head + body)});
  EXPECT_EQ(all.skipped, 3U);
  ASSERT_EQ(all.items.size(), 1U);
  EXPECT_THAT(all.items[0].points_m, ElementsAre(Vector3d(1, 2, 3), Vector3d(4, 5, 6)));
  EXPECT_EQ(cloud_error_of(head + body), "bad: line 9: is not a point of three finite numbers");
  EXPECT_EQ(cloud_error_of(head + "1 2 3\n4 5 6\n"), "bad: end: holds 2 of 5 points");
  EXPECT_EQ(all_scans({"bad", bytes_of(head + "1 2 3\n4 5 6\n")}).items.at(0).points_m.size(), 2U);

  FileBytes file = sample("ply/little");
  const std::uint8_t nan[] = {0, 0, 0xc0, 0x7f};
  std::memcpy(file.bytes.data() + file.bytes.size() - 14, nan, 4);  // x of the last of three
  EXPECT_EQ(cloud_in(file, Damage::kSkip).points_m.size(), 2U);
  EXPECT_THAT(all_scans(file, Damage::kFail).error, HasSubstr("point 2: is not a point"));
}

TEST(PlyCloud, RefusesWhatItsBytesDoNotHold) {
  FileBytes file = sample("ply/little");
  file.bytes.pop_back();
  EXPECT_THAT(all_scans(file).error, HasSubstr("3 vertices of 15 bytes do not fit into the 44 left"));
  const std::string binary = "ply\nformat binary_little_endian 1.0\n";
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  EXPECT_THAT(cloud_error_of(binary + "element vertex 18446744073709551615\n" + xyz + "end_header\n"),
              HasSubstr("fit"));
  EXPECT_THAT(cloud_error_of(binary + "element a 9223372036854775807\nproperty double b\nelement vertex 0\n" + xyz +
                             "end_header\n"),
              HasSubstr("ends before its vertices"));
  EXPECT_THAT(
      cloud_error_of(binary + "element a 1\nproperty list uchar int b\nelement vertex 0\n" + xyz + "end_header\n"),
      HasSubstr("lists before the vertices"));
  EXPECT_THAT(cloud_error_of(binary + "element vertex 0\n" + xyz + "property list uchar int b\nend_header\n"),
              HasSubstr("vertices with lists"));
  EXPECT_THAT(cloud_error_of("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n"),
              HasSubstr("no x, y and z"));
  EXPECT_THAT(cloud_error_of("ply\nformat ascii 1.0\nend_header\n"), HasSubstr("no vertices"));
  EXPECT_THAT(cloud_error_of("ply\nformat ascii 1.0\nelement vertex x\n"), HasSubstr("line 3"));
}

TEST(XyzCloud, IsReadWithAnySeparatorAndAnythingBehind) {
  EXPECT_THAT(cloud_in(sample("xyz/blanks")).points_m,
              ElementsAre(Vector3d(1, 2, 3), Vector3d(-4.5, 0.5, 6), Vector3d(0, 0, -0.25)));
  EXPECT_THAT(cloud_in(sample("xyz/commas")).points_m, ElementsAre(Vector3d(1.5, 2.5, 3.5), Vector3d(-1, -2, -3)));
  EXPECT_THAT(cloud_in({"a", bytes_of("0.1\t0.2\t0.3\n1 2 3 wall\n")}).points_m,
              ElementsAre(Vector3d(0.1, 0.2, 0.3), Vector3d(1, 2, 3)));
}

TEST(XyzCloud, LeavesOutDamagedLinesAndNamesTheFirstWhenAsked) {
  const std::string text = "1 2 3\n# a comment\n\n1 2\nX Y Z\n1 nan 3\n1 2 3e999\n4 5 6";
  const auto all = all_scans({"bad", bytes_of(text)});
  EXPECT_EQ(all.skipped, 4U);
  EXPECT_EQ(all.items.at(0).points_m.size(), 2U);
  EXPECT_EQ(cloud_error_of(text), "bad: line 4: is not a point of three finite numbers");
}

// CloudCompare names the columns, and PTS begins with the number of points: both were "text of no known format".
TEST(XyzCloud, MayBeginWithNamesOrTheNumberOfPoints) {
  const auto points = ElementsAre(Vector3d(1, 2, 3), Vector3d(4, 5, 6));
  for (const char* beginning : {"//X Y Z\n", "// X Y Z R G B\n", "x,y,z\n", "2\n", "# by hand\n 2 \n"}) {
    SCOPED_TRACE(beginning);
    const FileBytes file{"a", bytes_of(std::string(beginning) + "1 2 3\n4 5 6\n")};
    EXPECT_EQ(format_of(file.view()), Format::kXyz);
    EXPECT_THAT(cloud_in(file).points_m, points);
  }
  for (const char* other : {"//Y X Z\n1 2 3\n", "x y\n1 2 3\n", "2\n3\n1 2 3\n", "2\n", "//X Y Z\n"}) {
    EXPECT_EQ(format_of(bytes_of(other)), std::nullopt) << other;
  }
  EXPECT_EQ(cloud_error_of("3\n1 2 3\n4 5 6\n"), "bad: end: holds 2 of 3 points");
  EXPECT_THAT(cloud_in({"a", bytes_of("1\n1 2 3\n4 5 6\n")}).points_m, points) << "all that are there";
}

// PCL writes padding as a field of no bytes: the header was refused.
TEST(PcdCloud, AFieldOfCount0HasNoBytes) {
  const std::string head =
      "VERSION 0.7\nFIELDS x y _ z ring\nSIZE 1 1 4 1 1\nTYPE I I F I U\nCOUNT 1 1 0 1 2\nWIDTH 2\nHEIGHT 1\nPOINTS 2\n"
      "DATA ";
  const auto points = ElementsAre(Vector3d(1, 2, 3), Vector3d(4, 5, 6));
  EXPECT_THAT(cloud_in({"a", bytes_of(head + "ascii\n1 2 3 9 9\n4 5 6 9 9\n")}).points_m, points);
  EXPECT_THAT(cloud_in({"a", bytes_of(head + "binary\n\x01\x02\x03\x09\x09\x04\x05\x06\x09\x09")}).points_m, points);
  EXPECT_THAT(
      cloud_error_of("VERSION 0.7\nFIELDS x y z\nSIZE 1 1 1\nTYPE I I I\nCOUNT 1 0 1\nPOINTS 1\nDATA ascii\n1 2\n"),
      HasSubstr("the field y is of no type of number"));
}

TEST(PcdCloud, IsReadAsText) {
  const PointScan cloud = cloud_in(sample("pcd/ascii"));  // NaN is no damage here
  EXPECT_EQ(cloud.origin_m, Vector3d(1, 2, 3));
  EXPECT_THAT(cloud.points_m, ElementsAre(Vector3d(1, 2, 3), Vector3d(as_float(0.1F), as_float(0.2F), 0.3)));
  EXPECT_EQ(all_scans(sample("pcd/ascii"), Damage::kFail).skipped, 1U);
}

TEST(PcdCloud, IsReadAsPclWroteItBinaryAndCompressed) {
  // Both by pcl_convert_pcd_ascii_binary of PCL 1.13, without the zeros that it fills the last page with.
  const Vector3d usual(1, 2, 3);
  for (const std::string name : {"binary", "compressed"}) {
    SCOPED_TRACE(name);
    const auto all = all_scans(sample("pcd/" + name), Damage::kFail);
    EXPECT_EQ(all.skipped, 1U);
    ASSERT_EQ(all.items.size(), 1U) << all.error;
    EXPECT_EQ(all.items[0].origin_m, Vector3d(0.5, -1, 0.25));
    EXPECT_THAT(all.items[0].points_m, ElementsAre(usual, usual, usual, Vector3d(-0.5, 0.25, 8), usual, usual, usual));
  }
}

TEST(PcdCloud, OfTheFirstVersionsIsReadToo) {
  const PointScan cloud = cloud_in(sample("pcd/oldest"));
  EXPECT_EQ(cloud.origin_m, Vector3d::Zero());
  EXPECT_THAT(cloud.points_m, ElementsAre(Vector3d(1, -2, 3), Vector3d(400, 500, -600)));
}

TEST(PcdCloud, RefusesWhatItsBytesDoNotHold) {
  for (const std::string name : {"binary", "compressed", "oldest"}) {
    SCOPED_TRACE(name);
    const FileBytes whole = sample("pcd/" + name);
    const std::string text(whole.bytes.begin(), whole.bytes.end());
    const std::size_t head = text.find('\n', text.find("\nDATA") + 1) + 1;
    for (std::size_t size = head; size < whole.bytes.size(); ++size) {
      FileBytes cut = whole;
      cut.bytes.resize(size);
      const auto all = all_scans(cut);
      EXPECT_THAT(all.items, IsEmpty()) << size;
      EXPECT_THAT(all.error, HasSubstr(whole.name)) << size;
    }
  }
  FileBytes file = sample("pcd/compressed");
  file.bytes[file.bytes.size() - 67] = 0x3f;  // its first word: repeat what stands before the start
  EXPECT_THAT(all_scans(file).error, HasSubstr("broken LZF data"));

  const std::string xyz = "# .PCD v0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";
  const auto with = [&](std::string_view more) { return cloud_error_of(xyz + std::string(more)); };
  EXPECT_THAT(with("WIDTH 4294967296\nHEIGHT 4294967296\nDATA binary\n"), HasSubstr("not a valid number of points"));
  EXPECT_THAT(with("POINTS 18446744073709551615\nDATA binary\n"), HasSubstr("do not fit into the 0 left"));
  EXPECT_THAT(with("POINTS 1000000\nDATA binary_compressed\n01234567890"), HasSubstr("do not fit"));
  EXPECT_THAT(with("WIDTH 2\nHEIGHT 2\nPOINTS 5\nDATA ascii\n"), HasSubstr("5 POINTS are not WIDTH 2 times HEIGHT 2"));
  EXPECT_THAT(with("WIDTH 2\nHEIGHT 1\nDATA ascii\n1 2 3\n"), HasSubstr("holds 1 of 2 points"));
  EXPECT_THAT(with("DATA ascii\n"), HasSubstr("how many POINTS"));
  EXPECT_THAT(with("POINTS 1\n"), HasSubstr("no line DATA"));
  EXPECT_THAT(with("POINTS 1\nDATA morse\n"), HasSubstr("line 7: 'DATA morse' must be ascii, binary or"));
  EXPECT_THAT(with("VIEWPOINT 1 2 3\n"), HasSubstr("line 6: 'VIEWPOINT 1 2 3' must be seven numbers"));
  EXPECT_THAT(with("FIELDS x\n"), HasSubstr("is there twice"));
  EXPECT_THAT(with("SIZE 4\n"), HasSubstr("as much as FIELDS"));
  EXPECT_THAT(with("SIZE 4 4 0\n"), HasSubstr("line 6"));
  EXPECT_THAT(with("SIZE 4 4 3\nPOINTS 0\nDATA ascii\n"), HasSubstr("the field z is of no type of number"));
  EXPECT_THAT(with("HIGHT 1\n"), HasSubstr("is an unknown header line"));
  EXPECT_THAT(with(" , \n"), HasSubstr("is an unknown header line"));
  EXPECT_THAT(cloud_error_of("# .PCD\nFIELDS x y\nPOINTS 0\nDATA ascii\n"), HasSubstr("no x, y and z"));
}

TEST(Cloud, IsSeenFromWhereTheCallerSays) {
  const Vector3d place(7, 8, 9);
  for (const std::string name : {"ply/text", "ply/big", "pcd/ascii", "pcd/binary", "pcd/compressed", "xyz/commas"}) {
    const auto source = open_scans(sample(name), Damage::kSkip, place);
    ASSERT_TRUE(source) << source.error().message;
    const auto scan = (*source)->next();
    ASSERT_TRUE(scan && *scan) << name;
    EXPECT_EQ((*scan)->origin_m, place) << name;
  }
}

// Kills cells of a map in UTM coordinates that are written as one point.
TEST(Clouds, CoordinatesFarFromTheOriginAreKept) {
  OccupancyMap map({.resolution_m = 0.05, .depth = 30});
  const std::vector<Vector3d> points = {{500000.025, 4600000.025, 0.025}, {500000.075, 4600000.075, 0.025}};
  {
    Editor editor = map.edit();
    for (const Vector3d& point : points) editor.set(*map.lattice().key_of<WideWord>(point), 30, LogOdds(2.0F));
  }
  const auto expect_points = [&](std::vector<std::uint8_t> bytes, const char* name) {
    SCOPED_TRACE(name);
    const PointScan read = cloud_in({name, std::move(bytes)});
    ASSERT_EQ(read.points_m.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_LT((read.points_m[i] - points[i]).norm(), 2e-3);
  };
  for (const auto& [format, name] :
       {std::pair(Format::kPly, "a.ply"), std::pair(Format::kPcd, "a.pcd"), std::pair(Format::kXyz, "a.xyz")}) {
    expect_points(samples::to_bytes(map, format), name);
    std::string text;
    for (const Vector3d& p : points) text += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
    auto scans = open_scans({"points.xyz", bytes_of(text)}, Damage::kFail);
    ASSERT_TRUE(scans) << scans.error().message;
    std::ostringstream out;
    ASSERT_TRUE(write_points(**scans, format, out));
    expect_points(bytes_of(out.str()), name);
  }
}

// Kills decimal commas and those of thousands that are read as separators.
TEST(XyzCloud, CommasWithinNumbersAreRefused) {
  EXPECT_THAT(cloud_error_of("1,50 2,50 -3,25\n1,60 2,50 -3,25\n"), HasSubstr("\"1,50\" has a comma"));
  EXPECT_THAT(cloud_error_of("1,000.50 2,500.25 -3.00\n"), HasSubstr("\"1,000.50\" has a comma"));
  EXPECT_EQ(cloud_error_of("1.5, 2.5, -3.25, 7\n1.5,2.5,-3.25\n1 2 3 255,0,0\n"), "");
}

// Kills beams without return that become a wall at the origin.
TEST(Clouds, SeveralZerosAreBeamsWithoutReturn) {
  const std::string pcd = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nPOINTS 4\nDATA ascii\n";
  const std::string body = "1 2 3\n0 0 0\n4 5 6\n0 0 0\n";
  for (const std::string& text : {pcd + body, body}) {
    const auto all = all_scans({"zeros", bytes_of(text)});
    ASSERT_EQ(all.items.size(), 1U) << all.error;
    EXPECT_THAT(all.items[0].points_m, ElementsAre(Vector3d(1, 2, 3), Vector3d(4, 5, 6)));
    EXPECT_EQ(all.skipped, 2U);
    EXPECT_EQ(cloud_error_of(text), "") << "usual, as NaN in a PCD";
  }
  EXPECT_THAT(cloud_in({"place", bytes_of("1 2 3\n0 0 0\n")}).points_m, testing::SizeIs(2)) << "a single one";
}

// Kills a comment that names other columns and is not read: times as x, degrees as metres, depths as heights.
TEST(XyzCloud, ACommentMayNameTheColumns) {
  EXPECT_THAT(cloud_in({"times", bytes_of("# time x y z\n0.5 1 2 3\n0.6 4 5 6\n")}).points_m,
              ElementsAre(Vector3d(1, 2, 3), Vector3d(4, 5, 6)));
  EXPECT_THAT(cloud_error_of("# lon lat depth\n10.1 54.3 12\n"), HasSubstr("its columns are lon, lat, depth"));
  EXPECT_THAT(cloud_error_of("# easting northing depth\n3 1 2\n"), HasSubstr("only x, y and z in metres are read"));
  EXPECT_THAT(cloud_in({"words", bytes_of("# made of depths\n1 2 3\n")}).points_m, ElementsAre(Vector3d(1, 2, 3)));
}

}  // namespace
}  // namespace pingvox
