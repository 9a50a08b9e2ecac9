#include "imbibe/liquid/viscosity.h"

#include <algorithm>

#include "imbibe/liquid/sheet_wall.h"

namespace imbibe {

namespace {

// 1 up to half of the support away from a wall (d/H), 0 from the support on.
float wall_share(float distance) { return std::clamp(2 - 2 * distance, 0.0f, 1.0f); }

using simd::Floats;
using simd::Floats3;
using simd::Floats4;
using simd::lanes;

float dot3(const Float4& a, const Float4& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// result_i = sum_j nu_ij 10 V (u_ij . x_ij)/r^2 grad W over the liquid: minus the pair rate along the line of centres.
// w_i nu_i in u[i].w, nu_ij their mean.
void liquid_part(const LiquidFields& f, const std::vector<Float4>& u, std::vector<Float4>& result) {
  // Keeps 0/0 out of padding and coinciding particles; far below any distance that occurs.
  const float tiny = 1e-6f * f.spacing * f.spacing;
  for_each_slice(f.neighbours, [&](const Slice& s) {
    const Floats4 p = simd::load4(&f.position[s.first]), v = simd::load4(&u[s.first]);
    Floats3 sum{};
    for (std::size_t k = 0; k < s.slots; ++k) {
      const Index* id = s.index + k * lanes;
      const Floats4 q = simd::load4(f.position.data(), id), w = simd::load4(u.data(), id);
      const Floats3 x = p.xyz() - q.xyz(), along = v.xyz() - w.xyz();
      const Floats rate = viscous_pair_rate(0.5f * (v.w + w.w), simd::broadcast(f.volume),
                                            simd::load(s.slope + k * lanes));
      const Floats c = rate * simd::dot(along, x) / (simd::dot(x, x) + tiny);
      sum.x -= c * x.x, sum.y -= c * x.y, sum.z -= c * x.z;
    }
    simd::store4(&result[s.first], sum, Floats{});
  });
}

// -nu shear (u - w)_t of all walls near a particle but soft sheets, w_i nu_i in u.w; of a difference of velocities the walls'
// own drops out.
Vec3f wall_part(const LiquidFields& f, std::size_t i, const Float4& u, bool difference) {
  Vec3f sum{};
  for (const WallSample& s : f.boundary.samples(i)) {
    if (s.foot != no_index) continue;
    Vec3f v{u.x, u.y, u.z};
    if (!difference) v -= f.boundary.wall_velocity(i, s);
    sum -= u.w * s.shear * (v - dot(v, s.normal) * s.normal);
  }
  return sum;
}

// result = u - dt A u, with the walls.
void implicit_operator(const LiquidFields& f, const std::vector<Float4>& u, float dt, bool walls, bool difference,
                       std::vector<Float4>& result) {
  liquid_part(f, u, result);
  parallel_for(f.count, [&](std::size_t i) {
    const Vec3f w = walls ? wall_part(f, i, u[i], difference) : Vec3f{};
    result[i] = {u[i].x - dt * (result[i].x + w.x), u[i].y - dt * (result[i].y + w.y),
                 u[i].z - dt * (result[i].z + w.z), 0};
  });
}

double inner(const std::vector<Float4>& a, const std::vector<Float4>& b, std::size_t count) {
  return parallel_sum(count, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += static_cast<double>(dot3(a[i], b[i]));
    return sum;
  });
}

void add_scaled(std::vector<Float4>& to, double scale, const std::vector<Float4>& from, std::size_t count) {
  const auto s = static_cast<float>(scale);
  parallel_for(count, [&](std::size_t i) { to[i].x += s * from[i].x, to[i].y += s * from[i].y, to[i].z += s * from[i].z; });
}

// u += step expected.
void add_expected(LiquidFields& f, float step, const std::vector<Float4>* expected) {
  if (expected == nullptr) return;
  parallel_for(f.count, [&](std::size_t i) {
    Float4& u = f.velocity[i];
    const Float4& a = (*expected)[i];
    u = {u.x + step * a.x, u.y + step * a.y, u.z + step * a.z, u.w};
  });
}

// (1 - dt A) u = u_old by conjugate gradients, from u_old.
ViscosityReport solve_implicit(LiquidFields& f, const ViscosityParams& params, float dt) {
  const std::size_t n = f.count;
  std::vector<Float4>& product = f.acceleration;
  implicit_operator(f, f.velocity, dt, params.wall_friction, false, product);
  parallel_for(n, [&](std::size_t i) {
    const Float4 &u = f.velocity[i], &a = product[i];
    f.residual[i] = {u.x - a.x, u.y - a.y, u.z - a.z, 0};
    f.direction[i] = {u.x - a.x, u.y - a.y, u.z - a.z, u.w};
  });
  double square = inner(f.residual, f.residual, n);
  // Liquid at rest that a wall is about to set in motion is measured against that.
  const double before = inner(f.velocity, f.velocity, n);
  const double goal = params.tolerance * params.tolerance * (before > 0 ? before : square);
  ViscosityReport report;
  while (square > goal && report.iterations < params.max_iterations) {
    implicit_operator(f, f.direction, dt, params.wall_friction, true, product);
    const double step = square / inner(f.direction, product, n);
    add_scaled(f.velocity, step, f.direction, n);
    add_scaled(f.residual, -step, product, n);
    const double next = inner(f.residual, f.residual, n);
    const auto keep = static_cast<float>(next / square);
    parallel_for(n, [&](std::size_t i) {
      Float4 &d = f.direction[i], &r = f.residual[i];
      d = {r.x + keep * d.x, r.y + keep * d.y, r.z + keep * d.z, d.w};
    });
    square = next;
    ++report.iterations;
  }
  report.converged = square <= goal;
  return report;
}

// w_i of viscosity.h.
float missing_pairs(const LiquidFields& f, std::size_t i) {
  float held = 0;
  for (const WallSample& s : f.boundary.samples(i)) held += s.friction * s.lambda;
  return std::clamp((1 - held) / f.colour[i], 1.0f, 3.0f);
}

// w_i nu_i into f.velocity[i].w; returns the largest nu_i.
float set_viscosity(LiquidFields& f, float nu, float nu_at_walls) {
  return parallel_max(f.count, nu, [&](std::size_t begin, std::size_t end) {
    float most = nu;
    for (std::size_t i = begin; i < end; ++i) {
      float nearest = f.neighbours.kernel.support;
      for (const WallSample& s : f.boundary.samples(i)) nearest = std::min(nearest, s.distance);
      const float own = nu + wall_share(nearest * f.neighbours.kernel.inverse) * std::max(0.0f, nu_at_walls - nu);
      f.velocity[i].w = own * missing_pairs(f, i);
      most = std::max(most, own);
    }
    return most;
  });
}

// Share of a particle's slip that friction takes on a wall: implicit, because close to the wall the rate may be above 1/dt.
float taken(float rate) { return rate / (1 + rate); }

// Mass that drags each node of the soft sheets: R = sum over the feet on it of b m taken.
void find_drag(const LiquidFields& f, std::span<const Wall> walls, float dt) {
  bool any = false;
  for (const Wall& wall : walls)
    if (wall.sheet != nullptr) wall.sheet->dragging.assign(wall.sheet->inverse_mass.size(), 0), any = true;
  if (!any) return;
  for (std::size_t i = 0; i < f.count; ++i)
    for (const WallSample& s : f.boundary.samples(i)) {
      if (s.foot == no_index) continue;
      const SheetFoot& foot = f.boundary.foot(i, s);
      for (std::size_t c = 0; c < 3; ++c)
        walls[s.wall].sheet->dragging[foot.node[c]] += foot.weight[c] * f.particle_mass * taken(dt * f.velocity[i].w * s.shear);
    }
}

// How much of the friction a soft sheet can give: nodes lighter than the liquid that drags them would overshoot its velocity
// and swing ever more. 1/(1 + R/m_n) stops short of the common velocity.
float share_of_sheet(const SheetWall& sheet, const SheetFoot& foot) {
  float most = 0;
  for (const Index n : foot.node) most = std::max(most, sheet.dragging[n] * static_cast<float>(sheet.inverse_mass[n]));
  return 1 / (1 + most);
}

// Friction at walls: of the implicit form already in the velocity, here only booked; else, and on soft sheets, applied.
void add_friction(LiquidFields& f, std::span<const Wall> walls, float step, bool implicit, std::vector<Vec3>& impulse) {
  find_drag(f, walls, step);
  for (std::size_t i = 0; i < f.count; ++i) {
    const Float4 before = f.velocity[i];
    for (const WallSample& s : f.boundary.samples(i)) {
      Float4& u = f.velocity[i];
      const bool solved = implicit && s.foot == no_index;
      const Vec3f now = solved ? Vec3f{before.x, before.y, before.z} : Vec3f{u.x, u.y, u.z};
      const Vec3f v = now - f.boundary.wall_velocity(i, s), tangential = v - dot(v, s.normal) * s.normal;
      const float rate = step * before.w * s.shear;
      float part = solved ? rate : taken(rate);
      if (s.foot != no_index) part *= share_of_sheet(*walls[s.wall].sheet, f.boundary.foot(i, s));
      const Vec3f lost = part * tangential;
      if (!solved) u = {u.x - lost.x, u.y - lost.y, u.z - lost.z, u.w};
      impulse[s.wall] += static_cast<Real>(f.particle_mass) * Vec3(lost);
      f.boundary.give(i, s, static_cast<Real>(f.particle_mass) * Vec3(lost));
    }
  }
}

}  // namespace

bool viscosity_is_implicit(const ViscosityParams& params, Real kinematic, Real support, Real dt) {
  return params.on && dt * kinematic > params.explicit_limit * 0.25 * support * support;
}

ViscosityReport apply_viscosity(LiquidFields& f, const ViscosityParams& params, const ViscosityAt& viscosity, Real dt,
                                std::span<const Wall> walls, std::vector<Vec3>& impulse, const std::vector<Float4>* expected) {
  ViscosityReport report;
  if (!params.on || f.count == 0) return report;
  const auto kinematic = [&](Real eta) { return static_cast<float>(eta / static_cast<Real>(f.rest_density)); };
  const float nu = set_viscosity(f, kinematic(viscosity.bulk), kinematic(viscosity.walls));
  if (nu <= 0) return report;
  const auto step = static_cast<float>(dt);
  const bool implicit = viscosity_is_implicit(params, static_cast<Real>(nu), static_cast<Real>(f.neighbours.kernel.support), dt);
  if (implicit) {
    add_expected(f, step, expected);
    report = solve_implicit(f, params, step);
  } else {
    liquid_part(f, f.velocity, f.acceleration);
    parallel_for(f.count, [&](std::size_t i) {
      Float4 &u = f.velocity[i], &a = f.acceleration[i];
      u = {u.x + step * a.x, u.y + step * a.y, u.z + step * a.z, u.w};
    });
  }
  if (params.wall_friction) add_friction(f, walls, step, implicit, impulse);
  // u_old + dt A u, which is u but for what the solver left: so the liquid loses exactly what its friction was booked as.
  if (implicit && report.converged) add_scaled(f.velocity, 1, f.residual, f.count);
  if (implicit) add_expected(f, -step, expected);
  return report;
}

}  // namespace imbibe
