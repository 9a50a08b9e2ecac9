#include "imbibe/liquid/pressure.h"

#include <algorithm>
#include <cmath>

namespace imbibe {

using simd::Floats;
using simd::Floats3;
using simd::Floats4;
using simd::lanes;

namespace {

// Eight matrices, as rows of three, each row with a number beside it.
struct Rows {
  Floats4 row[3];
  Floats3 times(const Floats3& v) const {
    return {simd::dot(row[0].xyz(), v), simd::dot(row[1].xyz(), v), simd::dot(row[2].xyz(), v)};
  }
};

// Those of eight neighbours, by index; three records a particle.
Rows load_rows(const Float4* base, const Index* id) {
  Index at[lanes];
  Rows r;
  for (int k = 0; k < 3; ++k) {
    for (int l = 0; l < lanes; ++l) at[l] = 3 * id[l] + static_cast<Index>(k);
    r.row[k] = simd::load4(base, at);
  }
  return r;
}

// Those of eight consecutive particles.
Rows load_rows(const Float4* own) {
  constexpr Index here[lanes] = {0, 1, 2, 3, 4, 5, 6, 7};
  return load_rows(own, here);
}

// a(k) with L: each particle's own part is k L n, that of its neighbours goes by their k L.
void corrected_acceleration(LiquidFields& f) {
  const float volume = f.volume;
  parallel_for(f.count, [&](std::size_t i) {
    const float k = f.position[i].w;
    const float x[3] = {f.position[i].x, f.position[i].y, f.position[i].z};
    for (std::size_t r = 0; r < 3; ++r) {
      const Float4& l = f.correction[3 * i + r];
      f.stress[3 * i + r] = {k * l.x, k * l.y, k * l.z, x[r]};
    }
  });
  for_each_slice(f.neighbours, [&](const Slice& s) {
    const Floats4 here = simd::load4(&f.position[s.first]);
    Floats3 sum{};
    for (std::size_t k = 0; k < s.slots; ++k) {
      const Rows there = load_rows(f.stress.data(), s.index + k * lanes);
      const Floats c = simd::load(s.slope + k * lanes);
      const Floats3 x{c * (here.x - there.row[0].w), c * (here.y - there.row[1].w), c * (here.z - there.row[2].w)};
      const Floats3 t = there.times(x);
      sum.x += t.x, sum.y += t.y, sum.z += t.z;
    }
    const Floats3 own = load_rows(&f.stress[3 * s.first]).times(simd::load4(&f.colour_gradient[s.first]).xyz());
    const Floats4 wall = simd::load4(&f.boundary.push[s.first]);
    const Floats twice = -2 * here.w;
    const Floats3 a{twice * wall.x - volume * sum.x - own.x, twice * wall.y - volume * sum.y - own.y,
                    twice * wall.z - volume * sum.z - own.z};
    simd::store4(&f.acceleration[s.first], a, Floats{});
  });
}

// D(u) with L of the eight particles of a slice: L contracted with the gradient of u.
Floats corrected_rate(const LiquidFields& f, const std::vector<Float4>& u, const Slice& s) {
  const Floats4 here = simd::load4(&f.position[s.first]), own = simd::load4(&u[s.first]);
  Floats3 ex{}, ey{}, ez{};
  for (std::size_t k = 0; k < s.slots; ++k) {
    const Index* id = s.index + k * lanes;
    const Floats4 there = simd::load4(f.position.data(), id), other = simd::load4(u.data(), id);
    const Floats c = simd::load(s.slope + k * lanes);
    const Floats3 v{c * (own.x - other.x), c * (own.y - other.y), c * (own.z - other.z)};
    const Floats3 x = here.xyz() - there.xyz();
    ex.x += v.x * x.x, ex.y += v.x * x.y, ex.z += v.x * x.z;
    ey.x += v.y * x.x, ey.y += v.y * x.y, ey.z += v.y * x.z;
    ez.x += v.z * x.x, ez.y += v.z * x.y, ez.z += v.z * x.z;
  }
  const Rows l = load_rows(&f.correction[3 * s.first]);
  const Floats4 wall = simd::load4(&f.boundary.push[s.first]);
  const Floats pairs = simd::dot(l.row[0].xyz(), ex) + simd::dot(l.row[1].xyz(), ey) + simd::dot(l.row[2].xyz(), ez);
  return f.volume * pairs + 2 * simd::dot(own.xyz(), wall.xyz());
}

// The same with L = I.
void plain_acceleration(LiquidFields& f) {
  const float volume = f.volume;
  for_each_slice(f.neighbours, [&](const Slice& s) {
    const Floats4 here = simd::load4(&f.position[s.first]);
    Floats3 sum{};
    for (std::size_t k = 0; k < s.slots; ++k) {
      const Floats4 there = simd::load4(f.position.data(), s.index + k * lanes);
      const Floats c = simd::load(s.slope + k * lanes) * (here.w + there.w);
      sum.x += c * (here.x - there.x), sum.y += c * (here.y - there.y), sum.z += c * (here.z - there.z);
    }
    const Floats4 wall = simd::load4(&f.boundary.push[s.first]);
    const Floats twice = -2 * here.w;
    const Floats3 a{twice * wall.x - volume * sum.x, twice * wall.y - volume * sum.y, twice * wall.z - volume * sum.z};
    simd::store4(&f.acceleration[s.first], a, Floats{});
  });
}

Floats plain_rate(const LiquidFields& f, const std::vector<Float4>& u, const Slice& s) {
  const Floats4 here = simd::load4(&f.position[s.first]), own = simd::load4(&u[s.first]);
  Floats sum{};
  for (std::size_t k = 0; k < s.slots; ++k) {
    const Index* id = s.index + k * lanes;
    const Floats4 there = simd::load4(f.position.data(), id), other = simd::load4(u.data(), id);
    sum += simd::load(s.slope + k * lanes) * simd::dot(own.xyz() - other.xyz(), here.xyz() - there.xyz());
  }
  const Floats4 wall = simd::load4(&f.boundary.push[s.first]);
  return f.volume * sum + 2 * simd::dot(own.xyz(), wall.xyz());
}

// f.acceleration = a(k), k in position.w.
void pressure_acceleration(LiquidFields& f) {
  if (f.corrected) corrected_acceleration(f);
  else plain_acceleration(f);
}

// D(u) of the eight particles of a slice.
Floats compression_rate(const LiquidFields& f, const std::vector<Float4>& u, const Slice& s) {
  return f.corrected ? corrected_rate(f, u, s) : plain_rate(f, u, s);
}

struct Sums {
  double scaled = 0;    // residual . residual / diagonal
  double absolute = 0;  // sum |residual|
  Sums& operator+=(const Sums& o) { return scaled += o.scaled, absolute += o.absolute, *this; }
};

// Particles with little around them have no pressure: their row is taken out (factor 0).
std::size_t take_out_spray(LiquidFields& f, float spray_filling, std::span<const float> warm) {
  return parallel_sum(f.count, [&](std::size_t begin, std::size_t end) {
    std::size_t kept = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const bool spray = f.filling[i] < spray_filling;
      if (spray) f.factor[i] = 0;
      kept += !spray;
      f.position[i].w = f.pressure[i] = spray ? 0 : warm[i];
    }
    return kept;
  });
}

// u += dt a for a scaled step, k += scale direction, residual -= scale A direction.
void advance(LiquidFields& f, float scale, float dt, std::size_t begin, std::size_t end) {
  const float s = scale * dt;
  for (std::size_t i = begin; i < end; ++i) {
    Float4& u = f.velocity[i];
    const Float4& a = f.acceleration[i];
    u = {u.x + s * a.x, u.y + s * a.y, u.z + s * a.z, 0};
    f.pressure[i] += scale * f.position[i].w;
    f.source[i] -= scale * f.applied[i];
  }
}

Sums residual_sums(const LiquidFields& f, std::size_t begin, std::size_t end) {
  Sums sums;
  for (std::size_t i = begin; i < end; ++i) {
    if (f.factor[i] == 0) continue;
    sums.scaled += static_cast<double>(f.source[i]) * (f.source[i] * f.factor[i]);
    sums.absolute += std::abs(f.source[i]);
  }
  return sums;
}

// residual = D(u)/dt + relaxation (1 - lambda) e/dt^2.
Sums first_residual(LiquidFields& f, float dt, float relaxation, const SheetContacts* sheets) {
  if (sheets != nullptr) {
    f.sheet_rate.assign(f.density_error.size(), 0);
    sheets->add_rate(f.sheet_rate, 1);
  }
  const float rate = 1 / dt, density_rate = relaxation / (dt * dt);
  return parallel_sum(f.count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; i += lanes) {
      Floats d = compression_rate(f, f.velocity, f.neighbours.slice(i));
      if (sheets != nullptr) d -= simd::load(&f.sheet_rate[i]);
      const Floats open = 1 - simd::load4(&f.boundary.wall[i]).w;
      simd::store(&f.source[i], rate * d + density_rate * open * simd::load(&f.density_error[i]));
    }
    return residual_sums(f, begin, end);
  });
}

