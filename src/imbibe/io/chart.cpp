#include "imbibe/io/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace imbibe {

namespace {

// The drawing, in the units of its view box.
constexpr Real width = 620, height = 280, left = 62, right = 14, top = 12, bottom = 40;
constexpr std::size_t most_points = 600;  // about one per pixel; more would only make the page heavy

// Where a value lies on an axis of the drawing.
struct Axis {
  Real lower = 0, upper = 1, from = 0, to = 1;  // values; places
  bool logarithmic = false;
  Real place(Real value) const {
    const auto scale = [&](Real x) { return logarithmic ? std::log10(x) : x; };
    const Real clamped = std::clamp(value, lower, upper);
    return from + (scale(clamped) - scale(lower)) / (scale(upper) - scale(lower)) * (to - from);
  }
};

struct Range {
  Real lower = 0, upper = 0;
};

Range range_of(const Chart& chart) {
  Range range;
  bool first = true;
  for (const Curve& curve : chart.curves) {
    for (const Real value : curve.values) {
      const Real y = value / chart.y_unit.size;
      if (!std::isfinite(y) || (chart.logarithmic && y <= 0)) continue;
      range.lower = first ? y : std::min(range.lower, y);
      range.upper = first ? y : std::max(range.upper, y);
      first = false;
    }
  }
  if (chart.limit > 0) {
    range.upper = std::max(range.upper, chart.limit / chart.y_unit.size);
    if (first) range.lower = range.upper / 1e6;
  }
  return range;
}

std::vector<Real> decade_ticks(Real lower, Real upper) {
  const int from = static_cast<int>(std::floor(std::log10(lower) + 1e-9));
  const int to = std::max(from + 1, static_cast<int>(std::ceil(std::log10(upper) - 1e-9)));
  const int stride = std::max(1, (to - from + 5) / 6);
  std::vector<Real> ticks;
  for (int e = from; e < to + stride; e += stride) ticks.push_back(std::pow(10.0, e));
  return ticks;
}

std::string tick_text(Real value, bool logarithmic) {
  if (logarithmic) return fmt::format("{:.0e}", value);
  return fmt::format("{:.6g}", std::fabs(value) < 1e-12 ? 0.0 : value);
}

std::string path_of(const Chart& chart, const Curve& curve, const Axis& x, const Axis& y) {
  const std::size_t count = std::min(chart.x.size(), curve.values.size());
  // Of each group of points the first, the lowest and the highest are drawn: peaks survive the thinning.
  const std::size_t group = count <= most_points ? 1 : (3 * count + most_points - 1) / most_points;
  std::string path;
  const auto add = [&](std::size_t i) {
    const Real value = curve.values[i] / chart.y_unit.size;
    if (!std::isfinite(value)) return;
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", x.place(chart.x[i] / chart.x_unit.size),
                        y.place(value));
  };
  for (std::size_t begin = 0; begin < count; begin += group) {
    const std::size_t end = std::min(count, begin + group);
    std::array<std::size_t, 3> chosen{begin, begin, begin};
    for (std::size_t i = begin; i < end; ++i) {
      if (curve.values[i] < curve.values[chosen[1]]) chosen[1] = i;
      if (curve.values[i] > curve.values[chosen[2]]) chosen[2] = i;
    }
    std::sort(chosen.begin(), chosen.end());
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      if (k == 0 || chosen[k] != chosen[k - 1]) add(chosen[k]);
    }
  }
  if (count > 0 && group > 1) add(count - 1);
  return path;
}

std::string with_unit(const std::string& name, const AxisUnit& unit) {
  return html_escaped(unit.symbol.empty() ? name : name + " [" + unit.symbol + "]");
}

std::string frame_svg(const Chart& chart, const Axis& x, const Axis& y, const std::vector<Real>& x_ticks,
                      const std::vector<Real>& y_ticks) {
  std::string svg;
  for (const Real tick : y_ticks) {
    const Real at = y.place(tick);
    svg += fmt::format("<line class=\"grid\" x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>", left, width - right,
                       at, at);
    svg += fmt::format("<text class=\"tick\" x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n", left - 7, at + 4,
                       tick_text(tick, chart.logarithmic));
  }
  for (const Real tick : x_ticks) {
    if (tick < x.lower - 1e-12 || tick > x.upper * (1 + 1e-9)) continue;
    const Real at = x.place(tick);
    svg += fmt::format("<line class=\"axis\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{}\" y2=\"{}\"/>", at, at,
                       height - bottom, height - bottom + 4);
    svg += fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", at,
                       height - bottom + 17, tick_text(tick, false));
  }
  svg += fmt::format("<line class=\"axis\" x1=\"{}\" x2=\"{}\" y1=\"{}\" y2=\"{}\"/>\n", left, width - right,
                     height - bottom, height - bottom);
  svg += fmt::format("<text class=\"name\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                     (left + width - right) / 2, height - 6, with_unit(chart.x_name, chart.x_unit));
  svg +=
      fmt::format("<text class=\"name\" transform=\"translate(13 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                  (top + height - bottom) / 2, with_unit(chart.y_name, chart.y_unit));
  return svg;
}

std::string legend_html(const Chart& chart) {
  std::string html = "<ul class=\"legend\">";
  for (std::size_t i = 0; i < chart.curves.size(); ++i) {
    html += fmt::format(
        "<li><svg class=\"swatch\" viewBox=\"0 0 22 8\"><path class=\"curve c{}\" d=\"M0 4L22 4\"/></svg>{}", i + 1,
        html_escaped(chart.curves[i].name));
    if (!chart.curves[i].last_value.empty()) html += " <b>" + html_escaped(chart.curves[i].last_value) + "</b>";
    html += "</li>";
  }
  return html + "</ul>";
}

}  // namespace

