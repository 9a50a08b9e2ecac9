// What a cloth of cells takes of the particles that meet it.
#include <algorithm>

#include "imbibe/core/portable.h"
#include "imbibe/coupling/cell_cloth.h"

namespace imbibe {
namespace {

Vec3 xyz(const Float4& f) { return {f.x, f.y, f.z}; }

// Material coordinates of a point of the sheet.
Vec3 material(const Sheet& sheet, const SurfacePoint& at) {
  Vec3 m{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Index n = sheet.triangles[at.triangle][k];
    m += at.weight[k] * Vec3{sheet.u[n], sheet.v[n], 0};
  }
  return m;
}

// A particle becomes so many parcels that a full cell holds about twenty: with one or two the cells would be over-full by one
// and empty without it, and what a cloth takes would depend on the size of its cells.
constexpr Real parcels_of_a_full_cell = 20;
constexpr int most_parcels_of_a_particle = 64;

// Where a particle of edge dx that meets the cloth at m wets it: places spread evenly over a disc of its cross-section, or of
// as much cloth as it fills to a quarter if that is more. With the cross-section alone a particle of 20 mg on cells of 5 mm filled
// one or two of them to twice their capacity, and fine cells took up more than coarse ones.
constexpr Real filled_by_a_particle = 0.25;
void find_footprint(const CellCloth& cloth, const Vec3& m, Real kg, Real dx, std::vector<Vec3>& places) {
  const Real capacity = cloth.grid->capacity(cloth.grid->cell_at(m.x, m.y));
  const Real wanted = capacity > 0 ? std::ceil(parcels_of_a_full_cell * kg / capacity) : 1;
  const int count = static_cast<int>(std::clamp(wanted, Real{1}, Real{most_parcels_of_a_particle}));
  constexpr Real golden_angle = 2.399963229728653;
  const Real full = filled_by_a_particle * cloth.grid->capacity_per_area;
  const Real radius = std::sqrt(std::max(dx * dx, full > 0 ? kg / full : 0) / pi);
  places.assign(static_cast<std::size_t>(count), m);
  for (int k = 0; count > 1 && k < count; ++k) {
    const Real r = radius * std::sqrt((k + 0.5) / count);
    places[static_cast<std::size_t>(k)] += r * Vec3{portable::cos(golden_angle * k), portable::sin(golden_angle * k), 0};
  }
}

// Whether the cells under a footprint have room for so much of what they are given of the particle (their neighbours count the
// rest), or of what they hold if that is less; what one cell has too much counts against the room in the next. Where nothing
// flows cells of any size are then filled to 1.06 to 1.12, where it flows to about 1 (with room for three quarters 1.04 to 1.07 and
// a tenth less uptake by fine cells than by coarse ones).
constexpr Real room_for = 0.5;

bool takes(const CellCloth& cloth, const std::vector<Vec3>& footprint, Real kg) {
  if (!cloth.params.absorb) return false;
  if (!cloth.params.bounce) return true;
  std::array<Index, most_parcels_of_a_particle> cells;
  std::size_t count = 0;
  for (const Vec3& at : footprint) cells[count++] = cloth.grid->cell_at(at.x, at.y);
  std::sort(cells.begin(), cells.begin() + count);
  count = static_cast<std::size_t>(std::unique(cells.begin(), cells.begin() + count) - cells.begin());
  Real room = 0, capacity = 0, given = 0;
  for (std::size_t k = 0; k < count; ++k) {
    capacity += cloth.grid->capacity(cells[k]);
    room += cloth.grid->capacity(cells[k]) - cloth.contents.content_kg[cells[k]];
  }
  const CellStencil middle = stencil_at(*cloth.grid, footprint[0]);
  for (std::size_t k = 0; k < middle.count; ++k)
    if (std::binary_search(cells.begin(), cells.begin() + count, middle.cell[k])) given += kg * middle.weight[k];
  return room_for * std::min(given, capacity) <= room;
}

void absorb(CellCloth& cloth, std::span<const std::uint8_t> held, const std::vector<Vec3>& footprint, Real kg,
            const Vec3& velocity) {
  const Real part = kg / static_cast<Real>(footprint.size());
  for (const Vec3& m : footprint) {
    const CellStencil where = add_parcel(*cloth.grid, cloth.contents, m.x, m.y, part);
    for (std::size_t k = 0; k < where.count; ++k) {
      const Index node = (*cloth.node_of_cell)[where.cell[k]];
      merge_into_node(cloth.soft, held, node, part * where.weight[k], velocity);
      cloth.soft.sheet.added_mass[node] += part * where.weight[k];
    }
  }
  cloth.soft.liquid_impulse += kg * velocity;
  ++cloth.absorbed_particles;
}

// Liquid that lies on the sheet without crossing it: the liquid's solver holds it up.
constexpr Real touch_spacings = 0.75;

}  // namespace

void meet_particles(CellCloth& cloth, SoftSheetScratch& scratch, Liquid& liquid, std::span<const Float4> before,
                    std::span<std::uint8_t> dead, const Vec3& gravity, std::uint64_t seed, std::uint64_t step,
                    CellExchangeReport& report) {
  Particles& p = liquid.particles;
  const Real mass = liquid.particle_mass, dx = liquid.spacing();
  const Real gap = 0.25 * std::min(cloth.soft.cloth.hand.thickness, 0.2 * dx);
  const ImpactParams impact{.restitution = cloth.params.restitution, .scatter = cloth.params.scatter,
                            .rest_speed = 0.5 * std::sqrt(norm(gravity) * dx)};
  find_sheet_hits(scratch.surface, before.first(p.size()), p.position, scratch.hits, scratch.hit_tiles);
  Sheet& sheet = cloth.soft.sheet;
  for (const SheetHit& hit : scratch.hits) {
    const Index i = hit.particle;
    if (dead[i]) continue;
    ++cloth.crossings;
    const Vec3 m = material(sheet, hit.crossing.at), v = xyz(p.velocity[i]);
    find_footprint(cloth, m, mass, dx, scratch.footprint);
    if (takes(cloth, scratch.footprint, mass)) {
      absorb(cloth, scratch.held, scratch.footprint, mass - p.owed_kg[i], v);
      p.owed_kg[i] = 0, dead[i] = 1;
      ++report.absorbed;
      continue;
    }
    const Vec3 surface_v = velocity_at(sheet, hit.crossing.at);
    const Vec3 after = velocity_after_impact(v, surface_v, hit.crossing.normal, mass,
                                             inverse_mass_at(sheet, scratch.held, hit.crossing.at), impact,
                                             {seed, p.id[i], step});
    store(p.velocity[i], after);
    give_impulse(cloth.soft, scratch.held, hit.crossing.at, mass * (v - xyz(p.velocity[i])));
    store(p.position[i], place_over(scratch.surface, hit.crossing, gap));
    ++cloth.bounces, ++report.bounced;
  }
}

void absorb_touching(CellCloth& cloth, SoftSheetScratch& scratch, Liquid& liquid, std::span<std::uint8_t> dead,
                     const Vec3& gravity, CellExchangeReport& report) {
  if (!cloth.params.absorb || scratch.surface.empty()) return;
  Particles& p = liquid.particles;
  const Real reach = touch_spacings * liquid.spacing() + 0.5 * cloth.soft.cloth.hand.thickness;
  Bounds near_sheet = scratch.surface.at_end.nodes[0].bounds;
  near_sheet.grow(reach);
  const bool leaking = leaks(cloth);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec3 x = xyz(p.position[i]);
    if (dead[i] || !near_sheet.contains(x)) continue;
    const NearestOnSheet near = nearest_on(scratch.surface, x, reach);
    if (near.at.triangle == no_index || near.on_border) continue;
    // What hangs under a sheet that leaks, or flies off, is leaving it. What still hangs there when nothing leaks is drawn back.
    if ((leaking && dot(near.normal, gravity) > 0) ||
        dot(near.normal, xyz(p.velocity[i]) - velocity_at(cloth.soft.sheet, near.at)) > 0.5 * std::sqrt(norm(gravity) * liquid.spacing()))
      continue;
    const Vec3 m = material(cloth.soft.sheet, near.at);
    find_footprint(cloth, m, liquid.particle_mass, liquid.spacing(), scratch.footprint);
    if (!takes(cloth, scratch.footprint, liquid.particle_mass)) continue;
    absorb(cloth, scratch.held, scratch.footprint, liquid.particle_mass - p.owed_kg[i], xyz(p.velocity[i]));
    p.owed_kg[i] = 0, dead[i] = 1;
    ++report.absorbed;
  }
}

}  // namespace imbibe