// applied = A direction; returns direction . A direction.
double apply_operator(LiquidFields& f, SheetContacts* sheets) {
  pressure_acceleration(f);
  if (sheets != nullptr) {
    std::fill(f.sheet_rate.begin(), f.sheet_rate.end(), 0.0f);
    sheets->answer(f.position);
    sheets->add_answer(f.sheet_rate);
  }
  return parallel_sum(f.count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; i += lanes) {
      Floats applied = -compression_rate(f, f.acceleration, f.neighbours.slice(i));
      if (sheets != nullptr) applied += simd::load(&f.sheet_rate[i]);
      simd::store(&f.applied[i], applied);
    }
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += static_cast<double>(f.position[i].w) * f.applied[i];
    return sum;
  });
}

void report_density(const LiquidFields& f, PressureReport& report) {
  struct Both {
    double error = 0, compression = 0;
    Both& operator+=(const Both& o) { return error += o.error, compression += o.compression, *this; }
  };
  const Both sum = parallel_sum(f.count, [&](std::size_t begin, std::size_t end) {
    Both part;
    for (std::size_t i = begin; i < end; ++i) {
      part.error += std::abs(f.density_error[i]);
      part.compression += std::max(0.0f, f.filling[i] - 1);
    }
    return part;
  });
  report.density_error = sum.error / static_cast<double>(f.count);
  report.compression = sum.compression / static_cast<double>(f.count);
  report.peak_density_error = parallel_max(f.count, 0.0f, [&](std::size_t begin, std::size_t end) {
    float most = 0;
    for (std::size_t i = begin; i < end; ++i) most = std::max(most, f.density_error[i]);
    return most;
  });
}

}  // namespace