std::string html_escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::vector<Real> round_ticks(Real lower, Real upper, int most) {
  if (!(upper > lower)) upper = lower + (lower != 0 ? std::fabs(lower) : 1);
  const Real rough = (upper - lower) / std::max(1, most);
  const Real power = std::pow(10.0, std::floor(std::log10(rough)));
  Real stride = 10 * power;
  for (const Real factor : {5.0, 2.0, 1.0}) {
    if (factor * power >= rough * (1 - 1e-9)) stride = factor * power;
  }
  std::vector<Real> ticks;
  const Real first = std::floor(lower / stride + 1e-9), last = std::ceil(upper / stride - 1e-9);
  for (Real k = first; k <= last; ++k) ticks.push_back(k * stride);
  return ticks;
}

AxisUnit axis_unit(Real largest, const std::string& si) {
  largest = std::fabs(largest);
  if (si == "kg") {
    if (largest >= 1) return {1, "kg"};
    if (largest >= 1e-3 || largest == 0) return {1e-3, "g"};
    return largest >= 1e-6 ? AxisUnit{1e-6, "mg"} : AxisUnit{1e-9, "µg"};
  }
  if (si == "m")
    return largest >= 1                      ? AxisUnit{1, "m"}
           : largest >= 1e-4 || largest == 0 ? AxisUnit{1e-3, "mm"}
                                             : AxisUnit{1e-6, "µm"};
  if (si == "m2")
    return largest >= 1 ? AxisUnit{1, "m²"} : largest >= 1e-3 ? AxisUnit{1e-4, "cm²"} : AxisUnit{1e-6, "mm²"};
  if (si == "s") {
    if (largest >= 2 * 86400) return {3600, "h"};
    if (largest >= 3 * 3600) return {3600, "h"};
    if (largest >= 300) return {60, "min"};
    return largest >= 0.5 || largest == 0 ? AxisUnit{1, "s"}
           : largest >= 5e-4              ? AxisUnit{1e-3, "ms"}
                                          : AxisUnit{1e-6, "µs"};
  }
  return {1, si};
}

std::string chart_html(const Chart& chart) {
  const std::string title = html_escaped(chart.title);
  std::string html =
      fmt::format("<figure class=\"chart\"><figcaption>{}</figcaption>\n{}\n", title, legend_html(chart));
  if (chart.x.size() < 2)
    return html + "<p class=\"nothing\">Fewer than two rows so far: nothing to draw.</p></figure>\n";

  const Range range = range_of(chart);
  Axis x{chart.x.front() / chart.x_unit.size, chart.x.back() / chart.x_unit.size, left, width - right, false};
  if (!(x.upper > x.lower)) x.upper = x.lower + 1;
  const std::vector<Real> x_ticks = round_ticks(x.lower, x.upper, 7);
  std::vector<Real> y_ticks;
  if (chart.logarithmic) {
    y_ticks = range.upper > 0 ? decade_ticks(range.lower, range.upper) : std::vector<Real>{1e-16, 1};
  } else {
    y_ticks = round_ticks(std::min(0.0, range.lower), std::max(range.upper, 0.0), 5);
  }
  const Axis y{y_ticks.front(), y_ticks.back(), height - bottom, top, chart.logarithmic};

  html +=
      fmt::format("<svg class=\"plot\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n", width, height, title);
  html += frame_svg(chart, x, y, x_ticks, y_ticks);
  if (chart.limit > 0) {
    const Real at = y.place(chart.limit / chart.y_unit.size);
    html += fmt::format("<line class=\"limit\" x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>", left, width - right,
                        at, at);
    html += fmt::format("<text class=\"tick\" x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n", width - right - 4,
                        at - 5 < top + 8 ? at + 14 : at - 5, html_escaped(chart.limit_name));
  }
  for (std::size_t i = 0; i < chart.curves.size(); ++i) {
    html += fmt::format("<path class=\"curve c{}\" d=\"{}\"><title>{}</title></path>\n", i + 1,
                        path_of(chart, chart.curves[i], x, y), html_escaped(chart.curves[i].name));
  }
  return html + "</svg></figure>\n";
}

}  // namespace imbibe
