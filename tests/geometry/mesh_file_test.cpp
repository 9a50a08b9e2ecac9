#include "imbibe/geometry/mesh_file.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "imbibe/geometry/shape_spec.h"
#include "support/meshes.h"

namespace imbibe {
namespace {

namespace fs = std::filesystem;
using testing::box_mesh;

std::string scratch(const std::string& name) {
  return (fs::path(::testing::TempDir()) / ("imbibe_mesh_" + name)).string();
}

const char* tetrahedron_ply =
    "ply\nformat ascii 1.0\ncomment a tetrahedron\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nproperty uchar red\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0 255\n1 0 0 255\n0 1 0 255\n0 0 1 255\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

// The message of the InputError that parsing throws; "" when it throws none.
template <class Parse>
Problem problem_of(Parse&& parse) {
  try {
    parse();
  } catch (const InputError& error) {
    return error.problems().at(0);
  }
  ADD_FAILURE() << "no error";
  return {};
}

class RoundTrip : public ::testing::TestWithParam<const char*> {};

TEST_P(RoundTrip, GivesTheSameClosedSolidBack) {
  const TriangleMesh torus = testing::torus_mesh(2, 0.5);
  const std::string path = scratch(std::string("torus.") + GetParam());
  write_mesh(torus, path);
  const TriangleMesh read = read_mesh(path);
  fs::remove(path);
  EXPECT_EQ(read.triangles.size(), torus.triangles.size());
  EXPECT_EQ(read.vertices.size(), torus.vertices.size());  // STL: corners are welded
  EXPECT_FALSE(find_defects(read).any());
  EXPECT_NEAR(enclosed_volume(read), enclosed_volume(torus), 1e-6 * enclosed_volume(torus));  // floats in the file
}

INSTANTIATE_TEST_SUITE_P(Formats, RoundTrip, ::testing::Values("obj", "ply", "stl"));

TEST(MeshFile, ObjTakesPolygonsTextureIndicesNegativeIndicesAndComments) {
  const TriangleMesh mesh = parse_obj(
      "# a pyramid\no thing\nv 0 0 0\nv 1 0 0\r\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nv .5 .5 1e0\n\n"
      "f 4/1 3/1 2/1 1/1\nf 1//1 2//1 5//1\nf 2/1/1 3/1/1 5/1/1\nf -3 -2 -1 # last\nf 4 1 5\n", "p.obj");
  EXPECT_EQ(mesh.triangles.size(), 6u);
  EXPECT_FALSE(find_defects(mesh).any());
  EXPECT_NEAR(enclosed_volume(mesh), 1.0 / 3, 1e-14);
}

TEST(MeshFile, PlyAsciiSkipsWhatItDoesNotNeed) {
  const TriangleMesh mesh = parse_ply(tetrahedron_ply, "t.ply");
  EXPECT_FALSE(find_defects(mesh).any());
  EXPECT_NEAR(enclosed_volume(mesh), 1.0 / 6, 1e-15);
}

TEST(MeshFile, StlAsciiIsReadAndWelded) {
  std::string text = "solid box\n";
  const TriangleMesh box = box_mesh({1, 1, 1});
  for (std::size_t t = 0; t < box.triangles.size(); ++t) {
    text += " facet normal 0 0 0\n  outer loop\n";
    for (int k = 0; k < 3; ++k) {
      const Vec3& v = box.corner(t, k);
      text += "   vertex " + std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z) + "\n";
    }
    text += "  endloop\n endfacet\n";
  }
  const TriangleMesh mesh = parse_stl(text + "endsolid box\n", "box.stl");
  EXPECT_EQ(mesh.vertices.size(), 8u);
  EXPECT_FALSE(find_defects(mesh).any());
  EXPECT_NE(problem_of([&] { parse_stl(text, "box.stl"); }).message.find("endsolid"), std::string::npos);
}

TEST(MeshFile, ABinaryStlThatBeginsWithSolidIsStillReadAsBinary) {
  const std::string path = scratch("solid.stl");
  write_mesh(box_mesh({1, 1, 1}), path);
  {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.write("solid", 5);
  }
  EXPECT_EQ(read_mesh(path).triangles.size(), 12u);
  fs::remove(path);
}

struct Malformed {
  const char* name;
  const char* content;
  int line;  // that must be named
};

class MalformedObj : public ::testing::TestWithParam<Malformed> {};
TEST_P(MalformedObj, IsRefusedWithItsLine) {
  const Problem p = problem_of([] { parse_obj(GetParam().content, "x.obj"); });
  EXPECT_EQ(p.file, "x.obj");
  EXPECT_EQ(p.line, GetParam().line) << p.message;
}
INSTANTIATE_TEST_SUITE_P(
    Files, MalformedObj,
    ::testing::Values(Malformed{"number", "v 0 0 0\nv 0 zero 0\n", 2}, Malformed{"missing", "v 0 0\n", 1},
                      Malformed{"nan", "v nan 0 0\n", 1}, Malformed{"two", "v 0 0 0\nv 1 0 0\nf 1 2\n", 3},
                      Malformed{"index", "v 0 0 0\nf 1 1 7\n", 2}, Malformed{"zero", "v 0 0 0\nf 0 1 1\n", 2},
                      Malformed{"negative", "v 0 0 0\nf -2 1 1\n", 2}, Malformed{"empty", "", 0},
                      Malformed{"word", "v 0 0 0\nf a b c\n", 2}),
    [](const auto& file) { return file.param.name; });

std::string ply_with(std::string from, std::string to) {
  std::string text = tetrahedron_ply;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, from.size(), to);
}

