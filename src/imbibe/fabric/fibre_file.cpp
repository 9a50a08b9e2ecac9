#include "imbibe/fabric/fibre_file.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <set>

#include "imbibe/core/error.h"
#include "imbibe/core/output_file.h"
#include "imbibe/core/quantity.h"

namespace imbibe {
namespace {

// UDUNITS knows whole powers only; the absorption coefficient is read by its exact name.
constexpr std::string_view root_second_unit = "kg/(m2 s^0.5)";

constexpr std::size_t most_bytes = std::size_t{1} << 20;  // shipped files have 3 kB

struct Key {
  const char* name;
  const char* unit;  // SI
  double min, max;
  bool required;
  std::function<Real&(FibreRecord&)> field;
};

const std::vector<Key>& keys() {
  static const std::vector<Key> all{
      {"density", "kg/m3", 100, 20000, true, [](FibreRecord& r) -> Real& { return r.fibre.density; }},
      {"regain_65", "1", 0, 1, true, [](FibreRecord& r) -> Real& { return r.fibre.regain_65; }},
      {"regain_saturated", "1", 0, 5, true, [](FibreRecord& r) -> Real& { return r.fibre.regain_saturated; }},
      {"liquid_retention", "1", 0, 50, false, [](FibreRecord& r) -> Real& { return r.fibre.liquid_retention; }},
      {"volume_swelling", "1", 0, 10, true, [](FibreRecord& r) -> Real& { return r.fibre.volume_swelling; }},
      {"area_swelling", "1", 0, 10, true, [](FibreRecord& r) -> Real& { return r.fibre.area_swelling; }},
      {"radius", "m", 1e-7, 2e-3, true, [](FibreRecord& r) -> Real& { return r.fibre.radius; }},
      {"advancing_angle", "rad", 0, pi, true, [](FibreRecord& r) -> Real& { return r.fibre.advancing_angle; }},
      {"receding_angle", "rad", 0, pi, true, [](FibreRecord& r) -> Real& { return r.fibre.receding_angle; }},
      {"diffusivity", "m2/s", 0, 1e-6, true, [](FibreRecord& r) -> Real& { return r.fibre.diffusivity; }},
      {"desorption_offset_65", "1", 0, 1, false, [](FibreRecord& r) -> Real& { return r.fibre.desorption_offset_65; }},
      {"wet_softening", "1", 0, 0.95, false, [](FibreRecord& r) -> Real& { return r.fibre.wet_softening; }},
      {"absorption_coefficient", root_second_unit.data(), 0, 100, false,
       [](FibreRecord& r) -> Real& { return r.fibre.absorption_coefficient; }},
      {"packing", "1", 0.05, 1, false, [](FibreRecord& r) -> Real& { return r.staple_packing; }},
  };
  return all;
}

class FibreReader {
 public:
  explicit FibreReader(const std::filesystem::path& file) : file_(file.string()) {}

  FibreRecord read() {
    YAML::Node root;
    try {
      if (!std::ifstream(file_)) throw InputError(std::vector{Problem{file_, 0, 0, "", "cannot be opened"}});
      root = YAML::Load(read_whole_file(file_, most_bytes));
    } catch (const YAML::Exception& e) {
      throw InputError(std::vector{Problem{file_, e.mark.line + 1, e.mark.column + 1, "", "is not YAML: " + e.msg}});
    }
    if (!root.IsMap()) {
      problem(root, "", "is not a map with name, values and isotherm");
      throw InputError(std::move(problems_));
    }
    check_keys(root, "", {"name", "title", "values", "isotherm"});
    record_.file = file_;
    record_.fibre.name = text(root, "", "name", true);
    record_.title = text(root, "", "title", false);
    read_values(root["values"]);
    read_isotherm(root["isotherm"]);
    check_together(root);
    if (!problems_.empty()) throw InputError(std::move(problems_));
    return std::move(record_);
  }

 private:
  void problem(const YAML::Node& at, const std::string& key, std::string message) {
    const YAML::Mark mark = at ? at.Mark() : YAML::Mark::null_mark();
    problems_.push_back(Problem{file_, mark.line + 1, mark.column + 1, key, std::move(message)});
  }

