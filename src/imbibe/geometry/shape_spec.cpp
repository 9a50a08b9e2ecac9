#include "imbibe/geometry/shape_spec.h"

#include <fmt/format.h>

#include <array>
#include <memory>

#include "imbibe/core/portable.h"
#include "imbibe/geometry/mesh_distance.h"
#include "imbibe/geometry/mesh_file.h"

namespace imbibe {
namespace {

enum class Use { none, allowed, required };

struct KindUses {
  const char* name;
  Use point, normal, centre, size, base, axis, radius, height, file, transform;
};

// In the order of ShapeKind.
constexpr std::array<KindUses, 6> uses{{
    {"plane", Use::required, Use::allowed, Use::none, Use::none, Use::none, Use::none, Use::none, Use::none, Use::none,
     Use::none},
    {"box", Use::none, Use::none, Use::required, Use::required, Use::none, Use::none, Use::none, Use::none, Use::none,
     Use::none},
    {"sphere", Use::none, Use::none, Use::required, Use::none, Use::none, Use::none, Use::required, Use::none,
     Use::none, Use::none},
    {"cylinder", Use::none, Use::none, Use::none, Use::none, Use::required, Use::allowed, Use::required, Use::required,
     Use::none, Use::none},
    {"cone", Use::none, Use::none, Use::none, Use::none, Use::required, Use::allowed, Use::required, Use::required,
     Use::none, Use::none},
    {"mesh", Use::none, Use::none, Use::none, Use::none, Use::none, Use::none, Use::none, Use::none, Use::required,
     Use::allowed},
}};

const KindUses& uses_of(ShapeKind kind) { return uses[static_cast<std::size_t>(kind)]; }

bool is_given(const MeshTransform& t) {
  return t.scale != 1 || t.flip || !(t.rotation == Vec3{}) || !(t.translation == Vec3{});
}

struct Findings {
  const char* kind;
  std::vector<Problem> problems;
  void say(const char* key, std::string message) { problems.push_back({.key = key, .message = std::move(message)}); }

  template <class T>
  void presence(const char* key, Use use, const std::optional<T>& value) {
    if (use == Use::required && !value) say(key, fmt::format("is missing: a {} needs it", kind));
    if (use == Use::none && value) say(key, fmt::format("is given, but a {} has no such value", kind));
  }
  void length(const char* key, const std::optional<Real>& value) {
    if (value && !(*value > 0 && std::isfinite(*value))) say(key, fmt::format("{} m is not above 0", *value));
  }
  void place(const char* key, const std::optional<Vec3>& value) {
    if (value && !is_finite(*value)) say(key, "has a coordinate that is not a finite number");
  }
  void direction(const char* key, const std::optional<Vec3>& value) {
    place(key, value);
    if (value && is_finite(*value) && !(norm(*value) > 0)) say(key, "has no length, so no direction");
  }
};

Vec3 unit(const std::optional<Vec3>& direction) { return normalized(direction.value_or(Vec3{0, 0, 1})); }

Shape make_mesh(const ShapeSpec& spec, const std::filesystem::path& folder) {
  const std::filesystem::path given = *spec.file;
  const std::string path = (given.is_absolute() ? given : folder / given).string();
  TriangleMesh mesh = read_mesh(path);
  apply_transform(mesh, spec.transform);
  return std::make_shared<const MeshDistance>(std::move(mesh), path);
}

}  // namespace

std::vector<Problem> find_problems(const ShapeSpec& spec) {
  const KindUses& use = uses_of(spec.kind);
  Findings found{use.name, {}};
  found.presence("point", use.point, spec.point);
  found.presence("normal", use.normal, spec.normal);
  found.presence("centre", use.centre, spec.centre);
  found.presence("size", use.size, spec.size);
  found.presence("base", use.base, spec.base);
  found.presence("axis", use.axis, spec.axis);
  found.presence("radius", use.radius, spec.radius);
  found.presence("height", use.height, spec.height);
  found.presence("file", use.file, spec.file);
  if (use.transform == Use::none && is_given(spec.transform)) {
    found.say("transform", fmt::format("is given, but a {} has no such value", use.name));
  }
  for (const auto& [key, value] : {std::pair{"point", &spec.point}, {"centre", &spec.centre}, {"base", &spec.base}}) {
    found.place(key, *value);
  }
  found.direction("normal", spec.normal);
  found.direction("axis", spec.axis);
  found.length("radius", spec.radius);
  found.length("height", spec.height);
  if (spec.size && !(spec.size->x > 0 && spec.size->y > 0 && spec.size->z > 0 && is_finite(*spec.size))) {
    found.say("size", "every length must be above 0 and finite");
  }
  if (spec.file && spec.file->empty()) found.say("file", "is empty");
  const MeshTransform& t = spec.transform;
  if (!(t.scale > 0 && std::isfinite(t.scale))) found.say("transform.scale", "must be above 0 and finite");
  found.place("transform.rotation", t.rotation);
  found.place("transform.translation", t.translation);
  return std::move(found.problems);
}

Shape make_shape(const ShapeSpec& spec, const std::filesystem::path& folder) {
  if (auto problems = find_problems(spec); !problems.empty()) throw InputError(std::move(problems));
  switch (spec.kind) {
    case ShapeKind::plane: return Plane{*spec.point, unit(spec.normal)};
    case ShapeKind::box: return Box{*spec.centre, *spec.size};
    case ShapeKind::sphere: return Sphere{*spec.centre, *spec.radius};
    case ShapeKind::cylinder: return Cylinder{*spec.base, unit(spec.axis), *spec.radius, *spec.height};
    case ShapeKind::cone: return Cone{*spec.base, unit(spec.axis), *spec.radius, *spec.height};
    case ShapeKind::mesh: break;
  }
  return make_mesh(spec, folder);
}

void apply_transform(TriangleMesh& mesh, const MeshTransform& t) {
  const auto turn = [](Real& a, Real& b, Real angle) {
    const Real c = portable::cos(angle), s = portable::sin(angle), old = a;
    a = c * old - s * b;
    b = s * old + c * b;
  };
  for (Vec3& v : mesh.vertices) {
    v *= t.scale;
    turn(v.y, v.z, t.rotation.x);
    turn(v.z, v.x, t.rotation.y);
    turn(v.x, v.y, t.rotation.z);
    v += t.translation;
  }
  if (t.flip) flip(mesh);
}

}  // namespace imbibe
