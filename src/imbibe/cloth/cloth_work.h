// What a step of a sheet keeps between its parts: caches that follow from the sheet, and work space.
#pragma once

#include "imbibe/cloth/cloth_step.h"
#include "imbibe/cloth/elastic.h"
#include "imbibe/cloth/self_contact.h"

namespace imbibe {

struct ClothScratch::Work {
  bool built = false;
  std::uint64_t topology_key = 0;
  SheetTopology topology;
  std::vector<std::size_t> first_triangle;  // of each node in node_triangles; size + 1 entries
  std::vector<Index> node_triangles;
  std::vector<Real> node_area;              // m2 of cloth

  ElasticWork elastic;
  std::vector<Real> inverse_mass;           // 1/kg, 0 for pinned nodes
  std::vector<Vec3> held;                   // N s given to pinned nodes in a substep
  std::vector<Vec3> push;                   // m/s, changes of velocity in push_cloth
  std::vector<Vec3> normal;                 // of the nodes, unit
  std::vector<Real> clearance;              // m, node-major by solid: how far it may move unseen
  SelfContact self;

  void build(const Sheet& sheet);
  void prepare(const Sheet& sheet, const ClothParams& params);
  void update_normals(const Sheet& sheet);
};

}  // namespace imbibe
