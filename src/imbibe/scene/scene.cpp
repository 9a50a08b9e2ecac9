#include "imbibe/scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "imbibe/fabric/wif.h"
#include "imbibe/scene/cloth_builder.h"
#include "imbibe/scene/describe_reader.h"
#include "imbibe/scene/describe_writer.h"
#include "imbibe/scene/scene_files.h"

namespace imbibe {
namespace {

std::filesystem::path folder_of(const Scene& scene, const std::string& key) {
  const Place place = place_of(scene.places, key);
  const bool from_file = place.file && place.line > 0;
  return from_file ? std::filesystem::path(*place.file).parent_path() : std::filesystem::path();
}

std::string resolved(const std::string& name, const std::filesystem::path& folder) {
  const std::filesystem::path path(name);
  if (name.empty() || path.is_absolute()) return name;
  return std::filesystem::absolute(folder / path).lexically_normal().string();
}

// File names become absolute: scenes are read and run from anywhere.
void resolve_file_names(Scene& scene) {
  for (std::size_t i = 0; i < scene.textiles.size(); ++i)
    scene.textiles[i].fabric.folder = folder_of(scene, fmt::format("textiles[{}].weave", i));
  visit_file_names(scene, [&](std::string& name, const std::string& key) { name = resolved(name, folder_of(scene, key)); });
}

// Names become parts of file names, which end at 255 bytes.
constexpr std::size_t longest_name = 150;

template <class Item>
void check_names(const std::vector<Item>& items, const std::string& list, const Scene& scene,
                 std::vector<Problem>& problems) {
  std::set<std::string> seen;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::string key = fmt::format("{}[{}].name", list, i);
    if (items[i].name.empty()) problems.push_back(scene_problem(scene, key, "is empty"));
    else if (items[i].name.size() > longest_name)
      problems.push_back(scene_problem(scene, key, fmt::format("is longer than {} bytes", longest_name)));
    else if (!seen.insert(items[i].name).second)
      problems.push_back(scene_problem(scene, key, fmt::format("'{}' is already the name of another one", items[i].name)));
  }
}

void check_textile(const Scene& scene, std::size_t i, std::vector<Problem>& problems) {
  const TextileSpec& t = scene.textiles[i];
  const std::string key = fmt::format("textiles[{}]", i);
  const Real u = norm(t.weft_direction), v = norm(t.warp_direction);
  if (u == 0) problems.push_back(scene_problem(scene, key + ".weft_direction", "has no length"));
  if (v == 0) problems.push_back(scene_problem(scene, key + ".warp_direction", "has no length"));
  if (u > 0 && v > 0 && std::abs(dot(t.weft_direction, t.warp_direction)) > 1e-6 * u * v)
    problems.push_back(scene_problem(scene, key + ".warp_direction", "is not square to weft_direction"));
  check_cloth_keys(scene, i, problems);
  if (t.contact_angle && t.receding_angle && *t.receding_angle > *t.contact_angle)
    problems.push_back(scene_problem(scene, key + ".receding_angle", "is above contact_angle (the advancing angle)"));
}

void check_keys_against_each_other(const Scene& scene, std::vector<Problem>& problems) {
  const LiquidSpec& liquid = scene.liquid;
  const bool any = !liquid.drops.empty() || !liquid.boxes.empty() || !liquid.droppers.empty() || !liquid.pipes.empty();
  if (any && !liquid.particle_mass)
    problems.push_back(scene_problem(scene, "liquid.particle_mass", "is missing: it sets the resolution of the liquid"));
  if (!any && scene.textiles.empty())
    problems.push_back(scene_problem(scene, "", "has neither liquid nor textiles: nothing would happen"));
  check_pipe_keys(scene, problems);
  check_names(scene.textiles, "textiles", scene, problems);
  for (std::size_t i = 0; i < scene.textiles.size(); ++i) check_textile(scene, i, problems);
  for (std::size_t i = 0; i < scene.solids.size(); ++i) {
    const std::string key = fmt::format("solids[{}]", i);
    for (const Problem& problem : find_problems(scene.solids[i].shape))
      problems.push_back(scene_problem(scene, key + ".shape" + (problem.key.empty() ? "" : ".") + problem.key, problem.message));
    if (scene.solids[i].receding_angle && *scene.solids[i].receding_angle > scene.solids[i].contact_angle)
      problems.push_back(scene_problem(scene, key + ".receding_angle", "is above contact_angle (the advancing angle)"));
  }
  if (scene.domain.lower && scene.domain.upper) {
    const Vec3 size = *scene.domain.upper - *scene.domain.lower;
    if (size.x <= 0 || size.y <= 0 || size.z <= 0)
      problems.push_back(scene_problem(scene, "domain.upper", "is not above domain.lower in x, y and z"));
  }
  if (scene.picture.camera.eye.has_value() != scene.picture.camera.target.has_value())
    problems.push_back(scene_problem(scene, "picture.camera", "eye and target must be given together"));
  if (scene.output.every && *scene.output.every > scene.duration)
    problems.push_back(scene_problem(scene, "output.every", "is longer than duration"));
  if (scene.output.every && scene.duration / *scene.output.every > 1e6)
    problems.push_back(scene_problem(scene, "output.every", "would make more than a million outputs"));
}

Scene scene_from(DataNode root, std::vector<Problem> problems, const std::vector<std::string>& overrides) {
  if (root.kind == DataNode::Kind::null && !problems.empty()) throw InputError(std::move(problems));
  for (const std::string& assignment : overrides) apply_override(root, assignment, problems);
  Scene scene;
  ReadLog log;
  log.problems = std::move(problems);
  if (root.kind == DataNode::Kind::map) {
    read_described(root, "", scene, log);
  } else {
    log.problems.push_back(problem_at(root.place, "", "is not a scene: wants a map of keys such as 'version: 1'"));
  }
  scene.places = std::move(log.places);
  apply_presets(scene, log.problems);
  if (log.problems.empty()) check_keys_against_each_other(scene, log.problems);
  if (!log.problems.empty()) throw InputError(std::move(log.problems));
  resolve_file_names(scene);
  return scene;
}

}  // namespace

std::set<std::string> files_named_by(const Scene& scene) {
  std::set<std::string> files;
  visit_file_names(scene, [&](const std::string& name, const std::string&) { files.insert(name); });
  return files;
}

Real output_interval(const Scene& scene) { return scene.output.every.value_or(scene.duration / 50); }

Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  std::vector<Problem> problems;
  DataNode root = read_document(file, problems);
  return scene_from(std::move(root), std::move(problems), overrides);
}

Scene read_scene_text(const std::string& text, const std::string& file_name,
                      const std::vector<std::string>& overrides) {
  std::vector<Problem> problems;
  DataNode root = parse_document(text, file_name, problems);
  return scene_from(std::move(root), std::move(problems), overrides);
}

std::string write_scene(const Scene& scene) { return write_described(scene); }

Problem scene_problem(const Scene& scene, const std::string& key, const std::string& message) {
  return problem_at(place_of(scene.places, key), key, message);
}

}  // namespace imbibe
