#include "imbibe/view/liquid_surface.h"

#include <algorithm>
#include <utility>

#include "imbibe/core/error.h"
#include "imbibe/core/parallel.h"
#include "imbibe/view/surface_nets.h"

namespace imbibe {

namespace {

// Particles sorted into cubic bins, for range queries; bins exist only where particles are.
struct Bins {
  Vec3 origin{};
  Real size = 1;
  std::vector<std::uint64_t> keys;  // of each particle in sorted order
  std::vector<Vec3f> position;      // in sorted order
};

std::int64_t bin_coordinate(Real x, Real origin, Real size) {
  return static_cast<std::int64_t>(std::floor((x - origin) / size));
}

std::uint64_t bin_key(const Bins& bins, const Vec3& p) {
  return block_key(static_cast<std::uint64_t>(bin_coordinate(p.x, bins.origin.x, bins.size)),
                   static_cast<std::uint64_t>(bin_coordinate(p.y, bins.origin.y, bins.size)),
                   static_cast<std::uint64_t>(bin_coordinate(p.z, bins.origin.z, bins.size)));
}

Bins sorted_bins(std::span<const Vec3f> particles, const Vec3& origin, Real size) {
  Bins bins{origin, size, {}, {}};
  std::vector<std::pair<std::uint64_t, Index>> order(particles.size());
  parallel_for(particles.size(), [&](std::size_t i) { order[i] = {bin_key(bins, Vec3(particles[i])), static_cast<Index>(i)}; });
  std::sort(order.begin(), order.end());
  bins.keys.reserve(order.size());
  bins.position.reserve(order.size());
  for (const auto& [key, i] : order) {
    bins.keys.push_back(key);
    bins.position.push_back(particles[i]);
  }
  return bins;
}

// Calls visit(first, last) for the ranges of particles whose bins touch the box [low, high].
template <class Visit>
void for_bins_in(const Bins& bins, const Vec3& low, const Vec3& high, Visit&& visit) {
  const auto coordinate = [&](Real x, Real origin) { return std::max<std::int64_t>(0, bin_coordinate(x, origin, bins.size)); };
  const std::int64_t x0 = coordinate(low.x, bins.origin.x), x1 = coordinate(high.x, bins.origin.x);
  const std::int64_t y0 = coordinate(low.y, bins.origin.y), y1 = coordinate(high.y, bins.origin.y);
  const std::int64_t z0 = coordinate(low.z, bins.origin.z), z1 = coordinate(high.z, bins.origin.z);
  for (std::int64_t z = z0; z <= z1; ++z)
    for (std::int64_t y = y0; y <= y1; ++y) {
      const auto key = [&](std::int64_t x) {
        return block_key(static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y), static_cast<std::uint64_t>(z));
      };
      const auto first = std::lower_bound(bins.keys.begin(), bins.keys.end(), key(x0));
      const auto last = std::upper_bound(first, bins.keys.end(), key(x1));
      if (first != last) visit(static_cast<std::size_t>(first - bins.keys.begin()), static_cast<std::size_t>(last - bins.keys.begin()));
    }
}

// The kernel in units of its value at the centre: (1 - r^2/s^2)^3, s = support.
float kernel_shape(float squared_ratio) {
  const float t = std::max(0.0f, 1 - squared_ratio);
  return t * t * t;
}

// Each particle drawn towards the mean of its neighbours within `reach`.
std::vector<Vec3f> smoothed_centres(const Bins& bins, Real reach, Real share) {
  std::vector<Vec3f> centres(bins.position.size());
  const float inverse = static_cast<float>(1 / (reach * reach)), weight_of_mean = static_cast<float>(share);
  parallel_for(centres.size(), [&](std::size_t i) {
    const Vec3f here = bins.position[i];
    const Vec3 margin{reach, reach, reach};
    Vec3f sum{};
    float weight = 0;
    for_bins_in(bins, Vec3(here) - margin, Vec3(here) + margin, [&](std::size_t first, std::size_t last) {
      for (std::size_t j = first; j < last; ++j) {
        const Vec3f offset = bins.position[j] - here;
        const float w = kernel_shape(squared_norm(offset) * inverse);
        sum += offset * w;
        weight += w;
      }
    });
    centres[i] = here + sum * (weight_of_mean / weight);
  });
  return centres;
}

// V_i W(0) of each particle: 1 / (sum over neighbours of the kernel's shape), so that the field is about one inside.
std::vector<float> kernel_heights(const Bins& bins, Real support, float highest) {
  std::vector<float> heights(bins.position.size());
  const float inverse = static_cast<float>(1 / (support * support));
  parallel_for(heights.size(), [&](std::size_t i) {
    const Vec3f here = bins.position[i];
    const Vec3 margin{support, support, support};
    float sum = 0;
    for_bins_in(bins, Vec3(here) - margin, Vec3(here) + margin, [&](std::size_t first, std::size_t last) {
      for (std::size_t j = first; j < last; ++j) sum += kernel_shape(squared_norm(bins.position[j] - here) * inverse);
    });
    heights[i] = std::min(1 / sum, highest);
  });
  return heights;
}

std::vector<std::uint64_t> blocks_near(const Bins& bins, const Vec3& origin, Real cell, Real support) {
  const Real size = cell * BlockGrid::side, reach = support + 1.01 * cell;
  std::vector<std::uint64_t> keys;
  for (const Vec3f& p : bins.position) {
    const Vec3 low = Vec3(p) - origin - Vec3{reach, reach, reach}, high = low + Vec3{2 * reach, 2 * reach, 2 * reach};
    const auto at = [size](Real x) { return static_cast<std::uint64_t>(x / size); };
    for (std::uint64_t z = at(low.z); z <= at(high.z); ++z)
      for (std::uint64_t y = at(low.y); y <= at(high.y); ++y)
        for (std::uint64_t x = at(low.x); x <= at(high.x); ++x) {
          const std::uint64_t key = block_key(x, y, z);
          // Sorted particles touch the same blocks again and again: look back a little to keep the list short.
          const std::size_t back = std::min<std::size_t>(keys.size(), 27);
          if (std::find(keys.end() - static_cast<std::ptrdiff_t>(back), keys.end(), key) == keys.end()) keys.push_back(key);
        }
  }
  return keys;
}

// Adds one particle's kernel to the nodes of a block that it reaches. `at` is in cells from the block's first node.
void splat(std::array<float, BlockGrid::nodes>& values, const Vec3f& at, float support, float height) {
  const auto first = [support](float x) { return std::max(0, static_cast<int>(std::ceil(x - support))); };
  const auto last = [support](float x) { return std::min(BlockGrid::side - 1, static_cast<int>(std::floor(x + support))); };
  const float inverse = 1 / (support * support);
  for (int k = first(at.z); k <= last(at.z); ++k)
    for (int j = first(at.y); j <= last(at.y); ++j) {
      const float dz = static_cast<float>(k) - at.z, dy = static_cast<float>(j) - at.y;
      const float yz = (dz * dz + dy * dy) * inverse;
      if (yz >= 1) continue;
      float* row = &values[static_cast<std::size_t>((k * BlockGrid::side + j) * BlockGrid::side)];
      for (int i = 0; i < BlockGrid::side; ++i) {  // whole rows: the compiler makes one vector of it
        const float dx = static_cast<float>(i) - at.x;
        row[i] += height * kernel_shape(yz + dx * dx * inverse);
      }
    }
}

void fill_field(BlockGrid& grid, const Bins& bins, const std::vector<float>& heights, Real support) {
  parallel_for(grid.keys.size(), [&](std::size_t b) {
    std::array<float, BlockGrid::nodes>& values = grid.values[b];
    values.fill(0);
    const auto block = block_of_key(grid.keys[b]);
    const Real size = grid.cell * BlockGrid::side;
    const Vec3 corner = grid.origin + size * Vec3{static_cast<Real>(block[0]), static_cast<Real>(block[1]), static_cast<Real>(block[2])};
    const Vec3 margin{support, support, support};
    const Real extent = size - grid.cell;
    for_bins_in(bins, corner - margin, corner + margin + Vec3{extent, extent, extent}, [&](std::size_t first, std::size_t last) {
      for (std::size_t j = first; j < last; ++j)
        splat(values, Vec3f((Vec3(bins.position[j]) - corner) / grid.cell), static_cast<float>(support / grid.cell), heights[j]);
    });
  }, 4);
}

}  // namespace

