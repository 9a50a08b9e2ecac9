#include "imbibe/live/recall.h"

#include <algorithm>
#include <optional>

#include "imbibe/sim/measures.h"
#include "imbibe/view/vtp_reader.h"

namespace imbibe::live {
namespace {

std::optional<PolyData> data_at(const RunFrames& frames, const RunFrames::Collection& collection, Real time) {
  for (const PvdEntry& entry : collection.entries)
    if (entry.time_s == time) return read_vtp(frames.folder / std::filesystem::path(entry.file).filename());
  return std::nullopt;
}

// Copies one value for each of `count` items, that of point point_of(i), where the file has such an array.
template <class To, class PointOf>
void take(const PolyData& data, const char* name, std::size_t count, To&& to, PointOf&& point_of) {
  const std::vector<float>* values = find_floats(data, name);
  for (std::size_t i = 0; values && i < count; ++i)
    if (const std::size_t point = point_of(i); point < values->size()) to(i) = (*values)[point];
}

void recall_yarns(Textile& textile, const PolyData& data, std::vector<Vec3>& places) {
  const YarnNetwork& network = textile.fabric->network;
  if (data.points.size() != network.points.size()) return;
  const auto per = static_cast<std::size_t>(network.points_per_segment);
  const auto middle = [&](std::size_t s) {
    const Index yarn = network.segment_yarn[s];
    return network.yarn_first_point[yarn] + (s - network.yarn_first_segment[yarn]) * per + per / 2;
  };
  take(data, "yarn_kg", network.segments(), [&](std::size_t s) -> Real& { return textile.contents.liquid_kg[s]; }, middle);
  take(data, "sorbed_kg", network.segments(), [&](std::size_t s) -> Real& { return textile.contents.sorbed_kg[s]; }, middle);
  for (std::size_t s = 0; s < network.segments(); ++s) places[s] = Vec3(data.points[middle(s)]);
}

void recall_pores(Textile& textile, const PolyData& data, std::vector<Vec3>& places) {
  const YarnNetwork& network = textile.fabric->network;
  if (data.points.size() != network.pores()) return;
  take(data, "pore_kg", network.pores(), [&](std::size_t i) -> Real& { return textile.contents.liquid_kg[network.segments() + i]; },
       [](std::size_t i) { return i; });
  for (std::size_t i = 0; i < network.pores(); ++i) places[network.segments() + i] = Vec3(data.points[i]);
}

void recall_cells(CellCloth& cloth, const PolyData& data) {
  Sheet& sheet = cloth.soft.sheet;
  if (data.points.size() != sheet.size()) return;
  take(data, "cell_kg", sheet.size(), [&](std::size_t n) -> Real& { return sheet.added_mass[n]; }, [](std::size_t n) { return n; });
  for (std::size_t n = 0; n < sheet.size(); ++n) sheet.position[n] = Vec3(data.points[n]);
  if (const std::vector<float>* saturation = find_floats(data, "saturation")) {
    for (std::size_t n = 0; n < sheet.size(); ++n) {
      const std::size_t cell = sheet.is_grid() ? n : cloth.grid->cell_at(sheet.u[n], sheet.v[n]);
      cloth.contents.content_kg[cell] = (*saturation)[n] * cloth.grid->capacity(cell);
    }
  }
  for (const PointArray& array : data.arrays) {
    const auto* v = std::get_if<std::vector<float>>(&array.values);
    if (array.name != "velocity" || !v || v->size() != 3 * sheet.size()) continue;
    for (std::size_t n = 0; n < sheet.size(); ++n) sheet.velocity[n] = {(*v)[3 * n], (*v)[3 * n + 1], (*v)[3 * n + 2]};
  }
}

}  // namespace

void recall(World& world, const RunFrames& frames, const std::vector<RunFrames::Collection>& pores, Real time,
            std::vector<std::vector<Vec3>>& places) {
  places.resize(world.textiles.size());
  for (std::size_t t = 0; t < world.textiles.size(); ++t) {
    Textile& textile = world.textiles[t];
    if (places[t].empty()) places[t] = nodes_in_world(textile);
    if (const auto data = data_at(frames, frames.collections[1 + t], time)) recall_yarns(textile, *data, places[t]);
    if (const auto data = data_at(frames, pores[t], time)) recall_pores(textile, *data, places[t]);
  }
  for (std::size_t c = 0; c < world.cell_cloths.size(); ++c)
    if (const auto data = data_at(frames, frames.collections[1 + world.textiles.size() + c], time))
      recall_cells(world.cell_cloths[c], *data);
}

}  // namespace imbibe::live
