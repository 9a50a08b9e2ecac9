// The scenes a page may choose from, and what a page may hand in: names are looked up in a list made at the start, texts
// are read as scenes or drafts that name no file. Nothing of a client reaches the file system, but for a draft's text
// that is written under a name of our own making.
// Tested in tests/live/gallery_test.cpp and with the page, in viewer/test/live.test.mjs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "imbibe/scene/scene.h"

namespace imbibe::live {

struct GalleryEntry {
  std::string id;      // "quickstart/drop_on_cotton"
  std::string title;
  std::filesystem::path file;
};

struct Gallery {
  std::vector<GalleryEntry> entries;  // sorted by id, the quickstart's first
  std::filesystem::path drafts;       // where handed-in drafts are kept, by the hash of their text
};

// scenes/*/*.yaml of the data folders; scenes that cannot be read are left out.
Gallery find_gallery(const std::vector<std::string>& data_folders, const std::filesystem::path& drafts);
std::string gallery_json(const Gallery& gallery);

Scene open_gallery_scene(const Gallery& gallery, const std::string& id);

// A scene's text, checked as a file of that name is, with places in the errors; or a WIF draft, which becomes the weave
// of `base`'s first textile. Throws InputError.
Scene read_handed_in(const Gallery& gallery, const std::string& name, const std::string& text, const Scene& base);

// Throws InputError when `scene` names files that `before` does not: only those a scene began with may be read.
void refuse_new_files(const Scene& scene, const Scene& before);

// Output times must not depend on a duration that is changed while it runs.
void pin_output_interval(Scene& scene);

}  // namespace imbibe::live
