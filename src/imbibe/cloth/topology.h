// What holds a sheet together, derived from its triangles and material coordinates: the pieces that the two models put
// stiffness on. Every list is ordered by colour: pieces of one colour share no node, so they may be solved at the same
// time, and the colours one after the other give the same bits for any number of threads.
//
// A grid is measured along its threads: stretch is that of the edges of whole threads, bending is the second difference
// of three nodes along a thread. A free-form mesh is measured triangle by triangle (the deformation gradient is constant
// there) and bends at its inner nodes, by the cotangent Laplacian of the places: |Laplacian| is the curvature of bent cloth,
// whose curvature is in one direction; its stiffness there is the mean of weft and warp. Energies of edges' folding angles
// were tried first: what they give depends on the pattern of the mesh (3 times too much on a jittered grid).
//
// Sources: deformation gradient of a triangle, Baraff & Witkin, SIGGRAPH 1998, section 4; bending as a square of linear
// forms, Bergou et al., SGP 2006; cotangent Laplacian, Meyer et al., VisMath 2002, section 3.
// Tested in tests/cloth/topology_test.cpp: energies of homogeneous strains and of a cylinder, on grids and meshes.
#pragma once

#include <vector>

#include "imbibe/cloth/sheet.h"

namespace imbibe {

// First entries of the colours, and the end.
using Colours = std::vector<std::size_t>;

// F = sum weight x [1] is the stretched thread per its length at rest; energy = K area (|F| - 1)^2 / 2.
template <std::size_t N>
struct StretchPiece {
  std::array<Index, N> node{};
  std::array<Real, N> weight{};  // 1/m, sum zero
  Real area = 0;                 // m2 of cloth it stands for
  bool warp = false;             // else weft
};

// Angle between the directions of weft and warp; energy = G area (angle)^2 / 2.
template <std::size_t N>
struct ShearPiece {
  std::array<Index, N> node{};
  std::array<Real, N> weft{}, warp{};  // 1/m
  Real area = 0;
};

// s = sum weight x [m]; energy = (B_weft weft + B_warp warp + twist twisted) |s|^2 / 2.
template <std::size_t N>
struct BendPiece {
  std::array<Index, N> node{};
  std::array<Real, N> weight{};  // 1
  Real weft = 0, warp = 0, twisted = 0;  // 1/m2
};

// A node and its neighbours, the rest filled up with the node itself at weight 0. A node with more neighbours carries no
// bending.
inline constexpr std::size_t ring_nodes = 12;

// A spring between two nodes, as Provot's model has them; F as in StretchPiece, energy = k rest^2 (|F| - 1)^2 / 2.
enum class SpringKind : std::uint8_t { structural, shear, flexion };
struct SpringPiece {
  std::array<Index, 2> node{};
  std::array<Real, 2> weight{};  // 1/m
  Real rest = 0;                 // m
  SpringKind kind = SpringKind::structural;
};
SpringPiece make_spring(Index a, Index b, Real rest, SpringKind kind);

// What a piece counts in averages over the cloth; springs of one sheet count alike.
inline Real area_of(const SpringPiece&) { return 1; }
template <std::size_t N>
Real area_of(const StretchPiece<N>& piece) {
  return piece.area;
}

template <class Piece>
struct PieceList {
  std::vector<Piece> pieces;
  Colours colours{0};
};

// Pieces along lines of nodes of a grid, those of a line one after the other. Lines of one family share no node: weft threads,
// then warp threads; of springs flexion, shear and structural ones in this order (the stiffest last), each along both ways.
template <class Piece>
struct ThreadList {
  std::vector<Piece> pieces;
  std::vector<std::size_t> first{0};     // piece of each thread, and the end
  std::vector<std::size_t> families{0};  // thread of each family, and the end
  std::size_t size() const { return first.size() - 1; }
};

struct SheetTopology {
  ThreadList<StretchPiece<2>> thread_stretch;   // grids
  ThreadList<BendPiece<3>> thread_bend;         // grids
  PieceList<StretchPiece<3>> triangle_stretch;  // meshes
  PieceList<ShearPiece<4>> cell_shear;          // grids
  PieceList<ShearPiece<3>> triangle_shear;      // meshes
  PieceList<BendPiece<4>> cell_bend;            // grids: twist
  PieceList<BendPiece<ring_nodes>> ring_bend;   // meshes
  ThreadList<SpringPiece> spring_threads;       // grids
  PieceList<SpringPiece> springs;               // meshes
  Real shortest_edge = 0;                       // m, in the material
};

SheetTopology make_topology(const Sheet& sheet);

}  // namespace imbibe
