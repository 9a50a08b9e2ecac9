// A line chart as inline SVG: axes with round ticks and units, grid, legend; colours by CSS variables --curve-1 ... of
// the page, so that it follows light and dark. Tested in tests/io/report_test.cpp.
#pragma once

#include <string>
#include <vector>

#include "imbibe/core/types.h"

namespace imbibe {

struct Curve {
  std::string name;
  std::vector<Real> values;     // one per x, in SI; shown divided by Chart::y_unit
  std::string last_value;       // shown behind the name in the legend
};

// A unit of an axis: what is drawn is value / size.
struct AxisUnit {
  Real size = 1;
  std::string symbol;
};

struct Chart {
  std::string title;
  std::string x_name = "time";
  AxisUnit x_unit;
  std::string y_name;
  AxisUnit y_unit;
  bool logarithmic = false;     // y; values <= 0 are drawn at the lower end
  std::vector<Real> x;
  std::vector<Curve> curves;
  Real limit = 0;               // > 0: a dashed line there
  std::string limit_name;
};

// A <figure> element. Says so in words where there is nothing to draw.
std::string chart_html(const Chart& chart);

// Round numbers (1, 2 or 5 times a power of ten apart) that cover [lower, upper], at most `most` + 2 of them; the first
// is <= lower, the last >= upper.
std::vector<Real> round_ticks(Real lower, Real upper, int most);

// The unit in which `largest` reads best: mg, mm, mm2, min, ...; `si` is kg, m, m2, s or anything else (no prefix).
AxisUnit axis_unit(Real largest, const std::string& si);

// Text as it may stand in HTML and in attributes.
std::string html_escaped(const std::string& text);

}  // namespace imbibe