void pressure_response(LiquidFields& f, std::span<const float> pressure) {
  const float stress = f.rest_density * f.lattice.stress;
  parallel_for(f.count, [&](std::size_t i) { f.position[i].w = pressure[i] / (stress * std::max(1 - f.boundary.wall[i].w, 0.1f)); });
  pressure_acceleration(f);
  parallel_for(f.count, [&](std::size_t i) { f.position[i].w = 0; });
}

void uniform_pressure_response(LiquidFields& f) {
  parallel_for(f.count, [&](std::size_t i) { f.position[i].w = -0.5f / std::max(1 - f.boundary.wall[i].w, 0.1f); });
  pressure_acceleration(f);
  parallel_for(f.count, [&](std::size_t i) { f.position[i].w = 0; });
}

PressureReport project_velocity(LiquidFields& f, const PressureParams& params, Real dt_s, Real relaxation,
                                std::vector<float>& warm, SheetContacts* sheets) {
  PressureReport report;
  if (sheets != nullptr && sheets->empty()) sheets = nullptr;
  if (f.count == 0) return report;
  report_density(f, report);
  const auto dt = static_cast<float>(dt_s);
  const auto kept = static_cast<double>(
      std::max<std::size_t>(1, take_out_spray(f, static_cast<float>(params.spray_filling), warm)));
  pressure_acceleration(f);
  parallel_for(f.count, [&](std::size_t i) {
    Float4& u = f.velocity[i];
    const Float4& a = f.acceleration[i];
    u = {u.x + dt * a.x, u.y + dt * a.y, u.z + dt * a.z, 0};
  });
  if (sheets != nullptr) {
    sheets->answer(f.position);
    sheets->advance(dt_s);
    sheets->add_diagonal(f.factor);
  }
  Sums sums = first_residual(f, dt, static_cast<float>(relaxation), sheets);
  double keep = 0;  // of the last direction
  const auto relative = [&] { return sums.absolute / kept * dt_s * dt_s; };
  while (report.iterations < params.max_iterations && sums.scaled > 0) {
    if (report.iterations > 0 && relative() < params.tolerance) break;
    parallel_for(f.count, [&](std::size_t i) {
      f.position[i].w = f.source[i] * f.factor[i] + (keep == 0 ? 0 : static_cast<float>(keep) * f.position[i].w);
    });
    const double curvature = apply_operator(f, sheets);
    if (!(curvature > 0)) break;
    const auto scale = static_cast<float>(sums.scaled / curvature);
    const Sums next = parallel_sum(f.count, [&](std::size_t begin, std::size_t end) {
      advance(f, scale, dt, begin, end);
      return residual_sums(f, begin, end);
    });
    if (sheets != nullptr) sheets->advance(static_cast<Real>(scale) * dt_s);
    keep = next.scaled / sums.scaled;
    sums = next;
    ++report.iterations;
  }
  if (sheets != nullptr) sheets->book(f.pressure, dt_s);
  report.residual = relative();
  report.converged = report.residual < params.tolerance;
  const float stress = f.rest_density * f.lattice.stress;
  parallel_for(f.count, [&](std::size_t i) {
    const float k = f.pressure[i];
    warm[i] = k;
    f.wall_push[i] = 2 * k;
    f.pressure[i] = k * stress * (1 - f.boundary.wall[i].w);
    f.position[i].w = 0;
  });
  return report;
}

}  // namespace imbibe
