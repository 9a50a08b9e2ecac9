#include "imbibe/view/ray_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>

#include "imbibe/core/parallel.h"
#include "imbibe/view/liquid_surface.h"
#include "imbibe/view/shape_mesh.h"
#include "imbibe/view/smooth_surface_value.h"

namespace imbibe {

namespace {

struct Release {
  void operator()(RTCDevice d) const { rtcReleaseDevice(d); }
  void operator()(RTCScene s) const { rtcReleaseScene(s); }
};
using Device = std::unique_ptr<RTCDeviceTy, Release>;
using Scene = std::unique_ptr<RTCSceneTy, Release>;

RTCRayHit ray_of(const Ray& ray, float limit) {
  RTCRayHit r{};
  r.ray.org_x = ray.origin.x, r.ray.org_y = ray.origin.y, r.ray.org_z = ray.origin.z;
  r.ray.dir_x = ray.direction.x, r.ray.dir_y = ray.direction.y, r.ray.dir_z = ray.direction.z;
  r.ray.tfar = limit;
  r.ray.mask = ~0u;
  r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return r;
}

Vec3f facing(const Vec3f& normal, const Vec3f& direction) { return dot(normal, direction) > 0 ? -normal : normal; }

void attach_mesh(RTCDevice device, RTCScene scene, const DrawnMesh& mesh, unsigned id) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<Vec3f*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               sizeof(Vec3f), mesh.vertices.size()));
  std::copy(mesh.vertices.begin(), mesh.vertices.end(), vertices);
  auto* triangles = static_cast<std::array<Index, 3>*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(std::array<Index, 3>), mesh.triangles.size()));
  std::copy(mesh.triangles.begin(), mesh.triangles.end(), triangles);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, id);
  rtcReleaseGeometry(geometry);
}

Vec3f mesh_normal(const DrawnMesh& mesh, const RTCHit& hit) {
  if (mesh.normals.empty()) return normalized(Vec3f{hit.Ng_x, hit.Ng_y, hit.Ng_z});
  const auto& t = mesh.triangles[hit.primID];
  return normalized(mesh.normals[t[0]] * (1 - hit.u - hit.v) + mesh.normals[t[1]] * hit.u + mesh.normals[t[2]] * hit.v);
}

struct Float4 {
  float x, y, z, w;
};

struct SolidPart {
  DrawnMesh mesh;
  Vec3f colour;
  std::vector<float> saturation{};           // of a cloth
  std::vector<std::array<float, 2>> uv{};
  std::vector<Slope> slope{};                // of the saturation in uv
};

SolidPart part_of(const DrawnCloth& cloth) {
  SolidPart part{cloth.mesh, cloth.colour, cloth.saturation, cloth.uv};
  if (!cloth.uv.empty()) {
    part.saturation = averaged_values(cloth.mesh.triangles, cloth.uv, cloth.saturation);
    part.slope = corner_slopes(cloth.mesh.triangles, cloth.uv, part.saturation);
  }
  return part;
}

// One cubic piece of a yarn: it spans some steps of the yarn's centre line.
struct Piece {
  Index first = 0, last = 0;  // points
  Index yarn = 0;
};

// Points that a piece spans: pieces much shorter than the yarn is thick cost time and gain nothing.
Index piece_steps(const DrawnYarns& y, std::size_t yarn, const std::vector<float>& along) {
  const Index first = y.first_point[yarn], end = y.first_point[yarn + 1];
  if (end - first < 3) return 1;
  const float mean_step = along[end - 1] / static_cast<float>(end - first - 1);
  const float wanted = 1.1f * y.radius[yarn] / std::max(mean_step, 1e-12f);
  return static_cast<Index>(std::clamp(std::round(wanted), 1.0f, 4.0f));
}

}  // namespace

struct RayScene::Parts {
  Device device;
  Scene solids, liquid;
  DrawnYarns yarns;
  std::vector<DrawnSolid> drawn_solids;
  std::vector<DrawnCloth> cloths;
  Vec3f up{0, 0, 1};  // of the cloth
  std::vector<SolidPart> parts;
  DrawnMesh liquid_mesh;
  std::vector<Piece> pieces;                   // of all yarns
  std::vector<Vec3f> tangent;                  // per yarn point
  std::vector<float> along;                    // per yarn point, m
  unsigned yarn_geometry = RTC_INVALID_GEOMETRY_ID, end_geometry = RTC_INVALID_GEOMETRY_ID;
  std::vector<Index> end_yarn, end_point;      // of every cut end
  float skin = 1e-7f;

