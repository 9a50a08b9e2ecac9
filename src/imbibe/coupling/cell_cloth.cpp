#include "imbibe/coupling/cell_cloth.h"

#include <algorithm>
#include <numeric>

#include "imbibe/core/error.h"
#include "imbibe/core/portable.h"
#include "imbibe/coupling/hem_drops.h"
#include "imbibe/geometry/direction.h"
#include "imbibe/wetting/evaporation.h"

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

Bounds material_bounds(const Sheet& sheet) {
  Bounds b;
  for (std::size_t n = 0; n < sheet.size(); ++n) b.include({sheet.u[n], sheet.v[n], 0});
  return b;
}

// Area of the sheet in each cell of a free-form sheet: every triangle is cut into small ones, each counted at its middle, first
// for the cell it lies in, which tells the cells that there are, then with the weights of contents (cell_flow.h).
template <class Visit>
void each_small_triangle(const Sheet& sheet, Visit&& visit) {
  constexpr int cuts = 8;
  for (const auto& t : sheet.triangles) {
    const Vec3 a{sheet.u[t[0]], sheet.v[t[0]], 0}, b{sheet.u[t[1]], sheet.v[t[1]], 0}, c{sheet.u[t[2]], sheet.v[t[2]], 0};
    const Real part = 0.5 * norm(cross(b - a, c - a)) / (cuts * cuts);
    for (int i = 0; i < cuts; ++i)
      for (int j = 0; j < 2 * (cuts - i) - 1; ++j) {
        const Real third = j % 2 == 0 ? 1.0 / 3 : 2.0 / 3;
        const Real x = (i + third) / cuts, y = (j / 2 + third) / cuts;
        const Vec3 p = a + x * (b - a) + y * (c - a);
        visit(p, part);
      }
  }
}

void find_areas(const Sheet& sheet, CellGrid& grid) {
  grid.area.assign(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows), 0);
  each_small_triangle(sheet, [&](const Vec3& p, Real part) { grid.area[grid.cell_at(p.x, p.y)] += part; });
  std::vector<Real> weighted(grid.area.size(), 0);
  each_small_triangle(sheet, [&](const Vec3& p, Real part) {
    const CellStencil s = stencil_at(grid, p);
    for (std::size_t k = 0; k < s.count; ++k) weighted[s.cell[k]] += s.weight[k] * part;
  });
  grid.area = std::move(weighted);
}

// What the weights of a rectangle's outermost cells cover of an edge: 1/2 + 1/24 of a cell, and so much less beside it.
Real edge_share(int i, int cells) {
  constexpr Real more = 1.0 / 24;
  const bool first = i == 0, last = i == cells - 1;
  return 1 - (first || last ? 0.5 - more : 0) - (i == 1 ? more : 0) - (i == cells - 2 ? more : 0);
}

CellGrid grid_cells(const Sheet& sheet, Real capacity_per_area) {
  const Bounds b = material_bounds(sheet);
  CellGrid grid = rectangular_cells(static_cast<int>(sheet.columns), static_cast<int>(sheet.rows), b.size().x, b.size().y, capacity_per_area);
  for (int j = 0; j < grid.rows; ++j)
    for (int i = 0; i < grid.columns; ++i)
      grid.area[static_cast<std::size_t>(j * grid.columns + i)] =
          grid.pitch_x * edge_share(i, grid.columns) * grid.pitch_y * edge_share(j, grid.rows);
  return grid;
}

