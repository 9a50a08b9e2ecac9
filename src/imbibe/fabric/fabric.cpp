#include "imbibe/fabric/fabric.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "imbibe/core/quantity.h"
#include "imbibe/fabric/layers.h"
#include "imbibe/fabric/weaving.h"
#include "imbibe/fabric/wif.h"

namespace imbibe {
namespace {

constexpr double most_nodes = static_cast<double>(no_index);  // node and point numbers are 32 bits wide

std::string joined(const std::string& key, const std::string& name) { return key.empty() ? name : key + "." + name; }

// One family before it is laid out: how its pitch and its yarns go from thread to thread.
struct FamilyPlan {
  Real uniform_pitch = 0;              // m; 0: spacing holds
  std::vector<Real> spacing;           // m, per thread of a WIF repeat
  std::vector<Index> repeat_type;      // yarn types of a repeat; one entry without a WIF file
  struct Stripe {
    std::size_t first = 0, count = 0, repeat = 0;
    Index type = 0;
  };
  std::vector<Stripe> stripes;

  Real spacing_of(std::size_t i) const { return uniform_pitch > 0 ? uniform_pitch : spacing[i % spacing.size()]; }
  Index type_of(std::size_t i) const {
    Index type = repeat_type[i % repeat_type.size()];
    for (const Stripe& s : stripes) {
      if (i < s.first) continue;
      const std::size_t place = s.repeat > 0 ? (i - s.first) % s.repeat : i - s.first;
      if (place < s.count) type = s.type;
    }
    return type;
  }
  bool known() const { return uniform_pitch > 0 || !spacing.empty(); }
  Real mean_spacing() const {
    if (uniform_pitch > 0) return uniform_pitch;
    Real sum = 0;
    for (Real s : spacing) sum += s;
    return spacing.empty() ? 0 : sum / static_cast<Real>(spacing.size());
  }
};

// A spec with its files read and its yarns found; the pitches may still be scaled.
struct Plan {
  WeaveDraft draft;
  std::string weave_name;
  std::vector<YarnType> types;
  FamilyPlan warp, weft;
  std::vector<const Fibre*> layer_fibre;  // of every layer from above; nullptr: as described
};

class Planner {
 public:
  Planner(const FabricSpec& spec, const FibreLibrary& library, const std::string& key, std::vector<Problem>& problems)
      : spec_(spec), library_(library), key_(key), problems_(problems) {}

  Plan plan() {
    check_numbers();
    read_weave();
    plan_family(spec_.warp, wif_ ? &wif_->warp : nullptr, "warp", plan_.warp);
    plan_family(spec_.weft, wif_ ? &wif_->weft : nullptr, "weft", plan_.weft);
    for (std::size_t i = 0; i < spec_.stripes.size(); ++i) add_stripe(i);
    for (std::size_t i = 0; i < spec_.layers.size(); ++i) add_layers(i);
    if (plan_.layer_fibre.empty()) plan_.layer_fibre = {nullptr};
    return std::move(plan_);
  }

 private:
  void problem(const std::string& name, std::string message) {
    problems_.push_back(Problem{"", 0, 0, joined(key_, name), std::move(message)});
  }

  void check_numbers() {
    for (std::size_t i = 0; i < 2; ++i)
      if (!(spec_.size[i] > 0) || !std::isfinite(spec_.size[i]))
        problem(fmt::format("size[{}]", i), fmt::format("{} m is not above 0", spec_.size[i]));
    const auto wanted = [&](const std::optional<Real>& value, const char* name, Real most) {
      if (value && !(*value > 0 && *value < most)) problem(name, fmt::format("{} is outside (0, {:g})", *value, most));
    };
    wanted(spec_.thickness, "thickness", 1e3);
    wanted(spec_.areal_mass, "areal_mass", 1e6);
    wanted(spec_.porosity, "porosity", 1);
    if (spec_.warp_crimp_share && !(*spec_.warp_crimp_share >= 0 && *spec_.warp_crimp_share <= 1))
      problem("warp_crimp_share", fmt::format("{} is outside [0, 1]", *spec_.warp_crimp_share));
    if (spec_.points_per_segment < 2 || spec_.points_per_segment > 64 || spec_.points_per_segment % 2 != 0)
      problem("points_per_segment", fmt::format("{} is not an even number from 2 to 64", spec_.points_per_segment));
    if (spec_.porosity && spec_.porosity_by == PorosityBy::thickness && spec_.thickness)
      problem("thickness", "is given, and the wanted porosity would set it: leave one out, or porosity_by: pitch");
    if (spec_.porosity && spec_.porosity_by == PorosityBy::pitch && spec_.areal_mass)
      problem("areal_mass", "sets the pitch, and so would the porosity: leave one out, or porosity_by: thickness");
  }

