#include "imbibe/view/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include "imbibe/view/text_glyphs.h"

namespace imbibe {

namespace {

using detail::Glyph;
using detail::glyph_capital;
using detail::glyph_of;
using detail::glyph_spacing;

// Next character of UTF-8 text; a byte that is no UTF-8 counts as one unknown character.
char32_t take_character(std::string_view& text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  const std::size_t length = first < 0x80 ? 1 : first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : first >= 0xC0 ? 2 : 0;
  char32_t code = length == 1 ? first : U'\uFFFD';
  std::size_t used = 1;
  if (length > 1 && text.size() >= length) {
    code = first & (0x7F >> length);
    for (used = 1; used < length && (byte(used) & 0xC0) == 0x80; ++used) code = (code << 6) | (byte(used) & 0x3F);
    if (used < length) code = U'\uFFFD';
  }
  text.remove_prefix(used);
  return code;
}

struct PenPoint {
  Real x = 0, y = 0;
};
using PenLine = std::vector<PenPoint>;

std::vector<Real> numbers_in(std::string_view text) {
  std::vector<Real> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at < end) {
    Real value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error == std::errc{}) numbers.push_back(value);
    at = error == std::errc{} ? next : at + 1;
  }
  return numbers;
}

PenLine arc(const std::vector<Real>& n) {
  PenLine line;
  const int steps = std::max(2, static_cast<int>(std::ceil(std::abs(n[5] - n[4]) / 9)));
  for (int i = 0; i <= steps; ++i) {
    const Real angle = radians(n[4] + (n[5] - n[4]) * i / steps);
    line.push_back({n[0] + n[2] * std::cos(angle), n[1] + n[3] * std::sin(angle)});
  }
  return line;
}

// Catmull-Rom through the points, ends doubled.
PenLine smooth(const PenLine& p) {
  PenLine line;
  const int last = static_cast<int>(p.size()) - 1;
  const auto at = [&](int i) { return p[static_cast<std::size_t>(std::clamp(i, 0, last))]; };
  for (int i = 0; i < last; ++i) {
    for (int k = 0; k < 8; ++k) {
      const Real t = k / 8.0;
      const auto mix = [&](Real a, Real b, Real c, Real d) {
        return 0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t * t + (3 * b - a - 3 * c + d) * t * t * t);
      };
      const PenPoint a = at(i - 1), b = at(i), c = at(i + 1), d = at(i + 2);
      line.push_back({mix(a.x, b.x, c.x, d.x), mix(a.y, b.y, c.y, d.y)});
    }
  }
  line.push_back(p.back());
  return line;
}

std::vector<PenLine> pen_lines(const Glyph& glyph) {
  std::vector<PenLine> lines;
  std::string_view rest = glyph.strokes;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('|'), rest.size());
    const std::string_view stroke = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const std::vector<Real> n = numbers_in(stroke.substr(1));
    if (stroke[0] == 'E') {
      lines.push_back(arc(n));
      continue;
    }
    PenLine points;
    for (std::size_t i = 0; i + 1 < n.size(); i += 2) points.push_back({n[i], n[i + 1]});
    lines.push_back(stroke[0] == 'S' ? smooth(points) : points);
  }
  return lines;
}

Real squared_distance(const PenPoint& p, const PenPoint& a, const PenPoint& b) {
  const Real dx = b.x - a.x, dy = b.y - a.y, length2 = dx * dx + dy * dy;
  const Real t = length2 > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / length2, 0.0, 1.0) : 0.0;
  const Real ex = p.x - a.x - t * dx, ey = p.y - a.y - t * dy;
  return ex * ex + ey * ey;
}

struct Pen {
  Real radius = 1;  // px
  Vec3f colour;
  float opacity = 1;
};

void stamp_glyph(Image& image, const std::vector<PenLine>& lines, const Pen& pen) {
  PenPoint low{1e30, 1e30}, high{-1e30, -1e30};
  for (const PenLine& line : lines)
    for (const PenPoint& p : line) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
  if (low.x > high.x) return;
  const Real reach = pen.radius + 1;
  const int x0 = std::max(0, static_cast<int>(std::floor(low.x - reach)));
  const int x1 = std::min(image.width - 1, static_cast<int>(std::ceil(high.x + reach)));
  const int y0 = std::max(0, static_cast<int>(std::floor(low.y - reach)));
  const int y1 = std::min(image.height - 1, static_cast<int>(std::ceil(high.y + reach)));
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const PenPoint p{x + 0.5, y + 0.5};
      Real nearest = reach * reach;
      for (const PenLine& line : lines)
        for (std::size_t i = 0; i + 1 < line.size(); ++i)
          nearest = std::min(nearest, squared_distance(p, line[i], line[i + 1]));
      const Real coverage = std::clamp(pen.radius + 0.5 - std::sqrt(nearest), 0.0, 1.0);
      blend_pixel(image, x, y, pen.colour, pen.opacity * static_cast<float>(coverage));
    }
}

template <class Visit>
void for_each_glyph(std::string_view text, Visit&& visit) {
  while (!text.empty()) visit(glyph_of(take_character(text)));
}

void stamp_text(Image& image, Real x, Real y, std::string_view text, Real height, const Pen& pen) {
  const Real scale = height / glyph_capital;
  for_each_glyph(text, [&](const Glyph& glyph) {
    std::vector<PenLine> lines = pen_lines(glyph);
    for (PenLine& line : lines)
      for (PenPoint& p : line) p = {x + scale * p.x, y - scale * p.y};
    stamp_glyph(image, lines, pen);
    x += scale * (glyph.width + glyph_spacing);
  });
}

}  // namespace

Real text_width(std::string_view text, Real height) {
  Real width = 0;
  for_each_glyph(text, [&](const Glyph& glyph) { width += glyph.width + glyph_spacing; });
  return std::max(0.0, width - glyph_spacing) * height / glyph_capital;
}

void draw_text(Image& image, Real x, Real y, std::string_view text, const TextStyle& style) {
  const Real width = text_width(text, style.height);
  if (style.align == TextAlign::centre) x -= width / 2;
  if (style.align == TextAlign::right) x -= width;
  const Real radius = std::max(0.55, 0.5 * style.weight * style.height);
  if (style.halo_opacity > 0)
    stamp_text(image, x, y, text, style.height, {radius + 0.18 * style.height, style.halo, style.halo_opacity});
  stamp_text(image, x, y, text, style.height, {radius, style.colour, 1});
}

Real fitted_text_height(std::string_view text, Real height, Real width) {
  const Real full = text_width(text, height);
  return full > width ? height * width / full : height;
}

}  // namespace imbibe
