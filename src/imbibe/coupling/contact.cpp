#include "imbibe/coupling/contact.h"

#include <algorithm>

#include "imbibe/core/error.h"
#include "imbibe/core/parallel.h"
#include "imbibe/geometry/curve.h"
#include "imbibe/geometry/sweep.h"

namespace imbibe {
namespace {

constexpr std::size_t fan = 8;        // boxes under one box of a yarn's tree
constexpr Real relative_slack = 1e-4;  // of yarn radius + reach: float positions cannot tell touching any better

// --- a yarn's boxes -------------------------------------------------------------------------------------------------

std::size_t boxes_above(std::size_t segments) {
  std::size_t total = segments;
  for (std::size_t level = segments; level > 1;) total += level = (level + fan - 1) / fan;
  return total;
}

SmallBox outward(const Bounds& b) {
  const auto down = [](Real v) { return std::nextafterf(static_cast<float>(v), -std::numeric_limits<float>::infinity()); };
  const auto up = [](Real v) { return std::nextafterf(static_cast<float>(v), std::numeric_limits<float>::infinity()); };
  return {{down(b.lower.x), down(b.lower.y), down(b.lower.z)}, {up(b.upper.x), up(b.upper.y), up(b.upper.z)}};
}

Bounds wide(const SmallBox& b) { return {Vec3(b.lower), Vec3(b.upper)}; }

SmallBox joined(std::span<const SmallBox> boxes) {
  SmallBox all = boxes[0];
  for (const SmallBox& b : boxes.subspan(1)) {
    all.lower = {std::min(all.lower.x, b.lower.x), std::min(all.lower.y, b.lower.y), std::min(all.lower.z, b.lower.z)};
    all.upper = {std::max(all.upper.x, b.upper.x), std::max(all.upper.y, b.upper.y), std::max(all.upper.z, b.upper.z)};
  }
  return all;
}

Real radius_of_yarn(const YarnNetwork& network, Index yarn) {
  return network.yarn_types[network.yarn_type[yarn]].radius;
}

// The centre-line points of a segment: points_per_segment + 1 of them.
std::span<const Vec3> points_of_segment(const YarnNetwork& network, Index yarn, Index segment) {
  const auto steps = static_cast<std::size_t>(network.points_per_segment);
  const std::size_t first = network.yarn_first_point[yarn] + steps * (segment - network.yarn_first_segment[yarn]);
  return {network.points.data() + first, steps + 1};
}

void fit_yarn(YarnContactIndex& index, const YarnNetwork& network, Index yarn) {
  const Index first = network.yarn_first_segment[yarn], last = network.yarn_first_segment[yarn + 1];
  const Real radius = radius_of_yarn(network, yarn);
  SmallBox* box = index.boxes.data() + index.yarn_first_box[yarn];
  for (Index s = first; s < last; ++s) {
    Bounds bounds;
    for (const Vec3& p : points_of_segment(network, yarn, s)) bounds.include(p);
    bounds.grow(radius);
    *box++ = outward(bounds);
  }
  for (std::size_t count = last - first; count > 1;) {
    const SmallBox* below = box - count;
    const std::size_t parents = (count + fan - 1) / fan;
    for (std::size_t p = 0; p < parents; ++p) {
      *box++ = joined({below + p * fan, std::min(fan, count - p * fan)});
    }
    count = parents;
  }
}

// Calls visit(segment) for the segments of a yarn whose boxes pass; test(box) returns the path's entry time or
// infinity, boxes entered after `latest` are passed over. Earliest boxes first.
template <class Test, class Visit>
void visit_segments(const YarnContactIndex& index, const YarnNetwork& network, Index yarn, const Real& latest,
                    std::uint64_t& tested, Test&& test, Visit&& visit) {
  struct Entry { std::size_t level, place; Real time; };
  std::array<std::size_t, 16> level_begin{}, level_size{};
  std::size_t levels = 0;
  std::size_t begin = index.yarn_first_box[yarn];
  for (std::size_t n = network.yarn_first_segment[yarn + 1] - network.yarn_first_segment[yarn];;) {
    level_begin[levels] = begin, level_size[levels++] = n;
    if (n <= 1) break;
    begin += n;
    n = (n + fan - 1) / fan;
  }
  std::array<Entry, 16 * fan> stack;
  std::size_t depth = 0;
  stack[depth++] = {levels - 1, 0, 0};  // the yarn's own box was tested by the caller
  while (depth > 0) {
    const Entry entry = stack[--depth];
    if (entry.time > latest) continue;
    if (entry.level == 0) {
      visit(static_cast<Index>(network.yarn_first_segment[yarn] + entry.place));
      continue;
    }
    const std::size_t below = entry.level - 1, base = depth;
    const std::size_t end = std::min((entry.place + 1) * fan, level_size[below]);
    for (std::size_t child = entry.place * fan; child < end; ++child) {
      ++tested;
      const Real time = test(wide(index.boxes[level_begin[below] + child]));
      if (time > latest) continue;
      std::size_t at = depth++;  // insertion: the latest lies deepest in the stack
      for (; at > base && stack[at - 1].time < time; --at) stack[at] = stack[at - 1];
      stack[at] = {below, child, time};
    }
  }
}

// --- the two forms of a yarn's surface -------------------------------------------------------------------------------

// The nearest point of a yarn's surface as seen from p.
struct Gap {
  Real distance = std::numeric_limits<Real>::infinity();  // m, < 0 inside the yarn
  Vec3 point{}, normal{};
  Index segment = no_index;
};

struct Path {
  Vec3 from, step;
  Vec3 at(Real t) const { return from + t * step; }
};

Vec3 plane_normal_of(const YarnNetwork& network, Index yarn) {
  return network.yarn_family[yarn] == Family::weft ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
}

// A unit normal where rounding leaves none: against the path, or else up.
Vec3 fallback_normal(const Path& path) {
  return squared_norm(path.step) > 0 ? -normalized(path.step) : Vec3{0, 0, 1};
}

void nearest_round(const YarnNetwork& network, Index yarn, Index segment, const Path& path, Gap& gap,
                   ContactCounts& counts) {
  const Real radius = radius_of_yarn(network, yarn);
  const auto points = points_of_segment(network, yarn, segment);
  const CurvePoint near = closest_on_curve(points, path.from);
  counts.pieces += points.size() - 1;
  const Real away = std::sqrt(near.squared_distance), distance = away - radius;
  if (distance >= gap.distance) return;
  const Vec3 normal = away > 1e-9 * radius ? (path.from - near.point) / away : fallback_normal(path);
  gap = {distance, near.point + radius * normal, normal, segment};
}

// The triangles between the rings of two neighbouring centre-line points.
template <class Visit>
void visit_tube_triangles(const std::array<Vec3, tube_sides>& ring, const std::array<Vec3, tube_sides>& next,
                          Visit&& visit) {
  for (std::size_t k = 0; k < tube_sides; ++k) {
    const std::size_t l = (k + 1) % tube_sides;
    visit(ring[k], ring[l], next[l]);
    visit(ring[k], next[l], next[k]);
  }
}

Vec3 ring_centre(const std::array<Vec3, tube_sides>& ring) {
  Vec3 sum{};
  for (const Vec3& corner : ring) sum += corner;
  return sum / static_cast<Real>(tube_sides);
}

// The two ends of a yarn are closed by a fan.
template <class Visit>
void visit_cap(const std::array<Vec3, tube_sides>& ring, bool at_start, Visit&& visit) {
  const Vec3 centre = ring_centre(ring);
  for (std::size_t k = 0; k < tube_sides; ++k) {
    const Vec3 &a = ring[k], &b = ring[(k + 1) % tube_sides];
    at_start ? visit(centre, b, a) : visit(centre, a, b);
  }
}

// Calls visit(a, b, c) for the triangles of the pieces of a segment's tube whose boxes pass.
template <class Test, class Visit>
void visit_segment_triangles(const YarnNetwork& network, Index yarn, Index segment, Test&& test, Visit&& visit) {
  const Real radius = radius_of_yarn(network, yarn);
  const Index first = network.yarn_first_point[yarn], last = network.yarn_first_point[yarn + 1] - 1;
  const auto points = points_of_segment(network, yarn, segment);
  const Index begin = static_cast<Index>(points.data() - network.points.data());
  std::array<Vec3, tube_sides> ring, next;
  bool have_ring = false;
  for (Index i = begin; i + 1 < begin + points.size(); ++i) {
    Bounds bounds;
    bounds.include(network.points[i]);
    bounds.include(network.points[i + 1]);
    bounds.grow(radius);
    if (!test(bounds)) {
      have_ring = false;
      continue;
    }
    if (!have_ring) ring = tube_ring(network, yarn, i);
    next = tube_ring(network, yarn, i + 1);
    if (i == first) visit_cap(ring, true, visit);
    visit_tube_triangles(ring, next, visit);
    if (i + 1 == last) visit_cap(next, false, visit);
    ring = next, have_ring = true;
  }
}

void nearest_triangles(const YarnNetwork& network, Index yarn, Index segment, const Path& path, Real reach, Gap& gap,
                       ContactCounts& counts) {
  const Vec3& p = path.from;
  const auto near_enough = [&](const Bounds& b) { return squared_distance(b, p) <= reach * reach; };
  visit_segment_triangles(network, yarn, segment, near_enough, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    ++counts.triangles;
    const Vec3 point = closest_on_triangle(p, a, b, c).point;
    const Vec3 face = normalized(cross(b - a, c - a));
    const Vec3 away = p - point;
    const Real length = norm(away);
    // The tube is convex across the yarn, so any triangle that holds the nearest point tells inside from outside.
    const Real distance = dot(away, face) < 0 ? -length : length;
    if (std::abs(distance) >= std::abs(gap.distance)) return;
    const Vec3 normal = length > 1e-9 * norm(b - a) ? away / distance : face;
    gap = {distance, point, normal, segment};
  });
}

// --- one yarn ---------------------------------------------------------------------------------------------------------

// The best hit so far and what decides between hits at the same time.
struct BestHit {
  YarnHit hit;
  Real latest = 1;  // time fraction
  Real gap = std::numeric_limits<Real>::infinity();
  bool found = false;