  Parts();
  bool stands_still(const Frame& frame) const;
  void build_solids();
  void build_liquid(const Frame& frame);
  void prepare_yarns();
  void attach_yarns(unsigned id);
  void attach_ends(unsigned id);
  void yarn_hit(const RTCRayHit& found, SolidHit& hit) const;
  void end_hit(const RTCRayHit& found, SolidHit& hit) const;
};

RayScene::Parts::Parts() : device(rtcNewDevice(nullptr)) {
  if (!device) throw std::runtime_error("pictures: the ray tracing library does not start on this machine");
}

bool RayScene::Parts::stands_still(const Frame& frame) const {
  if (!solids || frame.solids.size() != drawn_solids.size() || frame.yarns.points != yarns.points ||
      frame.yarns.first_point != yarns.first_point || frame.yarns.radius != yarns.radius ||
      frame.yarns.colour != yarns.colour || frame.up != up)
    return false;
  if (!frame.cloths.empty() || !cloths.empty()) return false;  // they move in nearly every frame
  // Solids are fixed in every scene; a frame that brings meshes of its own is drawn anew.
  return std::all_of(frame.solids.begin(), frame.solids.end(), [&](const DrawnSolid& solid) {
    const DrawnSolid& before = drawn_solids[static_cast<std::size_t>(&solid - frame.solids.data())];
    return solid.mesh.triangles.empty() && before.mesh.triangles.empty() && solid.shape.index() == before.shape.index() &&
           bounds_of(solid.shape).lower == bounds_of(before.shape).lower &&
           bounds_of(solid.shape).upper == bounds_of(before.shape).upper && solid.colour == before.colour;
  });
}

void RayScene::Parts::build_solids() {
  parts.clear(), pieces.clear();
  solids.reset(rtcNewScene(device.get()));
  for (const DrawnSolid& solid : drawn_solids) {
    DrawnMesh mesh = solid.mesh.triangles.empty() ? mesh_of(solid.shape) : solid.mesh;
    if (!mesh.triangles.empty()) parts.push_back({std::move(mesh), solid.colour});
  }
  for (const DrawnCloth& cloth : cloths)
    if (!cloth.mesh.triangles.empty()) parts.push_back(part_of(cloth));
  for (unsigned i = 0; i < parts.size(); ++i) attach_mesh(device.get(), solids.get(), parts[i].mesh, i);
  if (yarns.yarns() > 0) prepare_yarns();
  yarn_geometry = end_geometry = RTC_INVALID_GEOMETRY_ID;
  if (!pieces.empty()) {
    attach_yarns(static_cast<unsigned>(parts.size()));
    attach_ends(static_cast<unsigned>(parts.size()) + 1);
  }
  // Trees are built by one thread: then they, and with them the last bit of every hit, are always the same.
  const ThreadLimit one(1);
  rtcCommitScene(solids.get());
}

void RayScene::Parts::build_liquid(const Frame& frame) {
  liquid_mesh = frame.particles.empty() ? DrawnMesh{} : liquid_surface(frame.particles, frame.particle_spacing);
  liquid.reset(rtcNewScene(device.get()));
  rtcSetSceneFlags(liquid.get(), RTC_SCENE_FLAG_ROBUST);  // a ray that slips between two faces would never leave it
  if (!liquid_mesh.triangles.empty()) attach_mesh(device.get(), liquid.get(), liquid_mesh, 0);
  const ThreadLimit one(1);
  rtcCommitScene(liquid.get());
}

void RayScene::Parts::prepare_yarns() {
  const DrawnYarns& y = yarns;
  tangent.resize(y.points.size());
  along.resize(y.points.size());
  for (std::size_t yarn = 0; yarn < y.yarns(); ++yarn) {
    const Index first = y.first_point[yarn], end = y.first_point[yarn + 1];
    for (Index i = first; i < end; ++i) {
      const Index before = i > first ? i - 1 : i, after = i + 1 < end ? i + 1 : i;
      tangent[i] = normalized(y.points[after] - y.points[before]);
      along[i] = i > first ? along[i - 1] + norm(y.points[i] - y.points[i - 1]) : 0;
    }
    const Index steps = piece_steps(y, yarn, along);
    for (Index i = first; i + 1 < end; i += steps)
      pieces.push_back({i, std::min(i + steps, end - 1), static_cast<Index>(yarn)});
  }
}

