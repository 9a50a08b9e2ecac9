#include "imbibe/cloth/thread_answer.h"

#include <algorithm>

#include "imbibe/cloth/cloth_work.h"
#include "imbibe/core/error.h"

namespace imbibe {

void ThreadAnswer::begin(const Sheet& sheet, const ClothParams& params, std::span<const Real> inverse_mass,
                         std::span<const Index> pushed, Real dt, ClothScratch& scratch) {
  dt_ = dt, inverse_mass_ = inverse_mass;
  edges_.clear(), nodes_.assign(pushed.begin(), pushed.end());
  first_.assign(1, 0), families_.assign(1, 0);
  if (pushed.empty() || params.model != ClothModel::xpbd || !sheet.is_grid()) return;
  pushed_.assign(sheet.size(), 0);
  for (const Index node : pushed) pushed_[node] = 1;
  const ClothScratch::Work& work = scratch.work();
  const auto& threads = work.topology.thread_stretch;
  const auto& materials = work.elastic.thread_stretch;
  IMBIBE_ASSERT(materials.size() == threads.pieces.size());
  const auto is_pushed = [&](std::size_t thread) {
    for (std::size_t e = threads.first[thread]; e < threads.first[thread + 1]; ++e)
      if (pushed_[threads.pieces[e].node[0]] != 0 || pushed_[threads.pieces[e].node[1]] != 0) return true;
    return false;
  };
  for (std::size_t f = 0; f + 1 < threads.families.size(); ++f) {
    for (std::size_t t = threads.families[f]; t < threads.families[f + 1]; ++t) {
      if (!is_pushed(t)) continue;
      for (std::size_t e = threads.first[t]; e < threads.first[t + 1]; ++e)
        add_edge(sheet, threads.pieces[e], materials[e], e == threads.first[t]);
      first_.push_back(edges_.size());
    }
    families_.push_back(first_.size() - 1);
  }
  std::sort(nodes_.begin(), nodes_.end());
  nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
}

// With its part of the factors of the thread's matrix.
void ThreadAnswer::add_edge(const Sheet& sheet, const StretchPiece<2>& piece, const PieceMaterial& m, bool starts_thread) {
  const auto [i, j] = piece.node;
  const Real b = piece.weight[1], wi = inverse_mass_[i], wj = inverse_mass_[j];
  const Vec3 way = sheet.position[j] - sheet.position[i];
  const Real length = norm(way);
  Edge edge{.node = piece.node, .softness = 1 / (dt_ * m.stiffness * (dt_ + m.damping))};
  if (length > 0) edge.pull = (b / length) * way;  // else it is folded to a point
  Real pivot = edge.softness + (wi + wj) * squared_norm(edge.pull);
  if (!starts_thread) {
    const Edge& before = edges_.back();
    const Real beside = -wi * dot(before.pull, edge.pull);
    edge.lower = beside * before.inverse_pivot;
    pivot -= beside * edge.lower;
  }
  edge.inverse_pivot = 1 / pivot;
  edges_.push_back(edge);
  nodes_.push_back(i), nodes_.push_back(j);
}

void ThreadAnswer::solve_family(std::size_t family, std::span<Vec3> velocity, std::span<Vec3> held) {
  const auto give = [&](Index node, const Vec3& impulse) {
    if (inverse_mass_[node] > 0) velocity[node] += inverse_mass_[node] * impulse;
    else if (!held.empty()) held[node] += impulse;
  };
  for (std::size_t t = families_[family]; t < families_[family + 1]; ++t) {
    const std::size_t begin = first_[t], end = first_[t + 1];
    Real before = 0;
    for (std::size_t e = begin; e < end; ++e) {
      Edge& edge = edges_[e];
      const Vec3 parting = velocity[edge.node[1]] - velocity[edge.node[0]];
      before = edge.side = dot(edge.pull, parting) - edge.softness * edge.impulse - edge.lower * before;
    }
    Real after = 0, lower_after = 0;
    for (std::size_t e = end; e-- > begin;) {
      Edge& edge = edges_[e];
      after = edge.side * edge.inverse_pivot - lower_after * after;
      lower_after = edge.lower;
      edge.impulse += after;
      give(edge.node[0], after * edge.pull);
      give(edge.node[1], -after * edge.pull);
    }
  }
}

void ThreadAnswer::resist(std::span<Vec3> velocity, std::span<Vec3> held) {
  if (edges_.empty()) return;
  for (Edge& edge : edges_) edge.impulse = 0;
  const std::size_t families = families_.size() - 1;
  for (std::size_t f = 0; f < families; ++f) solve_family(f, velocity, held);
  for (std::size_t f = families; f-- > 1;) solve_family(f - 1, velocity, held);
}

}  // namespace imbibe
