#include "imbibe/fabric/weaving.h"

#include <fmt/format.h>

#include <algorithm>

#include "imbibe/core/parallel.h"
#include "imbibe/core/quantity.h"
#include "imbibe/fabric/crimp.h"

namespace imbibe {
namespace {

// One family seen along its own yarns: `own` are the yarns that run, `across` those they cross.
struct View {
  const Layout& layout;
  Family family;

  const std::vector<Real>& own_place() const { return family == Family::warp ? layout.end_place : layout.pick_place; }
  const std::vector<Real>& across_place() const { return family == Family::warp ? layout.pick_place : layout.end_place; }
  Real own_radius(std::size_t yarn) const {
    return layout.types[family == Family::warp ? layout.end_type[yarn] : layout.pick_type[yarn]].radius;
  }
  // `k` may be -1 or one past the last: the cloth goes on with the draft and the outermost yarn.
  std::size_t clamped(std::ptrdiff_t k) const {
    return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, std::ssize(across_place()) - 1));
  }
  Real across_radius(std::ptrdiff_t k) const {
    return layout.types[family == Family::warp ? layout.pick_type[clamped(k)] : layout.end_type[clamped(k)]].radius;
  }
  Real across_at(std::ptrdiff_t k) const {
    const std::vector<Real>& place = across_place();
    if (k < 0) return 2 * place[0] - place[1];
    if (k >= std::ssize(place)) return 2 * place.back() - place[place.size() - 2];
    return place[static_cast<std::size_t>(k)];
  }
  Real edge() const { return (family == Family::warp ? layout.size_y : layout.size_x) / 2; }

  Real height(std::size_t yarn, std::ptrdiff_t k) const {
    const auto repeat = static_cast<std::ptrdiff_t>(family == Family::warp ? layout.draft.picks : layout.draft.ends);
    const auto wrapped = static_cast<std::size_t>(((k % repeat) + repeat) % repeat);
    const bool warp_up =
        family == Family::warp ? layout.draft.warp_on_face(wrapped, yarn) : layout.draft.warp_on_face(yarn, wrapped);
    const Real own = own_radius(yarn), across = across_radius(k), touch = own + across;
    Real lift = across;  // flush faces
    if (layout.warp_crimp_share) lift = touch * (family == Family::warp ? *layout.warp_crimp_share : 1 - *layout.warp_crimp_share);
    return warp_up == (family == Family::warp) ? lift : -lift;
  }
  // The path from crossing k to crossing k + 1.
  CrimpCurve curve(std::size_t yarn, std::ptrdiff_t k) const {
    const Real own = own_radius(yarn);
    return crimp_curve(across_at(k + 1) - across_at(k), height(yarn, k), height(yarn, k + 1), own + across_radius(k),
                       own + across_radius(k + 1));
  }
  // Middle of the gap between crossings k and k + 1; the sheet's edge outside the outermost ones.
  Real middle(std::ptrdiff_t k) const {
    if (k < 0) return -edge();
    if (k + 1 >= std::ssize(across_place())) return edge();
    return 0.5 * (across_at(k) + across_radius(k) + across_at(k + 1) - across_radius(k + 1));
  }
  // A point of the yarn's axis in the sheet.
  Vec3 place(std::size_t yarn, Real along, Real height_) const {
    const Real side = own_place()[yarn];
    return family == Family::warp ? Vec3{side, along, height_} : Vec3{along, side, height_};
  }
};

std::string prefixed(const std::string& key, const char* name) { return key.empty() ? name : key + "." + name; }

void check_gaps(const View& v, const std::string& key, std::vector<Problem>& problems) {
  const std::vector<Real>& place = v.own_place();
  Real worst = std::numeric_limits<Real>::infinity();
  std::size_t at = 0;
  for (std::size_t i = 0; i + 1 < place.size(); ++i) {
    const Real gap = place[i + 1] - place[i] - v.own_radius(i) - v.own_radius(i + 1);
    if (gap < worst) worst = gap, at = i;
  }
  if (worst > 0) return;
  const Real pitch = place[at + 1] - place[at], wanted = v.own_radius(at) + v.own_radius(at + 1);
  problems.push_back(Problem{
      "", 0, 0, prefixed(key, v.family == Family::warp ? "warp" : "weft"),
      fmt::format("the cell is smaller than its yarns: {} {} and {} are {} apart but {} thick; at most {:.4g} per cm of "
                  "this thickness fit",
                  v.family == Family::warp ? "ends" : "picks", at + 1, at + 2, format_quantity(pitch, "m", "mm"),
                  format_quantity(wanted, "m", "mm"), 0.01 / wanted)});
}

