// A scene as plain data, described once (core/parameter.h): what a scene file may say, with units, ranges, defaults.
// Reference of all keys: docs/reference/parameters.md, generated from these descriptions.
//
// The models' own parameters are described beside the models (FabricSpec, WettingParams, LiquidParams, ShapeSpec,
// PictureOptions, MeasureParams) and only nested here.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "imbibe/core/parameter.h"
#include "imbibe/core/types.h"
#include "imbibe/coupling/contact.h"
#include "imbibe/coupling/reservoir.h"
#include "imbibe/fabric/fabric.h"
#include "imbibe/geometry/shape_spec.h"
#include "imbibe/liquid/liquid_step.h"
#include "imbibe/scene/document.h"
#include "imbibe/scene/picture_options.h"
#include "imbibe/scene/soft_sheet_spec.h"
#include "imbibe/sim/measures.h"
#include "imbibe/wetting/wetting_model.h"

namespace imbibe {

// m from the origin: the liquid's loops are in single precision, which places a particle to 1 um out there.
inline constexpr Real farthest = 10;

struct AirSpec {
  Real temperature = Air{}.temperature;      // K
  Real humidity = Air{}.humidity;            // 1
  Real mass_transfer = Air{}.mass_transfer;  // m/s
};

template <class V>
void describe(V& v, AirSpec& p) {
  v.value("temperature", p.temperature,
          {.unit = "K", .shown = "degC", .min = 263.15, .max = 373.15, .help = "temperature of air, cloth and liquid"});
  v.value("humidity", p.humidity,
          {.unit = "1", .shown = "%", .min = 0, .max = 1, .help = "relative humidity; the fibres start in balance with it"});
  v.value("mass_transfer", p.mass_transfer,
          {.unit = "m/s", .shown = "mm/s", .min = 0, .max = 1,
           .help = "vapour transfer coefficient at the cloth's faces: 3 mm/s in still air, 10 mm/s in a draught"});
}

// A liquid of the library by name, with single properties changed if wanted; all three given: a liquid of its own.
struct LiquidKindSpec {
  std::string name = "water";
  std::optional<Real> density, viscosity, surface_tension;  // kg/m3, Pa s, N/m
};

template <class V>
void describe(V& v, LiquidKindSpec& p) {
  if constexpr (requires { v.short_form(""); }) v.short_form("name");
  v.value("name", p.name, {.help = "a liquid of liquids/*.yaml; any name when all three properties are given"});
  v.value("density", p.density, {.unit = "kg/m3", .min = 100, .max = 20000, .help = "in place of the library's"});
  v.value("viscosity", p.viscosity,
          {.unit = "Pa s", .shown = "mPa s", .min = 0, .max = 1000, .help = "dynamic, in place of the library's"});
  v.value("surface_tension", p.surface_tension,
          {.unit = "N/m", .shown = "mN/m", .min = 0, .max = 1, .help = "against air, in place of the library's"});
}

struct DropSpec {
  std::string name;
  Vec3 centre{};      // m
  Real volume = 0;    // m3
  Vec3 velocity{};    // m/s
  Real start = 0;     // s
  Vec3 stretch{1, 1, 1};
  std::optional<Real> cap_angle;  // rad
};

template <class V>
void describe(V& v, DropSpec& p) {
  v.value("name", p.name, {.help = "name in the report"});
  v.value("centre", p.centre,
          {.unit = "m", .shown = "mm", .min = -farthest, .max = farthest, .required = true,
           .help = "centre of the ball at its start; of a cap, the middle of its base"});
  v.value("volume", p.volume,
          {.unit = "m3", .shown = "uL", .min = 0, .max = 1, .above_min = true, .required = true, .help = "volume"});
  v.value("velocity", p.velocity, {.unit = "m/s", .min = -100, .max = 100, .help = "velocity at its start"});
  v.value("start", p.start, {.unit = "s", .min = 0, .help = "when it appears"});
  v.value("stretch", p.stretch,
          {.min = 0.05, .max = 20, .help = "relative half axes along x, y and z of an ellipsoid of this volume"});
  v.value("cap_angle", p.cap_angle,
          {.unit = "rad", .shown = "deg", .min = radians(5), .max = radians(175),
           .help = "born as a spherical cap of this angle that stands on a level plane, in place of a ball"});
}

struct LiquidBoxSpec {
  std::string name;
  Vec3 centre{};    // m
  Vec3 size{};      // m
  Vec3 velocity{};  // m/s
  Real start = 0;   // s
  Real vortex = 0;  // m/s
};

template <class V>
void describe(V& v, LiquidBoxSpec& p) {
  v.value("name", p.name, {.help = "name in the report"});
  v.value("centre", p.centre,
          {.unit = "m", .shown = "mm", .min = -farthest, .max = farthest, .required = true, .help = "centre of the box"});
  v.value("size", p.size,
          {.unit = "m", .shown = "mm", .min = 0, .max = 100, .above_min = true, .required = true,
           .help = "lengths of its edges"});
  v.value("velocity", p.velocity, {.unit = "m/s", .min = -100, .max = 100, .help = "velocity at its start"});
  v.value("start", p.start, {.unit = "s", .min = 0, .help = "when it appears"});
  v.value("vortex", p.vortex, {.unit = "m/s", .min = -100, .max = 100,
                               .help = "greatest speed of a Taylor-Green vortex about z that fills it, on top of velocity"});
}

struct DropperSpec {
  DropSpec drop;
  Real interval = 1;  // s
  int count = 1;
};

template <class V>
void describe(V& v, DropperSpec& p) {
  describe(v, p.drop);
  v.value("interval", p.interval,
          {.unit = "s", .min = 0, .above_min = true, .required = true, .help = "time from one drop to the next"});
  v.value("count", p.count, {.min = 1, .max = 1e6, .required = true, .help = "number of drops"});
}

// A pipe: its mesh (or a plain tube), where it stands, and the jet that leaves it. The pipe's own axis is z; the jet leaves
// at its upper end, so the transform aims it. The mesh is drawn; it is no wall.
struct PipeSpec {
  std::string name;
  std::optional<std::string> file;
  MeshTransform transform;
  std::optional<Real> radius, length;  // m
  std::optional<Real> flow;            // m3/s
  std::optional<Real> particle_rate;   // 1/s
  Real speed = 1;                      // m/s
  Real start = 0;                      // s
  std::optional<Real> stop;            // s
  bool submerged = false;
};

template <class V>
void describe(V& v, PipeSpec& p) {
  v.value("name", p.name, {.help = "name in the report"});
  v.value("file", p.file, {.help = "OBJ, PLY or STL mesh of the pipe, its axis along z; default: a plain tube"});
  v.group("transform", p.transform, "how the pipe stands in the world; the jet leaves at its upper end, along its axis");
  v.value("radius", p.radius, {.unit = "m", .shown = "mm", .min = 0, .max = 10, .above_min = true,
                               .help = "of the bore; default: 0.8 of the mesh's half width"});
  v.value("length", p.length, {.unit = "m", .shown = "mm", .min = 0, .max = 10, .above_min = true,
                               .help = "of the part of the bore that particles start in; default: the mesh's length"});
  v.value("flow", p.flow, {.unit = "m3/s", .shown = "mL/s", .min = 0, .max = 1, .above_min = true,
                           .help = "volume per time; or give particle_rate"});
  v.value("particle_rate", p.particle_rate, {.unit = "1/s", .min = 0, .max = 1e9, .above_min = true,
                                             .help = "particles per second; or give flow"});
  v.value("speed", p.speed, {.unit = "m/s", .min = 0, .max = 100, .above_min = true, .help = "of the jet"});
  v.value("start", p.start, {.unit = "s", .min = 0, .help = "when it begins"});
  v.value("stop", p.stop, {.unit = "s", .min = 0, .help = "when it ends; default: never"});
  v.value("submerged", p.submerged, {.help = "the mouth lies in liquid, which makes room for what the pipe gives; otherwise a "
                                             "particle waits until its place is free"});
}

struct LiquidSpec {
  LiquidKindSpec kind;
  std::optional<Real> particle_mass;  // kg
  std::vector<DropSpec> drops;
  std::vector<LiquidBoxSpec> boxes;
  std::vector<DropperSpec> droppers;
  std::vector<PipeSpec> pipes;
  bool rest = true;
  LiquidParams solver;
};

template <class V>
void describe(V& v, LiquidSpec& p) {
  v.group("kind", p.kind, "which liquid: a name such as water, or a map that changes its properties");
  v.value("particle_mass", p.particle_mass,
          {.unit = "kg", .shown = "mg", .min = 1e-15, .max = 1,
           .help = "mass of one particle: the resolution of the liquid. Needed when there is any liquid"});
  v.list("drops", p.drops, "drops of liquid, each once");
  v.list("boxes", p.boxes, "boxes of liquid");
  v.list("droppers", p.droppers, "drops that repeat at an interval");
  v.list("pipes", p.pipes, "pipes that let a jet of particles go");
  v.value("rest", p.rest, {.help = "liquid whose shape no longer changes makes no more steps; false: it always moves"});
  v.group("solver", p.solver, "accuracy of the flow solver");
}

enum class WettingKind { network, cells };

struct WettingSpec {
  WettingKind kind = WettingKind::network;
  WettingParams network;
  std::optional<CellParams> cells;
  bool is_cells() const { return kind == WettingKind::cells || cells.has_value(); }
};

template <class V>
void describe(V& v, WettingSpec& p) {
  if constexpr (requires { v.short_form(""); }) v.short_form("kind");
  v.choice("kind", p.kind, {{"network", WettingKind::network}, {"cells", WettingKind::cells}},
           "network: yarn segments and pores; cells: a cell of liquid parcels at each node of the sheet (no weave needed)");
  read_when(v, !p.is_cells(), [&] { v.group("network", p.network, "models and numbers of the yarn and pore network"); });
  read_when(v, p.is_cells(), [&] { v.group("cells", p.cells, "seed B's cells; giving this map chooses them"); });
}

// A wet place of a textile at the start.
struct SpotSpec {
  std::array<Real, 2> centre{0, 0};  // m, in the sheet
  std::array<Real, 2> size{0, 0};    // m, full lengths along weft and warp
  bool round = true;
  Real yarns = 0, pores = 0;         // saturation
};

template <class V>
void describe(V& v, SpotSpec& p) {
  v.value("centre", p.centre, {.unit = "m", .shown = "mm", .help = "along weft and warp from the sheet's middle"});
  v.value("size", p.size, {.unit = "m", .shown = "mm", .min = 0, .above_min = true, .required = true,
                           .help = "full lengths along weft and warp"});
  v.value("round", p.round, {.help = "an ellipse of these axes; false: a rectangle"});
  v.value("yarns", p.yarns, {.min = 0, .max = 1, .help = "saturation of the yarns there"});
  v.value("pores", p.pores, {.min = 0, .max = 1, .help = "saturation of the pores there"});
}

// What a textile holds at the start, in place of fibres in balance with the air and nothing between them.
struct StartSpec {
  std::optional<Real> humidity;  // 1
  Real yarns = 0, pores = 0;     // saturation
  std::vector<SpotSpec> spots;
};

template <class V>
void describe(V& v, StartSpec& p) {
  v.value("humidity", p.humidity,
          {.min = 0, .max = 1, .help = "relative humidity with which the fibres are in balance; default: that of the air"});
  v.value("yarns", p.yarns, {.min = 0, .max = 1, .help = "saturation of the yarns"});
  v.value("pores", p.pores, {.min = 0, .max = 1, .help = "saturation of the pores"});
  v.list("spots", p.spots, "places that hold other amounts; a later one wins where they overlap");
}

struct TextileSpec {
  std::string name = "textile";
  Vec3 centre{};                       // m, of the mid-plane
  Vec3 weft_direction{1, 0, 0};        // any length
  Vec3 warp_direction{0, 1, 0};        // any length, square to the weft; the face is weft x warp
  FabricSpec fabric;
  std::optional<Real> contact_angle;   // rad, advancing, in place of every fibre's
  std::optional<Real> warp_contact_angle, weft_contact_angle;  // rad, advancing, in place of contact_angle
  std::optional<Real> receding_angle;  // rad
  std::optional<Real> regain;          // kg/kg, that its fibres are conditioned to
  Vec3 colour{0.26, 0.40, 0.60};       // linear RGB, of a dry cloth of cells: a blue on which water shows
  SheetSpec sheet;
  WettingSpec wetting;
  ContactParams contact;
  StartSpec start;
  std::vector<ReservoirSpec> reservoirs;
};

template <class V>
void describe(V& v, TextileSpec& p) {
  const bool woven = !p.wetting.is_cells();
  v.value("name", p.name, {.help = "name of its files and of its part of the report"});
  v.value("centre", p.centre,
          {.unit = "m", .shown = "mm", .min = -farthest, .max = farthest, .help = "centre of its mid-plane"});
  v.value("weft_direction", p.weft_direction, {.min = -1e6, .max = 1e6, .help = "along the weft yarns; any length"});
  v.value("warp_direction", p.warp_direction,
          {.min = -1e6, .max = 1e6, .help = "along the warp yarns, square to the weft; the face is weft x warp"});
  describe(v, p.fabric, woven);
  v.value("contact_angle", p.contact_angle,
          {.unit = "rad", .shown = "deg", .min = 0, .max = pi,
           .help = "advancing contact angle of the liquid on every fibre; default: each fibre's own, which is water's"});
  read_when(v, woven, [&] {
    v.value("warp_contact_angle", p.warp_contact_angle,
            {.unit = "rad", .shown = "deg", .min = 0, .max = pi,
             .help = "advancing contact angle on the fibres of the warp alone; default: contact_angle"});
    v.value("weft_contact_angle", p.weft_contact_angle,
            {.unit = "rad", .shown = "deg", .min = 0, .max = pi,
             .help = "advancing contact angle on the fibres of the weft alone; default: contact_angle"});
    v.value("receding_angle", p.receding_angle,
            {.unit = "rad", .shown = "deg", .min = 0, .max = pi,
             .help = "receding contact angle on every fibre; never above its advancing one"});
    v.value("regain", p.regain,
            {.unit = "1", .shown = "%", .min = 0, .max = 1,
             .help = "water in its fibres per dry mass where no liquid touches them: conditioned to it at the start, and again "
                     "whenever it is changed (water from or to the air); default: in balance with start.humidity or the air"});
  });
  read_when(v, !woven, [&] {
    v.value("colour", p.colour,
            {.min = 0, .max = 1, .help = "linear red, green, blue of the dry cloth (a woven one has its yarns' colours)"});
  });
  v.group("sheet", p.sheet, "how the cloth is held");
  v.group("wetting", p.wetting, "how it takes liquid up");
  read_when(v, woven, [&] {
    v.group("contact", p.contact, "how particles that hit its yarns bounce");
    v.group("start", p.start, "what it holds at the start");
  });
  v.list("reservoirs", p.reservoirs, "liquid that stands against parts of it and never runs out");
}

struct SolidSpec {
  std::string name = "solid";
  ShapeSpec shape;
  Real contact_angle = pi / 2;         // rad
  std::optional<Real> receding_angle;  // rad
  Real friction = 1;
  Vec3 surface_velocity{};             // m/s
  Vec3 colour{0.55, 0.55, 0.58};
};

template <class V>
void describe(V& v, SolidSpec& p) {
  v.value("name", p.name, {.help = "name in the report"});
  v.group("shape", p.shape, "form and place");
  v.value("contact_angle", p.contact_angle,
          {.unit = "rad", .shown = "deg", .min = 0, .max = pi, .help = "of the liquid on it"});
  v.value("receding_angle", p.receding_angle,
          {.unit = "rad", .shown = "deg", .min = 0, .max = pi, .help = "default: no hysteresis"});
  v.value("friction", p.friction, {.min = 0, .max = 1, .help = "0: liquid slips along it; 1: it sticks (no slip)"});
  v.value("surface_velocity", p.surface_velocity,
          {.unit = "m/s", .min = -100, .max = 100,
           .help = "of its surface, which runs along itself as a belt does; only its part along the surface acts"});
  v.value("colour", p.colour, {.min = 0, .max = 1, .help = "linear red, green, blue"});
}

struct DomainSpec {
  std::optional<Vec3> lower, upper;  // m
};

template <class V>
void describe(V& v, DomainSpec& p) {
  v.value("lower", p.lower,
          {.unit = "m", .shown = "mm", .min = -2 * farthest, .max = 2 * farthest,
           .help = "lower corner; default from what is in the scene"});
  v.value("upper", p.upper,
          {.unit = "m", .shown = "mm", .min = -2 * farthest, .max = 2 * farthest,
           .help = "upper corner; default from what is in the scene"});
}

struct OutputSpec {
  std::optional<Real> every;        // s
  std::optional<Real> checkpoint_every;  // s, of wall time
  bool pictures = true, particles = true, textiles = true;
};

template <class V>
void describe(V& v, OutputSpec& p) {
  v.value("every", p.every,
          {.unit = "s", .min = 0, .above_min = true, .help = "simulated time between outputs; default: duration / 50"});
  v.value("checkpoint_every", p.checkpoint_every,
          {.unit = "s", .min = 0, .help = "wall-clock time between checkpoints; default: 60 s"});
  v.value("pictures", p.pictures, {.help = "a picture at every output, and the film"});
  v.value("particles", p.particles, {.help = "liquid_*.vtp files"});
  v.value("textiles", p.textiles, {.help = "textile_*.vtp files"});
}

// Guard rails: a scene that would need more is refused before it runs, or stopped with its results kept.
struct LimitsSpec {
  Real max_particles = 2e7;
  std::optional<Real> max_memory;  // bytes
  Real max_disk = 50e9;            // bytes
  std::optional<Real> max_steps;
  std::optional<Real> max_step;    // s
};

template <class V>
void describe(V& v, LimitsSpec& p) {
  v.value("max_particles", p.max_particles, {.min = 1, .max = 4e9, .help = "most particles of liquid"});
  v.value("max_memory", p.max_memory,
          {.unit = "byte", .shown = "GB", .min = 1e6, .help = "most memory; default: 80 % of the machine's"});
  v.value("max_disk", p.max_disk, {.unit = "byte", .shown = "GB", .min = 1e6, .help = "most room of the run folder"});
  v.value("max_steps", p.max_steps, {.min = 1, .max = 1e15, .help = "stop after so many steps; default: no limit"});
  v.value("max_step", p.max_step, {.unit = "s", .min = 1e-9, .help = "longest time step; default: what accuracy asks for"});
}

struct Scene {
  int version = 1;
  std::string title;
  Real duration = 1;  // s
  std::uint64_t seed = 1;
  Vec3 gravity{0, 0, -9.81};  // m/s2
  AirSpec air;
  DomainSpec domain;
  LiquidSpec liquid;
  std::vector<TextileSpec> textiles;
  std::vector<SolidSpec> solids;
  OutputSpec output;
  PictureOptions picture;
  MeasureParams measures;
  LimitsSpec limits;

