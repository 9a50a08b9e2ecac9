#include "imbibe/fabric/porosity.h"

#include <algorithm>

#include "imbibe/core/parallel.h"
#include "imbibe/core/portable.h"

namespace imbibe {

Real porosity_of_slab(Real yarn_volume_per_area, Real thickness) { return 1 - yarn_volume_per_area / thickness; }

Real porosity_as_printed(std::size_t yarns, Real radius, Real projected_length, Real arc_length) {
  return 1 - static_cast<Real>(yarns) * pi * radius * radius * projected_length / (2 * radius * arc_length * arc_length);
}

Real storage_radius(Real porosity, Real area, std::size_t pores) {
  return pores == 0 ? 0 : std::sqrt(porosity * area / (pi * static_cast<Real>(pores)));
}

Real pore_radius_as_printed(Real porosity, Real volume, Real yarn_radius, std::size_t segments_of_yarn,
                            std::size_t weft_yarns) {
  if (segments_of_yarn < 2 || weft_yarns < 2) return 0;
  return std::sqrt(porosity * volume /
                   (2 * pi * yarn_radius * static_cast<Real>(segments_of_yarn - 1) * static_cast<Real>(weft_yarns - 1)));
}

Real throat_radius(Real opening_x, Real opening_y) {
  return opening_x > 0 && opening_y > 0 ? opening_x * opening_y / (opening_x + opening_y) : 0;
}

ThroatCapillarity throat_capillarity(Real throat, Real surface_tension, Real angle, Real density, Real gravity) {
  const Real pressure = 2 * surface_tension * portable::cos(angle) / throat;
  return {pressure, pressure / (density * gravity), density * gravity * throat * throat / surface_tension};
}

namespace {

Real mean_of(const std::vector<Real>& values) {
  const Real sum = parallel_sum(values.size(), [&](std::size_t begin, std::size_t end) {
    Real part = 0;
    for (std::size_t i = begin; i < end; ++i) part += values[i];
    return part;
  });
  return values.empty() ? 0 : sum / static_cast<Real>(values.size());
}

// Sums over the yarns of one family; lengths per area of the sheet.
FamilyNumbers family_numbers(const YarnNetwork& net, Family family) {
  FamilyNumbers out;
  const bool warp = family == Family::warp;
  const Real straight = warp ? net.size_y : net.size_x, area = net.size_x * net.size_y;
  Real arc_sum = 0;
  for (std::size_t y = 0; y < net.yarn_family.size(); ++y) {
    if (net.yarn_family[y] != family) continue;
    const YarnType& type = net.yarn_types[net.yarn_type[y]];
    Real arc = 0;
    for (Index s = net.yarn_first_segment[y]; s < net.yarn_first_segment[y + 1]; ++s) arc += net.segment_length[s];
    const Real volume = pi * type.radius * type.radius * arc;
    ++out.yarns;
    arc_sum += arc;
    out.mean_radius += type.radius;
    out.linear_density += type.linear_density;
    out.volume_per_area += volume / area;
    if (!type.monofilament) out.capillary_volume_per_area += type.void_share() * volume / area;
    out.areal_mass += type.linear_density * arc / area;
  }
  if (out.yarns == 0) return out;
  const Real n = static_cast<Real>(out.yarns);
  out.mean_radius /= n;
  out.linear_density /= n;
  out.crimp = arc_sum / (n * straight) - 1;
  out.pitch = warp ? net.pitch_x : net.pitch_y;
  out.density = 1 / out.pitch;
  out.cover = 2 * out.mean_radius / out.pitch;
  out.cover_factor_tex = out.density / 100 * std::sqrt(out.linear_density * 1e6) / 10;
  out.opening = mean_of(warp ? net.pore_opening_x : net.pore_opening_y);
  return out;
}

// Distance of the outermost points of the yarns; the crowns lie at the crossings.
Real geometric_thickness(const YarnNetwork& net) {
  Real most = 0;
  for (std::size_t s = 0; s < net.segments(); ++s)
    most = std::max(most, std::abs(net.segment_centre[s].z) + net.type_of_segment(s).radius);
  return 2 * most;
}

}  // namespace

FabricNumbers fabric_numbers(const YarnNetwork& net) {
  FabricNumbers out;
  out.warp = family_numbers(net, Family::warp);
  out.weft = family_numbers(net, Family::weft);
  out.area = net.size_x * net.size_y;
  out.thickness = net.thickness;
  out.geometric_thickness = geometric_thickness(net);
  const Real solid = out.warp.volume_per_area + out.weft.volume_per_area;
  const Real projected = out.warp.volume_per_area / (1 + out.warp.crimp) + out.weft.volume_per_area / (1 + out.weft.crimp);
  out.porosity = porosity_of_slab(solid, net.thickness);
  out.porosity_projected = porosity_of_slab(projected, net.thickness);
  out.total_porosity =
      out.porosity + (out.warp.capillary_volume_per_area + out.weft.capillary_volume_per_area) / net.thickness;
  // Seed A's formula knows one kind of fibre on a square: means of both families stand for it.
  const auto layers = static_cast<std::size_t>(net.layers);  // both formulas know one
  const std::size_t yarns = (out.warp.yarns + out.weft.yarns) / layers;
  const Real share = static_cast<Real>(out.warp.yarns / layers) / static_cast<Real>(yarns);
  const Real radius = share * out.warp.mean_radius + (1 - share) * out.weft.mean_radius;
  const Real side = std::sqrt(out.area);
  out.porosity_as_printed =
      porosity_as_printed(yarns, radius, side, side * (1 + share * out.warp.crimp + (1 - share) * out.weft.crimp));
  out.areal_mass = out.warp.areal_mass + out.weft.areal_mass;
  out.cover = out.warp.cover + out.weft.cover - out.warp.cover * out.weft.cover;
  out.segments = net.segments();
  out.pores = net.pores();
  out.edges = net.edges.size();
  out.pore_volume = mean_of(net.pore_volume);
  out.pore_volume_per_area = out.porosity * net.thickness;
  out.storage_radius = storage_radius(out.porosity, mean_of(net.pore_area) * static_cast<Real>(net.pores()), net.pores());
  out.throat_radius = mean_of(net.pore_throat);
  out.radius_as_printed =
      pore_radius_as_printed(out.porosity, out.area * net.layer_thickness(), radius, out.warp.yarns / layers,
                             out.weft.yarns / layers);
  return out;
}

}  // namespace imbibe