void check_bending(const View& v, const std::string& key, std::vector<Problem>& problems) {
  const std::ptrdiff_t across = std::ssize(v.across_place());
  Real worst = 0;
  std::size_t at_yarn = 0;
  std::ptrdiff_t at = 0;
  for (std::size_t yarn = 0; yarn < v.own_place().size(); ++yarn)
    for (std::ptrdiff_t s = -1; s < across; ++s) {
      const Real own = v.own_radius(yarn);
      const Real missing = least_span(v.height(yarn, s + 1) - v.height(yarn, s), own + v.across_radius(s),
                                      own + v.across_radius(s + 1)) /
                               (v.across_at(s + 1) - v.across_at(s)) - 1;
      if (missing > worst) worst = missing, at_yarn = yarn, at = s;
    }
  // Touching arcs (L = 0) are still woven; beyond rounding they are not.
  if (worst <= 1e-12) return;
  const bool warp = v.family == Family::warp;
  const Real pitch = v.across_at(at + 1) - v.across_at(at);
  problems.push_back(Problem{
      "", 0, 0, prefixed(key, warp ? "weft.density" : "warp.density"),
      fmt::format("the cell is smaller than its yarns: {} {} has no room to pass between {} {} and {}, {} apart; round "
                  "yarns of this size need {} ({:.4g} per cm). Use fewer or thinner yarns, or a higher packing",
                  warp ? "end" : "pick", at_yarn + 1, warp ? "picks" : "ends", v.clamped(at) + 1, v.clamped(at) + 2,
                  format_quantity(pitch, "m", "mm"), format_quantity(pitch * (1 + worst), "m", "mm"),
                  0.01 / (pitch * (1 + worst)))});
}

}  // namespace

CrossingHeights crossing_heights(const Layout& layout, std::size_t pick, std::size_t end) {
  return {View{layout, Family::warp}.height(end, static_cast<std::ptrdiff_t>(pick)),
          View{layout, Family::weft}.height(pick, static_cast<std::ptrdiff_t>(end))};
}

std::vector<Problem> check_layout(const Layout& layout, const std::string& key) {
  std::vector<Problem> problems;
  if (layout.end_place.size() < 2 || layout.pick_place.size() < 2) {
    problems.push_back(Problem{"", 0, 0, prefixed(key, "size"),
                               fmt::format("a sheet of {} ends and {} picks has no pore: at least 2 of each are needed",
                                           layout.end_place.size(), layout.pick_place.size())});
    return problems;
  }
  for (Family family : {Family::warp, Family::weft}) check_gaps(View{layout, family}, key, problems);
  if (!problems.empty()) return problems;
  for (Family family : {Family::warp, Family::weft}) check_bending(View{layout, family}, key, problems);
  return problems;
}

std::vector<Real> yarn_arcs(const Layout& layout, Family family, std::size_t yarn) {
  const View v{layout, family};
  const std::ptrdiff_t n = std::ssize(v.across_place());
  std::vector<Real> arcs(static_cast<std::size_t>(n) + 1);
  for (std::ptrdiff_t k = -1; k < n; ++k) {
    const CrimpCurve c = v.curve(yarn, k);
    Real arc = c.length;
    if (k < 0) arc -= arc_at(c, -v.edge() - v.across_at(-1));
    if (k == n - 1) arc = arc_at(c, v.edge() - v.across_at(n - 1));
    arcs[static_cast<std::size_t>(k + 1)] = arc;
  }
  return arcs;
}

Real layout_thickness(const Layout& layout) {
  Real thickness = 0;
  for (Family family : {Family::warp, Family::weft}) {
    const View v{layout, family};
    thickness = parallel_max(v.own_place().size(), thickness, [&](std::size_t begin, std::size_t end) {
      Real most = 0;
      for (std::size_t yarn = begin; yarn < end; ++yarn)
        for (std::ptrdiff_t k = 0; k < std::ssize(v.across_place()); ++k)
          most = std::max(most, 2 * (std::abs(v.height(yarn, k)) + v.own_radius(yarn)));
      return most;
    }, 4);
  }
  return thickness;
}

LayoutSums layout_sums(const Layout& layout) {
  LayoutSums sums;
  for (Family family : {Family::warp, Family::weft}) {
    const View v{layout, family};
    for (std::size_t yarn = 0; yarn < v.own_place().size(); ++yarn) {
      Real length = 0;
      for (Real arc : yarn_arcs(layout, family, yarn)) length += arc;
      const YarnType& type = layout.types[family == Family::warp ? layout.end_type[yarn] : layout.pick_type[yarn]];
      sums.volume_per_area += pi * type.radius * type.radius * length;
      sums.mass_per_area += type.linear_density * length;
    }
  }
  sums.volume_per_area /= layout.size_x * layout.size_y;
  sums.mass_per_area /= layout.size_x * layout.size_y;
  return sums;
}

