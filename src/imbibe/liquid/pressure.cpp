#include "imbibe/liquid/pressure.h"

#include <algorithm>
#include <cmath>

#include "imbibe/core/portable.h"

namespace imbibe {

using simd::Floats;
using simd::Floats3;
using simd::Floats4;
using simd::lanes;

namespace {

// The stress that the pairs of a body-centred lattice of the rest density carry at k = 1, over rho0: its second moment
// V sum |W'| r/3, 0.984 at H = 2.5 dx and 1 in the continuum. k bears the load, so it is as much larger than p/rho0.
float lattice_stress(Real support_in_spacings) {
  const Real edge = portable::cbrt(2.0), h = support_in_spacings;
  const Kernel kernel(h);
  const int reach = 2 * (static_cast<int>(std::ceil(h / edge)) + 1);
  Real sum = 0;
  for (int z = -reach; z <= reach; ++z)
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x) {
        if ((x - y) % 2 != 0 || (x - z) % 2 != 0) continue;
        const Real square = 0.25 * edge * edge * static_cast<Real>(x * x + y * y + z * z);
        sum -= static_cast<Real>(kernel.slope(static_cast<float>(std::sqrt(square)))) * square / 3;
      }
  return static_cast<float>(sum);
}

// f.acceleration = a(k), k in position.w.
void pressure_acceleration(LiquidFields& f) {
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

// D(u) of the eight particles of a slice.
Floats compression_rate(const LiquidFields& f, const std::vector<Float4>& u, const Slice& s) {
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
  const double sum = parallel_sum(f.count, [&](std::size_t begin, std::size_t end) {
    double part = 0;
    for (std::size_t i = begin; i < end; ++i) part += std::abs(f.density_error[i]);
    return part;
  });
  report.density_error = sum / static_cast<double>(f.count);
  report.peak_density_error = parallel_max(f.count, 0.0f, [&](std::size_t begin, std::size_t end) {
    float most = 0;
    for (std::size_t i = begin; i < end; ++i) most = std::max(most, f.density_error[i]);
    return most;
  });
}

}  // namespace

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
  const float stress = f.rest_density * lattice_stress(static_cast<Real>(f.neighbours.kernel.support) / static_cast<Real>(f.spacing));
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