  void read_weave() {
    try {
      if (!spec_.weave_rows.empty()) {
        if (spec_.weave != FabricSpec{}.weave) problem("weave_rows", "is given beside weave: leave one out");
        plan_.draft = weave_from_rows(spec_.weave_rows);
        plan_.weave_name = fmt::format("rows, {} picks x {} ends", plan_.draft.picks, plan_.draft.ends);
      } else if (is_wif_name(spec_.weave)) {
        std::filesystem::path file = spec_.weave;
        if (file.is_relative() && !spec_.folder.empty()) file = spec_.folder / file;
        wif_ = read_wif(file);
        plan_.draft = wif_->draft;
        plan_.weave_name = file.filename().string();
      } else {
        plan_.draft = parse_weave(spec_.weave);
        plan_.weave_name = spec_.weave;
      }
    } catch (const InputError& e) {
      for (Problem p : e.problems()) {
        if (p.file.empty() && p.key.empty()) p.key = joined(key_, spec_.weave_rows.empty() ? "weave" : "weave_rows");
        problems_.push_back(std::move(p));
      }
      return;
    }
    const WeaveFacts facts = weave_facts(plan_.draft);
    if (std::ssize(facts.loose_ends) == plan_.draft.ends || std::ssize(facts.loose_picks) == plan_.draft.picks)
      problem(spec_.weave_rows.empty() ? "weave" : "weave_rows",
              "does not interlace: no yarn changes sides, and the cloth would fall apart");
  }

  Index add_type(const YarnSpec& spec, const std::string& name) {
    plan_.types.push_back(make_yarn(spec, library_, joined(key_, name), problems_));
    return static_cast<Index>(plan_.types.size() - 1);
  }

  void plan_family(const YarnSpec& spec, const WifThreads* wif, const char* name, FamilyPlan& family) {
    if (spec.density && *spec.density > 0) family.uniform_pitch = 1 / *spec.density;
    else if (wif != nullptr) family.spacing = wif->spacing;
    if (!family.known() && !spec.density) {
      const bool no_unit = wif != nullptr && wif->lengths_without_unit;
      problem(joined(name, "density"), no_unit ? "is needed: the WIF file gives a spacing without its Units"
                                                                 : "is needed, such as 24 /cm");
    }
    const bool own_size = spec.diameter || spec.linear_density;
    const bool sized = wif != nullptr && !wif->thickness.empty() && !own_size;
    const bool coloured = wif != nullptr && !wif->colour.empty();
    if (!sized && !coloured) {
      family.repeat_type = {add_type(spec, name)};
      return;
    }
    // One yarn type per pair of thickness and colour that the file uses.
    std::map<std::tuple<Real, Real, Real, Real>, Index> known;
    for (std::size_t i = 0; i < static_cast<std::size_t>(wif->threads); ++i) {
      YarnSpec thread = spec;
      if (sized) thread.diameter = wif->thickness[i];
      if (coloured) thread.colour = wif->colour[i];
      const auto identity = std::tuple(thread.diameter.value_or(0), thread.colour.x, thread.colour.y, thread.colour.z);
      auto it = known.find(identity);
      if (it == known.end()) {
        if (known.size() > 0 && problems_.size() > 20) return;  // the same mistake for each thread
        it = known.emplace(identity, add_type(thread, name)).first;
      }
      family.repeat_type.push_back(it->second);
    }
  }