namespace {

// Lays one yarn into the network: its points, segments and (in `arcs`) the arc lengths between its crossings.
void lay_yarn(const View& v, std::size_t yarn, std::size_t number, YarnNetwork& net, std::vector<Real>& arcs) {
  const std::ptrdiff_t n = std::ssize(v.across_place());
  const Index first = net.yarn_first_segment[number];
  const std::size_t steps = static_cast<std::size_t>(net.points_per_segment) / 2;
  std::size_t point = net.yarn_first_point[number];
  const std::size_t first_arc = first + number;  // a yarn has one gap more than crossings
  Real before = 0;  // arc from the last cut to the coming crossing
  for (std::ptrdiff_t k = -1; k < n; ++k) {
    const CrimpCurve c = v.curve(yarn, k);
    const Real start = v.across_at(k), cut = arc_at(c, std::clamp<Real>(v.middle(k) - start, 0, c.span));
    const auto put = [&](Real arc) {
      const CrimpPoint p = point_at(c, arc);
      net.points[point++] = v.place(yarn, start + p.along, p.height);
    };
    // From crossing k to the cut: the second half of segment k.
    if (k >= 0) {
      net.segment_length[first + static_cast<std::size_t>(k)] = before + cut;
      for (std::size_t j = 1; j <= steps; ++j) put(cut * static_cast<Real>(j) / static_cast<Real>(steps));
    } else {
      put(cut);
    }
    // From the cut to crossing k + 1: the first half of segment k + 1.
    before = c.length - cut;
    if (k + 1 < n) {
      for (std::size_t j = 1; j <= steps; ++j) put(cut + before * static_cast<Real>(j) / static_cast<Real>(steps));
      const std::size_t s = first + static_cast<std::size_t>(k + 1);
      net.segment_yarn[s] = static_cast<Index>(number);
      net.segment_centre[s] = v.place(yarn, v.across_at(k + 1), v.height(yarn, k + 1));
    }
    arcs[first_arc + static_cast<std::size_t>(k + 1)] = k < 0 ? before : k == n - 1 ? cut : c.length;
  }
}

void lay_pores(const Layout& layout, const std::vector<Real>& arcs, YarnNetwork& net) {
  const View warp{layout, Family::warp}, weft{layout, Family::weft};
  const std::size_t ends = layout.end_place.size(), picks = layout.pick_place.size();
  const std::size_t columns = ends - 1, pores = columns * (picks - 1);
  net.pore_centre.resize(pores);
  net.pore_volume.resize(pores);
  net.pore_opening_x.resize(pores);
  net.pore_opening_y.resize(pores);
  net.pore_throat.resize(pores);
  net.pore_area.resize(pores);
  // Half a yarn's section times the arc between the two crossings lies in the pore's cell.
  const auto half_yarn = [&](std::size_t yarn, std::size_t gap) {
    const Real r = net.yarn_types[net.yarn_type[yarn]].radius;
    return pi * r * r / 2 * arcs[net.yarn_first_segment[yarn] + yarn + gap + 1];
  };
  parallel_for(pores, [&](std::size_t pore) {
    const std::size_t j = pore / columns, i = pore % columns;
    const Real px = layout.end_place[i + 1] - layout.end_place[i], py = layout.pick_place[j + 1] - layout.pick_place[j];
    const Real wx = px - warp.own_radius(i) - warp.own_radius(i + 1);
    const Real wy = py - weft.own_radius(j) - weft.own_radius(j + 1);
    net.pore_centre[pore] = {weft.middle(static_cast<std::ptrdiff_t>(i)), warp.middle(static_cast<std::ptrdiff_t>(j)), 0};
    net.pore_opening_x[pore] = wx;
    net.pore_opening_y[pore] = wy;
    net.pore_throat[pore] = wx * wy / (wx + wy);
    net.pore_area[pore] = px * py;
    net.pore_volume[pore] = px * py * net.thickness - half_yarn(i, j) - half_yarn(i + 1, j) - half_yarn(ends + j, i) -
                            half_yarn(ends + j + 1, i);
  });
}

void connect(std::size_t ends, std::size_t picks, YarnNetwork& net) {
  const auto warp_segment = [&](std::size_t end, std::size_t pick) { return static_cast<Index>(end * picks + pick); };
  const auto weft_segment = [&](std::size_t pick, std::size_t end) {
    return static_cast<Index>(ends * picks + pick * ends + end);
  };
  const std::size_t columns = ends - 1, rows = picks - 1;
  const auto pore = [&](std::size_t row, std::size_t column) {
    return static_cast<Index>(net.segments() + row * columns + column);
  };
  net.edges.reserve(ends * rows + picks * columns + ends * picks + 8 * rows * columns + rows * (columns - 1) +
                    columns * (rows - 1));
  for (std::size_t i = 0; i < ends; ++i)
    for (std::size_t j = 0; j < rows; ++j)
      net.edges.push_back({warp_segment(i, j), warp_segment(i, j + 1), EdgeKind::along_yarn});
  for (std::size_t j = 0; j < picks; ++j)
    for (std::size_t i = 0; i < columns; ++i)
      net.edges.push_back({weft_segment(j, i), weft_segment(j, i + 1), EdgeKind::along_yarn});
  for (std::size_t j = 0; j < picks; ++j)
    for (std::size_t i = 0; i < ends; ++i)
      net.edges.push_back({warp_segment(i, j), weft_segment(j, i), EdgeKind::crossing});
  for (std::size_t j = 0; j < rows; ++j)
    for (std::size_t i = 0; i < columns; ++i)
      for (std::size_t b = 0; b < 2; ++b)
        for (std::size_t a = 0; a < 2; ++a) {
          net.edges.push_back({warp_segment(i + a, j + b), pore(j, i), EdgeKind::segment_pore});
          net.edges.push_back({weft_segment(j + b, i + a), pore(j, i), EdgeKind::segment_pore});
        }
  for (std::size_t j = 0; j < rows; ++j)
    for (std::size_t i = 0; i < columns; ++i) {
      if (i + 1 < columns) net.edges.push_back({pore(j, i), pore(j, i + 1), EdgeKind::pore_pore});
      if (j + 1 < rows) net.edges.push_back({pore(j, i), pore(j + 1, i), EdgeKind::pore_pore});
    }
}

void allocate(const Layout& layout, YarnNetwork& net) {
  const std::size_t ends = layout.end_place.size(), picks = layout.pick_place.size(), yarns = ends + picks;
  net.yarn_family.resize(yarns);
  net.yarn_type.resize(yarns);
  net.yarn_first_segment.resize(yarns + 1);
  net.yarn_first_point.resize(yarns + 1);
  std::size_t segment = 0, point = 0;
  for (std::size_t y = 0; y <= yarns; ++y) {
    net.yarn_first_segment[y] = static_cast<Index>(segment);
    net.yarn_first_point[y] = static_cast<Index>(point);
    if (y == yarns) break;
    const bool warp = y < ends;
    net.yarn_family[y] = warp ? Family::warp : Family::weft;
    net.yarn_type[y] = warp ? layout.end_type[y] : layout.pick_type[y - ends];
    const std::size_t crossings = warp ? picks : ends;
    segment += crossings;
    point += crossings * static_cast<std::size_t>(net.points_per_segment) + 1;
  }
  net.points.resize(point);
  net.segment_yarn.resize(segment);
  net.segment_centre.resize(segment);
  net.segment_length.resize(segment);
}

}  // namespace

