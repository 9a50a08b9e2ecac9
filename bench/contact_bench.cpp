// Swept contact of particles with yarns: half of the particles within two thicknesses of the sheet, half far above it.
#include "bench.h"
#include "imbibe/core/random.h"
#include "imbibe/coupling/contact.h"
#include "imbibe/liquid/kernel.h"
#include "imbibe/liquid/neighbours.h"
#include "textile_world.h"

namespace imbibe::bench {
namespace {

struct Rain {
  World world;
  ContactScratch scratch;
  std::vector<ParticleHit> hits;
};

// As many particles as segments and pores.
Rain rain_of(std::int64_t size) {
  Rain rain{cloth_world(size), {}, {}};
  const YarnNetwork& network = rain.world.textiles[0].fabric->network;
  Liquid& liquid = rain.world.liquid;
  for (Index k = 0; k < static_cast<Index>(size); ++k) {
    const auto random = [&](std::uint64_t stream) { return uniform({.seed = 3, .id = k}, stream); };
    const Real z = k % 2 == 0 ? 2 * network.thickness * random(2) : 5e-3 + 20e-3 * random(2);
    add_particle(liquid, {(random(0) - 0.5) * network.size_x, (random(1) - 0.5) * network.size_y, z},
                 {0.1 * random(3), 0.1 * random(4), -0.5 * random(5)});
  }
  Neighbours cells;  // a run asks for contact in this order
  sort_particles(cells, liquid.particles, kernel_for(liquid.spacing()));
  return rain;
}

void contact(benchmark::State& state, std::int64_t size, ContactForm form) {
  Rain& rain = shared_fixture<Rain>(size, [&] { return rain_of(size); });
  const Textile& textile = rain.world.textiles[0];
  const Particles& p = rain.world.liquid.particles;
  ContactParams params = textile.contact;
  params.form = form;
  ContactCounts counts;
  const auto pass = [&] {
    find_hits(*textile.yarn_boxes, textile.fabric->network, textile.placement, p.position, p.velocity, 2e-4, 0, params,
              rain.hits, rain.scratch, &counts);
  };
  pass();
  counts = {};
  for (auto _ : state) pass();
  const auto items = static_cast<double>(size), passes = static_cast<double>(state.iterations());
  report(state, {.items = items});
  report_extra(state, "hits", static_cast<double>(rain.hits.size()) / items);
  report_extra(state, "segment_boxes", static_cast<double>(counts.segment_boxes) / items / passes);
}

}  // namespace

void add_contact_benchmarks(const BenchOptions& options) {
  const auto passes = [](std::int64_t size) { return 1'000'000 / size + 1; };
  add_family(options, "contact/round", {10'000, 100'000, 1'000'000}, passes,
             [](benchmark::State& state, std::int64_t size) { contact(state, size, ContactForm::round); });
  add_family(options, "contact/triangles", {10'000, 100'000, 1'000'000}, passes,
             [](benchmark::State& state, std::int64_t size) { contact(state, size, ContactForm::triangles); });
}

}  // namespace imbibe::bench
