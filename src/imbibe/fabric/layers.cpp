#include "imbibe/fabric/layers.h"

#include <algorithm>

#include "imbibe/core/error.h"

namespace imbibe {
namespace {

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

// Numbers that begin with 0 and end with the count, as yarn_first_segment.
void append_starts(std::vector<Index>& to, const std::vector<Index>& from) {
  const Index base = to.empty() ? 0 : to.back();
  if (!to.empty()) to.pop_back();
  for (const Index first : from) to.push_back(base + first);
}

bool same_yarn(const YarnType& a, const YarnType& b) {
  return a.fibre.name == b.fibre.name && a.fibre.radius == b.fibre.radius && a.radius == b.radius &&
         a.packing == b.packing && a.linear_density == b.linear_density && a.monofilament == b.monofilament &&
         a.tortuosity_squared == b.tortuosity_squared && a.absorption_coefficient == b.absorption_coefficient &&
         a.colour == b.colour;
}

// The number of each of a layer's yarn types in the stack; those that an upper layer has too are shared.
std::vector<Index> join_types(YarnNetwork& net, const YarnNetwork& layer) {
  const std::size_t before = net.yarn_types.size();
  std::vector<Index> number;
  for (const YarnType& type : layer.yarn_types) {
    const auto end = net.yarn_types.begin() + static_cast<std::ptrdiff_t>(before);
    const auto same = std::find_if(net.yarn_types.begin(), end, [&](const YarnType& t) { return same_yarn(t, type); });
    number.push_back(static_cast<Index>(same != end ? same - net.yarn_types.begin() : std::ssize(net.yarn_types)));
    if (same == end) net.yarn_types.push_back(type);
  }
  return number;
}

void append_layer(YarnNetwork& net, const YarnNetwork& layer, Real height) {
  const auto yarns = static_cast<Index>(net.yarn_family.size());
  const auto at = [height](const std::vector<Vec3>& places) {
    std::vector<Vec3> moved = places;
    for (Vec3& p : moved) p.z += height;
    return moved;
  };
  const auto shifted = [](const std::vector<Index>& numbers, Index by) {
    std::vector<Index> moved = numbers;
    for (Index& n : moved) n += by;
    return moved;
  };
  const std::vector<Index> type = join_types(net, layer);
  append(net.yarn_family, layer.yarn_family);
  for (const Index t : layer.yarn_type) net.yarn_type.push_back(type[t]);
  append_starts(net.yarn_first_segment, layer.yarn_first_segment);
  append_starts(net.yarn_first_point, layer.yarn_first_point);
  append(net.points, at(layer.points));
  append(net.segment_yarn, shifted(layer.segment_yarn, yarns));
  append(net.segment_centre, at(layer.segment_centre));
  append(net.segment_length, layer.segment_length);
  append(net.pore_centre, at(layer.pore_centre));
  append(net.pore_volume, layer.pore_volume);
  append(net.pore_opening_x, layer.pore_opening_x);
  append(net.pore_opening_y, layer.pore_opening_y);
  append(net.pore_throat, layer.pore_throat);
  append(net.pore_area, layer.pore_area);
}

// Nodes by place in square bins of the sheet's plane.
class Grid {
 public:
  Grid(const YarnNetwork& net, std::vector<Index> nodes, Real bin) : net_(net), bin_(bin) {
    for (const Index node : nodes) entries_.push_back({bin_at(net.node_centre(node)), node});
    std::sort(entries_.begin(), entries_.end());
  }
  // Calls visit(node) for the nodes of the 3 x 3 bins around `place`, in rising order of bins.
  template <class Visit>
  void near(const Vec3& place, Visit&& visit) const {
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) {
        const auto bin = bin_at(place + Vec3{i * bin_, j * bin_, 0});
        for (auto e = std::lower_bound(entries_.begin(), entries_.end(), std::pair{bin, Index{0}});
             e != entries_.end() && e->first == bin; ++e)
          visit(e->second);
      }
  }