YarnNetwork weave_network(const Layout& layout, const std::string& key) {
  IMBIBE_ASSERT(layout.end_place.size() >= 2 && layout.pick_place.size() >= 2);
  IMBIBE_ASSERT(layout.points_per_segment >= 2 && layout.points_per_segment % 2 == 0);
  const std::size_t ends = layout.end_place.size(), picks = layout.pick_place.size();
  YarnNetwork net;
  net.size_x = layout.size_x;
  net.size_y = layout.size_y;
  net.pitch_x = (layout.end_place.back() - layout.end_place.front()) / static_cast<Real>(ends - 1);
  net.pitch_y = (layout.pick_place.back() - layout.pick_place.front()) / static_cast<Real>(picks - 1);
  net.yarn_types = layout.types;
  net.points_per_segment = layout.points_per_segment;
  net.thickness = layout.thickness ? *layout.thickness : layout_thickness(layout);
  allocate(layout, net);
  std::vector<Real> arcs(net.segments() + ends + picks);
  parallel_for(ends + picks, [&](std::size_t y) {
    const Family family = y < ends ? Family::warp : Family::weft;
    lay_yarn(View{layout, family}, y < ends ? y : y - ends, y, net, arcs);
  }, 4);
  lay_pores(layout, arcs, net);
  const auto least = std::min_element(net.pore_volume.begin(), net.pore_volume.end());
  if (*least <= 0)
    throw InputError(std::vector{Problem{
        "", 0, 0, prefixed(key, "thickness"),
        fmt::format("a slab of {} is filled by its yarns: pore {} would hold {:.3g} mm3; more thickness or fewer yarns "
                    "are needed",
                    format_quantity(net.thickness, "m", "mm"), least - net.pore_volume.begin(), *least * 1e9)}});
  connect(ends, picks, net);
  return net;
}

}  // namespace imbibe
