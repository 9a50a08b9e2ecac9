// The whole simulation as one plain, copyable value: snapshot = copy, test = compare. Immutable parts are shared.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "imbibe/core/types.h"
#include "imbibe/coupling/cell_cloth.h"
#include "imbibe/coupling/contact.h"
#include "imbibe/coupling/exchange_state.h"
#include "imbibe/coupling/face_map.h"
#include "imbibe/coupling/network_cloth.h"
#include "imbibe/coupling/reservoir.h"
#include "imbibe/fabric/fabric.h"
#include "imbibe/geometry/shapes.h"
#include "imbibe/liquid/liquid_step.h"
#include "imbibe/liquid/particles.h"
#include "imbibe/liquid/source.h"
#include "imbibe/liquid/wall.h"
#include "imbibe/wetting/contents.h"
#include "imbibe/wetting/wetting_step.h"

namespace imbibe {

struct SolidBody {
  std::string name;
  Shape shape;
  WallMaterial material;
  Vec3f colour{0.55f, 0.55f, 0.58f};
};

// Something that is drawn and touches nothing (a pipe).
struct Prop {
  std::string name;
  TriangleMesh mesh;
  Vec3f colour{0.45f, 0.46f, 0.48f};
};

struct Textile {
  std::string name;
  std::shared_ptr<const Fabric> fabric;       // geometry and dry materials
  std::shared_ptr<const WettingModel> model;  // conductances and capacities for this fabric and liquid
  Placement placement;
  std::shared_ptr<const FaceMap> faces;       // nodes by place, for the exchange with liquid on the faces
  std::shared_ptr<const YarnContactIndex> yarn_boxes;  // for the swept contact of particles with yarns
  ContactParams contact;
  std::vector<Reservoir> reservoirs;
  Contents contents;
  ExchangeState exchange;
  std::optional<NetworkCloth> cloth;          // a soft sheet that the network rides on; `placement`: where it was flat
};

// How the two clocks go together: SPH steps (1e-5 - 1e-3 s) run inside textile steps, and stop while the liquid rests.
struct Pace {
  Real wetting_interval = 2e-3;  // s, the textile step that the network suggests; followed where no liquid moves
  Real since_wetting = 0;        // s of liquid motion since the last textile step
  bool resting = false;          // true: the free liquid is at rest and makes no SPH steps
  // The shape that the liquid has kept since `calm_since` (world time, s; < 0: none yet).
  Real calm_since = -1;
  Vec3 calm_centre{};            // m
  Vec3 calm_extent{};            // m, root mean square distance from the centre along x, y, z
  Vec3 calm_velocity{};          // m/s, mean velocity at calm_since
  std::uint64_t particles_at_rest = 0;  // particles there were when it came to rest
};

// How well the liquid kept its density, over the SPH steps since the start. Errors are relative, at the start of a step.
struct DensityRecord {
  std::uint64_t steps = 0;    // SPH steps
  Real sum_of_means = 0;      // of each step's mean |error| over the particles
  Real worst_mean = 0;        // the largest of these means
  Real sum_of_compressions = 0;  // of each step's mean compression (LiquidStepReport::compression)
  Real worst_mean_compression = 0;
  Real worst_particle = 0;    // the largest compression of one particle
  Real mean() const { return steps > 0 ? sum_of_means / static_cast<Real>(steps) : 0; }
  Real mean_compression() const { return steps > 0 ? sum_of_compressions / static_cast<Real>(steps) : 0; }
};

// Where all the liquid is, kg. free + sorbed + yarn + pore + cell + waiting - owed + evaporated + left
// = initial + supplied.
struct Ledger {
  Real initial_kg = 0;     // sorbed and other water in the textiles at the start
  Real supplied_kg = 0;    // by sources and reservoirs, less what reservoirs took back
  Real evaporated_kg = 0;  // to the air; negative when the fibres took vapour up on balance
  Real left_kg = 0;        // particles that left the domain
};

struct World {
  Real time = 0;            // s
  std::uint64_t step = 0;
  std::uint64_t seed = 1;
  Vec3 gravity{0, 0, -9.81};
  Air air;
  Liquid liquid;
  LiquidParams liquid_params;
  std::vector<Source> sources;
  std::vector<Textile> textiles;
  std::vector<CellCloth> cell_cloths;  // seed B: cloths whose nodes are cells of liquid
  std::vector<SolidBody> solids;
  std::vector<Prop> props;
  Ledger ledger;
  Pace pace;
  DensityRecord density;
  Bounds domain;            // a particle outside is removed and counted in left_kg
};

// Whether any cloth is a soft sheet (or a fixed one of cells).
bool any_soft_sheet(const World& world);

// The masses of series.csv at one instant, kg (docs/run_folder.md). Sums in fixed order.
struct MassBalance {
  Real free = 0, sorbed = 0, yarn = 0, pore = 0, cell = 0, evaporated = 0, left = 0, supplied = 0, initial = 0;
  Real error() const;       // |sum of parts - initial - supplied| / (initial + supplied); 0 when both are 0
};
MassBalance mass_balance(const World& world);

}  // namespace imbibe
