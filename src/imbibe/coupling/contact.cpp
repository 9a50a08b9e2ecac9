#include "imbibe/coupling/contact.h"

#include <algorithm>

#include "imbibe/core/error.h"
#include "imbibe/core/parallel.h"
#include "imbibe/geometry/curve.h"
#include "imbibe/geometry/sweep.h"

namespace imbibe {
namespace {

constexpr Real relative_slack = 1e-4;  // of yarn radius + reach: float positions cannot tell touching any better

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
    const Vec3 outward = cross(b - a, c - a);
    if (dot(outward, q.path.step) >= 0) return;
    // Then the plane: the path must come down to `reach` over it, and begin no deeper than that below it.
    const Real shell = reach * norm(outward), end_height = dot(end - a, outward), height = dot(q.path.from - a, outward);
    if (end_height > shell || height < -shell) return;
    Bounds box;
    box.include(a), box.include(b), box.include(c);
    if (!passes(box)) return;
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

namespace {

// What every query of a step has in common.
struct FirstHit {
  const YarnContactIndex& index;
  const YarnNetwork& network;
  Real particle_radius;
  const ContactParams& params;
  ContactCounts& counts;
  std::optional<YarnHit> operator()(const Vec3& p0, const Vec3& p1) const {
    return first_hit(index, network, p0, p1, particle_radius, params, &counts);
  }
};

std::optional<ParticleHit> hit_of_flat(const FirstHit& first, const ClothPlace& place, const Vec3& from, const Vec3& way) {
  const auto hit = first(place.to_sheet(from), place.to_sheet(from + way));
  if (!hit) return std::nullopt;
  ParticleHit found{no_index, *hit, hit->point};
  found.hit.point = place.to_world(hit->point);
  found.hit.normal = place.to_world(hit->normal) - place.to_world({});
  return found;
}

std::optional<ParticleHit> hit_of_bent(const FirstHit& first, const ClothPlace& place, const Vec3& from,
                                       const Vec3& velocity, Real step_s) {
  const ClothPlace::Frame frame = place.frame_near(from);
  if (!std::isfinite(frame.at.z)) return std::nullopt;
  const auto hit = first(frame.at, frame.at + frame.into_sheet(step_s * (velocity - frame.velocity)));
  if (!hit) return std::nullopt;
  ParticleHit found{no_index, *hit, hit->point};
  found.hit.point = from + frame.into_world(hit->point - frame.at);
  found.hit.normal = frame.into_world(hit->normal);
  return found;
}

}  // namespace

void find_hits(const YarnContactIndex& index, const YarnNetwork& network, const ClothPlace& place,
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
    const FirstHit q{index, network, particle_radius, params, scratch.counts[tile]};
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 v{velocity[i].x, velocity[i].y, velocity[i].z};
      const Vec3 from{position[i].x, position[i].y, position[i].z};
      const std::optional<ParticleHit> hit =
          place.is_flat() ? hit_of_flat(q, place, from, step_s * v) : hit_of_bent(q, place, from, v, step_s);
      if (!hit) continue;
      found.push_back(*hit);
      found.back().particle = static_cast<Index>(i);
    }
  });
  hits.clear();
  for (std::size_t t = 0; t < tiles; ++t) {
    hits.insert(hits.end(), scratch.tiles[t].begin(), scratch.tiles[t].end());
    if (counts) *counts += scratch.counts[t];
  }
}

}  // namespace imbibe
