#include "imbibe/cloth/elastic.h"

#include <algorithm>

#include "imbibe/cloth/shear.h"
#include "imbibe/core/parallel.h"

namespace imbibe {
namespace {

constexpr std::size_t tile = 1024;
constexpr Real shear_weight = 0.25;  // an angle of four times a strain shows as little (1 deg against 0.5 %)

// Calls solve(piece, its number, outcome of its tile) for every piece, colour by colour; adds the outcomes.
template <class Piece, class Solve>
PassOutcome pass(const PieceList<Piece>& list, std::vector<PassOutcome>& tiles, Solve&& solve) {
  PassOutcome all;
  for (std::size_t c = 0; c + 1 < list.colours.size(); ++c) {
    const std::size_t first = list.colours[c], count = list.colours[c + 1] - first;
    tiles.assign((count + tile - 1) / tile, {});
    parallel_tiles(count, [&](std::size_t begin, std::size_t end) {
      PassOutcome outcome;
      for (std::size_t k = first + begin; k < first + end; ++k) solve(list.pieces[k], k, outcome);
      outcome.solved = end - begin;
      tiles[begin / tile] = outcome;
    }, tile);
    for (const PassOutcome& outcome : tiles) all += outcome;
  }
  return all;
}

// The same for groups of neighbouring pieces, whose outcomes of the pass before say which of them are still to be solved;
// solve(first piece, how many, their first number, outcome).
template <std::size_t together, class Piece, class Solve>
PassOutcome pass(const PieceList<Piece>& list, const PassScope& scope, std::vector<PassOutcome>& groups, Solve&& solve) {
  constexpr std::size_t group = 32;
  std::size_t before = 0;
  for (std::size_t c = 0; c + 1 < list.colours.size(); ++c) {
    const std::size_t first = list.colours[c], count = list.colours[c + 1] - first, here = (count + group - 1) / group;
    groups.resize(std::max(groups.size(), before + here));
    parallel_for(here, [&](std::size_t g) {
      PassOutcome& outcome = groups[before + g];
      if (scope.skips(outcome)) {
        outcome.solved = 0;
        return;
      }
      outcome = {};
      const std::size_t begin = first + g * group, end = std::min(begin + group, first + count);
      for (std::size_t k = begin; k < end; k += together)
        solve(&list.pieces[k], std::min(together, end - k), k, outcome);
      outcome.solved = end - begin;
    }, tile / group);
    before += here;
  }
  PassOutcome all;
  for (std::size_t g = 0; g < before; ++g) all += groups[g];
  return all;
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

void update_materials(const Sheet& sheet, const SheetTopology& t, const ClothParams& params, ElasticWork& m) {
  const FabricHand& hand = params.hand;
  if (params.model == ClothModel::provot) {
    const ProvotParams& p = params.provot;
    const Real constants[]{p.structural, p.shear, p.flexion};
    const auto spring = [&](const SpringPiece& s) { return constants[static_cast<std::size_t>(s.kind)] * s.rest * s.rest; };
    fill(sheet, params, t.spring_threads.pieces, m.spring_threads, spring);
    fill(sheet, params, t.springs.pieces, m.springs, spring);
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
    fill(sheet, params, t.ring_bend.pieces, m.ring_bend, bend);
  }
}

void solve_bending(const SheetTopology& t, const ClothParams& params, const NodeMotion& nodes, Real dt,
                   ElasticWork& work) {
  if (params.model == ClothModel::provot) return;  // its flexion springs are springs
  solve_thread_bend(t.thread_bend, work.thread_bend, nodes, dt, work.threads);
  const auto bend = [&](const std::vector<PieceMaterial>& materials) {
    return [&, dt](const auto& piece, std::size_t k, PassOutcome&) {
      solve_bend(piece, nodes, materials[k].stiffness, materials[k].damping, dt);
    };
  };
  pass(t.cell_bend, work.tiles, bend(work.cell_bend));
  pass(t.ring_bend, work.tiles, bend(work.ring_bend));
}

void begin_in_plane(const SheetTopology& t, const ClothParams& params, ElasticWork& work) {
  if (params.model == ClothModel::provot) {
    work.given_stretch.assign(t.springs.pieces.size(), 0);
    begin_thread_stretch(t.spring_threads, work.threads);
    return;
  }
  work.given_stretch.assign(t.triangle_stretch.pieces.size(), 0);
  work.given_cell_shear.assign(t.cell_shear.pieces.size(), 0);
  work.given_triangle_shear.assign(t.triangle_shear.pieces.size(), 0);
  begin_thread_stretch(t.thread_stretch, work.threads);
}

InPlaneOutcome solve_in_plane(const SheetTopology& t, const ClothParams& params, const NodeMotion& nodes, Real dt,
                              const PassScope& scope, ElasticWork& work) {
  InPlaneOutcome all;
  const auto stretch = [&](const std::vector<PieceMaterial>& materials) {
    return [&, dt](const auto& piece, std::size_t k, PassOutcome& outcome) {
      const Real change = solve_stretch(piece, nodes, materials[k].stiffness, materials[k].damping, dt, work.given_stretch[k]);
      outcome.add(change, area_of(piece));
    };
  };
  if (params.model == ClothModel::provot) {
    // Lines of springs cross each other far more closely than threads: their changes count as those of relaxation.
    all.relaxed = pass(t.springs, work.tiles, stretch(work.springs));
    all.relaxed += solve_thread_stretch(t.spring_threads, work.spring_threads, nodes, dt, work.threads, scope);
    all.threads.turn = all.relaxed.turn;
    pass(t.springs, work.tiles, [&](const SpringPiece& piece, std::size_t, PassOutcome&) {
      if (piece.kind != SpringKind::flexion) correct_stretch(piece, nodes, params.provot.limit, dt);
    });
    correct_threads(t.spring_threads, nodes, params.provot.limit, dt, work.threads);
    const std::size_t springs = t.springs.pieces.size() + t.spring_threads.pieces.size();
    all.part = static_cast<Real>(all.relaxed.solved) / static_cast<Real>(springs);
    return all;
  }
  const auto shear = [&](const std::vector<PieceMaterial>& materials, std::vector<Real>& given) {
    return [&, dt](const auto* pieces, std::size_t count, std::size_t k, PassOutcome& outcome) {
      Reals changed;
      solve_shear(pieces, count, nodes, &materials[k], dt, &given[k], changed);
      for (std::size_t l = 0; l < count; ++l) outcome.add(shear_weight * changed[l], pieces[l].area);
    };
  };
  const auto stretch_alone = [&](const auto* piece, std::size_t, std::size_t k, PassOutcome& outcome) {
    stretch(work.triangle_stretch)(*piece, k, outcome);
  };
  // The stiffest last: what is solved last holds best.
  all.relaxed += pass<lanes>(t.cell_shear, scope, work.cell_shear_groups, shear(work.cell_shear, work.given_cell_shear));
  all.relaxed += pass<lanes>(t.triangle_shear, scope, work.triangle_shear_groups,
                                   shear(work.triangle_shear, work.given_triangle_shear));
  all.relaxed += pass<1>(t.triangle_stretch, scope, work.triangle_stretch_groups, stretch_alone);
  all.threads = solve_thread_stretch(t.thread_stretch, work.thread_stretch, nodes, dt, work.threads, scope);
  const std::size_t pieces = t.cell_shear.pieces.size() + t.triangle_shear.pieces.size() + t.triangle_stretch.pieces.size() +
                             t.thread_stretch.pieces.size();
  all.part = static_cast<Real>(all.relaxed.solved + all.threads.solved) / static_cast<Real>(pieces);
  return all;
}

Real stored_energy(const Sheet& sheet, const SheetTopology& t, const ElasticWork& m, const ClothParams& params) {
  const Vec3* x = sheet.position.data();
  const auto stretch = [&](const auto& piece) {
    const Real strain = norm(linear_form(x, piece.node, piece.weight)) - 1;
    return strain * strain;
  };
  if (params.model == ClothModel::provot)
    return energy_of(t.spring_threads.pieces, m.spring_threads, stretch) + energy_of(t.springs.pieces, m.springs, stretch);
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
         energy_of(t.thread_bend.pieces, m.thread_bend, bend) + energy_of(t.cell_bend.pieces, m.cell_bend, bend) +
         energy_of(t.ring_bend.pieces, m.ring_bend, bend);
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
    const auto structural = [](const SpringPiece& s) { return s.kind == SpringKind::structural; };
    return std::max(greatest(t.spring_threads.pieces, structural), greatest(t.springs.pieces, structural));
  }
  const auto all = [](const auto&) { return true; };
  return std::max(greatest(t.thread_stretch.pieces, all), greatest(t.triangle_stretch.pieces, all));
}

}  // namespace imbibe