  void add_stripe(std::size_t i) {
    const StripeSpec& stripe = spec_.stripes[i];
    const std::string name = fmt::format("stripes[{}]", i);
    if (stripe.first < 1) problem(name + ".first", fmt::format("{} is below 1, the first yarn", stripe.first));
    if (stripe.count < 1) problem(name + ".count", fmt::format("{} is below 1", stripe.count));
    if (stripe.repeat < 0 || (stripe.repeat > 0 && stripe.repeat < stripe.count))
      problem(name + ".repeat", fmt::format("{} is below the stripe's own {} yarns; 0 = once", stripe.repeat, stripe.count));
    const Index type = add_type(stripe.yarn, name + ".yarn");
    FamilyPlan& family = stripe.family == Family::warp ? plan_.warp : plan_.weft;
    family.stripes.push_back({static_cast<std::size_t>(std::max(stripe.first, 1) - 1),
                              static_cast<std::size_t>(std::max(stripe.count, 1)),
                              static_cast<std::size_t>(std::max(stripe.repeat, 0)), type});
  }

  void add_layers(std::size_t i) {
    const LayerSpec& layer = spec_.layers[i];
    const std::string name = fmt::format("layers[{}]", i);
    if (layer.count < 1) problem(name + ".count", fmt::format("{} is below 1", layer.count));
    const FibreRecord* record = layer.fibre.empty() ? nullptr : find_fibre(library_, layer.fibre);
    if (!layer.fibre.empty() && record == nullptr) problem(name + ".fibre", unknown_fibre_message(library_, layer.fibre));
    plan_.layer_fibre.insert(plan_.layer_fibre.end(), static_cast<std::size_t>(std::clamp(layer.count, 1, 64)),
                             record != nullptr ? &record->fibre : nullptr);
  }