// Catmull-Rom curves with round cross-section through every few points of the centre line.
void RayScene::Parts::attach_yarns(unsigned id) {
  const DrawnYarns& y = yarns;
  RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_ROUND_CATMULL_ROM_CURVE);
  // Controls of a yarn: one before its start, the ends of its pieces, one after its end.
  const std::size_t controls = pieces.size() + 3 * y.yarns();
  auto* control = static_cast<Float4*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                                                              sizeof(Float4), controls));
  auto* start = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT,
                                                              sizeof(unsigned), pieces.size()));
  std::size_t n = 0;
  const auto put = [&](const Vec3f& p, float radius) { control[n++] = {p.x, p.y, p.z, radius}; };
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Piece& piece = pieces[i];
    const float radius = y.radius[piece.yarn];
    const Vec3f &p = y.points[piece.first], &q = y.points[piece.last];
    if (i == 0 || pieces[i - 1].yarn != piece.yarn) {
      put(p - (q - p), radius);
      put(p, radius);
    }
    start[i] = static_cast<unsigned>(n - 2);
    put(q, radius);
    if (i + 1 == pieces.size() || pieces[i + 1].yarn != piece.yarn) put(q + (q - p), radius);
  }
  while (n < controls) put({}, 0);  // yarns of one point have no piece
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(solids.get(), geometry, id);
  rtcReleaseGeometry(geometry);
  yarn_geometry = id;
}

// Curves are open tubes: a disc closes each cut end.
void RayScene::Parts::attach_ends(unsigned id) {
  const DrawnYarns& y = yarns;
  end_yarn.clear(), end_point.clear();
  for (std::size_t yarn = 0; yarn < y.yarns(); ++yarn) {
    const Index first = y.first_point[yarn], end = y.first_point[yarn + 1];
    if (end - first < 2) continue;
    for (const Index p : {first, end - 1}) end_yarn.push_back(static_cast<Index>(yarn)), end_point.push_back(p);
  }
  RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT);
  auto* middle = static_cast<Float4*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                                                             sizeof(Float4), end_point.size()));
  auto* normal = static_cast<Vec3f*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_NORMAL, 0, RTC_FORMAT_FLOAT3,
                                                            sizeof(Vec3f), end_point.size()));
  for (std::size_t i = 0; i < end_point.size(); ++i) {
    const Vec3f& p = y.points[end_point[i]];
    middle[i] = {p.x, p.y, p.z, y.radius[end_yarn[i]]};
    normal[i] = end_point[i] == y.first_point[end_yarn[i]] ? -tangent[end_point[i]] : tangent[end_point[i]];
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(solids.get(), geometry, id);
  rtcReleaseGeometry(geometry);
  end_geometry = id;
}

void RayScene::Parts::end_hit(const RTCRayHit& found, SolidHit& hit) const {
  const Index yarn = end_yarn[found.hit.primID], p = end_point[found.hit.primID];
  hit.yarn = hit.cut_end = true;
  hit.normal = hit.flat_normal;
  hit.axis = tangent[p];
  hit.radius = yarns.radius[yarn];
  hit.colour = yarns.colour[yarn];
  hit.point = p > yarns.first_point[yarn] ? p - 1 : p;
  hit.nearest = p;
  hit.saturation = hit.nearest_saturation = yarns.saturation[p];
  hit.along = along[p];
}

void RayScene::Parts::yarn_hit(const RTCRayHit& found, SolidHit& hit) const {
  const DrawnYarns& y = yarns;
  const Piece& piece = pieces[found.hit.primID];
  const float place = std::clamp(found.hit.u, 0.0f, 1.0f) * static_cast<float>(piece.last - piece.first);
  const Index p = std::min(piece.first + static_cast<Index>(place), piece.last - 1);
  const float u = place - static_cast<float>(p - piece.first);
  hit.yarn = true;
  hit.normal = hit.flat_normal;
  hit.axis = normalized(tangent[p] * (1 - u) + tangent[p + 1] * u);
  hit.radius = y.radius[piece.yarn];
  hit.colour = y.colour[piece.yarn];
  hit.saturation = y.saturation[p] * (1 - u) + y.saturation[p + 1] * u;
  hit.point = p;
  hit.nearest = u < 0.5f ? p : p + 1;
  hit.nearest_saturation = y.saturation[hit.nearest];
  hit.along = along[p] * (1 - u) + along[p + 1] * u;
  const Vec3f side = normalized(cross(hit.axis, up)), face = cross(side, hit.axis);
  hit.around = std::atan2(dot(hit.normal, side), dot(hit.normal, face));
}

