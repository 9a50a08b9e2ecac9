// A solid as a scene describes it, and the shape made from it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "imbibe/core/error.h"
#include "imbibe/core/parameter.h"
#include "imbibe/core/types.h"
#include "imbibe/geometry/shapes.h"
#include "imbibe/geometry/triangle_mesh.h"

namespace imbibe {

enum class ShapeKind { plane, box, sphere, cylinder, cone, mesh };

// A mesh file's coordinates times `scale`, turned about x, then y, then z, then moved.
struct MeshTransform {
  Real scale = 1;         // m per unit of the file: 0.001 for a file in millimetres
  Vec3 rotation{};        // rad about x, y, z
  Vec3 translation{};     // m
  bool flip = false;      // the file's triangles face inwards
};

// What is not given stays empty; a kind uses some of these and must be given them: plane: point, normal;
// box: centre, size; sphere: centre, radius; cylinder and cone: base, radius, height (axis: up unless given);
// mesh: file (transform as wanted).
struct ShapeSpec {
  ShapeKind kind = ShapeKind::plane;
  std::optional<Vec3> point{}, normal{};
  std::optional<Vec3> centre{}, size{};
  std::optional<Vec3> base{}, axis{};
  std::optional<Real> radius{}, height{};
  std::optional<std::string> file{};
  MeshTransform transform{};
};

template <class V>
void describe(V& v, MeshTransform& t) {
  v.value("scale", t.scale, {.unit = "1", .min = 0, .above_min = true,
                             .help = "metres per unit of the file; 0.001 for a file in millimetres"});
  v.value("rotation", t.rotation, {.unit = "rad", .shown = "deg", .help = "turned about x, then y, then z"});
  v.value("translation", t.translation, {.unit = "m", .shown = "mm", .help = "moved after turning"});
  v.value("flip", t.flip, {.help = "turn the mesh inside out: its file has the triangles facing inwards"});
}

template <class V>
void describe(V& v, ShapeSpec& s) {
  v.choice("kind", s.kind,
           Choices<ShapeKind>{{"plane", ShapeKind::plane}, {"box", ShapeKind::box}, {"sphere", ShapeKind::sphere},
                              {"cylinder", ShapeKind::cylinder}, {"cone", ShapeKind::cone}, {"mesh", ShapeKind::mesh}},
           "form of the solid");
  v.value("point", s.point, {.unit = "m", .shown = "mm", .help = "plane: any point on it"});
  v.value("normal", s.normal, {.unit = "1", .help = "plane: direction out of the solid; any length"});
  v.value("centre", s.centre, {.unit = "m", .shown = "mm", .help = "box, sphere: centre"});
  v.value("size", s.size, {.unit = "m", .shown = "mm", .help = "box: full lengths along x, y, z"});
  v.value("base", s.base, {.unit = "m", .shown = "mm", .help = "cylinder, cone: centre of the round base"});
  v.value("axis", s.axis, {.unit = "1", .help = "cylinder, cone: from the base to the top; any length; default up"});
  v.value("radius", s.radius, {.unit = "m", .shown = "mm", .min = 0, .above_min = true,
                               .help = "sphere, cylinder, cone: radius (of the base)"});
  v.value("height", s.height, {.unit = "m", .shown = "mm", .min = 0, .above_min = true,
                               .help = "cylinder, cone: height"});
  v.value("file", s.file, {.help = "mesh: OBJ, PLY or STL file of a closed surface, relative to the scene"});
  v.group("transform", s.transform, "mesh: how the file's coordinates become metres in the world");
}

// Everything that is wrong with the spec itself: missing, unused and unusable values. Problem::key is the name in the
// spec ("radius"), so that a reader can put its own path, file and line before it. Does not open the mesh file.
std::vector<Problem> find_problems(const ShapeSpec& spec);

// The shape. Throws InputError with all problems (of the spec, or of the mesh file). A relative mesh file is looked for
// in `folder`.
Shape make_shape(const ShapeSpec& spec, const std::filesystem::path& folder = ".");

void apply_transform(TriangleMesh& mesh, const MeshTransform& transform);

}  // namespace imbibe
