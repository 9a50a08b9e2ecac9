// Contact of moving particles with yarns: which segment a particle meets first on its path of the next step.
//
// Boxes in the order textile -> (groups of) yarns -> yarn -> (groups of) segments -> segment -> triangles of its tube;
// a parent's box is made of its children's corners (seed A section 4). Only the segments' boxes hold geometry. On a soft
// sheet they stay as woven: the particle is carried into the flat cloth instead (embedding.h).
//
// The rules of seed A section 5.1, with d the particle's path p0 -> p1 and n the outward normal where it is nearest:
//   distance   contact begins where the particle's centre is `particle_radius` from the yarn's surface
//   projection the nearest point lies on the triangle, or on an edge or corner of it: the slabs over two triangles leave
//              a wedge between them at every convex edge, through which a centre would get nearer than the threshold
//   direction  d.n > 0 moves away: none; d.n < 0 moves towards: contact; |d.n| <= parallel_cosine |d|: rests by friction
//   path       the whole path is swept, never only its ends: nothing tunnels at any speed or step
// A yarn is one body. A particle that touches it already and moves away meets it again only where it would come nearer
// than it is now (a bend further on).
//
// Two forms of the surface: `round`, the round curve itself (all points nearer than the radius to the centre line; a
// half ball at each yarn end), and `triangles`, the tube mesh on the same centre line with `tube_sides` corners per
// ring, made on demand. The mesh lies inside the round yarn by at most mesh_deviation(); both forms give the same
// answer within it.
// Everything is in sheet coordinates (network.h) unless said otherwise.
// Tested in tests/coupling/contact_test.cpp.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "imbibe/core/parameter.h"
#include "imbibe/core/types.h"
#include "imbibe/coupling/bounce.h"
#include "imbibe/coupling/contact_index.h"
#include "imbibe/coupling/embedding.h"
#include "imbibe/coupling/yarn_tube.h"
#include "imbibe/fabric/network.h"
#include "imbibe/liquid/particles.h"

namespace imbibe {

enum class ContactForm { round, triangles };

struct ContactParams {
  ContactForm form = ContactForm::round;
  Real parallel_cosine = 1e-3;  // 1, |cos| of path and normal below which a touching particle rests
  Real restitution = 1;         // 1, e: share of the normal speed that a bounce keeps; 1 = specular
  Real friction = 0;            // 1, mu: Coulomb's coefficient of a bounce
};

template <class V>
void describe(V& v, ContactParams& p) {
  v.choice("form", p.form, Choices<ContactForm>{{"round", ContactForm::round}, {"triangles", ContactForm::triangles}},
           "surface that particles meet: the round yarn itself, or its triangle mesh");
  v.value("parallel_cosine", p.parallel_cosine,
          {.min = 0, .max = 0.1, .help = "a touching particle whose path is this parallel to the yarn rests on it"});
  v.value("restitution", p.restitution, {.min = 0, .max = 1, .help = "share of the normal speed kept by a bounce"});
  v.value("friction", p.friction, {.min = 0, .max = 10, .help = "Coulomb friction of a bounce"});
}

// --- queries ----------------------------------------------------------------------------------------------------------

// What queries cost, level by level. Boxes of groups count at the level below them.
struct ContactCounts {
  std::uint64_t textile_boxes = 0, yarn_boxes = 0, segment_boxes = 0;
  std::uint64_t pieces = 0;     // round: straight pieces of centre lines tested
  std::uint64_t triangles = 0;  // triangles: of tubes, tested
  ContactCounts& operator+=(const ContactCounts& o);
};

struct YarnHit {
  Index segment = no_index;
  Real time_fraction = 0;  // of the path p0 -> p1; 0 when it touches at the start
  Vec3 point{};            // on the yarn's surface
  Vec3 normal{};           // unit, out of the yarn
  bool resting = false;    // touches and moves along the surface
};

// The first contact on the path p0 -> p1 of a particle; of several at one time a real approach before a rest, then the
// deepest, then the lowest segment. nullopt: none.
std::optional<YarnHit> first_hit(const YarnContactIndex& index, const YarnNetwork& network, const Vec3& p0,
                                 const Vec3& p1, Real particle_radius, const ContactParams& params = {},
                                 ContactCounts* counts = nullptr);

struct ParticleHit {
  Index particle = no_index;
  YarnHit hit;  // point and normal in world coordinates
  Vec3 sheet_point{};  // the point in sheet coordinates
};

// Reused between steps, so that a step allocates nothing once warm.
struct ContactScratch {
  std::vector<std::vector<ParticleHit>> tiles;
  std::vector<ContactCounts> counts;
};

// The first hits of all particles that move by velocity * step_s, in rising particle order: the same for any number of
// threads. A particle far from the sheet costs one box test.
// On a sheet that moves the way is the one relative to it.
void find_hits(const YarnContactIndex& index, const YarnNetwork& network, const ClothPlace& place,
               std::span<const Float4> position, std::span<const Float4> velocity, Real step_s, Real particle_radius,
               const ContactParams& params, std::vector<ParticleHit>& hits, ContactScratch& scratch,
               ContactCounts* counts = nullptr);

}  // namespace imbibe