  const FabricSpec& spec_;
  const FibreLibrary& library_;
  const std::string& key_;
  std::vector<Problem>& problems_;
  std::optional<WifFile> wif_;
  Plan plan_;
};

// How many yarns of this family fill `size`: at least 2, and never less than half a pitch short of it.
double count_yarns(const FamilyPlan& family, Real size, Real scale) {
  const Real pitch = family.mean_spacing() * scale;
  return std::max(2.0, std::round(size / pitch));
}

// Places of `count` yarns about the middle, and the width they take with half a pitch outside each.
Real place_yarns(const FamilyPlan& family, std::size_t count, Real scale, std::vector<Real>& place,
                 std::vector<Index>& type) {
  place.resize(count);
  type.resize(count);
  Real at = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (family.uniform_pitch > 0) at = static_cast<Real>(i) * family.uniform_pitch * scale;
    else if (i > 0) at += scale * (family.spacing_of(i - 1) + family.spacing_of(i)) / 2;
    place[i] = at;
    type[i] = family.type_of(i);
  }
  const Real before = (place[1] - place[0]) / 2, after = (place[count - 1] - place[count - 2]) / 2;
  const Real width = place.back() + before + after;
  for (Real& p : place) p += before - width / 2;
  return width;
}

Layout lay_out(const Plan& plan, const FabricSpec& spec, Real scale, double most_yarns) {
  Layout layout;
  layout.draft = plan.draft;
  layout.types = plan.types;
  layout.warp_crimp_share = spec.warp_crimp_share;
  layout.thickness = spec.thickness;
  layout.points_per_segment = spec.points_per_segment;
  const auto ends = static_cast<std::size_t>(std::min(most_yarns, count_yarns(plan.warp, spec.size[0], scale)));
  const auto picks = static_cast<std::size_t>(std::min(most_yarns, count_yarns(plan.weft, spec.size[1], scale)));
  layout.size_x = place_yarns(plan.warp, ends, scale, layout.end_place, layout.end_type);
  layout.size_y = place_yarns(plan.weft, picks, scale, layout.pick_place, layout.pick_type);
  return layout;
}

// The scale of both pitches at which `excess` (falling with the scale) is zero; bisection of its logarithm.
template <class Excess>
Real solve_scale(Excess&& excess) {
  Real low = 1, high = 1;
  while (excess(low) < 0 && low > 1e-4) low *= 0.5;
  while (excess(high) > 0 && high < 1e4) high *= 2;
  for (int i = 0; i < 60; ++i) {
    const Real middle = std::sqrt(low * high);
    (excess(middle) > 0 ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

// A patch of so many yarns each way stands for the whole sheet while the pitch is sought. Sums of whole repeats would
// be exact; the sheet's own numbers are computed from the sheet.
constexpr double patch_yarns = 128;

Real wanted_scale(const Plan& plan, const FabricSpec& spec) {
  const auto patch = [&](Real scale) {
    FabricSpec sheet = spec;  // the same yarns at any scale
    sheet.size = {spec.size[0] * scale, spec.size[1] * scale};
    return lay_out(plan, sheet, scale, patch_yarns);
  };
  if (spec.areal_mass)
    return solve_scale([&](Real scale) { return layout_sums(patch(scale)).mass_per_area - *spec.areal_mass; });
  if (spec.porosity && spec.porosity_by == PorosityBy::pitch) {
    const Real thickness = spec.thickness ? *spec.thickness : layout_thickness(patch(1));
    return solve_scale([&](Real scale) {
      return *spec.porosity - porosity_of_slab(layout_sums(patch(scale)).volume_per_area, thickness);
    });
  }
  return 1;
}

void check_counts(const Plan& plan, const FabricSpec& spec, Real scale, const std::string& key,
                  std::vector<Problem>& problems) {
  const double ends = count_yarns(plan.warp, spec.size[0], scale), picks = count_yarns(plan.weft, spec.size[1], scale);
  const auto layers = static_cast<double>(plan.layer_fibre.size());
  const double points = layers * ((2 * ends * picks) * spec.points_per_segment + ends + picks);
  if (points < most_nodes && layers * 3 * ends * picks < static_cast<double>(most_network_nodes)) return;
  problems.push_back(Problem{"", 0, 0, joined(key, "size"),
                             fmt::format("{:.0f} ends x {:.0f} picks are {:.3g} segments with {:.3g} points: more than "
                                         "{:.3g} cannot be numbered", ends, picks, layers * 2 * ends * picks, points, most_nodes)});
}

void check_thickness(const Layout& layout, const std::string& key, const char* name, std::vector<Problem>& problems) {
  if (!layout.thickness) return;
  Real thickest = 0;
  for (const YarnType& type : layout.types) thickest = std::max(thickest, 2 * type.radius);
  if (*layout.thickness <= thickest)
    problems.push_back(Problem{"", 0, 0, joined(key, name),
                               fmt::format("a slab of {} is thinner than its thickest yarn, {}",
                                           format_quantity(*layout.thickness, "m", "mm"),
                                           format_quantity(thickest, "m", "mm"))});
}

// Crowns that rest on each other cannot be nearer than the yarns are thick.
void check_layers(const Layout& layout, std::size_t layers, const std::string& key, std::vector<Problem>& problems) {
  const Real yarns = layout_thickness(layout);
  if (layers < 2 || !layout.thickness || *layout.thickness >= yarns * (1 - 1e-9)) return;
  problems.push_back(Problem{"", 0, 0, joined(key, "thickness"),
                             fmt::format("layers that lie on each other are at least as thick as their yarns reach, {}",
                                         format_quantity(yarns, "m", "mm"))});
}

// The layers' own yarns: another fibre in tubes of the same diameter and packing.
YarnNetwork weave_layers(Layout layout, const std::vector<const Fibre*>& fibres, Real gap, const std::string& key) {
  const std::vector<YarnType> described = layout.types;
  std::vector<YarnNetwork> layers;
  for (const Fibre* fibre : fibres) {
    layout.types = described;
    for (YarnType& type : layout.types) {
      if (fibre == nullptr) continue;
      type.fibre = *fibre;
      type.linear_density = pi * type.radius * type.radius * type.packing * fibre->density;
    }
    layers.push_back(weave_network(layout, key));
  }
  return stack_layers(std::move(layers), gap);
}

void throw_any(std::vector<Problem>& problems) {
  if (!problems.empty()) throw InputError(std::move(problems));
}

}  // namespace

FabricEstimate estimate_fabric(const FabricSpec& spec) {
  FabricEstimate out;
  FamilyPlan warp, weft;
  if (spec.warp.density && *spec.warp.density > 0) warp.uniform_pitch = 1 / *spec.warp.density;
  if (spec.weft.density && *spec.weft.density > 0) weft.uniform_pitch = 1 / *spec.weft.density;
  if ((!warp.known() || !weft.known()) && is_wif_name(spec.weave)) {
    try {
      std::filesystem::path file = spec.weave;
      if (file.is_relative() && !spec.folder.empty()) file = spec.folder / file;
      const WifFile wif = read_wif(file);
      if (!warp.known()) warp.spacing = wif.warp.spacing;
      if (!weft.known()) weft.spacing = wif.weft.spacing;
    } catch (const InputError&) {  // reported by build_fabric
    }
  }
  if (!warp.known() || !weft.known() || !(spec.size[0] > 0) || !(spec.size[1] > 0)) return out;
  const double ends = count_yarns(warp, spec.size[0], 1), picks = count_yarns(weft, spec.size[1], 1);
  out.ends = static_cast<std::size_t>(ends);
  out.picks = static_cast<std::size_t>(picks);
  double layers = spec.layers.empty() ? 1 : 0;
  for (const LayerSpec& layer : spec.layers) layers += layer.count;
  out.segments = layers * 2 * ends * picks;
  out.pores = layers * (ends - 1) * (picks - 1);
  out.points = out.segments * spec.points_per_segment + layers * (ends + picks);
  out.edges = layers * (ends * (picks - 1) + picks * (ends - 1) + ends * picks + (ends - 2) * (picks - 1) +
                        (ends - 1) * (picks - 2)) + 8 * out.pores + (layers - 1) * (ends * picks + out.pores / layers);
  out.bytes = out.points * sizeof(Vec3) + out.segments * (sizeof(Index) + sizeof(Vec3) + 2 * sizeof(Real)) +
              out.pores * (sizeof(Vec3) + 5 * sizeof(Real)) + out.edges * sizeof(Edge) +
              layers * (ends + picks) * (4 * sizeof(Index) + sizeof(Real));
  return out;
}

Fabric build_fabric(const FabricSpec& spec, const FibreLibrary& library, const std::string& key) {
  std::vector<Problem> problems;
  Plan plan = Planner(spec, library, key, problems).plan();
  throw_any(problems);
  const Real scale = wanted_scale(plan, spec);
  check_counts(plan, spec, scale, key, problems);
  throw_any(problems);
  Layout layout = lay_out(plan, spec, scale, most_nodes);
  problems = check_layout(layout, key);
  if (!problems.empty() && scale != 1)
    for (Problem& p : problems)
      p.message += fmt::format(" (the pitch was scaled by {:.4g} to reach the wanted {})", scale,
                               spec.areal_mass ? "areal mass" : "porosity");
  throw_any(problems);
  if (spec.porosity && spec.porosity_by == PorosityBy::thickness)
    layout.thickness = layout_sums(layout).volume_per_area / (1 - *spec.porosity);
  check_thickness(layout, key, spec.thickness ? "thickness" : "porosity", problems);
  check_layers(layout, plan.layer_fibre.size(), key, problems);
  throw_any(problems);

  Fabric fabric;
  fabric.network = weave_layers(std::move(layout), plan.layer_fibre, spec.layer_gap, key);
  fabric.numbers = fabric_numbers(fabric.network);
  fabric.draft = std::move(plan.draft);
  fabric.weave_name = std::move(plan.weave_name);
  return fabric;
}

}  // namespace imbibe
