// Drops under a cloth of cells: what has leaked hangs, falls as particles, or is drawn back.
#include <algorithm>

#include "imbibe/core/portable.h"
#include "imbibe/coupling/cell_cloth_parts.h"
#include "imbibe/geometry/direction.h"

namespace imbibe {
namespace {

Vec3 xyz(const Float4& f) { return {f.x, f.y, f.z}; }

// In particle spacings: what is nearer to the sheet than hanging ones is moved off it.
constexpr Real clear_of_sheet = 0.4;

// Where what leaks at a cell may hang: under the sheet there, around that place, and one spacing lower.
std::array<Vec3, 14> birth_places(const CellCloth& cloth, const MovingMesh& surface, Index cell, const Vec3& down, Real spacing) {
  const Vec3 hang = cloth.soft.sheet.position[(*cloth.node_of_cell)[cell]] + hanging_spacings * spacing * down;
  const Vec3 a = any_perpendicular(down), b = cross(down, a);
  std::array<Vec3, 14> places;
  for (std::size_t k = 0; k < places.size(); ++k) {
    Vec3 place = hang + (k < 7 ? 0 : spacing) * down;
    const Real angle = 2 * pi * static_cast<Real>(k % 7) / 6;
    if (k % 7 > 0) place += spacing * (portable::cos(angle) * a + portable::sin(angle) * b);
    // Clear of the sheet, on the side where it hangs.
    const NearestOnSheet near = nearest_on(surface, place, clear_of_sheet * spacing);
    if (near.at.triangle != no_index)
      place = near.point + hanging_spacings * spacing * (dot(near.normal, down) >= 0 ? near.normal : -near.normal);
    places[k] = place;
  }
  return places;
}

// Births of one step: whether a place is free, and the books of what is born there.
struct Births {
  CellCloth& cloth;
  SoftSheetScratch& scratch;
  Liquid& liquid;
  const SolidAt& solid_at;
  CellExchangeReport& report;

  bool is_free(const Vec3& place) const { return scratch.occupancy.is_free(place) && !(solid_at && solid_at(place)); }
  // A particle of what waits at `cell`.
  void give(Index cell, const Vec3& place) const {
    const Index node = (*cloth.node_of_cell)[cell];
    const Vec3 velocity = cloth.soft.sheet.velocity[node];
    const Real mass = liquid.particle_mass;
    add_particle(liquid, place, velocity);
    scratch.occupancy.add(place);
    cloth.waiting_kg[cell] -= mass;
    cloth.soft.sheet.added_mass[node] = std::max(0.0, cloth.soft.sheet.added_mass[node] - mass);
    cloth.soft.liquid_impulse -= mass * velocity;
    // What rounding to single precision takes from the particle stays with the node: momentum is whole.
    give_impulse(cloth.soft, scratch.held, node, mass * (velocity - xyz(liquid.particles.velocity.back())));
    ++cloth.released_particles, ++report.released;
  }
};

// What hangs within a drop's width of `cell` is one drop with it: where that makes kg, it is drawn together there.
bool gather_waiting(CellCloth& cloth, std::span<const std::uint8_t> held, std::span<const Index> waiting, Index cell,
                    Real kg, Real width) {
  const auto place = [&](Index c) { return cloth.soft.sheet.position[(*cloth.node_of_cell)[c]]; };
  const auto near = [&](Index other) { return norm(place(other) - place(cell)) <= width; };
  Real sum = 0;
  for (const Index other : waiting) sum += near(other) ? cloth.waiting_kg[other] : 0;
  if (sum < kg) return false;
  for (const Index other : waiting) {
    const Real missing = kg - cloth.waiting_kg[cell];
    if (other == cell || missing <= 0 || !near(other)) continue;
    const Real moved = std::min(missing, cloth.waiting_kg[other]);
    carry(cloth, held, other, cell, moved);
    cloth.waiting_kg[other] -= moved, cloth.waiting_kg[cell] += moved;
  }
  return cloth.waiting_kg[cell] >= kg;
}

}  // namespace

void draw_back(CellCloth& cloth, std::span<const std::uint8_t> held) {
  constexpr Real least_share = 0.05;  // of the capacity: not a parcel in every step
  const CellGrid& grid = *cloth.grid;
  CellContents& contents = cloth.contents;
  if (!cloth.params.absorb || waiting_kg(cloth) == 0 || leaks(cloth)) return;
  for (Index c = 0; c < grid.cells(); ++c) {
    const Real room = grid.capacity(c) - contents.content_kg[c], kg = std::min(room, cloth.waiting_kg[c]);
    if (!(kg > 0) || (kg < cloth.waiting_kg[c] && kg < least_share * grid.capacity(c))) continue;
    const Vec3 at = grid.centre(c);
    const CellStencil where = add_parcel(grid, contents, at.x, at.y, kg);
    for (std::size_t k = 0; k < where.count; ++k) carry(cloth, held, c, where.cell[k], kg * where.weight[k]);
    cloth.waiting_kg[c] -= kg;
  }
}

void release_waiting(CellCloth& cloth, SoftSheetScratch& scratch, Liquid& liquid, const Vec3& gravity, const SolidAt& solid_at,
                     CellExchangeReport& report) {
  const Real mass = liquid.particle_mass, spacing = liquid.spacing(), neck = cloth.params.drop_neck;
  std::vector<Index> waiting;
  for (Index c = 0; c < cloth.waiting_kg.size(); ++c)
    if (cloth.waiting_kg[c] > 0) waiting.push_back(c);
  if (mass <= 0 || waiting.empty()) return;
  const Real falling = falling_drop_kg(neck, liquid.kind.surface_tension, norm(gravity));
  if (waiting_kg(cloth) < std::max(mass, falling)) return;
  const auto count = static_cast<std::size_t>(std::max(1.0, std::round(falling / mass)));
  const Real drop_kg = static_cast<Real>(count) * mass;
  std::stable_sort(waiting.begin(), waiting.end(), [&](Index a, Index b) { return cloth.waiting_kg[a] > cloth.waiting_kg[b]; });
  Bounds region;
  for (const Vec3& x : cloth.soft.sheet.position) region.include(x);
  const Vec3 down = normalized(gravity);
  const std::vector<Vec3> drop = hanging_drop(count, spacing, hanging_spacings, down);
  region.grow(norm(drop.back()) + 4 * spacing);
  scratch.occupancy.reset(liquid.particles.position, region, clear_spacings * spacing);
  const Births births{cloth, scratch, liquid, solid_at, report};
  for (const Index cell : waiting) {
    if (!gather_waiting(cloth, scratch.held, waiting, cell, drop_kg, 2 * neck)) continue;
    const Vec3 from = cloth.soft.sheet.position[(*cloth.node_of_cell)[cell]];
    const bool free = std::all_of(drop.begin(), drop.end(), [&](const Vec3& p) {
      return births.is_free(from + p) && nearest_on(scratch.surface, from + p, clear_of_sheet * spacing).at.triangle == no_index;
    });
    if (free) {
      for (const Vec3& p : drop) births.give(cell, from + p);
    } else if (count == 1 || cloth.waiting_kg[cell] > drops_of_a_stream * drop_kg) {
      for (const Vec3& place : birth_places(cloth, scratch.surface, cell, down, spacing))
        if (cloth.waiting_kg[cell] >= mass && births.is_free(place)) births.give(cell, place);
    }
  }
}

}  // namespace imbibe
