// What flows now over every link, from every supply and to the faces: the laws of along_yarn.h, crossing.h, capillary.h
// and entry.h applied to the solved set of transport.h. Each value comes with its slopes for Newton's method.
// Tested through transport.h in tests/wetting/network_test.cpp.
#pragma once

#include "imbibe/core/portable.h"
#include "imbibe/wetting/transport.h"

namespace imbibe {

inline constexpr Real driest_wall = 1e-4;  // saturation whose corners wet the walls of a dry pore enough to begin
inline constexpr std::size_t transport_tile = 1024;

// The potential of a yarn's links at pressure p: Psi, or Kuenzel's Phi at the saturation the yarn would have.
struct YarnPotential {
  TransportModel model;
  Real entry, size_index;
  Sloped operator()(Real p) const {
    if (model == TransportModel::physical) return kirchhoff_potential(entry, size_index, p);
    if (p >= -entry) return {kunzel_potential(1).value, 0};
    const Real s = portable::pow(entry / -p, size_index);
    const Sloped phi = kunzel_potential(s);
    return {phi.value, phi.slope * size_index * s / -p};
  }
};

// Gives a node a saturation, and the pressure that it has there.
void set_saturation(const WettingModel& model, TransportWorkspace& work, std::size_t local, Real saturation);
// What a node gives off to its faces now, m3/s and per saturation.
Sloped release_law(const WettingModel& model, const TransportWorkspace& work, std::size_t local);
// Potentials of the nodes at their saturations.
void evaluate_nodes(const WettingModel& model, TransportWorkspace& work);
// Of a link between local nodes a and b in this step: its conductance now (the share of a pore's walls that is wetted,
// D_ww, a bridge's area), and P_e of the curve that its potential follows.
Real link_factor(const WettingModel& model, const TransportWorkspace& work, const LinkKind& link, Index a, Index b);
Real link_entry(const WettingModel& model, const TransportWorkspace& work, const LinkKind& link, Index a, Index b);
// Flows of the links; needs the nodes.
void evaluate_links(const WettingModel& model, TransportWorkspace& work);
// Flows from the faces, no more than is available; needs the nodes.
void evaluate_supplies(const TransportInput& input, TransportWorkspace& work);

}  // namespace imbibe