DrawnMesh liquid_surface(std::span<const Vec3f> particles, Real spacing, const LiquidSurfaceParams& params) {
  if (particles.empty()) return {};
  IMBIBE_ASSERT(spacing > 0);
  Bounds bounds;
  for (const Vec3f& p : particles) bounds.include(Vec3(p));
  const Real support = params.support * spacing, cell = params.cell * spacing;
  const Vec3 origin = bounds.lower - Vec3{1, 1, 1} * (support + 2 * cell + BlockGrid::side * cell);

  const Bins raw = sorted_bins(particles, origin, support);
  const std::vector<Vec3f> centres = smoothed_centres(raw, support, params.centre_smoothing);
  const Bins bins = sorted_bins(centres, origin, support);
  // A lone particle's ball has the particle's volume: radius (3 / 4 pi)^(1/3) spacings at the iso value, times what
  // meshing so small a ball with cells of half a spacing, and relaxing it, takes away (measured).
  const Real lone_radius = 1.3 * std::cbrt(3 / (4 * pi)) / params.support;
  const float highest = static_cast<float>(params.iso) / kernel_shape(static_cast<float>(lone_radius * lone_radius));
  const std::vector<float> heights = kernel_heights(bins, support, highest);

  BlockGrid grid = block_grid(blocks_near(bins, origin, cell, support), origin, cell);
  fill_field(grid, bins, heights, support);
  DrawnMesh mesh = surface_nets(grid, static_cast<float>(params.iso));
  relax(mesh, params.relaxations);
  compute_normals(mesh, params.normal_rounds);
  return mesh;
}

Real enclosed_volume(const DrawnMesh& mesh) {
  Real six_volumes = 0;
  for (const auto& t : mesh.triangles)
    six_volumes += dot(Vec3(mesh.vertices[t[0]]), cross(Vec3(mesh.vertices[t[1]]), Vec3(mesh.vertices[t[2]])));
  return six_volumes / 6;
}

}  // namespace imbibe
