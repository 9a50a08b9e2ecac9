// Small yarn networks made by hand, for tests of what flows on them (not of how a fabric is built).
#pragma once

#include <cmath>

#include "imbibe/fabric/network.h"
#include "imbibe/wetting/wetting_model.h"
#include "imbibe/wetting/wetting_step.h"

namespace imbibe::testing {

inline Fibre cotton_fibre(Real angle_deg = 45) {
  Fibre f;
  f.name = "cotton";
  f.density = 1550;
  f.regain_65 = 0.073;
  f.regain_saturated = 0.24;
  f.liquid_retention = 0.48;
  f.volume_swelling = 0.43;
  f.area_swelling = 0.4;
  f.radius = 7e-6;
  f.advancing_angle = radians(angle_deg);
  f.receding_angle = radians(10);
  f.diffusivity = 3e-14;
  f.isotherm = {.m0 = 0.0339, .c = 11.0, .k = 0.857};
  f.desorption_offset_65 = 0.009;
  f.absorption_coefficient = 2;
  return f;
}

inline Fibre wool_fibre(Real angle_deg = 65) {
  Fibre f;
  f.name = "wool";
  f.density = 1300;
  f.regain_65 = 0.145;
  f.regain_saturated = 0.33;
  f.volume_swelling = 0.38;
  f.area_swelling = 0.26;
  f.radius = 10.5e-6;
  f.advancing_angle = radians(angle_deg);
  f.receding_angle = radians(40);
  f.diffusivity = 4e-14;
  f.isotherm = {.m0 = 0.0810, .c = 10.5, .k = 0.755};
  f.desorption_offset_65 = 0.020;
  f.absorption_coefficient = 0.75;
  return f;
}

inline Fibre polyester_fibre(Real angle_deg = 75) {
  Fibre f;
  f.name = "polyester";
  f.density = 1390;
  f.regain_65 = 0.004;
  f.regain_saturated = 0.008;
  f.volume_swelling = 0.005;
  f.area_swelling = 0.005;
  f.radius = 7e-6;
  f.advancing_angle = radians(angle_deg);
  f.receding_angle = radians(50);
  f.diffusivity = 1.3e-13;
  f.isotherm = {.m0 = 0.00378, .c = 2.87, .k = 0.599};
  f.absorption_coefficient = 0.65;
  return f;
}

inline Fibre polypropylene_fibre() {
  Fibre f;
  f.name = "polypropylene";
  f.density = 910;
  f.regain_65 = 0.0003;
  f.regain_saturated = 0.001;
  f.radius = 10e-6;
  f.advancing_angle = radians(100);
  f.receding_angle = radians(84);
  f.diffusivity = 1e-13;
  f.isotherm = {.m0 = 0, .linear_slope = 0.001};
  return f;
}

inline YarnType yarn_of(const Fibre& fibre, Real radius, Real packing) {
  YarnType yarn;
  yarn.fibre = fibre;
  yarn.radius = radius;
  yarn.packing = packing;
  return yarn;
}

// 20 tex cotton, ring spun, and a 0.4 mm yarn of the paper sheet.
inline YarnType shirting_yarn(const Fibre& fibre, Real packing = 0.55) { return yarn_of(fibre, 86e-6, packing); }
inline YarnType paper_yarn(const Fibre& fibre, Real packing = 0.55) { return yarn_of(fibre, 200e-6, packing); }

// One straight yarn along x with `count` segments; no pores.
inline YarnNetwork yarn_strip(std::size_t count, Real length, const YarnType& yarn) {
  YarnNetwork n;
  n.size_x = static_cast<Real>(count) * length;
  n.size_y = 4 * yarn.radius;
  n.thickness = 4 * yarn.radius;
  n.pitch_x = length;
  n.pitch_y = n.size_y;
  n.yarn_types = {yarn};
  n.yarn_family = {Family::weft};
  n.yarn_type = {0};
  n.yarn_first_segment = {0, static_cast<Index>(count)};
  for (std::size_t i = 0; i < count; ++i) {
    n.segment_yarn.push_back(0);
    n.segment_centre.push_back({(static_cast<Real>(i) + 0.5) * length, 0, 0});
    n.segment_length.push_back(length);
    if (i > 0) n.edges.push_back({static_cast<Index>(i - 1), static_cast<Index>(i), EdgeKind::along_yarn});
  }
  return n;
}

// One upright tube of `radius` and `length` through the sheet's thickness: a pore between walls of `wall`, no yarns.
inline YarnNetwork one_tube(Real radius, Real length, const Fibre& wall) {
  YarnNetwork n;
  n.size_x = n.size_y = n.pitch_x = n.pitch_y = 4 * radius;
  n.thickness = length;
  n.yarn_types = {yarn_of(wall, radius, 1)};
  n.pore_centre = {{0, 0, 0}};
  n.pore_volume = {pi * radius * radius * length};
  n.pore_opening_x = n.pore_opening_y = {2 * radius};
  n.pore_throat = {radius};
  n.pore_area = {16 * radius * radius};
  n.yarn_first_segment = {0};
  return n;
}

// Plain weave of nx warp yarns (along y, one per x position) and ny weft yarns (along x), sheet centred at the origin.
// Segment of warp i at weft j: i*ny + j; of weft j at warp i: nx*ny + j*nx + i; pores between, row by row.
inline YarnNetwork plain_weave(std::size_t nx, std::size_t ny, Real pitch_x, Real pitch_y, const YarnType& warp,
                               const YarnType& weft) {
  YarnNetwork n;
  n.pitch_x = pitch_x, n.pitch_y = pitch_y;
  n.size_x = static_cast<Real>(nx) * pitch_x, n.size_y = static_cast<Real>(ny) * pitch_y;
  n.thickness = 2 * (warp.radius + weft.radius);
  n.yarn_types = {warp, weft};
  const Real x0 = -0.5 * n.size_x + 0.5 * pitch_x, y0 = -0.5 * n.size_y + 0.5 * pitch_y;
  // A yarn climbs from one side to the other within a pitch: arc of a sine of amplitude A over half its wave.
  const auto arc = [](Real pitch, Real amplitude) {
    constexpr int steps = 400;
    Real length = 0;
    for (int i = 0; i < steps; ++i) {
      const Real slope = amplitude * pi / pitch * std::cos(pi * (i + 0.5) / steps);
      length += std::sqrt(1 + slope * slope) * pitch / steps;
    }
    return length;
  };
  const Real warp_length = arc(pitch_y, weft.radius), weft_length = arc(pitch_x, warp.radius);
  n.yarn_first_segment.push_back(0);
  for (std::size_t yarn = 0; yarn < nx + ny; ++yarn) {
    const bool is_warp = yarn < nx;
    n.yarn_family.push_back(is_warp ? Family::warp : Family::weft);
    n.yarn_type.push_back(is_warp ? 0 : 1);
    const std::size_t count = is_warp ? ny : nx;
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t i = is_warp ? yarn : k, j = is_warp ? k : yarn - nx;
      const Real side = ((i + j) % 2 == 0 ? 1.0 : -1.0) * (is_warp ? weft.radius : -warp.radius);
      n.segment_yarn.push_back(static_cast<Index>(yarn));
      n.segment_centre.push_back({x0 + static_cast<Real>(i) * pitch_x, y0 + static_cast<Real>(j) * pitch_y, side});
      n.segment_length.push_back(is_warp ? warp_length : weft_length);
      const auto s = static_cast<Index>(n.segment_yarn.size() - 1);
      if (k > 0) n.edges.push_back({s - 1, s, EdgeKind::along_yarn});
    }
    n.yarn_first_segment.push_back(static_cast<Index>(n.segment_yarn.size()));
  }
  const auto warp_segment = [&](std::size_t i, std::size_t j) { return static_cast<Index>(i * ny + j); };
  const auto weft_segment = [&](std::size_t i, std::size_t j) { return static_cast<Index>(nx * ny + j * nx + i); };
  const Real w_x = pitch_x - 2 * warp.radius, w_y = pitch_y - 2 * weft.radius;
  const Real volume = pitch_x * pitch_y * n.thickness - pi * warp.radius * warp.radius * warp_length -
                      pi * weft.radius * weft.radius * weft_length;
  const auto segments = static_cast<Index>(n.segments());
  const auto pore_at = [&](std::size_t i, std::size_t j) { return static_cast<Index>(segments + j * (nx - 1) + i); };
  for (std::size_t j = 0; j < ny; ++j) {
    for (std::size_t i = 0; i < nx; ++i) {
      n.edges.push_back({warp_segment(i, j), weft_segment(i, j), EdgeKind::crossing});
    }
  }
  for (std::size_t j = 0; j + 1 < ny; ++j) {
    for (std::size_t i = 0; i + 1 < nx; ++i) {
      const Index pore = pore_at(i, j);
      n.pore_centre.push_back({x0 + (static_cast<Real>(i) + 0.5) * pitch_x, y0 + (static_cast<Real>(j) + 0.5) * pitch_y, 0});
      n.pore_volume.push_back(volume);
      n.pore_opening_x.push_back(w_x);
      n.pore_opening_y.push_back(w_y);
      n.pore_throat.push_back(w_x * w_y / (w_x + w_y));
      n.pore_area.push_back(pitch_x * pitch_y);
      for (std::size_t a = 0; a < 2; ++a) {
        for (std::size_t b = 0; b < 2; ++b) {
          n.edges.push_back({warp_segment(i + a, j + b), pore, EdgeKind::segment_pore});
          n.edges.push_back({weft_segment(i + a, j + b), pore, EdgeKind::segment_pore});
        }
      }
      if (i > 0) n.edges.push_back({pore_at(i - 1, j), pore, EdgeKind::pore_pore});
      if (j > 0) n.edges.push_back({pore_at(i, j - 1), pore, EdgeKind::pore_pore});
    }
  }
  return n;
}

inline YarnNetwork shirting(std::size_t count, const YarnType& yarn) {
  return plain_weave(count, count, 1.0 / 3000, 1.0 / 2800, yarn, yarn);
}
inline YarnNetwork paper_sheet(std::size_t count, const YarnType& yarn) {
  return plain_weave(count, count, 1e-3, 1e-3, yarn, yarn);
}

// Neither vapour nor sorption nor swelling.
inline WettingParams transport_only() {
  WettingParams p;
  p.evaporation = false;
  p.sorption = SorptionModel::none;
  p.swelling = false;
  return p;
}

inline Real total_kg(const WettingModel& m, const Contents& c) {
  return total_sorbed_kg(m, c) + total_yarn_kg(m, c) + total_pore_kg(m, c);
}

inline Real released_kg(const WettingReport& report) {
  Real sum = 0;
  for (const auto& r : report.released) sum += r.kg;
  return sum;
}

}  // namespace imbibe::testing