  void offer(const YarnHit& other, Real gap_now) {
    if (found && !comes_first(other, gap_now)) return;
    hit = other, latest = other.time_fraction, gap = gap_now, found = true;
  }
  bool comes_first(const YarnHit& other, Real other_gap) const {
    if (other.time_fraction != hit.time_fraction) return other.time_fraction < hit.time_fraction;
    if (other.resting != hit.resting) return !other.resting;
    if (other_gap != gap) return other_gap < gap;
    return other.segment < hit.segment;
  }
};

struct Query {
  const YarnContactIndex& index;
  const YarnNetwork& network;
  const ContactParams& params;
  Path path;
  Real reach;
  ContactCounts& counts;
};

Gap gap_at_start(const Query& q, Index yarn, Real limit) {
  Gap gap;
  const Real never = std::numeric_limits<Real>::infinity(), latest = 0;
  visit_segments(
      q.index, q.network, yarn, latest, q.counts.segment_boxes,
      [&](const Bounds& b) { return squared_distance(b, q.path.from) <= limit * limit ? 0 : never; },
      [&](Index segment) {
        if (q.params.form == ContactForm::round) nearest_round(q.network, yarn, segment, q.path, gap, q.counts);
        else nearest_triangles(q.network, yarn, segment, q.path, limit, gap, q.counts);
      });
  return gap;
}

void sweep_round(const Query& q, Index yarn, Index segment, Real reach, BestHit& best) {
  const Real radius = radius_of_yarn(q.network, yarn);
  const auto points = points_of_segment(q.network, yarn, segment);
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    Bounds bounds;
    bounds.include(points[i]);
    bounds.include(points[i + 1]);
    if (entry_time(bounds, q.path.from, q.path.step, radius + reach, best.latest) > best.latest) continue;
    ++q.counts.pieces;
    const auto span = cross_capsule(q.path.from, q.path.step, points[i], points[i + 1], radius + reach);
    if (!span || span->leave < 0 || span->enter > best.latest) continue;
    const Real t = std::max(Real(0), span->enter);
    const Vec3 axis_point = closest_on_segment(q.path.at(t), points[i], points[i + 1]).point;
    const Vec3 away = q.path.at(t) - axis_point;
    if (dot(away, q.path.step) >= 0) continue;  // only grazes, or leaves
    const Vec3 normal = normalized(away);
    best.offer({segment, t, axis_point + radius * normal, normal, false}, norm(away) - radius);
  }
}

