#include "pingvox/io/mesh.hpp"

#include <gmock/gmock.h>

#include <sstream>
#include <string>
#include <vector>

#include "pingvox/io/file.hpp"

namespace pingvox {
namespace {

using Eigen::Vector3d;
using testing::ElementsAre;
using testing::HasSubstr;

using Corners = std::array<std::uint32_t, 3>;

TriangleMesh sample(const std::string& name) {
  const auto file = read_file(PINGVOX_FUZZ_CORPUS "/mesh/" + name);
  EXPECT_TRUE(file) << name;
  const auto mesh = file ? read_mesh(*file) : fail(file.error().code, file.error().message);
  EXPECT_TRUE(mesh) << mesh.error().message;
  return mesh.value_or(TriangleMesh{});
}

std::string mesh_error_of(const std::string& text) {
  const auto mesh = read_mesh({"bad", {text.begin(), text.end()}});
  return mesh ? "" : mesh.error().message;
}

TEST(Mesh, ReadsOffWithCommentsColoursAndPolygons) {
  const TriangleMesh mesh = sample("off");
  ASSERT_EQ(mesh.vertices_m.size(), 5U);
  EXPECT_EQ(mesh.vertices_m[1], Vector3d(1.0, 0.0, 0.0));
  EXPECT_THAT(mesh.triangles, ElementsAre(Corners{0, 2, 1}, Corners{0, 1, 3}, Corners{0, 3, 2}, Corners{1, 2, 3},
                                          Corners{0, 1, 4}, Corners{0, 4, 2}));
}

TEST(Mesh, ReadsStlAsTextAndAsBytes) {
  const TriangleMesh text = sample("stl_text");
  ASSERT_EQ(text.triangles.size(), 2U);
  EXPECT_EQ(text.vertices_m[2], Vector3d(0.0, 1.5, 0.0));
  EXPECT_THAT(text.triangles[1], ElementsAre(3U, 4U, 5U));
  const TriangleMesh bytes = sample("stl_binary");
  ASSERT_EQ(bytes.triangles.size(), 2U) << "a binary file may begin with 'solid'";
  EXPECT_EQ(bytes.vertices_m[4], Vector3d(0.0, 0.0, 2.0));
}

// Kills a reader that is stricter than what recognises the format.
TEST(Mesh, ReadsStlWithAnEmptyFirstLine) {
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
  const std::string text = "\nsolid a\n" + facet + "endsolid a\n";
  const auto mesh = read_mesh({"a.stl", {text.begin(), text.end()}});
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->triangles.size(), 1U);
}

TEST(Mesh, ReadsPlyInAllThreeFormsAndStepsOverWhatItDoesNotKnow) {
  const TriangleMesh text = sample("ply_text");
  EXPECT_EQ(text.vertices_m[3], Vector3d(0.0, 1.0, 0.5));
  EXPECT_THAT(text.triangles, ElementsAre(Corners{0, 1, 2}, Corners{0, 2, 3}, Corners{0, 1, 2}));
  const TriangleMesh little = sample("ply_little");
  const TriangleMesh big = sample("ply_big");
  EXPECT_EQ(little.vertices_m[2], Vector3d(0.0, 2.0, 0.0));
  EXPECT_THAT(little.triangles, ElementsAre(Corners{0, 1, 2}));
  EXPECT_EQ(little.vertices_m, big.vertices_m);
  EXPECT_EQ(little.triangles, big.triangles);
}

TEST(Mesh, SaysWhereAFileIsBroken) {
  EXPECT_THAT(mesh_error_of(""), HasSubstr("bad: is not an OFF, PLY or STL mesh"));
  EXPECT_THAT(mesh_error_of("time_s,bearing_rad\n"), HasSubstr("is not an OFF, PLY or STL mesh"));
  EXPECT_THAT(mesh_error_of("OFF\n3 1 0\n0 0 0\n1 0 0\n0 nan 0\n3 0 1 2\n"), HasSubstr("vertex 2"));
  EXPECT_THAT(mesh_error_of("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"), HasSubstr("corner 3 of 3 vertices"));
  EXPECT_THAT(mesh_error_of("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n"), HasSubstr("line 6: a face of 2 corners"));
  EXPECT_THAT(mesh_error_of("OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n"), HasSubstr("no triangle"));
  EXPECT_THAT(mesh_error_of("OFF\n18446744073709551615 1 0\n0 0 0\n"), HasSubstr("vertex 1"));
  EXPECT_THAT(mesh_error_of("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n"),
              HasSubstr("line 6: a facet of 2 corners"));
  EXPECT_THAT(mesh_error_of("solid\nvertex 0 0\n"), HasSubstr("a vertex is broken"));
  EXPECT_THAT(mesh_error_of("solid\nhello\n"), HasSubstr("'hello'"));
  EXPECT_THAT(mesh_error_of("ply\nformat ascii 1.0\nelement vertex 1\n"), HasSubstr("header has no end"));
  EXPECT_THAT(mesh_error_of("ply\nelement vertex 0\nend_header\n"), HasSubstr("there is no format line"));
  EXPECT_THAT(mesh_error_of("ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\n"), HasSubstr("line 4"));
  EXPECT_THAT(
      mesh_error_of("ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
                    "4000000000 0\n"),
      HasSubstr("face 0: the list ends early"));
  EXPECT_THAT(mesh_error_of("ply\nformat ascii 1.0\nelement vertex 9999999999999\nend_header\n"),
              HasSubstr("no triangle"))
      << "elements without properties take no time, however many";
}

TEST(Mesh, IsReadBackAsItWasWritten) {
  const TriangleMesh mesh = sample("off");
  std::stringstream out;
  ASSERT_TRUE(write_mesh_ply(mesh, out));
  const std::string text = out.str();
  const auto back = read_mesh({"back", {text.begin(), text.end()}});
  ASSERT_TRUE(back);
  EXPECT_EQ(back->vertices_m, mesh.vertices_m);
  EXPECT_EQ(back->triangles, mesh.triangles);
  std::ostringstream closed;
  closed.setstate(std::ios::badbit);
  EXPECT_FALSE(write_mesh_ply(mesh, closed));
}

}  // namespace
}  // namespace pingvox
