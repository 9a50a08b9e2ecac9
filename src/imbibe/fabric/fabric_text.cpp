// The derived numbers of a fabric as text, in the units of the trade.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "imbibe/fabric/fabric.h"

namespace imbibe {
namespace {

constexpr Real gravity = 9.81;

// Yarn types of a family, in the order of first use.
std::vector<Index> types_of(const YarnNetwork& net, Family family) {
  std::vector<Index> out;
  std::set<Index> seen;
  for (std::size_t y = 0; y < net.yarn_family.size(); ++y)
    if (net.yarn_family[y] == family && seen.insert(net.yarn_type[y]).second) out.push_back(net.yarn_type[y]);
  return out;
}

std::string yarn_text(const YarnNetwork& net, Family family) {
  const std::vector<Index> types = types_of(net, family);
  std::set<std::string> fibres;
  for (Index t : types) fibres.insert(net.yarn_types[t].fibre.name);
  std::string text = fmt::format("{}", fmt::join(fibres, "+"));
  return types.size() > 1 ? fmt::format("{} ({} yarns)", text, types.size()) : text;
}

Real packing_of(const YarnNetwork& net, Family family) { return net.yarn_types[types_of(net, family).front()].packing; }

struct Table {
  std::string text;
  void row(const char* name, const std::string& warp, const std::string& weft, const char* unit = "") {
    text += fmt::format("  {:<34}{:>16}{:>16}  {}\n", name, warp, weft, unit);
  }
  void row(const char* name, Real warp, Real weft, const char* unit) {
    row(name, fmt::format("{:.4g}", warp), fmt::format("{:.4g}", weft), unit);
  }
  void line(const char* name, Real value, const char* unit, const std::string& note = "") {
    text += fmt::format("  {:<34}{:>16.4g}  {}{}{}\n", name, value, unit, note.empty() ? "" : "   ", note);
  }
};

void add_weave(const Fabric& fabric, Table& table) {
  const WeaveFacts facts = weave_facts(fabric.draft);
  table.text += fmt::format("weave {}: repeat of {} ends x {} picks, warp on {:.0f} % of the face, longest floats {} (warp) "
                            "and {} (weft)\n", fabric.weave_name, fabric.draft.ends, fabric.draft.picks,
                            100 * facts.warp_face_share, facts.longest_warp_float, facts.longest_weft_float);
  if (!facts.loose_ends.empty() || !facts.loose_picks.empty())
    table.text += fmt::format("note: {} ends and {} picks of the repeat never interlace\n", facts.loose_ends.size(),
                              facts.loose_picks.size());
}

void add_families(const Fabric& fabric, Table& table) {
  const YarnNetwork& net = fabric.network;
  const FamilyNumbers &warp = fabric.numbers.warp, &weft = fabric.numbers.weft;
  table.row("", "warp (along y)", "weft (along x)");
  table.row("fibre", yarn_text(net, Family::warp), yarn_text(net, Family::weft));
  table.row("yarns", std::to_string(warp.yarns), std::to_string(weft.yarns));
  table.row("linear density", warp.linear_density * 1e6, weft.linear_density * 1e6, "tex");
  table.row("cotton count", 590.5412e-6 / warp.linear_density, 590.5412e-6 / weft.linear_density, "Ne");
  table.row("yarn diameter", 2e6 * warp.mean_radius, 2e6 * weft.mean_radius, "um");
  table.row("packing of the yarn", 100 * packing_of(net, Family::warp), 100 * packing_of(net, Family::weft), "%");
  table.row("density", warp.density / 100, weft.density / 100, "per cm");
  table.row("", warp.density * 0.0254, weft.density * 0.0254, "per inch");
  table.row("pitch", 1e6 * warp.pitch, 1e6 * weft.pitch, "um");
  table.row("gap between yarns", 1e6 * warp.opening, 1e6 * weft.opening, "um");
  table.row("crimp", 100 * warp.crimp, 100 * weft.crimp, "%");
  table.row("cover", 100 * warp.cover, 100 * weft.cover, "%");
  table.row("cover factor (tex)", warp.cover_factor_tex, weft.cover_factor_tex, "sqrt(tex)/10 per cm");
  table.row("mass per area", 1e3 * warp.areal_mass, 1e3 * weft.areal_mass, "g/m2");
}

void add_sheet(const Fabric& fabric, Table& table) {
  const FabricNumbers& n = fabric.numbers;
  table.text += "sheet\n";
  if (fabric.network.layers > 1) {
    table.line("layers lying on each other", fabric.network.layers, "");
    table.line("crowns that touch between them", static_cast<Real>(fabric.network.face_contacts.size()), "");
  }
  table.line("areal mass", 1e3 * n.areal_mass, "g/m2");
  const bool set = std::abs(n.thickness / n.geometric_thickness - 1) > 1e-9;
  table.line("thickness", 1e3 * n.thickness, "mm",
             set ? fmt::format("yarns reach {:.4g} mm", 1e3 * n.geometric_thickness) : "from the yarns");
  table.line("cover", 100 * n.cover, "%");
  table.line("porosity between the yarns", 100 * n.porosity, "%", "arc length of the yarns");
  table.line("  with straight yarns", 100 * n.porosity_projected, "%");
  table.line("  seed A eq. 5 as printed", 100 * n.porosity_as_printed, "%", "slab 2r thick, lengths swapped");
  table.line("porosity with the yarns' inside", 100 * n.total_porosity, "%");
}

void add_pores(const Fabric& fabric, const ShownLiquid& liquid, Table& table) {
  const FabricNumbers& n = fabric.numbers;
  table.text += "pores between four crossings\n";
  table.line("pores", static_cast<Real>(n.pores), "");
  table.line("volume of one", 1e12 * n.pore_volume, "nL");
  table.line("liquid that fills them", 1e3 * n.pore_volume_per_area, "L/m2");
  table.line("liquid that fills the yarns",
             1e3 * (n.warp.capillary_volume_per_area + n.weft.capillary_volume_per_area), "L/m2");
  table.line("throat radius r_t", 1e6 * n.throat_radius, "um", "w_x w_y / (w_x + w_y)");
  table.line("storage radius R_V", 1e6 * n.storage_radius, "um", "sqrt(porosity A / (pi N))");
  table.line("  seed A eq. 11 as printed", 1e6 * n.radius_as_printed, "um", "sqrt(porosity V / (2 pi r (n-1)(n-1)))");
  table.text += fmt::format("{} in a throat, between yarns of\n", liquid.name);
  std::set<std::string> shown;
  for (const YarnType& type : fabric.network.yarn_types) {
    if (!shown.insert(type.fibre.name).second) continue;
    const Real angle = type.fibre.advancing_angle;
    const ThroatCapillarity c =
        throat_capillarity(n.throat_radius, liquid.surface_tension, angle, liquid.density, gravity);
    table.text += fmt::format("  {:<18} angle {:>5.1f} deg   pressure {:>8.1f} Pa   height {:>7.1f} mm   Bond number {:.2e}\n",
                              type.fibre.name, degrees(angle), c.pressure, 1e3 * c.height, c.bond_number);
  }
}

}  // namespace

std::string describe_fabric(const Fabric& fabric, const ShownLiquid& liquid) {
  Table table;
  const YarnNetwork& net = fabric.network;
  table.text = fmt::format("{:.4g} x {:.4g} mm, ", 1e3 * net.size_x, 1e3 * net.size_y);
  add_weave(fabric, table);
  add_families(fabric, table);
  add_sheet(fabric, table);
  add_pores(fabric, liquid, table);
  table.text += fmt::format("network: {} segments, {} pores, {} edges, {} points\n", net.segments(), net.pores(),
                            net.edges.size(), net.points.size());
  return table.text;
}

}  // namespace imbibe