TEST(MeshFile, AMalformedPlyIsRefusedWithItsLine) {
  const auto line_of = [](std::string from, std::string to) {
    return problem_of([&] { parse_ply(ply_with(from, to), "x.ply"); }).line;
  };
  EXPECT_EQ(line_of("ascii", "binary_big_endian"), 2);
  EXPECT_EQ(line_of("vertex 4", "vertex many"), 4);
  EXPECT_EQ(line_of("float y", "fluot y"), 6);
  EXPECT_EQ(line_of("property float z\n", ""), 10);
  EXPECT_EQ(line_of("1 0 0 255", "1 x 0 255"), 13);
  EXPECT_EQ(line_of("3 0 3 2", "3 0 9 2"), 18);
  EXPECT_EQ(line_of("3 0 3 2", "2 0 3"), 18);
  EXPECT_EQ(line_of("3 1 2 3\n", ""), 18);
  EXPECT_EQ(line_of("end_header\n", ""), 11);
}

TEST(MeshFile, CountsAreCheckedAgainstTheFilesSizeBeforeMemoryIsTaken) {
  const Problem ply = problem_of([] { parse_ply(ply_with("vertex 4", "vertex 4000000000000"), "x.ply"); });
  EXPECT_NE(ply.message.find("cannot fit"), std::string::npos);
  const Problem face = problem_of([] { parse_ply(ply_with("face 4", "face 4000000000000"), "x.ply"); });
  EXPECT_NE(face.message.find("cannot fit"), std::string::npos);
  std::string stl(84, '\0');
  const std::uint32_t count = 4000000000u;
  std::memcpy(stl.data() + 80, &count, 4);
  EXPECT_NE(problem_of([&] { parse_stl(stl, "x.stl"); }).message.find("4000000000"), std::string::npos);
}

TEST(MeshFile, ATruncatedBinaryFileIsRefusedAtEveryLength) {
  for (const char* format : {"ply", "stl"}) {
    const std::string path = scratch(std::string("cut.") + format);
    write_mesh(box_mesh({1, 1, 1}), path);
    std::ifstream file(path, std::ios::binary);
    const std::string whole(std::istreambuf_iterator<char>(file), {});
    fs::remove(path);
    for (std::size_t length = 4; length < whole.size(); ++length) {
      const std::string cut = whole.substr(0, length);
      EXPECT_THROW(std::string_view(format) == "ply" ? parse_ply(cut, "c") : parse_stl(cut, "c"), InputError) << length;
    }
  }
}

TEST(MeshFile, AMissingFileAFolderAndAnUnknownFormatAreErrorsOfTheInput) {
  EXPECT_NE(problem_of([] { read_mesh("/nowhere/mesh.obj"); }).message.find("cannot be read"), std::string::npos);
  EXPECT_THROW(read_mesh(::testing::TempDir()), InputError);
  const std::string path = scratch("notes.txt");
  std::ofstream(path) << "hello";
  EXPECT_NE(problem_of([&] { read_mesh(path); }).message.find(".obj, .ply or .stl"), std::string::npos);
  fs::remove(path);
  EXPECT_THROW(write_mesh(box_mesh({1, 1, 1}), "/nowhere/box.obj"), InputError);
}

TEST(MeshFile, ASolidFromAFileIsPlacedAndAnOpenOneRefused) {
  const std::string path = scratch("box_mm.stl");
  write_mesh(box_mesh({500, 500, 500}), path);
  ShapeSpec spec{.kind = ShapeKind::mesh, .file = fs::path(path).filename().string()};
  spec.transform = {.scale = 1e-3, .rotation = {}, .translation = {0, 0, 1}};
  const Shape shape = make_shape(spec, fs::path(path).parent_path());
  EXPECT_NEAR(nearest_surface(shape, {0, 0, 2}).distance, 0.5, 1e-12);
  TriangleMesh open = box_mesh({1, 1, 1});
  open.triangles.pop_back();
  write_mesh(open, path);
  EXPECT_THROW(make_shape(spec, fs::path(path).parent_path()), InputError);
  fs::remove(path);
}

}  // namespace
}  // namespace imbibe
