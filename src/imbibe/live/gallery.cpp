#include "imbibe/live/gallery.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "imbibe/core/error.h"
#include "imbibe/core/output_file.h"
#include "imbibe/fabric/wif.h"
#include "imbibe/live/websocket.h"

namespace imbibe::live {

namespace fs = std::filesystem;

Gallery find_gallery(const std::vector<std::string>& data_folders, const fs::path& drafts) {
  Gallery gallery;
  gallery.drafts = drafts;
  std::set<std::string> seen;
  for (const std::string& folder : data_folders) {
    std::error_code none;
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(folder) / "scenes", none)) {
      if (entry.path().extension() != ".yaml") continue;
      const fs::path id = entry.path().parent_path().filename() / entry.path().stem();
      if (!seen.insert(id.string()).second) continue;
      try {
        gallery.entries.push_back({id.string(), read_scene(entry.path()).title, entry.path()});
      } catch (const InputError&) {  // its own run says what is wrong with it
      }
    }
  }
  const auto rank = [](const GalleryEntry& e) { return std::pair(!e.id.starts_with("quickstart"), e.id); };
  std::sort(gallery.entries.begin(), gallery.entries.end(),
            [&](const GalleryEntry& a, const GalleryEntry& b) { return rank(a) < rank(b); });
  return gallery;
}

std::string gallery_json(const Gallery& gallery) {
  nlohmann::json list = nlohmann::json::array();
  for (const GalleryEntry& entry : gallery.entries) list.push_back({{"id", entry.id}, {"title", entry.title}});
  return list.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void pin_output_interval(Scene& scene) { scene.output.every = output_interval(scene); }

Scene open_gallery_scene(const Gallery& gallery, const std::string& id) {
  for (const GalleryEntry& entry : gallery.entries)
    if (entry.id == id) return read_scene(entry.file);
  throw InputError(fmt::format("the gallery has no scene '{}'", id));
}

void refuse_new_files(const Scene& scene, const Scene& before) {
  const std::set<std::string> known = files_named_by(before);
  for (const std::string& file : files_named_by(scene))
    if (!known.contains(file))
      throw InputError("a scene of the page may not name files (" + file + "); start it with `imbibe live FILE`");
}

Scene read_handed_in(const Gallery& gallery, const std::string& name, const std::string& text, const Scene& base) {
  if (!is_wif_name(name)) {
    Scene scene = read_scene_text(text, name.empty() ? "scene" : name);
    refuse_new_files(scene, {});
    return scene;
  }
  if (base.textiles.empty()) throw InputError("the scene has no textile for this draft: open another first");
  parse_wif(text, name);  // its problems, with lines, before anything is kept
  const auto digest = sha1(text);
  std::string stem;
  for (std::size_t i = 0; i < 8; ++i) stem += fmt::format("{:02x}", digest[i]);
  std::error_code error;
  fs::create_directories(gallery.drafts, error);
  const fs::path file = fs::absolute(gallery.drafts / (stem + ".wif"));
  write_whole_file(file, text);
  Scene scene = base;
  scene.title = name;
  scene.textiles.front().fabric.weave = file.string();
  scene.textiles.front().fabric.weave_rows.clear();
  return scene;
}

}  // namespace imbibe::live
