#include "imbibe/scene/scene_files.h"

#include "imbibe/core/output_file.h"

namespace imbibe {

std::map<std::string, std::string> take_files_along(Scene& scene, const std::string& folder) {
  std::map<std::string, std::string> contents, new_names;
  visit_file_names(scene, [&](std::string& name, const std::string&) {
    const auto known = new_names.find(name);
    if (known != new_names.end()) {
      name = known->second;
      return;
    }
    const std::filesystem::path path(name);
    std::string taken = folder + "/" + path.filename().string();
    for (int i = 2; contents.contains(taken); ++i)
      taken = fmt::format("{}/{}-{}{}", folder, path.stem().string(), i, path.extension().string());
    contents[taken] = read_whole_file(path);
    new_names[name] = taken;
    name = taken;
  });
  return contents;
}

}  // namespace imbibe
