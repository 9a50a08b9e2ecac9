#include "imbibe/coupling/cell_cloth.h"

#include <algorithm>
#include <numeric>

#include "imbibe/coupling/cell_cloth_parts.h"
#include "imbibe/wetting/evaporation.h"

namespace imbibe {
namespace {

// As carry(), for all that the parcels carry in a step, from the velocities before it: what leaves a cell has its node's, and
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

void carry(CellCloth& cloth, std::span<const std::uint8_t> held, Index from, Index to, Real kg) {
  const Index a = (*cloth.node_of_cell)[from], b = (*cloth.node_of_cell)[to];
  if (a == b) return;
  Sheet& sheet = cloth.soft.sheet;
  const Vec3 velocity = sheet.velocity[a];
  sheet.added_mass[a] = std::max(0.0, sheet.added_mass[a] - kg);
  merge_into_node(cloth.soft, held, b, kg, velocity);
  sheet.added_mass[b] += kg;
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

void step_cell_cloth(CellCloth& cloth, SoftSheetScratch& scratch, Liquid& liquid, const Air& air, const Vec3& gravity,
                     Real dt, CellExchangeReport& report, const SolidAt& solid_at) {
  if (cloth.contents.parcels() > 0) {
    flow(cloth, scratch, gravity, dt);
    const Real evaporation = 2 * evaporation_rate(air, 1, wet_bulb_temperature(air));
    report.evaporated_kg += dry_parcels(*cloth.grid, cloth.params, evaporation, liquid.particle_mass, dt, cloth.contents);
  }
  draw_back(cloth, scratch.held);
  release_waiting(cloth, scratch, liquid, gravity, solid_at, report);
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