void sweep_triangles(const Query& q, Index yarn, Index segment, Real reach, BestHit& best) {
  const auto passes = [&](const Bounds& b) {
    return entry_time(b, q.path.from, q.path.step, reach, best.latest) <= best.latest;
  };
  const Vec3 end = q.path.at(1);
  visit_segment_triangles(q.network, yarn, segment, passes, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    ++q.counts.triangles;
    // Direction first (seed A). At a convex edge one of its two triangles faces the particle.
    if (dot(cross(b - a, c - a), q.path.step) >= 0) return;
    const auto swept = sweep_triangle(q.path.from, end, reach, a, b, c);
    if (!swept || swept->time_fraction > best.latest || dot(swept->normal, q.path.step) >= 0) return;
    const Vec3 at = q.path.at(swept->time_fraction);
    const Vec3 point = closest_on_triangle(at, a, b, c).point;
    best.offer({segment, swept->time_fraction, point, swept->normal, false}, norm(at - point));
  });
}

void hit_yarn(const Query& q, Index yarn, BestHit& best) {
  const Real radius = radius_of_yarn(q.network, yarn);
  const Real slack = relative_slack * (radius + q.reach);
  const SmallBox& whole = q.index.boxes[q.index.yarn_first_box[yarn + 1] - 1];
  Real reach = q.reach;
  if (squared_distance(wide(whole), q.path.from) <= (q.reach + slack) * (q.reach + slack)) {
    const Gap gap = gap_at_start(q, yarn, q.reach + slack);
    if (gap.distance <= q.reach + slack) {
      const Real towards = -dot(gap.normal, q.path.step), parallel = q.params.parallel_cosine * norm(q.path.step);
      if (towards >= -parallel) {
        best.offer({gap.segment, 0, gap.point, gap.normal, towards <= parallel}, gap.distance);
        return;
      }
      // Moving away: the rest of this yarn counts only where the particle would come nearer than it is now.
      reach = std::min(reach, gap.distance - slack);
      if (q.params.form == ContactForm::triangles) reach = std::max(reach, Real(0));
      reach = std::max(reach, -radius);
    }
  }
  visit_segments(
      q.index, q.network, yarn, best.latest, q.counts.segment_boxes,
      [&](const Bounds& b) {
        return entry_time(b, q.path.from, q.path.step, std::max(reach, Real(0)), best.latest);
      },
      [&](Index segment) {
        if (q.params.form == ContactForm::round) sweep_round(q, yarn, segment, reach, best);
        else sweep_triangles(q, yarn, segment, reach, best);
      });
}

}  // namespace