CellGrid free_form_cells(const Sheet& sheet, std::optional<Real> size, Real capacity_per_area) {
  const Bounds b = material_bounds(sheet);
  Real area = 0;
  for (const Real a : node_areas(sheet)) area += a;
  const Real pitch = size.value_or(std::sqrt(area / static_cast<Real>(sheet.size())));
  CellGrid grid;
  const auto fit = [&](Real length) { return std::max(2, static_cast<int>(std::lround(length / pitch))); };
  grid.columns = fit(b.size().x), grid.rows = fit(b.size().y);
  grid.pitch_x = b.size().x / grid.columns, grid.pitch_y = b.size().y / grid.rows;
  grid.first_x = b.lower.x + 0.5 * grid.pitch_x, grid.first_y = b.lower.y + 0.5 * grid.pitch_y;
  grid.lower_x = b.lower.x, grid.lower_y = b.lower.y, grid.upper_x = b.upper.x, grid.upper_y = b.upper.y;
  grid.capacity_per_area = capacity_per_area;
  find_areas(sheet, grid);
  return grid;
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

// Mass that changes node takes its momentum along.
void carry(CellCloth& cloth, std::span<const std::uint8_t> held, Index from, Index to, Real kg) {
  const Index a = (*cloth.node_of_cell)[from], b = (*cloth.node_of_cell)[to];
  if (a == b) return;
  Sheet& sheet = cloth.soft.sheet;
  const Vec3 velocity = sheet.velocity[a];
  sheet.added_mass[a] = std::max(0.0, sheet.added_mass[a] - kg);
  merge_into_node(cloth.soft, held, b, kg, velocity);
  sheet.added_mass[b] += kg;
}

// The same for all that the parcels carry in a step, from the velocities before it: what leaves a cell has its node's, and
// what a parcel brings elsewhere the mean of what it took.
class Carried {
 public:
  Carried(CellCloth& cloth, CellFlowScratch& work) : cloth_(cloth), kg_(work.moved_kg), momentum_(work.moved_momentum) {
    kg_.assign(cloth.soft.sheet.size(), 0);
    momentum_.assign(cloth.soft.sheet.size(), Vec3{});
  }

  void move(Real kg, const CellStencil& from, const CellStencil& to) {
    std::array<Index, 18> cell;
    std::array<Real, 18> change;
    std::size_t count = from.count;
    for (std::size_t k = 0; k < from.count; ++k) cell[k] = from.cell[k], change[k] = -kg * from.weight[k];
    for (std::size_t k = 0; k < to.count; ++k) {
      // Mostly the same cells in the same order.
      const std::size_t at = k < from.count && cell[k] == to.cell[k]
                                 ? k
                                 : static_cast<std::size_t>(std::find(cell.begin(), cell.begin() + count, to.cell[k]) - cell.begin());
      if (at == count) cell[count] = to.cell[k], change[count++] = 0;
      change[at] += kg * to.weight[k];
    }
    Real taken = 0;
    Vec3 momentum{};
    for (std::size_t k = 0; k < count; ++k)
      if (change[k] < 0) taken -= change[k], momentum -= change[k] * velocity(cell[k]);
    if (!(taken > 0)) return;
    for (std::size_t k = 0; k < count; ++k) add(cell[k], change[k], change[k] < 0 ? velocity(cell[k]) : momentum / taken);
  }

  // What leaks of a parcel.
  void move(Real kg, const CellStencil& from, Index to) {
    for (std::size_t k = 0; k < from.count; ++k) {
      const Real part = kg * from.weight[k];
      add(to, part, velocity(from.cell[k])), add(from.cell[k], -part, velocity(from.cell[k]));
    }
  }

  void apply(std::span<const std::uint8_t> held) {
    Sheet& sheet = cloth_.soft.sheet;
    for (std::size_t n = 0; n < kg_.size(); ++n) {
      if (kg_[n] == 0 && momentum_[n] == Vec3{}) continue;
      Vec3& v = sheet.velocity[n];
      const Real mass = sheet.mass(n), added = std::max(0.0, sheet.added_mass[n] + kg_[n]);
      if (held[n]) cloth_.soft.support_impulse -= momentum_[n] - kg_[n] * v;
      else v = (mass * v + momentum_[n]) / (mass - sheet.added_mass[n] + added);
      sheet.added_mass[n] = added;
    }
  }

 private:
  Vec3 velocity(Index cell) const { return cloth_.soft.sheet.velocity[(*cloth_.node_of_cell)[cell]]; }
  void add(Index cell, Real kg, const Vec3& velocity) {
    const Index node = (*cloth_.node_of_cell)[cell];
    kg_[node] += kg, momentum_[node] += kg * velocity;
  }

  CellCloth& cloth_;
  std::vector<Real>& kg_;
  std::vector<Vec3>& momentum_;
};

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

// Drops that hang where cells have room again, and nothing leaks, are drawn back into the cloth.
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

// Drops fall where they have grown to their greatest mass; what comes faster than drops can fall leaves as a stream.
void release(CellCloth& cloth, SoftSheetScratch& scratch, Liquid& liquid, const Vec3& gravity, const SolidAt& solid_at,
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

}  // namespace

void fit_cells(CellCloth& cloth) {
  const Sheet& sheet = cloth.soft.sheet;
  const Real capacity = cloth.params.capacity.value_or(cloth.params.capacity_ratio * sheet.areal_mass);
  std::vector<Index> nodes;
  if (sheet.is_grid()) {
    cloth.grid = std::make_shared<const CellGrid>(grid_cells(sheet, capacity));
    nodes.resize(sheet.size());
    std::iota(nodes.begin(), nodes.end(), Index{0});
  } else {
    cloth.grid = std::make_shared<const CellGrid>(free_form_cells(sheet, cloth.params.cell_size, capacity));
    for (Index c = 0; c < cloth.grid->cells(); ++c) {
      const Vec3 at = cloth.grid->centre(c);
      nodes.push_back(cloth.grid->area[c] > 0 ? node_nearest(sheet, at.x, at.y) : Index{0});
    }
  }
  cloth.node_of_cell = std::make_shared<const std::vector<Index>>(std::move(nodes));
  cloth.contents = empty_contents(*cloth.grid);
  cloth.waiting_kg.assign(cloth.grid->cells(), 0);
}

bool leaks(const CellCloth& cloth) {
  // Of the capacity: what cloth holds without leaking it. All that is wet drains through its lowest cell, ever more slowly.
  constexpr Real over_full = 5e-3;
  if (!cloth.params.leak) return false;
  for (std::size_t c = 0; c < cloth.grid->cells(); ++c)
    if (cloth.contents.content_kg[c] > (1 + over_full) * cloth.grid->capacity(c)) return true;
  return false;
}

Real cell_kg(const CellCloth& cloth) { return total_kg(cloth.contents); }
Real waiting_kg(const CellCloth& cloth) {
  return std::accumulate(cloth.waiting_kg.begin(), cloth.waiting_kg.end(), Real{0});
}

std::vector<HangingDrop> hanging_drops(const CellCloth& cloth) {
  const auto place = [&](Index c) -> const Vec3& { return cloth.soft.sheet.position[(*cloth.node_of_cell)[c]]; };
  std::vector<Index> cells(cloth.waiting_kg.size());
  std::iota(cells.begin(), cells.end(), Index{0});
  std::vector<HangingDrop> drops;
  const auto near = [&](Index a, Index b) { return norm(place(a) - place(b)) <= 2 * cloth.params.drop_neck; };
  for (const auto& [cell, kg] : gather_drops(cells, cloth.waiting_kg, near)) drops.push_back({place(cell), kg});
  return drops;
}

std::vector<float> node_saturation(const CellCloth& cloth) {
  const Sheet& sheet = cloth.soft.sheet;
  std::vector<float> s(sheet.size(), 0);
  for (std::size_t n = 0; n < s.size(); ++n) {
    const std::size_t cell = sheet.is_grid() ? n : cloth.grid->cell_at(sheet.u[n], sheet.v[n]);
    s[n] = static_cast<float>(cell_saturation(*cloth.grid, cloth.contents, cell));
  }
  return s;
}

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

namespace {

// Liquid that lies on the sheet without crossing it: the liquid's solver holds it up.
constexpr Real touch_spacings = 0.75;

}  // namespace

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

namespace {

// Parcels move and leak; what they carry from node to node takes its momentum along.
void flow(CellCloth& cloth, SoftSheetScratch& scratch, const Vec3& gravity, Real dt) {
  const CellGrid& grid = *cloth.grid;
  CellContents& contents = cloth.contents;
  CellFlowScratch& work = scratch.cells;
  work.lift.resize(grid.cells());
  for (std::size_t c = 0; c < grid.cells(); ++c) work.lift[c] = -dot(gravity, cloth.soft.sheet.position[(*cloth.node_of_cell)[c]]);
  work.place_before = contents.parcel_place;
  work.content_before = contents.content_kg;
  move_parcels(grid, cloth.params, work.lift, dt, contents, work);
  Carried carried(cloth, work);
  for (std::size_t p = 0; p < contents.parcels(); ++p)
    if (contents.parcel_place[p] != work.place_before[p])
      carried.move(contents.parcel_kg[p], stencil_at(grid, work.place_before[p]), stencil_at(grid, contents.parcel_place[p]));
  std::vector<ParcelLeak> leaked;
  if (leaks(cloth)) leaked = leak_parcels(grid, cloth.params, work.content_before, work.lift, dt, contents);
  for (const ParcelLeak& leak : leaked) {
    carried.move(leak.kg, stencil_at(grid, contents.parcel_place[leak.parcel]), leak.at);
    cloth.waiting_kg[leak.at] += leak.kg;
  }
  carried.apply(scratch.held);
  if (!leaked.empty()) count_contents(grid, contents);
}

}  // namespace

void step_cell_cloth(CellCloth& cloth, SoftSheetScratch& scratch, Liquid& liquid, const Air& air, const Vec3& gravity,
                     Real dt, CellExchangeReport& report, const SolidAt& solid_at) {
  if (cloth.contents.parcels() > 0) {
    flow(cloth, scratch, gravity, dt);
    const Real evaporation = 2 * evaporation_rate(air, 1, wet_bulb_temperature(air));
    report.evaporated_kg += dry_parcels(*cloth.grid, cloth.params, evaporation, liquid.particle_mass, dt, cloth.contents);
  }
  draw_back(cloth, scratch.held);
  release(cloth, scratch, liquid, gravity, solid_at, report);
  weigh(cloth);
}

void weigh(CellCloth& cloth) {
  Sheet& sheet = cloth.soft.sheet;
  std::fill(sheet.added_mass.begin(), sheet.added_mass.end(), 0);
  for (Index c = 0; c < cloth.grid->cells(); ++c)
    sheet.added_mass[(*cloth.node_of_cell)[c]] += cloth.contents.content_kg[c] + cloth.waiting_kg[c];
  if (cloth.wet.softening > 0 || cloth.wet.damping > 0) {
    const std::vector<float> s = node_saturation(cloth);
    for (std::size_t n = 0; n < sheet.size(); ++n) {
      const Real wet = std::min(1.0f, s[n]);
      sheet.stiffness_factor[n] = 1 - cloth.wet.softening * wet;
      sheet.damping_added[n] = cloth.wet.damping * wet;
    }
  }
  wake_if_heavier(cloth.soft);
}

}  // namespace imbibe