RayScene::RayScene() : parts_(new Parts) {}
RayScene::~RayScene() = default;
bool RayScene::has_liquid() const { return !parts_->liquid_mesh.triangles.empty(); }
float RayScene::skin() const { return parts_->skin; }

bool RayScene::update(const Frame& frame) {
  Parts& parts = *parts_;
  const bool still = parts.stands_still(frame);
  if (still) {
    parts.yarns.saturation = frame.yarns.saturation;
  } else {
    parts.yarns = frame.yarns;
    parts.drawn_solids = frame.solids;
    parts.cloths = frame.cloths;
    parts.up = frame.up;
    parts.build_solids();
    Bounds all = bounds_of_cloth(frame);
    all.include(bounds_of_solids(frame));
    if (all.empty()) all = bounds_of_liquid(frame);
    // Hits are float: their rounding grows with the scene's extent and its distance from the origin.
    const Real extent = all.empty() ? 1 : norm(all.size()) + norm(all.centre());
    parts.skin = static_cast<float>(1e-5 * extent);
  }
  parts.build_liquid(frame);
  return still;
}

bool RayScene::meets_solid(const Ray& ray, float limit, SolidHit& hit) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit found = ray_of(ray, limit);
  rtcIntersect1(parts_->solids.get(), &context, &found);
  if (found.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  hit = {};
  hit.distance = found.ray.tfar;
  hit.flat_normal = facing(normalized(Vec3f{found.hit.Ng_x, found.hit.Ng_y, found.hit.Ng_z}), ray.direction);
  if (found.hit.geomID == parts_->yarn_geometry) {
    parts_->yarn_hit(found, hit);
  } else if (found.hit.geomID == parts_->end_geometry) {
    parts_->end_hit(found, hit);
  } else {
    const SolidPart& part = parts_->parts[found.hit.geomID];
    hit.normal = facing(mesh_normal(part.mesh, found.hit), ray.direction);
    hit.colour = part.colour;
    if (!part.saturation.empty()) {
      const auto& t = part.mesh.triangles[found.hit.primID];
      const float a = 1 - found.hit.u - found.hit.v, b = found.hit.u, c = found.hit.v;
      hit.cloth = true;
      const std::array<float, 3> values{part.saturation[t[0]], part.saturation[t[1]], part.saturation[t[2]]};
      if (part.uv.empty()) {
        hit.saturation = a * values[0] + b * values[1] + c * values[2];
      } else {
        hit.saturation = smooth_value({a, b, c}, values, {part.uv[t[0]], part.uv[t[1]], part.uv[t[2]]},
                                      {part.slope[t[0]], part.slope[t[1]], part.slope[t[2]]});
        hit.u = a * part.uv[t[0]][0] + b * part.uv[t[1]][0] + c * part.uv[t[2]][0];
        hit.v = a * part.uv[t[0]][1] + b * part.uv[t[1]][1] + c * part.uv[t[2]][1];
      }
    }
  }
  return true;
}

bool RayScene::meets_liquid(const Ray& ray, float limit, LiquidHit& hit) const {
  if (!has_liquid()) return false;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit found = ray_of(ray, limit);
  rtcIntersect1(parts_->liquid.get(), &context, &found);
  if (found.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  const Vec3f flat = normalized(Vec3f{found.hit.Ng_x, found.hit.Ng_y, found.hit.Ng_z});
  hit.distance = found.ray.tfar;
  hit.entering = dot(flat, ray.direction) < 0;
  hit.normal = mesh_normal(parts_->liquid_mesh, found.hit);
  // Near the outline a smooth normal may look away from the ray although its face does not.
  if ((dot(hit.normal, ray.direction) < 0) != hit.entering) hit.normal = flat;
  return true;
}

bool RayScene::solid_between(const Ray& ray, float limit) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay shadow = ray_of(ray, limit).ray;
  rtcOccluded1(parts_->solids.get(), &context, &shadow);
  return shadow.tfar < 0;
}

bool RayScene::liquid_between(const Ray& ray, float limit) const {
  if (!has_liquid()) return false;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay shadow = ray_of(ray, limit).ray;
  rtcOccluded1(parts_->liquid.get(), &context, &shadow);
  return shadow.tfar < 0;
}

}  // namespace imbibe
