// The woven structure as a network: yarn segments and pores are nodes; ways for liquid between them are edges.
// Pure geometry and dry materials: nothing here knows about liquid. Built by fabric/fabric.h; read by wetting,
// coupling, io and view.
//
// Sheet coordinates: weft yarns run along x, warp yarns along y, the face is +z, the mid-plane is z = 0 and the
// sheet's centre is the origin. `Placement` (below) puts the sheet into the world.
// Node numbers: segments 0 .. segments-1 (yarn by yarn, in order along the yarn), then pores. A sheet of several layers
// (layers.h) has those of its upper layer first, both among the segments and among the pores.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "imbibe/core/types.h"
#include "imbibe/fabric/fibre.h"

namespace imbibe {

enum class Family : std::uint8_t { warp = 0, weft = 1 };

// One kind of yarn, as laid into the cloth.
struct YarnType {
  Fibre fibre;
  Real radius = 0;           // m, r_f of the drawn yarn
  Real packing = 1;          // fibre share of the yarn's cross-section, phi_y; 1 = monofilament
  Real linear_density = 0;   // kg/m, conditioned dry mass per length of yarn
  bool monofilament = false; // true: no capillary water between fibres
  Real tortuosity_squared = 4;      // tau^2 of the yarn's permeability, trials 2-10
  Real absorption_coefficient = 0;  // kg/(m2 s^0.5), A_w for the Kuenzel form; 0 = the fibre's
  Vector3<float> colour{0.93f, 0.91f, 0.86f};  // linear RGB when dry
  Real void_share() const { return 1 - packing; }  // eps_y
};

enum class EdgeKind : std::uint8_t {
  along_yarn,    // segment - next segment of the same yarn
  crossing,      // warp segment - weft segment that touch at a crossing
  segment_pore,  // segment - pore beside it
  pore_pore,     // neighbouring pores in the plane, over a yarn; or facing pores of two layers
  face_back,     // segments of two layers whose crowns touch
};

// Node numbers stay below 2^29, so that an edge is 8 bytes.
inline constexpr std::size_t most_network_nodes = std::size_t{1} << 29;
struct Edge {
  Edge() = default;
  Edge(Index from, Index to, EdgeKind of) : a(from), b(to), kind(of) {}
  Index a = 0;
  Index b : 29 = 0;
  EdgeKind kind : 3 = EdgeKind::along_yarn;
};

// Where the crowns of two layers touch: the area within which their gap is below h is area_per_height (h - gap).
struct FaceContact {
  Real gap = 0;              // m, least distance of the two surfaces
  Real area_per_height = 0;  // m
};

// Position and attitude of the flat sheet in the world: world = origin + x*u + y*v + z*n.
struct Placement {
  Vec3 origin{};
  Vec3 u{1, 0, 0}, v{0, 1, 0}, n{0, 0, 1};
  Vec3 to_world(const Vec3& p) const { return origin + p.x * u + p.y * v + p.z * n; }
  Vec3 to_sheet(const Vec3& w) const { const Vec3 d = w - origin; return {dot(d, u), dot(d, v), dot(d, n)}; }
};

struct YarnNetwork {
  // Sheet
  Real size_x = 0, size_y = 0;    // m
  Real thickness = 0;             // m, of all layers; of one: t, default 2 (r_warp + r_weft)
  int layers = 1;                 // lying on each other, the first uppermost
  Real layer_gap = 0;             // m, between the slabs of two layers
  Real pitch_x = 0, pitch_y = 0;  // m, mean distance of neighbouring warp yarns (along x) and weft yarns (along y)
  std::vector<YarnType> yarn_types;

  // Yarns
  std::vector<Family> yarn_family;
  std::vector<Index> yarn_type;
  std::vector<Index> yarn_first_segment;  // size yarns + 1; segments of yarn y: [first[y], first[y+1])
  std::vector<Index> yarn_first_point;    // size yarns + 1; centre-line points of yarn y in `points`
  std::vector<Vec3> points;               // crimped centre lines; `points_per_segment` steps per segment
  int points_per_segment = 8;             // yarn with n segments has n*points_per_segment + 1 points

  // Segments: half loops centred on crossings
  std::vector<Index> segment_yarn;
  std::vector<Vec3> segment_centre;
  std::vector<Real> segment_length;       // m, arc length

  // Pores: between four crossings
  std::vector<Vec3> pore_centre;
  std::vector<Real> pore_volume;          // m3, cell minus its yarns; > 0
  std::vector<Real> pore_opening_x, pore_opening_y;  // m, free widths w = pitch - 2r between the yarns
  std::vector<Real> pore_throat;          // m, r_t = w_x w_y / (w_x + w_y)
  std::vector<Real> pore_area;            // m2, projected cell area p_x p_y that belongs to the pore

  std::vector<Edge> edges;
  std::vector<FaceContact> face_contacts;  // of the edges face_back, which are the last ones, in their order

  std::size_t segments() const { return segment_yarn.size(); }
  std::size_t pores() const { return pore_centre.size(); }
  std::size_t nodes() const { return segments() + pores(); }
  bool is_pore(std::size_t node) const { return node >= segments(); }
  const YarnType& type_of_segment(std::size_t s) const { return yarn_types[yarn_type[segment_yarn[s]]]; }
  Family family_of_segment(std::size_t s) const { return yarn_family[segment_yarn[s]]; }
  Real layer_thickness() const { return (thickness - (layers - 1) * layer_gap) / layers; }  // m, t of one layer
  // m, the mid-plane of a layer.
  Real layer_height(int layer) const {
    return (0.5 * (layers - 1) - layer) * (layer_thickness() + layer_gap);
  }
  int layer_of(std::size_t node) const {
    const std::size_t per_layer = (is_pore(node) ? pores() : segments()) / static_cast<std::size_t>(layers);
    return layers == 1 ? 0 : static_cast<int>((is_pore(node) ? node - segments() : node) / per_layer);
  }
  // Whether liquid on the upper (z > 0) or lower face of the sheet touches the node.
  bool on_face(std::size_t node, bool upper) const { return layer_of(node) == (upper ? 0 : layers - 1); }
  const Vec3& node_centre(std::size_t node) const {
    return is_pore(node) ? pore_centre[node - segments()] : segment_centre[node];
  }
};

}  // namespace imbibe