  void check_keys(const YAML::Node& map, const std::string& path, const std::vector<std::string>& known) {
    std::set<std::string> seen;
    for (const auto& item : map) {
      const std::string key = item.first.IsScalar() ? item.first.Scalar() : "?";
      const std::string full = path.empty() ? key : path + "." + key;
      if (!seen.insert(key).second) problem(item.first, full, "is given twice");
      if (std::find(known.begin(), known.end(), key) != known.end()) continue;
      const std::string near = nearest_word(key, known);
      problem(item.first, full, near.empty() ? std::string("is not a known key") : "is not a known key; did you mean '" + near + "'?");
    }
  }

  std::string text(const YAML::Node& map, const std::string& path, const char* key, bool required) {
    const YAML::Node node = map[key];
    const std::string full = path.empty() ? key : path + "." + key;
    if (!node || node.IsNull()) {
      if (required) problem(map, full, "is missing");
      return {};
    }
    if (!node.IsScalar() || node.Scalar().empty()) {
      problem(node, full, "is not a word or sentence");
      return {};
    }
    return node.Scalar();
  }

  // Source and confidence, which every number must have.
  FibreValue provenance(const YAML::Node& node, const std::string& path) {
    FibreValue value{path, "", text(node, path, "source", true), text(node, path, "confidence", true)};
    if (!value.confidence.empty() && value.confidence != "high" && value.confidence != "medium" && value.confidence != "low")
      problem(node["confidence"], path + ".confidence", fmt::format("'{}' is not high, medium or low", value.confidence));
    return value;
  }

  void read_values(const YAML::Node& values) {
    if (!values || !values.IsMap()) {
      problem(values, "values", "is missing or is not a map");
      return;
    }
    std::vector<std::string> known;
    for (const Key& key : keys()) known.emplace_back(key.name);
    check_keys(values, "values", known);
    for (const Key& key : keys()) {
      const YAML::Node node = values[key.name];
      const std::string path = std::string("values.") + key.name;
      if (!node) {
        if (key.required) problem(values, path, "is missing");
        continue;
      }
      if (!node.IsMap()) {
        problem(node, path, "is not a map {value, source, confidence}");
        continue;
      }
      check_keys(node, path, {"value", "source", "confidence"});
      FibreValue value = provenance(node, path);
      value.key = key.name;
      value.shown = text(node, path, "value", true);
      if (!value.shown.empty()) read_number(node["value"], path, key);
      record_.values.push_back(std::move(value));
    }
  }

  void read_number(const YAML::Node& node, const std::string& path, const Key& key) {
    try {
      std::string_view written = node.Scalar();
      if (written.ends_with(root_second_unit) && key.unit == root_second_unit)
        written.remove_suffix(root_second_unit.size());
      const Real value = parse_quantity(written, key.unit);
      if (value < key.min || value > key.max)
        problem(node, path, fmt::format("{} is outside [{:g}, {:g}] {}", node.Scalar(), key.min, key.max, key.unit));
      key.field(record_) = value;
    } catch (const QuantityError& e) {
      problem(node, path, e.what());
    }
  }

