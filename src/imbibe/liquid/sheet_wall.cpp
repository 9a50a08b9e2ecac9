#include "imbibe/liquid/sheet_wall.h"

#include <algorithm>

namespace imbibe {

// All loops are serial: feet are few against particles, and the order of sums over a node's feet is fixed.

void SheetContacts::begin(std::span<SheetFoot* const> feet, std::span<SheetWall* const> walls, Real particle_mass, Real dt) {
  feet_.assign(feet.begin(), feet.end());
  walls_.assign(walls.begin(), walls.end());
  particle_mass_ = particle_mass;
  first_node_.clear(), velocity_.clear(), touched_.clear();
  for (std::size_t k = 0; k < walls_.size(); ++k) {
    const std::size_t first = velocity_.size();
    first_node_.push_back(first);
    const SheetWall* wall = walls_[k];
    if (wall == nullptr) continue;
    velocity_.insert(velocity_.end(), wall->velocity.begin(), wall->velocity.end());
    pushed_.clear();
    for (const SheetFoot* foot : feet_)
      if (foot->wall == k) pushed_.insert(pushed_.end(), foot->node.begin(), foot->node.end());
    std::sort(pushed_.begin(), pushed_.end());
    pushed_.erase(std::unique(pushed_.begin(), pushed_.end()), pushed_.end());
    std::span<const Index> answering = pushed_;
    if (wall->resistance != nullptr) {
      wall->resistance->begin(pushed_, dt);
      answering = wall->resistance->nodes();
    }
    for (const Index node : answering) touched_.push_back(first + node);
  }
  answer_.assign(velocity_.size(), Vec3{});
}

Vec3 SheetContacts::at(const SheetFoot& foot, const std::vector<Vec3>& nodal) const {
  Vec3 sum{};
  for (std::size_t c = 0; c < 3; ++c)
    sum += static_cast<Real>(foot.weight[c]) * nodal[first_node_[foot.wall] + foot.node[c]];
  return sum;
}

Real SheetContacts::inverse_mass(const SheetFoot& foot, std::size_t corner) const {
  return walls_[foot.wall]->inverse_mass[foot.node[corner]];
}

void SheetContacts::add_rate(std::vector<float>& rate, float scale) const {
  for (const SheetFoot* foot : feet_)
    rate[foot->particle] += scale * 2 * static_cast<float>(dot(at(*foot, velocity_), Vec3(foot->push)));
}

void SheetContacts::answer(std::span<const Float4> k) {
  for (const std::size_t n : touched_) answer_[n] = {};
  for (const SheetFoot* foot : feet_) {
    const Vec3 force = (particle_mass_ * 2 * static_cast<Real>(k[foot->particle].w)) * Vec3(foot->push);
    for (std::size_t c = 0; c < 3; ++c)
      answer_[first_node_[foot->wall] + foot->node[c]] += (static_cast<Real>(foot->weight[c]) * inverse_mass(*foot, c)) * force;
  }
  for (std::size_t wall = 0; wall < walls_.size(); ++wall)
    if (walls_[wall] != nullptr && walls_[wall]->resistance != nullptr)
      walls_[wall]->resistance->resist(std::span(answer_).subspan(first_node_[wall], walls_[wall]->velocity.size()));
}

void SheetContacts::add_answer(std::vector<float>& applied) const {
  for (const SheetFoot* foot : feet_)
    applied[foot->particle] += 2 * static_cast<float>(dot(at(*foot, answer_), Vec3(foot->push)));
}

void SheetContacts::advance(Real scale) {
  for (const std::size_t n : touched_) velocity_[n] += scale * answer_[n];
}

void SheetContacts::add_diagonal(std::vector<float>& factor) const {
  for (const SheetFoot* foot : feet_) {
    float& f = factor[foot->particle];
    if (f == 0) continue;
    Real sum = 0;
    for (std::size_t c = 0; c < 3; ++c)
      sum += static_cast<Real>(foot->weight[c]) * static_cast<Real>(foot->weight[c]) * inverse_mass(*foot, c);
    f = static_cast<float>(1 / (1 / static_cast<Real>(f) + 4 * particle_mass_ * sum * static_cast<Real>(squared_norm(foot->push))));
  }
}

void SheetContacts::book(std::span<const float> k, Real dt) {
  for (SheetFoot* foot : feet_) {
    const Real strength = particle_mass_ * dt * 2 * static_cast<Real>(k[foot->particle]);
    foot->impulse += strength * Vec3(foot->push);
    walls_[foot->wall]->pressing += strength * norm(Vec3(foot->push));
  }
}

}  // namespace imbibe
