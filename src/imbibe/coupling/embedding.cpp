#include "imbibe/coupling/embedding.h"

#include <algorithm>

#include "imbibe/core/error.h"
#include "imbibe/core/parallel.h"
#include "imbibe/geometry/closest.h"

namespace imbibe {
namespace {

constexpr Real infinite = std::numeric_limits<Real>::infinity();
constexpr Real most_drying = 0.5;  // of a node's dry mass: fibres never hold so much vapour that more could leave

Vec3 flat_corner(const Sheet& sheet, Index node) {
  return {sheet.u[node], sheet.v[node], 0};
}

template <class Of>
Vec3 mixed(const Sheet& sheet, const SurfacePoint& at, Of&& of) {
  const auto& t = sheet.triangles[at.triangle];
  return at.weight[0] * of(t[0]) + at.weight[1] * of(t[1]) + at.weight[2] * of(t[2]);
}

Vec3 position_at(const Sheet& sheet, const SurfacePoint& at) {
  return mixed(sheet, at, [&](Index i) { return sheet.position[i]; });
}

}  // namespace

Embedding build_embedding(const Sheet& sheet, const YarnNetwork& network) {
  IMBIBE_ASSERT(sheet.is_grid());
  Embedding e;
  e.width = sheet.u.back() - sheet.u.front(), e.height = sheet.v.back() - sheet.v.front();
  e.columns = sheet.columns - 1, e.rows = sheet.rows - 1;
  e.cell_triangles.assign(static_cast<std::size_t>(e.columns) * e.rows, {no_index, no_index});
  for (Index t = 0; t < sheet.triangles.size(); ++t) {
    const auto& v = sheet.triangles[t];
    const Index column = std::min({v[0] % sheet.columns, v[1] % sheet.columns, v[2] % sheet.columns});
    const Index row = std::min({v[0] / sheet.columns, v[1] / sheet.columns, v[2] / sheet.columns});
    auto& pair = e.cell_triangles[column + static_cast<std::size_t>(e.columns) * row];
    (pair[0] == no_index ? pair[0] : pair[1]) = t;
  }
  for (std::size_t k = 0; k < network.nodes(); ++k) {
    const Vec3& c = network.node_centre(k);
    e.node.push_back(point_at(e, sheet, c.x, c.y));
  }
  return e;
}

SurfacePoint point_at(const Embedding& e, const Sheet& sheet, Real x, Real y) {
  const Real u = std::clamp(x + 0.5 * e.width, 0.0, e.width), v = std::clamp(y + 0.5 * e.height, 0.0, e.height);
  const Index i = std::min(static_cast<Index>(u / e.width * e.columns), e.columns - 1);
  const Index j = std::min(static_cast<Index>(v / e.height * e.rows), e.rows - 1);
  const Vec3 p{sheet.u.front() + u, sheet.v.front() + v, 0};
  SurfacePoint best;
  Real inside = -infinite;
  for (const Index t : e.cell_triangles[i + static_cast<std::size_t>(e.columns) * j]) {
    const auto& n = sheet.triangles[t];
    const auto w = barycentric(p, flat_corner(sheet, n[0]), flat_corner(sheet, n[1]), flat_corner(sheet, n[2]));
    const Real least = std::min({w[0], w[1], w[2]});
    if (least > inside) inside = least, best = {t, w};
  }
  return best;
}

void update_normals(EmbeddingScratch& scratch, const Sheet& sheet) {
  scratch.normal.assign(sheet.size(), Vec3{});
  const auto& x = sheet.position;
  for (const auto& t : sheet.triangles) {
    const Vec3 n = cross(x[t[1]] - x[t[0]], x[t[2]] - x[t[0]]);
    for (const Index k : t) scratch.normal[k] += n;
  }
  for (Vec3& n : scratch.normal) n = normalized(n);
}

void update(EmbeddingScratch& scratch, const Embedding& embedding, const Sheet& sheet, const YarnNetwork& network,
            const Vec3& gravity) {
  if (scratch.positions == sheet.position && scratch.potential.size() == network.nodes()) return;
  scratch.positions = sheet.position;
  update_normals(scratch, sheet);
  scratch.potential.resize(network.nodes()), scratch.across.resize(network.nodes());
  const ClothPlace place(embedding, sheet, scratch);
  parallel_for(network.nodes(), [&](std::size_t k) {
    const SurfacePoint& at = embedding.node[k];
    const Vec3 n = normalized(mixed(sheet, at, [&](Index i) { return scratch.normal[i]; }));
    scratch.potential[k] = dot(gravity, position_at(sheet, at) + network.node_centre(k).z * n);
    scratch.across[k] = dot(gravity, n);
  });
}

// --- ClothPlace
// -------------------------------------------------------------------------------------------------------

Vec3 ClothPlace::bent_normal(const Vec3& p) const {
  return normalized(mixed(*sheet_, surface_point(p), [&](Index i) { return scratch_->normal[i]; }));
}

Vec3 ClothPlace::bent_to_world(const Vec3& p) const {
  const SurfacePoint at = surface_point(p);
  const Vec3 n = normalized(mixed(*sheet_, at, [&](Index i) { return scratch_->normal[i]; }));
  return position_at(*sheet_, at) + p.z * n;
}

NearestOnSheet ClothPlace::nearest(const Vec3& w) const {
  IMBIBE_ASSERT(surface_ != nullptr && !surface_->empty());
  Bounds all = surface_->at_end.nodes[0].bounds;
  all.grow(reach_);
  NearestOnSheet near;
  if (!all.contains(w)) return near;
  near = nearest_on(*surface_, w, reach_);
  if (near.on_border) near.at.triangle = no_index;
  return near;
}

Vec3 ClothPlace::material(const NearestOnSheet& near) const {
  Vec3 p = mixed(*sheet_, near.at, [&](Index i) { return flat_corner(*sheet_, i); });
  p -= Vec3{sheet_->u.front() + 0.5 * embedding_->width, sheet_->v.front() + 0.5 * embedding_->height, 0};
  p.z = near.side * near.distance;
  return p;
}

Vec3 ClothPlace::bent_to_sheet(const Vec3& w) const {
  const NearestOnSheet near = nearest(w);
  return near.at.triangle == no_index ? Vec3{0, 0, infinite} : material(near);
}

Vec3 ClothPlace::velocity_at(const Vec3& p) const {
  return flat_ ? Vec3{} : imbibe::velocity_at(*sheet_, surface_point(p));
}

ClothPlace::Frame ClothPlace::frame_near(const Vec3& w) const {
  if (flat_) return {flat_->to_sheet(w), flat_->u, flat_->v, flat_->n, {}};
  const NearestOnSheet near = nearest(w);
  Frame f;
  f.at = {0, 0, infinite};
  if (near.at.triangle == no_index) return f;
  f.at = material(near);
  f.velocity = imbibe::velocity_at(*sheet_, near.at);
  f.n = near.side * near.normal;
  const auto& t = sheet_->triangles[near.at.triangle];
  const auto& x = surface_->mesh.vertices;
  const Vec3 a = flat_corner(*sheet_, t[0]), b = flat_corner(*sheet_, t[1]) - a, c = flat_corner(*sheet_, t[2]) - a;
  const Vec3 along_u = c.y * (x[t[1]] - x[t[0]]) - b.y * (x[t[2]] - x[t[0]]);  // dx/du, but for a factor > 0
  f.u = normalized(along_u - dot(along_u, f.n) * f.n);
  f.v = cross(f.n, f.u);
  return f;
}

Vec3 ClothPlace::foot(const Vec3& gravity) const {
  if (flat_) return flat_->origin;
  const auto& x = sheet_->position;
  return *std::max_element(x.begin(), x.end(),
                           [&](const Vec3& a, const Vec3& b) { return dot(gravity, a) < dot(gravity, b); });
}

// --- what the cloth carries
// -------------------------------------------------------------------------------------------

void add_to_sheet(const Embedding& embedding, const Sheet& sheet, std::span<const Real> network_kg,
                  std::vector<Real>& sheet_kg) {
  for (std::size_t k = 0; k < network_kg.size(); ++k) {
    if (network_kg[k] == 0) continue;
    const SurfacePoint& at = embedding.node[k];
    for (std::size_t c = 0; c < 3; ++c) sheet_kg[sheet.triangles[at.triangle][c]] += at.weight[c] * network_kg[k];
  }
}

void join_sheet(SoftSheet& soft, std::span<const std::uint8_t> held, const SurfacePoint& at, Real kg,
                const Vec3& velocity) {
  soft.liquid_impulse += kg * velocity;
  for (std::size_t c = 0; c < 3; ++c) {
    const Index node = soft.sheet.triangles[at.triangle][c];
    const Real part = at.weight[c] * kg;
    if (part > 0) merge_into_node(soft, held, node, part, velocity);
    soft.sheet.added_mass[node] += part;
  }
}

void leave_sheet(SoftSheet& soft, std::span<const std::uint8_t> held, const SurfacePoint& at, Real kg,
                 const Vec3& velocity, MassLeft& left) {
  const Vec3 own = velocity_at(soft.sheet, at);
  left.kg += kg, left.momentum += kg * own;
  soft.liquid_impulse -= kg * velocity;
  const Vec3 push = kg * (own - velocity);
  soft.liquid_impulse -= push;  // booked once more below
  give_impulse(soft, held, at, push);
}

void set_added_mass(SoftSheet& soft, std::span<const std::uint8_t> held, std::span<const Real> wanted,
                    const MassLeft& left) {
  Sheet& sheet = soft.sheet;
  const Real mass = total_mass(sheet);
  const Vec3 mean = momentum(sheet) / mass;
  Vec3 carried{};
  Real change = 0, free_mass = 0;
  for (std::size_t n = 0; n < sheet.size(); ++n) {
    // Drying below the air's regain makes a node lighter than its conditioned cloth, by some per cent at most.
    const Real now = std::max(wanted[n], -most_drying * sheet.dry_mass[n]), more = now - sheet.added_mass[n];
    change += more, carried += more * sheet.velocity[n];
    sheet.added_mass[n] = now;
    if (!held[n]) free_mass += sheet.mass(n);
  }
  if (!soft.moves() || !(free_mass > 0)) return;
  const Vec3 shift = ((change + left.kg) * mean - left.momentum - carried) / free_mass;
  for (std::size_t n = 0; n < sheet.size(); ++n)
    if (!held[n]) sheet.velocity[n] += shift;
}

}  // namespace imbibe
