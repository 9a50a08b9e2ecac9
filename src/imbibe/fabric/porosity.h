// Numbers of a woven sheet from its geometry: porosity, mass, cover, pores and what capillarity makes of them.
//
// Porosity (seed A eq. 5, put right): 1 - (yarn volume per area) / t with the ARC length of the yarns,
//   yarn volume per area = pi r_w^2 (1 + c_w) / p_x + pi r_f^2 (1 + c_f) / p_y
//   r m, yarn radius; c 1, crimp = arc / projected length - 1; p m, pitch; t m, thickness, by default 2 (r_w + r_f).
// As printed, eq. 5 divides n pi r^2 l by 2 r l'^2: a slab 2 r thick where a weave is 4 r at its crossings, with
// projected length l above and arc length l' below. Kept as porosity_as_printed for comparison.
// Pore radius (eq. 11): storage R_V = sqrt(eps A / (pi N)), A area of the sheet, N pores; throat from the opening,
// r_t = w_x w_y / (w_x + w_y), w = p - 2 r. As printed: sqrt(eps V / (2 pi r (n_s - 1)(n_f - 1))).
// Tested in tests/fabric/porosity_test.cpp.
#pragma once

#include "imbibe/core/types.h"
#include "imbibe/fabric/network.h"

namespace imbibe {

// One family's part of a fabric's numbers.
struct FamilyNumbers {
  std::size_t yarns = 0;
  Real density = 0;             // 1/m
  Real pitch = 0;               // m, mean
  Real mean_radius = 0;         // m
  Real linear_density = 0;      // kg/m, mean
  Real crimp = 0;               // arc / projected - 1, mean
  Real cover = 0;               // 2 r / p, share of the plane covered by this family alone
  Real cover_factor_tex = 0;    // K = ends per cm * sqrt(tex) / 10
  Real opening = 0;             // m, mean free width between neighbours
  Real areal_mass = 0;          // kg/m2
  Real volume_per_area = 0;     // m3/m2, of the yarn tubes
  Real capillary_volume_per_area = 0;  // m3/m2, between the fibres inside the yarns
};

struct FabricNumbers {
  FamilyNumbers warp, weft;
  Real area = 0;                    // m2
  Real thickness = 0;               // m, t of the slab
  Real geometric_thickness = 0;     // m, from the lowest to the highest point of the yarns
  Real porosity = 0;                // between the yarns, with arc length
  Real porosity_projected = 0;      // the same with projected lengths
  Real porosity_as_printed = 0;     // seed A eq. 5
  Real total_porosity = 0;          // with the void inside the yarns
  Real areal_mass = 0;              // kg/m2
  Real cover = 0;                   // share of the plane under yarns: c_w + c_f - c_w c_f
  Real pore_volume = 0;             // m3, mean of one pore
  Real pore_volume_per_area = 0;    // m3/m2
  Real storage_radius = 0;          // m, R_V
  Real throat_radius = 0;           // m, mean r_t
  Real radius_as_printed = 0;       // m, seed A eq. 11
  std::size_t segments = 0, pores = 0, edges = 0;
};

Real porosity_of_slab(Real yarn_volume_per_area, Real thickness);
// Seed A eq. 5 literally, for `yarns` yarns of radius r, projected length l and bent length l_bent on a square sheet.
Real porosity_as_printed(std::size_t yarns, Real radius, Real projected_length, Real arc_length);
Real storage_radius(Real porosity, Real area, std::size_t pores);
Real pore_radius_as_printed(Real porosity, Real volume, Real yarn_radius, std::size_t segments_of_yarn,
                            std::size_t weft_yarns);
Real throat_radius(Real opening_x, Real opening_y);  // 0 where an opening is shut

// Liquid in the throat, seen by itself.
struct ThroatCapillarity {
  Real pressure = 0;        // Pa, 2 gamma cos(theta) / r_t, > 0 draws in
  Real height = 0;          // m, Jurin: pressure / (rho g)
  Real bond_number = 0;     // rho g r_t^2 / gamma
};
ThroatCapillarity throat_capillarity(Real throat, Real surface_tension, Real angle, Real density, Real gravity);

FabricNumbers fabric_numbers(const YarnNetwork& network);

}  // namespace imbibe
