#include "imbibe/sim/state_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <type_traits>

#include "imbibe/sim/state_fields.h"
#include "imbibe/wetting/wetting_model.h"
#include "imbibe/wetting/wetting_step.h"

namespace imbibe {
namespace {

using Problems = std::vector<std::string>;

constexpr Real greatest_number = 1e15;
constexpr Real farthest_place = 100;     // m
constexpr Real fastest = 1e4;            // m/s
constexpr Real greatest_mass = 1000;     // kg, owed by a particle or waiting at a node
constexpr Real greatest_gravity = 1732;  // m/s2, 1000 along each axis
constexpr Real times_capacity = 10;
constexpr Real latest = 1e9;             // s: later, steps of 0.1 us would not move the clock on

bool within(Real x, Real most) { return std::abs(x) <= most; }  // false for NaN
bool within(const Vec3& v, Real most) { return norm(v) <= most; }
bool within(const Float4& v, Real most) { return within(Vec3(v.x, v.y, v.z), most); }

template <class T>
bool all_within(const std::vector<T>& values, Real most) {
  return std::all_of(values.begin(), values.end(), [&](const T& v) { return within(v, most); });
}

// Finds numbers that no run comes to, in any field.
class NumberVisitor {
 public:
  void group(const std::string& name) { group_ = name; }
  template <class T>
  void value(const char* name, const T& x) {
    look(name, std::span(&x, 1));
  }
  template <class T>
  void array(const char* name, const std::vector<T>& x) {
    if constexpr (!std::is_same_v<T, bool>) look(name, std::span(x));
  }
  Problems problems;

 private:
  template <class T>
  void look(const char* name, std::span<const T> values) {
    if constexpr (!std::is_integral_v<T> && !std::is_enum_v<T>) {
      for (const T& x : values) {
        if (within(x, greatest_number)) continue;
        problems.push_back(fmt::format("field {}/{} holds a number that no run comes to", group_, name));
        return;
      }
    }
  }
  std::string group_;
};

class StateCheck {
 public:
  StateCheck(const World& read, const World& built) : read_(read), built_(built) {}

  Problems find() {
    NumberVisitor numbers;
    visit_state(numbers, read_);
    problems_ = std::move(numbers.problems);
    surroundings();
    particles();
    sources();
    for (std::size_t i = 0; i < read_.textiles.size(); ++i) textile(read_.textiles[i], built_.textiles[i]);
    for (std::size_t i = 0; i < read_.cell_cloths.size(); ++i) cells(read_.cell_cloths[i], built_.cell_cloths[i]);
    return std::move(problems_);
  }

 private:
  void require(bool holds, const std::string& problem) {
    if (!holds) problems_.push_back(problem);
  }
  template <class A, class B>
  void same(const std::string& what, A stored, B wanted) {
    require(stored == wanted, fmt::format("is of another scene: {} is {}, the scene has {}", what, stored, wanted));
  }

  void surroundings() {
    const Air& air = read_.air;
    require(read_.time >= 0 && read_.time <= latest, "its time is none that a run comes to");
    require(within(read_.gravity, greatest_gravity), "gravity is stronger than a scene may set it");
    require(air.temperature >= 263.15 && air.temperature <= 373.15, "air is not between -10 and 100 degC");
    require(air.humidity >= 0 && air.humidity <= 1, "humidity is not between 0 and 100 %");
    require(air.mass_transfer >= 0 && air.mass_transfer <= 1, "mass transfer to the air is not between 0 and 1 m/s");
    // The network would be stepped over all of it.
    const Real since = read_.pace.since_wetting;
    require(read_.textiles.empty() || (since >= 0 && since <= longest_wetting_step),
            fmt::format("textiles were last stepped {} s ago; no run lets more than {} s pass", since, longest_wetting_step));
  }

  void particles() {
    same("particle mass in kg", read_.liquid.particle_mass, built_.liquid.particle_mass);
    const Particles& p = read_.liquid.particles;
    for (const std::size_t size : {p.velocity.size(), p.id.size(), p.kind.size(), p.density.size(), p.pressure.size(),
                                   p.warm_pressure.size(), p.warm_divergence.size(), p.owed_kg.size()}) {
      if (size != p.size()) problems_.push_back("particle arrays differ in length");
    }
    require(all_within(p.position, farthest_place), "a particle is out of reach");
    require(all_within(p.velocity, fastest), "a particle is too fast");
    require(all_within(p.owed_kg, greatest_mass), "a particle owes more than any could");
  }

