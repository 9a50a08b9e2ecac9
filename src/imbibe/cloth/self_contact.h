// A sheet against itself.
//
// 1. Near pairs (close_pair.h) are listed from a grid of triangle boxes, with room for each node to move: the list holds
//    while no node has moved, relative to the sheet's mean motion, further than its room.
// 2. Repulsion: pairs nearer than the cloth's thickness do not come nearer, those farther not nearer than it; impulses
//    along the gap, Coulomb friction across it, and the pull of liquid bridges (Sheet::cling) against parting.
// 3. Swept: the substep's motion of every near pair is tested; what would meet is stopped by further impulses, and what
//    is still going to meet after some rounds moves as one (zones). So a sheet that starts without crossings has none
//    after any substep.
// Sources: Bridson, Fedkiw & Anderson, SIGGRAPH 2002 (repulsion, impulses, zones); Curtis et al., I3D 2008 (each node and
// edge tested by one of its triangles).
// Impulses are equal and opposite; they are given one after the other in the order of the list: the same bits for any
// number of threads.
// Tested in tests/cloth/self_contact_test.cpp: a fold thrown shut at 20 m/s, brute-force crossings.
#pragma once

#include <vector>

#include "imbibe/cloth/close_pair.h"
#include "imbibe/cloth/impulse.h"
#include "imbibe/cloth/sheet.h"
#include "imbibe/geometry/bounds.h"

namespace imbibe {

// Which triangle tests which node and edge; built once for a topology.
struct SelfOwners {
  std::vector<std::array<Index, 2>> edges;
  struct Owned {
    std::array<Index, 3> node{no_index, no_index, no_index};  // nodes of the sheet
    std::array<Index, 3> edge{no_index, no_index, no_index};  // in edges
  };
  std::vector<Owned> of_triangle;
  Real shortest_edge = 0;  // m, material
};
SelfOwners make_owners(const Sheet& sheet);

struct SelfContact {
  SelfOwners owners;
  std::vector<ClosePair> pairs;
  std::vector<Real> room;  // m each node may move before the list is made anew; empty: there is no list
  std::vector<Real> moved; // m since
  Real thickness = 0;  // m, for which it was made

  std::size_t touching = 0;  // pairs of `hits` nearer than their thickness
  std::vector<Vec3> position;  // at the end of the last step: the list serves the next one if nothing was changed since

  // Work space.
  std::vector<std::vector<ClosePair>> tile_pairs;
  std::vector<Bounds> box;
  std::vector<std::array<std::int32_t, 3>> cell;
  std::vector<std::uint32_t> bucket_start, bucket_triangle;
  std::vector<Vec3> normal;
  std::vector<std::uint8_t> active;
  std::vector<PairGap> gap;
  std::vector<Index> hits, zone;
};

struct SelfContactRules {
  Real thickness = 0;     // m
  Real friction = 0;
  const Real* cling = nullptr;  // Pa per node
  const Real* area = nullptr;   // m2 per node
};

// Pairs that may come nearer than the thickness while no node moves further than contact.room.
void list_near_pairs(const Sheet& sheet, Real thickness, SelfContact& contact);

// Makes the list anew if a node would leave its room in h at the velocities of `nodes` as they are.
void reserve_near_pairs(const Sheet& sheet, const NodeMotion& nodes, Real thickness, Real h, SelfContact& contact);
// Books the motion of a substep.
void note_motion(const Sheet& sheet, const NodeMotion& nodes, Real h, SelfContact& contact);

// Lists in `hits` the pairs that may come nearer than their thickness in h, with their gaps.
void find_near_pairs(const SelfContactRules& rules, const NodeMotion& nodes, Real h, SelfContact& contact);
// One pass of impulses over them; `pull_part` of the bridges' pull is used.
void repel_near_pairs(const SelfContactRules& rules, const NodeMotion& nodes, Real h, Real pull_part,
                      SelfContact& contact);

struct SweptReport {
  std::size_t hits = 0;        // crossings prevented
  std::size_t zones = 0;       // rounds in which nodes had to move as one
  std::size_t unresolved = 0;  // pairs that pins of different motion force through each other
};
SweptReport prevent_crossings(const Sheet& sheet, const NodeMotion& nodes, Real h, SelfContact& contact);

}  // namespace imbibe