  void read_isotherm(const YAML::Node& node) {
    if (!node) return;  // then the shape common to hygroscopic fibres is used, from regain_65
    if (!node.IsMap()) {
      problem(node, "isotherm", "is not a map");
      return;
    }
    check_keys(node, "isotherm", {"m0", "c", "k", "linear_slope", "source", "confidence"});
    FibreValue value = provenance(node, "isotherm");
    GabIsotherm& gab = record_.fibre.isotherm;
    const auto number = [&](const char* name, Real& field, Real min, Real max, bool required) {
      const std::string path = std::string("isotherm.") + name;
      if (!node[name]) {
        if (required) problem(node, path, "is missing");
        return;
      }
      try {
        const Real read = parse_quantity(node[name].IsScalar() ? node[name].Scalar() : "", "1");
        if (!(read > min) || read > max) problem(node[name], path, fmt::format("{} is outside ({:g}, {:g}]", read, min, max));
        field = read;
      } catch (const QuantityError& e) {
        problem(node[name], path, e.what());
      }
    };
    const bool linear = static_cast<bool>(node["linear_slope"]);
    if (linear && (node["m0"] || node["c"] || node["k"]))
      problem(node, "isotherm", "has both a linear_slope and m0, c, k: one of them");
    if (linear) {
      number("linear_slope", gab.linear_slope, -1e-300, 5, true);
      value.shown = fmt::format("W = {:g} phi", gab.linear_slope);
    } else {
      number("m0", gab.m0, 0, 1, true);
      number("c", gab.c, 0, 1e4, true);
      number("k", gab.k, 0, 0.999, true);  // k = 1 would hold endless water at saturation
      value.shown = fmt::format("m0 {:g}, c {:g}, k {:g}", gab.m0, gab.c, gab.k);
    }
    record_.values.push_back(std::move(value));
  }

  void check_together(const YAML::Node& root) {
    const Fibre& f = record_.fibre;
    if (!problems_.empty()) return;
    if (f.receding_angle > f.advancing_angle) problem(root["values"], "values.receding_angle", "is above the advancing angle");
    if (f.regain_saturated < f.regain_65) problem(root["values"], "values.regain_saturated", "is below regain_65");
  }

  std::string file_;
  FibreRecord record_;
  std::vector<Problem> problems_;
};

}  // namespace

FibreRecord read_fibre_file(const std::filesystem::path& file) { return FibreReader(file).read(); }

FibreLibrary read_fibre_library(const std::vector<std::filesystem::path>& folders) {
  FibreLibrary library;
  std::vector<Problem> problems;
  for (const auto& folder : folders) {
    std::error_code code;
    std::vector<std::filesystem::path> files;
    for (const auto& item : std::filesystem::directory_iterator(folder, code))
      if (item.path().extension() == ".yaml") files.push_back(item.path());
    if (code) problems.push_back(Problem{folder.string(), 0, 0, "", "cannot be read as a folder of fibres: " + code.message()});
    std::sort(files.begin(), files.end());
    std::set<std::string> here;
    for (const auto& file : files) {
      try {
        FibreRecord record = read_fibre_file(file);
        if (!here.insert(record.fibre.name).second) {
          problems.push_back(Problem{file.string(), 0, 0, "name",
                                     fmt::format("another file of this folder has the fibre '{}' too", record.fibre.name)});
          continue;
        }
        std::erase_if(library.records, [&](const FibreRecord& r) { return r.fibre.name == record.fibre.name; });
        library.records.push_back(std::move(record));
      } catch (const InputError& e) {
        problems.insert(problems.end(), e.problems().begin(), e.problems().end());
      }
    }
  }
  if (!problems.empty()) throw InputError(std::move(problems));
  std::sort(library.records.begin(), library.records.end(),
            [](const FibreRecord& a, const FibreRecord& b) { return a.fibre.name < b.fibre.name; });
  return library;
}

const FibreRecord* find_fibre(const FibreLibrary& library, const std::string& name) {
  for (const FibreRecord& record : library.records)
    if (record.fibre.name == name) return &record;
  return nullptr;
}

std::string unknown_fibre_message(const FibreLibrary& library, const std::string& name) {
  std::vector<std::string> names;
  for (const FibreRecord& record : library.records) names.push_back(record.fibre.name);
  const std::string near = nearest_word(name, names);
  return fmt::format("there is no fibre '{}'{}; known: {}", name, near.empty() ? "" : "; did you mean '" + near + "'?",
                     names.empty() ? "none (the fibre library is empty)" : fmt::format("{}", fmt::join(names, ", ")));
}

const FibreRecord& require_fibre(const FibreLibrary& library, const std::string& name) {
  const FibreRecord* record = find_fibre(library, name);
  if (record == nullptr) throw InputError(unknown_fibre_message(library, name));
  return *record;
}

}  // namespace imbibe