ContactCounts& ContactCounts::operator+=(const ContactCounts& o) {
  textile_boxes += o.textile_boxes, yarn_boxes += o.yarn_boxes, segment_boxes += o.segment_boxes;
  pieces += o.pieces, triangles += o.triangles;
  return *this;
}

YarnContactIndex build_contact_index(const YarnNetwork& network) {
  YarnContactIndex index;
  const std::size_t yarns = network.yarn_family.size();
  index.yarn_first_box.resize(yarns + 1);
  for (Index y = 0; y < yarns; ++y) {
    const std::size_t segments = network.yarn_first_segment[y + 1] - network.yarn_first_segment[y];
    IMBIBE_ASSERT(segments > 0);
    index.yarn_first_box[y + 1] = index.yarn_first_box[y] + boxes_above(segments);
    index.members[static_cast<std::size_t>(network.yarn_family[y])].push_back(y);
  }
  index.boxes.resize(index.yarn_first_box[yarns]);
  refit(index, network);
  return index;
}

void refit(YarnContactIndex& index, const YarnNetwork& network) {
  const std::size_t yarns = network.yarn_family.size();
  parallel_for(yarns, [&](std::size_t y) { fit_yarn(index, network, static_cast<Index>(y)); }, 16);
  index.textile = {};
  for (std::size_t f = 0; f < 2; ++f) {
    std::vector<Bounds> boxes;
    for (const Index y : index.members[f]) boxes.push_back(wide(index.boxes[index.yarn_first_box[y + 1] - 1]));
    if (index.yarns[f].order.size() == boxes.size()) refit(index.yarns[f], boxes);
    else index.yarns[f] = build_hierarchy(boxes, 1);
    if (!boxes.empty()) index.textile.include(index.yarns[f].nodes[0].bounds);
  }
}

std::optional<YarnHit> first_hit(const YarnContactIndex& index, const YarnNetwork& network, const Vec3& p0,
                                 const Vec3& p1, Real particle_radius, const ContactParams& params,
                                 ContactCounts* counts) {
  ContactCounts local;
  const Query q{index, network, params, {p0, p1 - p0}, particle_radius, local};
  BestHit best;
  // A touching particle may lie outside the boxes by the slack; no yarn is thicker than the textile's box.
  const Vec3 size = index.textile.size();
  const Real margin = particle_radius + relative_slack * (particle_radius + std::min({size.x, size.y, size.z}));
  ++local.textile_boxes;
  if (!index.textile.empty() && entry_time(index.textile, p0, q.path.step, margin, 1) <= 1) {
    for (std::size_t f = 0; f < 2; ++f) {
      QueryCounts boxes;
      visit_swept(index.yarns[f], p0, q.path.step, margin, best.latest, boxes,
                  [&](Index member) { hit_yarn(q, index.members[f][member], best); });
      local.yarn_boxes += boxes.boxes;
    }
  }
  if (counts) *counts += local;
  if (!best.found) return std::nullopt;
  return best.hit;
}

