#include "imbibe/scene/fabric_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "imbibe/fabric/wif.h"
#include "imbibe/scene/describe_reader.h"
#include "imbibe/scene/scene.h"

namespace imbibe {
namespace {

struct FabricFile {
  std::string name;
  FabricSpec fabric;
};

template <class V>
void describe(V& v, FabricFile& p) {
  v.value("name", p.name, {.help = "name of the fabric"});
  describe(v, p.fabric);
}

}  // namespace

std::vector<NamedFabric> read_fabrics(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  std::vector<Problem> problems;
  DataNode root;
  if (is_wif_name(file.string())) {
    if (!std::filesystem::exists(file)) throw InputError(fmt::format("there is no file '{}'", file.string()));
    root.kind = DataNode::Kind::map;
    DataNode weave;
    weave.kind = DataNode::Kind::scalar;
    weave.text = std::filesystem::absolute(file).string();
    root.keys.emplace_back("weave");
    root.key_places.emplace_back();
    root.items.push_back(weave);
  } else {
    root = read_document(file, problems);
  }
  if (root.kind == DataNode::Kind::map && root.find("textiles") != nullptr) {
    const Scene scene = read_scene(file, overrides);
    std::vector<NamedFabric> fabrics;
    for (std::size_t i = 0; i < scene.textiles.size(); ++i)
      fabrics.push_back({scene.textiles[i].name, scene.textiles[i].fabric, fmt::format("textiles[{}]", i), scene.places});
    return fabrics;
  }
  if (root.kind == DataNode::Kind::map)
    for (const std::string& assignment : overrides) apply_override(root, assignment, problems);
  FabricFile data;
  ReadLog log;
  log.problems = std::move(problems);
  if (log.problems.empty()) read_described(root, "", data, log);
  if (!log.problems.empty()) throw InputError(std::move(log.problems));
  const Place place = place_of(log.places, "weave");
  if (place.file && place.line > 0) data.fabric.folder = std::filesystem::path(*place.file).parent_path();
  return {{data.name.empty() ? file.stem().string() : data.name, data.fabric, "", std::move(log.places)}};
}

Fabric build_named_fabric(const NamedFabric& named, const FibreLibrary& fibres) {
  try {
    return build_fabric(named.spec, fibres, named.key);
  } catch (const InputError& error) {
    std::vector<Problem> problems;
    for (const Problem& problem : error.problems()) {
      problems.push_back(problem.file.empty() ? problem_at(place_of(named.places, problem.key), problem.key, problem.message)
                                              : problem);
      if (!problems.back().file.empty() || !is_wif_name(named.spec.weave)) continue;
      problems.back().file = named.spec.weave;  // the draft has no such key: it is given beside it
      problems.back().message += fmt::format("; give it with --set {}=...", problem.key);
    }
    throw InputError(std::move(problems));
  }
}

}  // namespace imbibe
