// Closed forms of hanging, vibrating and bending cloth. Lengths in m.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "imbibe/cloth/cloth_step.h"
#include "imbibe/verify/heavy_elastica.h"
#include "imbibe/verify/zero_crossings.h"

namespace imbibe {
namespace {

using verify::ZeroCrossings;

constexpr Real gravity = 9.81;

FabricHand inextensible() {
  FabricHand hand;
  hand.areal_mass = 0.2;
  hand.stretch_weft = hand.stretch_warp = 1e6;
  hand.shear = 100;
  hand.bending_weft = hand.bending_warp = 1e-9;
  hand.twist = 1e-10;
  return hand;
}

ClothParams quiet_params(const FabricHand& hand) {
  ClothParams params;
  params.hand = hand;
  params.damping = 0;
  params.air.density = 0;
  params.contact.self = false;
  return params;
}

// A narrow strip, its length along u, two nodes wide.
Sheet strip(Real length, Index columns, const Vec3& along, const Vec3& across, Real areal_mass = 0.2) {
  return make_sheet(GridSheet{.along_u = along, .along_v = across, .width = length, .height = 0.02, .columns = columns,
                              .rows = 2, .areal_mass = areal_mass});
}

void pin_ends(Sheet& sheet, bool both) {
  pin_nodes(sheet, nodes_of_edge(sheet, "left"));
  if (both) pin_nodes(sheet, nodes_of_edge(sheet, "right"));
}

void settle(Sheet& sheet, ClothParams params, Real time) {
  params.air.density = 20;  // brings it to rest; has no part in the shape of rest
  params.air.normal_drag = params.air.tangential_drag = 5;
  ClothScratch scratch;
  for (Real t = 0; t < time; t += 5e-3) {
    params.air.density = t < 0.7 * time ? 20 : 200;
    step_cloth(sheet, params, {.measure = false}, 5e-3, scratch);
  }
}

// Span 1, length 1.2: sag .292344 (PHYSICS 3.15). The strip starts as a V.
Real catenary_sag(Index columns) {
  Sheet sheet = strip(1.2, columns, {1, 0, 0}, {0, 1, 0});
  const Real depth = std::sqrt(0.6 * 0.6 - 0.5 * 0.5);
  for (std::size_t i = 0; i < sheet.size(); ++i) {
    const Real u = sheet.u[i], part = u < 0.6 ? u / 0.6 : (1.2 - u) / 0.6;
    sheet.position[i] = {u / 1.2, sheet.v[i], -depth * part};
  }
  pin_ends(sheet, true);
  settle(sheet, quiet_params(inextensible()), 4);
  Real lowest = 0;
  for (const Vec3& x : sheet.position) lowest = std::min(lowest, x.z);
  return -lowest;
}

TEST(ClothClosedForms, a_strip_between_two_supports_hangs_as_a_catenary) {
  const Real sag = catenary_sag(61);
  EXPECT_NEAR(sag, 0.292344, 0.01 * 0.292344);  // the bound
  RecordProperty("sag_m", std::to_string(sag));
}

TEST(ClothClosedForms, twice_as_many_nodes_change_the_sag_by_less_than_two_per_cent) {
  const Real coarse = catenary_sag(31), fine = catenary_sag(61);
  EXPECT_NEAR(coarse / fine, 1, 0.02);
}

// f = sqrt(T/mu)/(2 L): a strip of elastic cloth stretched by 2 %, no weight.
Real string_frequency(Real added_part) {
  FabricHand hand = inextensible();
  hand.stretch_weft = hand.stretch_warp = 200;
  Sheet sheet = strip(1, 41, {1, 0, 0}, {0, 1, 0});
  const Real stretch = 1.02;
  for (std::size_t i = 0; i < sheet.size(); ++i) {
    sheet.position[i].x = stretch * sheet.u[i];
    sheet.position[i].z = 2e-3 * std::sin(pi * sheet.u[i]);
    sheet.added_mass[i] = added_part * sheet.dry_mass[i];
  }
  pin_ends(sheet, true);
  for (Pin& pin : sheet.pins) pin.anchor.z = 0, sheet.position[pin.node].z = 0;
  ClothParams params = quiet_params(hand);
  ClothScratch scratch;
  ZeroCrossings zero;
  for (int k = 0; k < 3000; ++k) {
    step_cloth(sheet, params, {.gravity = {}, .measure = false}, 1e-3, scratch);
    zero.add(sheet.time, sheet.position[20].z);
  }
  return zero.frequency();
}

TEST(ClothClosedForms, a_stretched_strip_vibrates_as_a_string) {
  // Tension 200 N/m x 2 %; mass per length at rest 0.2 kg/m2 over 1.02 m of length. Amplitude 0.2 %: 1e-4 of tension.
  const Real tension = 200 * 0.02, density = 0.2 / 1.02;
  const Real expected = std::sqrt(tension / density) / (2 * 1.02);
  EXPECT_NEAR(string_frequency(0), expected, 0.01 * expected);
}

TEST(ClothClosedForms, water_in_the_cloth_lowers_the_frequency_by_the_root_of_the_masses) {
  for (const Real part : {0.5, 2.0}) {
    const Real ratio = string_frequency(part) / string_frequency(0);
    EXPECT_NEAR(ratio, std::sqrt(1 / (1 + part)), 0.01 * std::sqrt(1 / (1 + part)));
  }
}

TEST(ClothClosedForms, a_hanging_strip_swings_as_a_hanging_chain) {
  // f_1 = j01/(4 pi) sqrt(g/L), mode J0(j01 sqrt(s/L)) with s from the free end.
  const Real length = 1, j01 = 2.404825557695773;
  Sheet sheet = strip(length, 51, {0, 0, -1}, {0, 1, 0});
  for (std::size_t i = 0; i < sheet.size(); ++i) {
    sheet.position[i].x = 0.005 * std::cyl_bessel_j(0, j01 * std::sqrt((length - sheet.u[i]) / length));
  }
  for (const Index node : nodes_of_edge(sheet, "left")) sheet.position[node].x = 0;
  pin_ends(sheet, false);
  const ClothParams params = quiet_params(inextensible());
  ClothScratch scratch;
  ZeroCrossings zero;
  for (int k = 0; k < 1600; ++k) {
    step_cloth(sheet, params, {.measure = false}, 5e-3, scratch);
    zero.add(sheet.time, sheet.position[50].x);
  }
  const Real expected = j01 / (4 * pi) * std::sqrt(gravity / length);
  EXPECT_NEAR(zero.frequency(), expected, 0.01 * expected);
}

// --- cantilever -----------------------------------------------------------------------------------------------------

TEST(ClothClosedForms, a_cantilever_strip_droops_as_the_heavy_elastica) {
  // The clamp holds the first two columns: the cloth is free from the middle between them on.
  FabricHand hand = inextensible();
  hand.stretch_weft = hand.stretch_warp = 1e4;
  hand.bending_weft = hand.bending_warp = 2e-5;
  for (const Real free_length : {0.04, 0.08}) {
    const Index columns = 42;
    const Real length = free_length / (1 - 0.5 / (columns - 1)), edge = length / (columns - 1);
    Sheet sheet = strip(length, columns, {1, 0, 0}, {0, 1, 0});
    pin_ends(sheet, false);
    pin_nodes(sheet, std::vector<Index>{1, columns + 1});
    ClothParams params = quiet_params(hand);
    params.strain_error = 1e-3;
    settle(sheet, params, 1.2);
    const verify::ElasticaTip tip = verify::heavy_elastica(free_length, 0.2 * gravity / 2e-5);
    const Vec3 end = sheet.position[columns - 1];
    EXPECT_NEAR(-end.z, tip.drop, 0.03 * tip.drop) << "length " << free_length;
    EXPECT_NEAR(end.x - 0.5 * edge, tip.reach, 0.03 * free_length) << "length " << free_length;
  }
}

}  // namespace
}  // namespace imbibe
