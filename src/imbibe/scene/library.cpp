#include "imbibe/scene/library.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "imbibe/core/parameter.h"
#include "imbibe/scene/describe_reader.h"

namespace imbibe {
namespace {

namespace fs = std::filesystem;

struct SourcedValue {
  explicit SourcedValue(const ParameterInfo& of) : info(of) {}
  ParameterInfo info;
  Real value = 0;
  std::string source, confidence;
};

template <class V>
void describe(V& v, SourcedValue& p) {
  ParameterInfo info = p.info;
  info.required = true;
  v.value("value", p.value, info);
  v.value("source", p.source, {.required = true, .help = "where the value comes from"});
  v.value("confidence", p.confidence, {.required = true, .help = "high, medium or low"});
}

struct LiquidValues {
  SourcedValue density{{.unit = "kg/m3", .min = 100, .max = 20000}};
  SourcedValue viscosity{{.unit = "Pa s", .shown = "mPa s", .min = 0, .max = 1000}};
  SourcedValue surface_tension{{.unit = "N/m", .shown = "mN/m", .min = 0, .max = 1}};
};

template <class V>
void describe(V& v, LiquidValues& p) {
  v.group("density", p.density, "density");
  v.group("viscosity", p.viscosity, "dynamic viscosity");
  v.group("surface_tension", p.surface_tension, "surface tension against air");
}

struct LiquidFile {
  std::string name, title;
  Real temperature = 0;
  LiquidValues values;
};

template <class V>
void describe(V& v, LiquidFile& p) {
  v.value("name", p.name, {.required = true});
  v.value("title", p.title, {.required = true});
  v.value("temperature", p.temperature,
          {.unit = "K", .shown = "degC", .min = 250, .max = 400, .required = true});
  v.group("values", p.values, "properties");
}

}  // namespace

LiquidRecord read_liquid_file(const fs::path& file) {
  ReadLog log;
  const DataNode root = read_document(file, log.problems);
  LiquidFile data;
  if (log.problems.empty()) read_described(root, "", data, log);
  for (const char* key : {"density", "viscosity", "surface_tension"}) {
    const std::string path = std::string("values.") + key;
    if (log.problems.empty() && !log.places.contains(path))
      log.problems.push_back(problem_at(root.place, path, "is missing: this key must be given"));
  }
  if (!log.problems.empty()) throw InputError(std::move(log.problems));
  LiquidRecord record;
  record.title = data.title;
  record.temperature = data.temperature;
  record.file = file;
  record.kind = {data.name, data.values.density.value, data.values.viscosity.value, data.values.surface_tension.value};
  const DataNode* values = root.find("values");
  const auto add = [&](const char* key, const SourcedValue& value) {
    record.values.push_back({key, values->find(key)->find("value")->text, value.source, value.confidence});
  };
  add("density", data.values.density);
  add("viscosity", data.values.viscosity);
  add("surface_tension", data.values.surface_tension);
  return record;
}

std::vector<fs::path> library_folders(const fs::path& scene_file, const std::vector<std::string>& program_folders) {
  std::vector<fs::path> folders;
  const auto add = [&](const fs::path& folder) {
    std::error_code ignored;
    if (!fs::is_directory(folder / "fibres", ignored) && !fs::is_directory(folder / "liquids", ignored)) return;
    const fs::path whole = fs::weakly_canonical(folder, ignored);
    std::erase(folders, whole);
    folders.push_back(whole);
  };
  for (auto folder = program_folders.rbegin(); folder != program_folders.rend(); ++folder) add(*folder);
  if (const char* given = std::getenv("IMBIBE_DATA_DIR")) add(given);
  if (!scene_file.empty()) {
    std::error_code ignored;
    std::vector<fs::path> above;
    for (fs::path at = fs::absolute(scene_file, ignored).lexically_normal().parent_path(); above.size() < 6;
         at = at.parent_path()) {
      above.push_back(at);
      if (at == at.parent_path()) break;
    }
    for (auto at = above.rbegin(); at != above.rend(); ++at) add(*at);
  }
  return folders;
}

Library read_library(const std::vector<fs::path>& folders) {
  Library library;
  library.folders = folders;
  std::vector<fs::path> fibre_folders;
  std::vector<Problem> problems;
  std::error_code ignored;
  for (const fs::path& folder : folders) {
    if (fs::is_directory(folder / "fibres", ignored)) fibre_folders.push_back(folder / "fibres");
    if (!fs::is_directory(folder / "liquids", ignored)) continue;
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder / "liquids"))
      if (entry.path().extension() == ".yaml") files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) {
      try {
        LiquidRecord record = read_liquid_file(file);
        std::erase_if(library.liquids, [&](const LiquidRecord& r) { return r.kind.name == record.kind.name; });
        library.liquids.push_back(std::move(record));
      } catch (const InputError& e) {
        problems.insert(problems.end(), e.problems().begin(), e.problems().end());
      }
    }
  }
  try {
    library.fibres = read_fibre_library(fibre_folders);
  } catch (const InputError& e) {
    problems.insert(problems.end(), e.problems().begin(), e.problems().end());
  }
  if (!problems.empty()) throw InputError(std::move(problems));
  if (library.fibres.records.empty() && library.liquids.empty())
    throw InputError(
        "no data folder found: wanted a folder with fibres/ and liquids/, beside the scene or above it, or named by "
        "the environment variable IMBIBE_DATA_DIR");
  std::sort(library.liquids.begin(), library.liquids.end(),
            [](const LiquidRecord& a, const LiquidRecord& b) { return a.kind.name < b.kind.name; });
  return library;
}

const LiquidRecord* find_liquid(const Library& library, const std::string& name) {
  for (const LiquidRecord& record : library.liquids)
    if (record.kind.name == name) return &record;
  return nullptr;
}

}  // namespace imbibe
