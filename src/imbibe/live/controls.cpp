#include "imbibe/live/controls.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "imbibe/core/quantity.h"
#include "imbibe/wetting/conditioning.h"

namespace imbibe::live {
namespace {

using Json = nlohmann::json;

Real in_shown_unit(Real si, const ParameterRow& row) {
  return std::isfinite(si) && row.unit != "1" && row.unit != row.shown ? convert_from_si(si, row.unit, row.shown)
         : std::isfinite(si) && row.unit == "1" && row.shown == "%"    ? 100 * si
                                                                       : si;
}

void append_numbers(std::vector<Real>& out, Real x) { out.push_back(x); }
void append_numbers(std::vector<Real>& out, int x) { out.push_back(x); }
void append_numbers(std::vector<Real>& out, std::uint64_t x) { out.push_back(static_cast<Real>(x)); }
void append_numbers(std::vector<Real>&, bool) {}
void append_numbers(std::vector<Real>&, const std::string&) {}
template <class T>
void append_numbers(std::vector<Real>& out, const Vector3<T>& v) {
  out.insert(out.end(), {Real(v.x), Real(v.y), Real(v.z)});
}
template <class T, std::size_t N>
void append_numbers(std::vector<Real>& out, const std::array<T, N>& values) {
  for (const T& value : values) append_numbers(out, value);
}
template <class T>
void append_numbers(std::vector<Real>&, const std::vector<T>&) {}
template <class T>
void append_numbers(std::vector<Real>& out, const std::optional<T>& value) {
  if (value) append_numbers(out, *value);
}

// Visits a scene that has values, where ParameterTable describes the scenes that there may be. What its models do not read is
// left out: controls without an effect would only mislead.
class ControlList {
 public:
  bool reads = true;  // parameter.h
  ControlList(std::string prefix, std::vector<Control>& out) : prefix_(std::move(prefix)), out_(out) {}

  template <class T>
  void value(const char* name, T& field, ParameterInfo info = {}) {
    info.required = false;  // so that the row holds the value
    ParameterTable one(prefix_);
    one.value(name, field, info);
    Control control{one.rows().front(), {}, 0, 0, Effect::next_step};
    append_numbers(control.numbers, field);
    for (Real& number : control.numbers) number = in_shown_unit(number, control.row);
    control.low = in_shown_unit(info.min, control.row), control.high = in_shown_unit(info.max, control.row);
    add(std::move(control));
  }
  template <class Enum>
  void choice(const char* name, Enum& field, const Choices<std::type_identity_t<Enum>>& choices, const char* help = "") {
    ParameterTable one(prefix_);
    one.choice(name, field, choices, help);
    add({one.rows().front(), {}, 0, 0, Effect::next_step});
  }
  template <class P>
  void group(const char* name, P& params, const char* help = "") {
    header(name, help);
    ControlList inner(prefix_ + name + ".", out_);
    inner.reads = reads;
    describe(inner, params);
  }
  template <class P>
  void group(const char* name, std::optional<P>& params, const char* help = "") {
    if (params) group(name, *params, help);
  }
  template <class P>
  void list(const char* name, std::vector<P>& items, const char* help = "") {
    for (std::size_t i = 0; i < items.size(); ++i) group(fmt::format("{}[{}]", name, i).c_str(), items[i], help);
  }

 private:
  void header(const char* name, const char* help) {
    Control control;
    control.row.kind = RowKind::group;
    control.row.path = prefix_ + name;
    control.row.help = help;
    add(std::move(control));
  }
  void add(Control control) {
    if (!reads) return;
    control.effect = effect_of(control.row.path);
    out_.push_back(std::move(control));
  }