  // Not described: where each key stands, for problems found later. Resolved scenes written by us have none.
  std::map<std::string, Place> places;
};

template <class V>
void describe(V& v, Scene& p) {
  v.value("version", p.version, {.min = 1, .max = 1, .required = true, .help = "of the scene language: 1"});
  v.value("title", p.title, {.help = "shown on pictures and in the report"});
  v.value("duration", p.duration,
          {.unit = "s", .min = 0, .max = 1e9, .above_min = true, .required = true, .help = "simulated time"});
  v.value("seed", p.seed, {.help = "of all random numbers"});
  v.value("gravity", p.gravity, {.unit = "m/s2", .min = -1000, .max = 1000, .help = "z is up"});
  v.group("air", p.air, "the air around");
  v.group("domain", p.domain, "box outside which liquid is taken out and counted as left");
  v.group("liquid", p.liquid, "the liquid and where it comes from");
  v.list("textiles", p.textiles, "woven cloths");
  v.list("solids", p.solids, "fixed solids");
  v.group("output", p.output, "what is written, and how often");
  v.group("picture", p.picture, "how pictures look");
  v.group("measures", p.measures, "what counts as wet");
  v.group("limits", p.limits, "guard rails of time, memory and disk");
}

// Every file that building the scene would open, beside those of the library.
std::set<std::string> files_named_by(const Scene& scene);

// The time between outputs.
Real output_interval(const Scene& scene);

// Reads a scene file with its bases, applies `overrides` ("path=value", as --set), and checks each key. Throws one
// InputError with every problem of the file.
Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});
Scene read_scene_text(const std::string& text, const std::string& file_name,
                      const std::vector<std::string>& overrides = {});

// The scene with every value, runnable again: reads back to the same bits.
std::string write_scene(const Scene& scene);

// A problem at the place where `key` (or the nearest enclosing key) was written.
Problem scene_problem(const Scene& scene, const std::string& key, const std::string& message);

}  // namespace imbibe
