#include "imbibe/cloth/elastic.h"

#include <algorithm>

#include "imbibe/core/parallel.h"

namespace imbibe {
namespace {

constexpr std::size_t tile = 1024;
constexpr Real shear_weight = 0.25;  // an angle of four times a strain shows as little (1 deg against 0.5 %)

// Calls solve(piece, material) for every piece, colour by colour; what it returns is kept as the greatest of each tile.
template <class Piece, class Solve>
void pass(const PieceList<Piece>& list, const std::vector<PieceMaterial>& materials, std::vector<Real>& tile_error,
          Solve&& solve) {
  for (std::size_t c = 0; c + 1 < list.colours.size(); ++c) {
    const std::size_t first = list.colours[c];
    parallel_tiles(list.colours[c + 1] - first, [&](std::size_t begin, std::size_t end) {
      Real greatest = tile_error[begin / tile];
      for (std::size_t k = first + begin; k < first + end; ++k) {
        greatest = std::max(greatest, solve(list.pieces[k], materials[k]));
      }
      tile_error[begin / tile] = greatest;
    }, tile);
  }
}

template <class Piece, class Dry>
void fill(const Sheet& sheet, const ClothParams& params, const std::vector<Piece>& pieces,
          std::vector<PieceMaterial>& materials, Dry&& dry_stiffness) {
  materials.resize(pieces.size());
  parallel_for(pieces.size(), [&](std::size_t k) {
    const Piece& piece = pieces[k];
    Real factor = 0, damping = 0;
    for (const Index i : piece.node) factor += sheet.stiffness_factor[i], damping += sheet.damping_added[i];
    constexpr Real share = 1.0 / std::tuple_size_v<decltype(piece.node)>;
    materials[k] = {dry_stiffness(piece) * factor * share, params.damping + damping * share};
  });
}

template <class Piece, class Energy>
Real energy_of(const std::vector<Piece>& pieces, const std::vector<PieceMaterial>& materials, Energy&& squared_strain) {
  return parallel_sum(pieces.size(), [&](std::size_t begin, std::size_t end) {
    Real sum = 0;
    for (std::size_t k = begin; k < end; ++k) sum += 0.5 * materials[k].stiffness * squared_strain(pieces[k]);
    return sum;
  });
}

}  // namespace

void update_materials(const Sheet& sheet, const SheetTopology& t, const ClothParams& params, ElasticMaterials& m) {
  const FabricHand& hand = params.hand;
  if (params.model == ClothModel::provot) {
    const ProvotParams& p = params.provot;
    const Real constants[]{p.structural, p.shear, p.flexion};
    fill(sheet, params, t.springs.pieces, m.springs, [&](const SpringPiece& s) {
      return constants[static_cast<std::size_t>(s.kind)] * s.rest * s.rest;
    });
  } else {
    const auto stretch = [&](const auto& s) { return s.area * (s.warp ? hand.stretch_warp : hand.stretch_weft); };
    const auto shear = [&](const auto& s) { return s.area * hand.shear; };
    const auto bend = [&](const auto& s) {
      return s.weft * hand.bending_weft + s.warp * hand.bending_warp + s.twisted * hand.twist;
    };
    fill(sheet, params, t.thread_stretch.pieces, m.thread_stretch, stretch);
    fill(sheet, params, t.triangle_stretch.pieces, m.triangle_stretch, stretch);
    fill(sheet, params, t.cell_shear.pieces, m.cell_shear, shear);
    fill(sheet, params, t.triangle_shear.pieces, m.triangle_shear, shear);
    fill(sheet, params, t.thread_bend.pieces, m.thread_bend, bend);
    fill(sheet, params, t.cell_bend.pieces, m.cell_bend, bend);
  }
  const std::size_t most = std::max({t.springs.pieces.size(), t.triangle_stretch.pieces.size(),
                                     t.cell_bend.pieces.size()});
  m.tile_error.resize(most / tile + 1);
}

ElasticErrors solve_elastic(const SheetTopology& t, ElasticMaterials& m, const ClothParams& params,
                            const NodeMotion& nodes, Real dt) {
  Real turn = 0;
  std::fill(m.tile_error.begin(), m.tile_error.end(), 0);
  const auto stretch = [&](const auto& piece, const PieceMaterial& material) {
    return solve_stretch(piece, nodes, material.stiffness, material.damping, dt);
  };
  const auto shear = [&](const auto& piece, const PieceMaterial& material) {
    return shear_weight * solve_shear(piece, nodes, material.stiffness, material.damping, dt);
  };
  const auto bend = [&](const auto& piece, const PieceMaterial& material) {
    solve_bend(piece, nodes, material.stiffness, material.damping, dt);
    return Real{0};
  };
  if (params.model == ClothModel::provot) {
    pass(t.springs, m.springs, m.tile_error, stretch);
    pass(t.springs, m.springs, m.tile_error, [&](const SpringPiece& piece, const PieceMaterial&) {
      if (piece.kind != SpringKind::flexion) correct_stretch(piece, nodes, params.provot.limit, dt);
      return Real{0};
    });
  } else {
    // The stiffest last: what is solved last holds best.
    solve_thread_bend(t.thread_bend, m.thread_bend, nodes, dt, m.thread_solve);
    pass(t.cell_bend, m.cell_bend, m.tile_error, bend);
    pass(t.cell_shear, m.cell_shear, m.tile_error, shear);
    pass(t.triangle_shear, m.triangle_shear, m.tile_error, shear);
    turn = solve_thread_stretch(t.thread_stretch, m.thread_stretch, nodes, dt, m.thread_solve);
    pass(t.triangle_stretch, m.triangle_stretch, m.tile_error, stretch);
  }
  return {*std::max_element(m.tile_error.begin(), m.tile_error.end()), turn};
}

Real stored_energy(const Sheet& sheet, const SheetTopology& t, const ElasticMaterials& m, const ClothParams& params) {
  const Vec3* x = sheet.position.data();
  const auto stretch = [&](const auto& piece) {
    const Real strain = norm(linear_form(x, piece.node, piece.weight)) - 1;
    return strain * strain;
  };
  if (params.model == ClothModel::provot) return energy_of(t.springs.pieces, m.springs, stretch);
  const auto shear = [&](const auto& piece) {
    const Real cosine = dot(normalized(linear_form(x, piece.node, piece.weft)),
                            normalized(linear_form(x, piece.node, piece.warp)));
    return cosine * cosine;
  };
  const auto bend = [&](const auto& piece) {
    return squared_norm(linear_form(x, piece.node, piece.weight));
  };
  return energy_of(t.thread_stretch.pieces, m.thread_stretch, stretch) + energy_of(t.triangle_stretch.pieces, m.triangle_stretch, stretch) +
         energy_of(t.cell_shear.pieces, m.cell_shear, shear) + energy_of(t.triangle_shear.pieces, m.triangle_shear, shear) +
         energy_of(t.thread_bend.pieces, m.thread_bend, bend) + energy_of(t.cell_bend.pieces, m.cell_bend, bend);
}

Real greatest_strain(const Sheet& sheet, const SheetTopology& t, const ClothParams& params) {
  const Vec3* x = sheet.position.data();
  const auto greatest = [&](const auto& pieces, auto&& counts) {
    return parallel_max(pieces.size(), Real{-1}, [&](std::size_t begin, std::size_t end) {
      Real most = -1;
      for (std::size_t k = begin; k < end; ++k) {
        const auto& piece = pieces[k];
        if (counts(piece)) most = std::max(most, norm(linear_form(x, piece.node, piece.weight)) - 1);
      }
      return most;
    });
  };
  if (params.model == ClothModel::provot) {
    return greatest(t.springs.pieces, [](const SpringPiece& s) { return s.kind == SpringKind::structural; });
  }
  const auto all = [](const auto&) { return true; };
  return std::max(greatest(t.thread_stretch.pieces, all), greatest(t.triangle_stretch.pieces, all));
}

}  // namespace imbibe