void find_hits(const YarnContactIndex& index, const YarnNetwork& network, const Placement& placement,
               std::span<const Float4> position, std::span<const Float4> velocity, Real step_s, Real particle_radius,
               const ContactParams& params, std::vector<ParticleHit>& hits, ContactScratch& scratch,
               ContactCounts* counts) {
  IMBIBE_ASSERT(position.size() == velocity.size());
  const std::size_t tiles = (position.size() + default_tile - 1) / default_tile;
  if (scratch.tiles.size() < tiles) scratch.tiles.resize(tiles);
  scratch.counts.assign(tiles, {});
  parallel_tiles(position.size(), [&](std::size_t begin, std::size_t end) {
    const std::size_t tile = begin / default_tile;
    std::vector<ParticleHit>& found = scratch.tiles[tile];
    found.clear();
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 v{velocity[i].x, velocity[i].y, velocity[i].z};
      const Vec3 from{position[i].x, position[i].y, position[i].z};
      auto hit = first_hit(index, network, placement.to_sheet(from), placement.to_sheet(from + step_s * v),
                           particle_radius, params, &scratch.counts[tile]);
      if (!hit) continue;
      hit->point = placement.to_world(hit->point);
      hit->normal = placement.to_world(hit->normal) - placement.origin;
      found.push_back({static_cast<Index>(i), *hit});
    }
  });
  hits.clear();
  for (std::size_t t = 0; t < tiles; ++t) {
    hits.insert(hits.end(), scratch.tiles[t].begin(), scratch.tiles[t].end());
    if (counts) *counts += scratch.counts[t];
  }
}

std::array<Vec3, tube_sides> tube_ring(const YarnNetwork& network, Index yarn, Index point) {
  const Index first = network.yarn_first_point[yarn], last = network.yarn_first_point[yarn + 1];
  const std::span<const Vec3> points(network.points.data() + first, last - first);
  const CrossFrame frame = frame_beside(tangent_at(points, point - first), plane_normal_of(network, yarn));
  const Real radius = radius_of_yarn(network, yarn);
  std::array<Vec3, tube_sides> ring;
  for (int k = 0; k < tube_sides; ++k) {
    const Real angle = 2 * pi * k / tube_sides;
    ring[static_cast<std::size_t>(k)] =
        network.points[point] + radius * (std::cos(angle) * frame.side + std::sin(angle) * frame.up);
  }
  return ring;
}

Real mesh_deviation(const YarnNetwork& network) {
  Real largest = 0;
  for (Index y = 0; y < network.yarn_family.size(); ++y) {
    // Between corners a chord lies inside the circle. At a bend of the centre line the ring stands across the mean
    // direction, so it is narrower by the cosine of half the bend seen along either piece.
    Real least_cosine = 1;
    for (Index i = network.yarn_first_point[y] + 1; i + 1 < network.yarn_first_point[y + 1]; ++i) {
      const Vec3 before = network.points[i] - network.points[i - 1], after = network.points[i + 1] - network.points[i];
      least_cosine = std::min(least_cosine, dot(normalized(before), normalized(after)));
    }
    const Real narrower = std::sqrt((1 + least_cosine) / 2) * std::cos(pi / tube_sides);
    largest = std::max(largest, radius_of_yarn(network, y) * (1 - narrower));
  }
  return largest;
}

Bounce bounce(const Vec3& velocity, const Vec3& normal, Real mass, Real restitution, Real friction) {
  const Real approach = -dot(velocity, normal);
  if (approach <= 0) return {velocity, {}};
  const Real normal_change = (1 + restitution) * approach;
  const Vec3 tangential = velocity + approach * normal;
  const Real slip = norm(tangential);
  const Real taken = std::min(friction * normal_change, slip);  // friction stops, it never turns round
  Vec3 after = velocity + normal_change * normal;
  if (slip > 0) after -= (taken / slip) * tangential;
  return {after, mass * (velocity - after)};
}

Bounce rest(const Vec3& velocity, Real mass) { return {{}, mass * velocity}; }

}  // namespace imbibe
