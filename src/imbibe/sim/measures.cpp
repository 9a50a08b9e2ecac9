#include "imbibe/sim/measures.h"

#include <algorithm>

#include "imbibe/core/error.h"
#include "imbibe/core/parallel.h"
#include "imbibe/coupling/hem_drops.h"

namespace imbibe {

std::vector<Real> node_saturations(const Textile& textile, const Air& air) {
  const WettingModel& model = *textile.model;
  const Contents& contents = textile.contents;
  const bool all_wet = std::all_of(model.yarns.begin(), model.yarns.end(), [](const YarnWetting& y) { return y.wets; });
  const Contents in_air = all_wet ? Contents{} : conditioned_contents(model, air);
  std::vector<Real> result(model.nodes());
  for (std::size_t node = 0; node < model.nodes(); ++node) {
    if (node >= model.segments || model.yarns[model.segment_type[node]].wets) {
      result[node] = saturation(model, contents, node);
      continue;
    }
    const Real regain_in_air = node_regain(model, in_air, node);
    const Real room = model.yarns[model.segment_type[node]].swelling_regain - regain_in_air;
    const Real above = node_regain(model, contents, node) - regain_in_air;
    result[node] = room > 0 ? std::max(0.0, above / room) : 0;
  }
  return result;
}

namespace {

// The interval that holds all added numbers; 0 long when there is none.
struct Range {
  Real lower = unlimited, upper = -unlimited;
  void include(Real x) {
    lower = std::min(lower, x);
    upper = std::max(upper, x);
  }
  Real length() const { return upper > lower ? upper - lower : 0; }
};

}  // namespace

TextileMeasures measure(const Textile& textile, const Air& air, const MeasureParams& params) {
  const WettingModel& model = *textile.model;
  const YarnNetwork& network = textile.fabric->network;
  IMBIBE_ASSERT(model.segments == network.segments() && model.pores == network.pores());
  const std::vector<Real> saturations = node_saturations(textile, air);

  const std::vector<Vec3> places = nodes_in_world(textile);

  TextileMeasures m;
  Range along_warp, along_weft, upwards;
  std::vector<std::size_t> wet_segments(static_cast<std::size_t>(network.layers), 0);
  Real yarn_sum = 0, pore_sum = 0, pore_volume = 0;
  for (std::size_t node = 0; node < model.nodes(); ++node) {
    const Real s = saturations[node];
    m.max_saturation = std::max(m.max_saturation, s);
    if (node < model.segments) {
      m.yarn_volume += model.yarn_volume(node);
      yarn_sum += s * model.yarn_volume(node);
      m.max_regain = std::max(m.max_regain, node_regain(model, textile.contents, node));
    } else {
      pore_volume += model.volume(node);
      pore_sum += s * model.volume(node);
    }
    if (!(s > params.wet_saturation)) continue;
    along_warp.include(network.node_centre(node).y);
    along_weft.include(network.node_centre(node).x);
    upwards.include(places[node].z);
    if (node < model.segments) {
      ++wet_segments[static_cast<std::size_t>(network.layer_of(node))];
    } else {
      m.wet_pore_area += network.pore_area[node - model.segments];
    }
  }
  if (model.segments > 0) {
    const auto most = static_cast<Real>(*std::max_element(wet_segments.begin(), wet_segments.end()));
    m.wet_area = network.size_x * network.size_y * most * network.layers / static_cast<Real>(model.segments);
  }
  if (m.yarn_volume > 0) m.mean_saturation = yarn_sum / m.yarn_volume;
  if (pore_volume > 0) m.pore_saturation = pore_sum / pore_volume;
  m.extent_warp = along_warp.length();
  m.extent_weft = along_weft.length();
  m.wet_height = upwards.length();
  return m;
}

CellClothMeasures measure(const CellCloth& cloth, const MeasureParams& params) {
  CellClothMeasures m;
  const CellGrid& grid = *cloth.grid;
  Range along_warp, along_weft;
  Real capacity = 0, content = 0;
  for (std::size_t c = 0; c < grid.cells(); ++c) {
    const Real s = cell_saturation(grid, cloth.contents, c);
    capacity += grid.capacity(c), content += cloth.contents.content_kg[c];
    m.max_saturation = std::max(m.max_saturation, s);
    if (!(s > params.wet_saturation)) continue;
    m.wet_area += grid.area[c];
    along_weft.include(grid.centre(c).x);
    along_warp.include(grid.centre(c).y);
  }
  m.extent_warp = along_warp.length(), m.extent_weft = along_weft.length();
  if (capacity > 0) m.mean_saturation = content / capacity;
  m.capacity_volume = capacity / 1000;
  const std::vector<float> saturations = node_saturation(cloth);
  Range upwards;
  for (std::size_t n = 0; n < saturations.size(); ++n) {
    const Real z = cloth.soft.sheet.position[n].z;
    m.lowest = std::min(m.lowest, z);
    if (saturations[n] > params.wet_saturation) upwards.include(z);
  }
  m.wet_height = upwards.length();
  return m;
}

namespace {

template <class Place>
std::vector<Vec3> in_world(const Textile& textile, std::size_t count, Place&& flat_place) {
  std::vector<Vec3> places(count);
  EmbeddingScratch normals;
  if (textile.cloth) update_normals(normals, textile.cloth->soft.sheet);
  const ClothPlace place =
      textile.cloth ? ClothPlace(*textile.cloth->embedding, textile.cloth->soft.sheet, normals) : ClothPlace(textile.placement);
  parallel_for(count, [&](std::size_t i) { places[i] = place.to_world(flat_place(i)); });
  return places;
}

}  // namespace

std::vector<Vec3> points_in_world(const Textile& textile) {
  const std::vector<Vec3>& points = textile.fabric->network.points;
  return in_world(textile, points.size(), [&](std::size_t i) { return points[i]; });
}

std::vector<Vec3> nodes_in_world(const Textile& textile) {
  const YarnNetwork& network = textile.fabric->network;
  return in_world(textile, network.nodes(), [&](std::size_t i) { return network.node_centre(i); });
}

std::vector<Vec3> hanging_liquid(const World& world) {
  std::vector<Vec3> places;
  const Real mass = world.liquid.particle_mass, g = norm(world.gravity);
  if (!(mass > 0) || !(g > 0)) return places;
  const Vec3 down = normalized(world.gravity);
  const auto add = [&](const std::vector<HangingDrop>& drops) {
    for (const HangingDrop& drop : drops) {
      const auto count = static_cast<std::size_t>(std::floor(drop.kg / mass + 0.5));
      for (const Vec3& p : hanging_drop(count, world.liquid.spacing(), hanging_spacings, down)) places.push_back(drop.at + p);
    }
  };
  for (const Textile& textile : world.textiles) {
    if (!textile.cloth) continue;
    const YarnNetwork& network = textile.fabric->network;
    EmbeddingScratch scratch;
    update_normals(scratch, textile.cloth->soft.sheet);
    const ClothPlace place(*textile.cloth->embedding, textile.cloth->soft.sheet, scratch);
    const Real neck = hem_neck(world.liquid.kind.surface_tension, world.liquid.kind.density, g);
    Hem hem;
    find_hem(network, place, world.gravity, neck, hem);
    add(drops_at_hem(network, place, hem, neck, textile.exchange));
  }
  for (const CellCloth& cloth : world.cell_cloths) add(hanging_drops(cloth));
  return places;
}

}  // namespace imbibe