 private:
  using Bin = std::pair<long, long>;
  Bin bin_at(const Vec3& p) const {
    return {static_cast<long>(std::floor(p.y / bin_)), static_cast<long>(std::floor(p.x / bin_))};
  }
  const YarnNetwork& net_;
  Real bin_;
  std::vector<std::pair<Bin, Index>> entries_;
};

// The bending radius of a segment's axis at its crossing: the yarns touch there, so it is the sum of their radii.
std::vector<Real> bending_radii(const YarnNetwork& net) {
  std::vector<Real> radius(net.segments(), 0);
  for (const Edge& e : net.edges)
    if (e.kind == EdgeKind::crossing)
      radius[e.a] = radius[e.b] = net.type_of_segment(e.a).radius + net.type_of_segment(e.b).radius;
  return radius;
}

Crown crown_of(const YarnNetwork& net, Index segment, Real bending) {
  const Real across = net.type_of_segment(segment).radius, along = bending + across;
  return net.family_of_segment(segment) == Family::warp ? Crown{across, along} : Crown{along, across};
}

// Segments of a layer whose crowns look up (side 1) or down (side -1).
std::vector<Index> crowns(const YarnNetwork& net, int layer, Real side) {
  const Real middle = net.layer_height(layer);
  std::vector<Index> out;
  const std::size_t count = net.segments() / static_cast<std::size_t>(net.layers), first = count * static_cast<std::size_t>(layer);
  for (std::size_t s = first; s < first + count; ++s)
    if (side * (net.segment_centre[s].z - middle) > 0) out.push_back(static_cast<Index>(s));
  return out;
}

void join_yarns(YarnNetwork& net, int upper, const std::vector<Real>& bending) {
  const std::vector<Index> above = crowns(net, upper, -1), below = crowns(net, upper + 1, 1);
  Real widest = 0;
  for (const YarnType& type : net.yarn_types) widest = std::max(widest, type.radius);
  // g below half the widest radius means d < sqrt(6) of it (parallel crowns, 3 r + 3 r): the grid misses no pair.
  const Grid grid(net, below, 4 * widest);
  for (const Index a : above) {
    const Vec3& top_a = net.segment_centre[a];
    const Real radius_a = net.type_of_segment(a).radius;
    grid.near(top_a, [&](Index b) {
      const Vec3& top_b = net.segment_centre[b];
      const Real radius_b = net.type_of_segment(b).radius;
      const Crown one = crown_of(net, a, bending[a]), other = crown_of(net, b, bending[b]);
      const Real apart = std::max<Real>(0, (top_a.z - radius_a) - (top_b.z + radius_b));
      const Real gap = apart + crown_gap(one, other, top_b.x - top_a.x, top_b.y - top_a.y);
      if (gap > 0.25 * (radius_a + radius_b)) return;
      net.edges.push_back({a, b, EdgeKind::face_back});
      net.face_contacts.push_back({gap, contact_area_per_height(one, other)});
    });
  }
}

void join_pores(YarnNetwork& net, int upper) {
  const std::size_t count = net.pores() / static_cast<std::size_t>(net.layers), segments = net.segments();
  const auto first = static_cast<Index>(segments + count * static_cast<std::size_t>(upper));
  std::vector<Index> below(count);
  for (std::size_t i = 0; i < count; ++i) below[i] = first + static_cast<Index>(count + i);
  const Grid grid(net, below, 2 * std::max(net.pitch_x, net.pitch_y));
  const auto overlap = [&](Index a, Index b) {
    const std::size_t i = a - segments, j = b - segments;
    const Vec3 d = net.pore_centre[j] - net.pore_centre[i];
    const Real x = 0.5 * (net.pore_opening_x[i] + net.pore_opening_x[j]) - std::abs(d.x);
    const Real y = 0.5 * (net.pore_opening_y[i] + net.pore_opening_y[j]) - std::abs(d.y);
    return x > 0 && y > 0;
  };
  for (std::size_t i = 0; i < count; ++i) {
    const Index a = first + static_cast<Index>(i);
    grid.near(net.node_centre(a), [&](Index b) {
      if (overlap(a, b)) net.edges.push_back({a, b, EdgeKind::pore_pore});
    });
  }
}

}  // namespace

Real crown_gap(const Crown& a, const Crown& b, Real dx, Real dy) {
  return 0.5 * (dx * dx / (a.radius_x + b.radius_x) + dy * dy / (a.radius_y + b.radius_y));
}

Real contact_area_per_height(const Crown& a, const Crown& b) {
  return 2 * pi / std::sqrt((1 / a.radius_x + 1 / b.radius_x) * (1 / a.radius_y + 1 / b.radius_y));
}

YarnNetwork stack_layers(std::vector<YarnNetwork> layers, Real gap) {
  IMBIBE_ASSERT(!layers.empty());
  if (layers.size() == 1) return std::move(layers.front());
  YarnNetwork net;
  const YarnNetwork& model = layers.front();
  const auto n = static_cast<int>(layers.size());
  net.size_x = model.size_x, net.size_y = model.size_y;
  net.pitch_x = model.pitch_x, net.pitch_y = model.pitch_y;
  net.points_per_segment = model.points_per_segment;
  net.layers = n;
  net.layer_gap = gap;
  net.thickness = n * model.thickness + (n - 1) * gap;
  for (int l = 0; l < n; ++l) append_layer(net, layers[static_cast<std::size_t>(l)], net.layer_height(l));
  // Edges know their nodes only once all segments are counted: pores come after them.
  const std::size_t segments = model.segments(), pores = model.pores();
  for (std::size_t l = 0; l < layers.size(); ++l) {
    IMBIBE_ASSERT(layers[l].segments() == segments && layers[l].pores() == pores);
    const auto node = [&](Index k) {
      return static_cast<Index>(k < segments ? k + l * segments : k + (layers.size() - 1) * segments + l * pores);
    };
    for (const Edge& e : layers[l].edges) net.edges.push_back({node(e.a), node(e.b), e.kind});
  }
  const std::vector<Real> bending = bending_radii(net);
  for (int l = 0; l + 1 < n; ++l) join_pores(net, l);
  for (int l = 0; l + 1 < n; ++l) join_yarns(net, l, bending);
  return net;
}

}  // namespace imbibe
