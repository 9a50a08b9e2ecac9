#include "imbibe/cloth/self_contact.h"

#include "imbibe/cloth/liquid_bridge.h"
#include "imbibe/core/parallel.h"
#include "imbibe/core/union_find.h"

namespace imbibe {
namespace {

constexpr std::size_t pair_tile = 256;
constexpr Real leading_out_time = 0.02;  // s in which layers that are too near are led apart
constexpr int impulse_rounds = 8;        // then nodes move as one
constexpr int zone_rounds = 60;

std::array<Vec3, 4> places(const ClosePair& pair, const Vec3* x) {
  return {x[pair.node[0]], x[pair.node[1]], x[pair.node[2]], x[pair.node[3]]};
}
std::array<Vec3, 4> motions(const ClosePair& pair, const Vec3* v, Real h) {
  return {h * v[pair.node[0]], h * v[pair.node[1]], h * v[pair.node[2]], h * v[pair.node[3]]};
}

struct Contact {
  const ClosePair& pair;
  const PairGap& gap;
  const NodeMotion& nodes;

  Vec3 relative_velocity() const {
    Vec3 sum;
    for (std::size_t k = 0; k < 4; ++k) sum += gap.weight[k] * nodes.velocity[pair.node[k]];
    return sum;
  }
  Real mobility() const { return mobility_of(nodes, pair.node, gap.weight); }
  void give(const Vec3& impulse) const {
    for (std::size_t k = 0; k < 4; ++k) nodes.give(pair.node[k], gap.weight[k] * impulse);
  }
};

// Brings the relative velocity along the gap to at least `wanted`; friction by Coulomb's law, the bridges' pull (N s)
// against parting and as a load on the friction.
void push_apart(const Contact& contact, Real wanted, Real friction, Real pull) {
  const Real mobility = contact.mobility();
  if (!(mobility > 0)) return;
  const Vec3 relative = contact.relative_velocity();
  const Real along = dot(relative, contact.gap.normal);
  Real normal_impulse = (wanted - along) / mobility;
  if (normal_impulse < 0) normal_impulse = -std::min({pull, -normal_impulse, std::max(Real{0}, along) / mobility});
  const Vec3 sliding = relative - along * contact.gap.normal;
  const Real speed = norm(sliding);
  const Real pressing = std::max(Real{0}, normal_impulse) + pull;
  const Real stopped = speed > 0 ? std::min(1 / mobility, friction * pressing / speed) : 0;
  contact.give(normal_impulse * contact.gap.normal - stopped * sliding);
}

// Work of `body(pair index)` over all pairs at once; body writes its own entry of active.
template <class Body>
void mark_active(SelfContact& c, Body&& body) {
  c.active.resize(c.pairs.size()), c.gap.resize(c.pairs.size());
  parallel_for(c.pairs.size(), [&](std::size_t k) { c.active[k] = body(k) ? 1 : 0; }, pair_tile);
  c.hits.clear();
  for (std::size_t k = 0; k < c.pairs.size(); ++k) {
    if (c.active[k]) c.hits.push_back(static_cast<Index>(k));
  }
}

// The pairs whose motion in h meets; their gaps at that time.
void find_hits(SelfContact& c, const NodeMotion& nodes, Real h) {
  mark_active(c, [&](std::size_t k) {
    const auto gap = swept_gap(c.pairs[k].kind, places(c.pairs[k], nodes.position), motions(c.pairs[k], nodes.velocity, h));
    if (gap) c.gap[k] = *gap;
    return gap.has_value();
  });
}

// --- zones ----------------------------------------------------------------------------------------------------------

// The nodes of each zone take the zone's mean velocity, or that of its pins. False when pins of one zone part.
void move_zones(const Sheet& sheet, const NodeMotion& nodes, SelfContact& c) {
  struct Sum {
    Vec3 momentum{};
    Real mass = 0;
    Index pin = no_index;
    std::size_t count = 0;
  };
  std::vector<Sum> sums(sheet.size());
  for (Index i = 0; i < sheet.size(); ++i) {
    Sum& sum = sums[root_of(c.zone, i)];
    ++sum.count;
    if (nodes.inverse_mass[i] == 0) {
      if (sum.pin == no_index) sum.pin = i;
    } else {
      sum.momentum += nodes.velocity[i] / nodes.inverse_mass[i];
      sum.mass += 1 / nodes.inverse_mass[i];
    }
  }
  for (Index i = 0; i < sheet.size(); ++i) {
    const Sum& sum = sums[root_of(c.zone, i)];
    if (sum.count < 2 || nodes.inverse_mass[i] == 0) continue;
    const Vec3 common = sum.pin == no_index ? sum.momentum / sum.mass : nodes.velocity[sum.pin];
    if (sum.pin != no_index) nodes.held[sum.pin] += (nodes.velocity[i] - common) / nodes.inverse_mass[i];
    nodes.velocity[i] = common;
  }
}

}  // namespace

void find_near_pairs(const SelfContactRules& rules, const NodeMotion& nodes, Real h, SelfContact& c) {
  mark_active(c, [&](std::size_t k) {
    const ClosePair& pair = c.pairs[k];
    auto motion = motions(pair, nodes.velocity, h);
    c.gap[k] = gap_of(pair.kind, places(pair, nodes.position));
    const Real wet = rules.cling && rules.cling[pair.node[0]] > 0 ? bridge_length : 0;
    return c.gap[k].distance > 0 && c.gap[k].distance - approach_bound(pair.kind, motion) < pair.thickness + wet;
  });
  c.touching = 0;
  for (const Index k : c.hits) c.touching += c.gap[k].distance <= 1.05 * c.pairs[k].thickness ? 1 : 0;
}

void repel_near_pairs(const SelfContactRules& rules, const NodeMotion& nodes, Real h, Real pull_part, SelfContact& c) {
  for (const Index k : c.hits) {
    const ClosePair& pair = c.pairs[k];
    const Real room = c.gap[k].distance - pair.thickness;
    const Real wanted = room >= 0 ? -room / h : -room / leading_out_time;
    const bool bridged = rules.cling && pair.kind == PairKind::node_triangle && room < bridge_length;
    const Real pull = bridged ? pull_part * rules.cling[pair.node[0]] * rules.area[pair.node[0]] * h : 0;
    push_apart({pair, c.gap[k], nodes}, wanted, rules.friction, pull);
  }
}

SweptReport prevent_crossings(const Sheet& sheet, const NodeMotion& nodes, Real h, SelfContact& c) {
  SweptReport report;
  for (int round = 0; round < impulse_rounds; ++round) {
    find_hits(c, nodes, h);
    if (c.hits.empty()) return report;
    report.hits += c.hits.size();
    for (const Index k : c.hits) push_apart({c.pairs[k], c.gap[k], nodes}, 0, 0, 0);
  }
  find_hits(c, nodes, h);
  if (c.hits.empty()) return report;
  separate_all(c.zone, sheet.size());
  for (int round = 0; round < zone_rounds && !c.hits.empty(); ++round) {
    report.hits += c.hits.size();
    ++report.zones;
    for (const Index k : c.hits) {
      for (std::size_t j = 1; j < 4; ++j) unite(c.zone, c.pairs[k].node[0], c.pairs[k].node[j]);
    }
    move_zones(sheet, nodes, c);
    find_hits(c, nodes, h);
  }
  report.unresolved = c.hits.size();
  return report;
}

}  // namespace imbibe
