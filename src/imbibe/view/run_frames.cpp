#include "imbibe/view/run_frames.h"

#include <algorithm>

#include "imbibe/core/error.h"
#include "imbibe/io/run_folder.h"
#include "imbibe/view/frame_from_world.h"
#include "imbibe/view/vtp_reader.h"

namespace imbibe {

namespace {

// The file of a collection at a time; nothing when this collection was not written then.
const PvdEntry* entry_at(const RunFrames::Collection& collection, Real time) {
  for (const PvdEntry& entry : collection.entries)
    if (entry.time_s == time) return &entry;
  return nullptr;
}

// Files named in a .pvd lie beside it: a name that leads elsewhere is not followed.
std::filesystem::path file_in(const std::filesystem::path& folder, const std::string& name) {
  const std::filesystem::path relative(name);
  if (relative.is_absolute() || relative.has_parent_path())
    throw InputError(folder.string() + ": a .pvd names a file outside the run folder: " + name);
  return folder / relative;
}

}  // namespace

RunFrames open_run_frames(const std::filesystem::path& folder, const World& world, const std::string& title) {
  RunFrames run;
  run.folder = folder;
  run.start = frame_from_world(world, title);
  run.start.particles.clear();
  run.collections.push_back({.textile = "", .entries = read_pvd(folder / "liquid.pvd")});
  const std::vector<std::string> stems = collection_stems(world);  // liquid, then yarns and pores of each textile
  std::size_t first = 0;
  for (std::size_t i = 0; i < world.textiles.size(); ++i) {
    const Textile& textile = world.textiles[i];
    const std::size_t points = textile.fabric->network.points.size();
    run.collections.push_back({.textile = textile.name, .first_point = first, .points = points,
                               .entries = read_pvd(folder / (stems[1 + 2 * i] + ".pvd"))});
    first += points;
  }
  for (std::size_t i = 0; i < world.cell_cloths.size(); ++i) {
    const CellCloth& cloth = world.cell_cloths[i];
    run.collections.push_back({.textile = cloth.name, .points = cloth.soft.sheet.size(),
                               .entries = read_pvd(folder / (stems[1 + 2 * world.textiles.size() + i] + ".pvd")),
                               .cloth = i});
  }
  for (const RunFrames::Collection& collection : run.collections)
    for (const PvdEntry& entry : collection.entries) run.times.push_back(entry.time_s);
  std::sort(run.times.begin(), run.times.end());
  run.times.erase(std::unique(run.times.begin(), run.times.end()), run.times.end());
  if (run.times.empty())
    throw InputError(folder.string() + ": the run folder holds no liquid.pvd and no textile_*.pvd to make pictures of");
  return run;
}

Frame read_frame(const RunFrames& run, std::size_t number) {
  IMBIBE_ASSERT(number < run.times.size());
  Frame frame = run.start;
  frame.time = run.times[number];
  for (const RunFrames::Collection& collection : run.collections) {
    const PvdEntry* entry = entry_at(collection, frame.time);
    if (!entry) continue;
    const std::filesystem::path file = file_in(run.folder, entry->file);
    PolyData data = read_vtp(file);
    if (collection.textile.empty()) {
      frame.particles = std::move(data.points);
      continue;
    }
    const std::vector<float>* saturation = find_floats(data, "saturation");
    if (!saturation || data.points.size() != collection.points)
      throw InputError(file.string() + ": the file does not belong to this scene's textile " + collection.textile);
    if (collection.cloth != RunFrames::no_cloth) {
      DrawnCloth& cloth = frame.cloths[collection.cloth];
      cloth.mesh.vertices = std::move(data.points);
      set_normals(cloth.mesh);
      cloth.saturation = *saturation;
      continue;
    }
    std::copy(data.points.begin(), data.points.end(), frame.yarns.points.begin() + static_cast<std::ptrdiff_t>(collection.first_point));
    std::copy(saturation->begin(), saturation->end(),
              frame.yarns.saturation.begin() + static_cast<std::ptrdiff_t>(collection.first_point));
  }
  return frame;
}

}  // namespace imbibe