  void sources() {
    const Real particle_volume = built_.liquid.particle_mass / built_.liquid.kind.density;
    for (std::size_t i = 0; i < read_.sources.size(); ++i) {
      const Source& s = read_.sources[i];
      require(s.emitted >= 0, fmt::format("source {} has emitted {} drops", i, s.emitted));
      // What rounding to whole particles leaves over; a change of the density while it ran may have stretched it.
      require(within(s.carried, 2 * particle_volume),
              fmt::format("source {} owes {} m3, more than a particle's volume", i, s.carried));
    }
  }

  void textile(const Textile& t, const Textile& b) {
    const std::string name = "textile '" + b.name + "': ";
    const Contents &contents = t.contents, &wanted = b.contents;
    const std::size_t problems = problems_.size(), nodes = wanted.liquid_kg.size();
    same(name + "number of segments", contents.sorbed_kg.size(), wanted.sorbed_kg.size());
    same(name + "number of nodes", contents.liquid_kg.size(), nodes);
    same(name + "number of fibre shells", contents.shell_regain.size(), wanted.shell_regain.size());
    same(name + "number of hysteresis values", contents.reached_saturation.size(), wanted.reached_saturation.size());
    const std::vector<Real>& waiting = t.exchange.waiting_kg;
    if (!waiting.empty()) same(name + "number of exchange values", waiting.size(), nodes);
    require(all_within(waiting, greatest_mass), name + "more liquid waits on a face than any holds");
    if (problems_.size() == problems && b.model) contents_fit(name, *b.model, contents);
    if (t.cloth) sheet(name, t.cloth->soft, b.cloth->soft);
  }

  void contents_fit(const std::string& name, const WettingModel& m, const Contents& contents) {
    bool liquid = true, sorbed = true;
    for (std::size_t i = 0; i < m.nodes(); ++i) {
      const Real most = m.liquid.density * m.volume(i) * (1 + m.overfill(i));
      liquid = liquid && contents.liquid_kg[i] >= -1e-9 * most && contents.liquid_kg[i] <= times_capacity * most;
      if (i < m.segments) sorbed = sorbed && contents.sorbed_kg[i] >= 0 &&
                                   contents.sorbed_kg[i] <= times_capacity * m.at(i).dry_mass;
    }
    require(liquid, name + "a node holds more liquid than it could, or less than none");
    require(sorbed, name + "fibres hold more water than they could, or less than none");
    require(shares(contents.shell_regain), name + "a fibre's shell holds more water than it could, or less than none");
    require(shares(contents.reached_saturation), name + "a node was fuller than it could be");
  }
  static bool shares(const std::vector<Real>& values) {
    return std::all_of(values.begin(), values.end(), [](Real v) { return v >= 0 && v <= times_capacity; });
  }

  void cells(const CellCloth& c, const CellCloth& b) {
    const std::string name = "cloth '" + b.name + "': ";
    sheet(name, c.soft, b.soft);
    same(name + "number of cells", c.contents.content_kg.size(), b.contents.content_kg.size());
    same(name + "number of cells that leak", c.waiting_kg.size(), b.waiting_kg.size());
    const std::size_t parcels = c.contents.parcels();
    require(c.contents.parcel_place.size() == parcels && c.contents.parcel_velocity.size() == parcels,
            name + "arrays of parcels differ in length");
    require(all_within(c.contents.parcel_place, farthest_place), name + "a parcel is out of reach");
    require(all_within(c.contents.parcel_velocity, fastest), name + "a parcel is too fast");
    for (const auto* masses : {&c.contents.parcel_kg, &c.contents.content_kg, &c.waiting_kg}) {
      require(all_within(*masses, greatest_mass), name + "it holds more liquid than it could");
    }
  }

  void sheet(const std::string& name, const SoftSheet& read, const SoftSheet& built) {
    const Sheet &s = read.sheet, &b = built.sheet;
    for (const std::size_t size : {s.velocity.size(), s.added_mass.size(), s.stiffness_factor.size(),
                                   s.damping_added.size(), s.cling.size()}) {
      same(name + "number of nodes", size, b.size());
    }
    same(name + "number of nodes", s.size(), b.size());
    require(read.calm_place.empty() || read.calm_place.size() == b.size(), name + "its places of rest are not all there");
    require(all_within(s.position, farthest_place), name + "a node is out of reach");
    require(all_within(s.velocity, fastest), name + "a node is too fast");
    require(all_within(s.added_mass, greatest_mass), name + "a node carries more water than it could");
  }

  const World &read_, &built_;
  Problems problems_;
};

}  // namespace

std::vector<std::string> unsound_state(const World& read, const World& built) { return StateCheck(read, built).find(); }

}  // namespace imbibe