  std::string prefix_;
  std::vector<Control>& out_;
};

// Of the first yarn of the family.
Real angle_of(const Textile& textile, Family family) {
  const YarnNetwork& network = textile.fabric->network;
  const auto yarn = std::find(network.yarn_family.begin(), network.yarn_family.end(), family) - network.yarn_family.begin();
  return network.yarn_types[network.yarn_type[static_cast<std::size_t>(yarn)]].fibre.advancing_angle;
}

// What stands in for keys that a scene leaves to the materials, in SI: every optional number of a scene whose meaning is
// "in place of the material's own". `most`: what the material allows, where that is less than the description does.
struct StandIn {
  std::string path;
  Real value = 0, most = unlimited;
};
std::vector<StandIn> stand_ins(const Scene& scene, const World& world) {
  std::vector<StandIn> out{{"liquid.kind.density", world.liquid.kind.density},
                           {"liquid.kind.viscosity", world.liquid.kind.viscosity},
                           {"liquid.kind.surface_tension", world.liquid.kind.surface_tension}};
  for (std::size_t i = 0, network = 0; i < scene.textiles.size() && network < world.textiles.size(); ++i) {
    if (scene.textiles[i].wetting.is_cells()) continue;
    const WettingModel& model = *world.textiles[network++].model;
    if (model.fibres.empty()) continue;
    out.push_back({fmt::format("textiles[{}].contact_angle", i), model.fibres.front().advancing_angle});
    out.push_back({fmt::format("textiles[{}].warp_contact_angle", i), angle_of(world.textiles[network - 1], Family::warp)});
    out.push_back({fmt::format("textiles[{}].weft_contact_angle", i), angle_of(world.textiles[network - 1], Family::weft)});
    out.push_back({fmt::format("textiles[{}].receding_angle", i), model.fibres.front().receding_angle});
    out.push_back({fmt::format("textiles[{}].regain", i), regain_in_balance(model, world.air.humidity), regain_in_balance(model, 1)});
  }
  for (std::size_t i = 0; i < world.solids.size(); ++i)
    out.push_back({fmt::format("solids[{}].receding_angle", i), world.solids[i].material.contact_angle});
  return out;
}

const char* effect_name(Effect effect) {
  return effect == Effect::next_step ? "next step" : effect == Effect::restart ? "restart" : "never";
}

}  // namespace

std::vector<Control> controls_of(const Scene& scene) {
  std::vector<Control> out;
  ControlList visitor("", out);
  Scene copy = scene;
  describe(visitor, copy);
  return out;
}

std::string controls_json(const Scene& scene, const World& world, const Library& library) {
  const auto own = stand_ins(scene, world);
  std::vector<std::string> fibres;
  for (const auto& fibre : library.fibres.records) fibres.push_back(fibre.fibre.name);
  Json rows = Json::array();
  for (const Control& c : controls_of(scene)) {
    if (c.effect == Effect::never) continue;
    Json row{{"path", c.row.path}, {"help", c.row.help}, {"effect", effect_name(c.effect)}};
    if (c.row.kind == RowKind::group) {
      row["kind"] = "group";
      rows.push_back(std::move(row));
      continue;
    }
    row["kind"] = c.row.kind == RowKind::choice ? "choice" : c.row.element;
    row["length"] = c.row.length;
    row["unit"] = c.row.shown == "1" ? "" : c.row.shown;
    row["text"] = c.row.fallback;
    if (std::isfinite(c.low)) row["low"] = c.low;
    if (std::isfinite(c.high)) row["high"] = c.high;
    if (c.row.above_min) row["above_low"] = true;
    if (!c.row.choices.empty()) row["choices"] = c.row.choices;
    if (c.row.path.ends_with(".fibre")) row["choices"] = fibres;
    if (!c.numbers.empty()) row["numbers"] = c.numbers;
    for (const StandIn& material : own) {
      if (material.path != c.row.path) continue;
      if (c.numbers.empty()) row["stands_for"] = in_shown_unit(material.value, c.row);
      if (material.most < unlimited) row["high"] = std::floor(1e3 * in_shown_unit(material.most, c.row)) / 1e3;
    }
    rows.push_back(std::move(row));
  }
  return rows.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace imbibe::live
