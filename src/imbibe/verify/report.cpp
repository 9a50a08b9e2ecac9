#include "imbibe/verify/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "imbibe/core/output_file.h"
#include "imbibe/io/report_style.h"
#include "imbibe/view/png.h"

namespace imbibe::verify {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

const std::string own_style = R"css(
.case { border-top: 1px solid var(--line); padding-top: 8px; }
.case h3 { font-size: 20px; margin-top: 24px; }
td.figure, th.figure { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
table.figures { border-collapse: collapse; width: 100%; margin: 10px 0; font-size: 14px; }
table.figures th, table.figures td { padding: 3px 8px; border-bottom: 1px solid var(--line); text-align: left; }
table.figures td.figure, table.figures th.figure { text-align: right; }
.good { color: var(--good); font-weight: 600; } .bad { color: var(--bad); font-weight: 600; }
.facts { display: grid; grid-template-columns: max-content 1fr; gap: 2px 14px; font-size: 14px; }
.facts dt { color: var(--soft); } .facts dd { margin: 0; }
.shown { max-width: 640px; width: 100%; border: 1px solid var(--line); border-radius: 6px; display: block; margin-top: 12px; }
)css";

std::string base64(const std::string& bytes) {
  static const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t block = 0;
    for (std::size_t k = 0; k < 3; ++k)
      block = block << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += i + k <= bytes.size() ? digits[block >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

std::string verdict(bool passed) {
  return passed ? "<span class=\"good\">passed</span>" : "<span class=\"bad\">FAILED</span>";
}

std::string fact(const std::string& name, const std::string& text) {
  return text.empty() ? "" : fmt::format("<dt>{}</dt><dd>{}</dd>\n", name, html_escaped(text));
}

std::string check_table(const CaseResult& r) {
  std::string html =
      "<table class=\"figures\"><tr><th>quantity</th><th class=\"figure\">computed</th><th class=\"figure\">reference</th>"
      "<th>unit</th><th class=\"figure\">error</th><th class=\"figure\">tolerance</th><th></th><th>why this tolerance"
      "</th></tr>\n";
  for (const Check& c : r.checks)
    html += fmt::format(
        "<tr><td>{}</td><td class=\"figure\">{}</td><td class=\"figure\">{}</td><td>{}</td><td class=\"figure\">{}</td>"
        "<td class=\"figure\">{}</td><td>{}</td><td>{}</td></tr>\n",
        html_escaped(c.quantity), figure_text(c.measured), figure_text(c.reference), html_escaped(c.unit), error_text(c),
        tolerance_text(c), verdict(c.passed), html_escaped(c.reason));
  return html + "</table>\n";
}

std::string convergence_table(const Convergence& c) {
  std::string html = fmt::format(
      "<table class=\"figures\"><tr><th>{}</th><th class=\"figure\">error of {}</th></tr>\n", html_escaped(c.step_name),
      html_escaped(c.error_of));
  for (const Convergence::Row& row : c.rows)
    html += fmt::format("<tr><td>{:.4g}</td><td class=\"figure\">{:+.3g}</td></tr>\n", row.step, row.error);
  return html + fmt::format("<tr><td>observed order</td><td class=\"figure\">{:.2f}</td></tr></table>\n", c.order);
}

std::string case_section(const CaseOutcome& o, const std::string& picture) {
  const Case& c = *o.of;
  std::string html = fmt::format("<section class=\"case\" id=\"{0}\"><h3>{1} <small>{2}</small></h3>\n<dl class=\"facts\">",
                                 c.name, html_escaped(c.title), verdict(o.passed()));
  html += fact("name", c.name) + fact("computed", c.computes) + fact("reference", c.formula) + fact("source", c.source);
  html += fact("assumptions", c.assumptions);
  for (const ParameterRow& p : o.result.parameters) html += fact(html_escaped(p.name), p.value);
  html += "</dl>\n";
  if (!o.failure.empty()) html += "<p class=\"bad\">Did not run to its end: " + html_escaped(o.failure) + "</p>\n";
  if (!o.result.checks.empty()) html += check_table(o.result);
  for (const Convergence& table : o.result.convergence) html += convergence_table(table);
  for (const std::string& note : o.result.notes) html += "<p>" + html_escaped(note) + "</p>\n";
  if (!o.result.charts.empty()) {
    html += "<div class=\"charts\">\n";
    for (const Chart& chart : o.result.charts) html += chart_html(chart);
    html += "</div>\n";
  }
  if (!picture.empty())
    html += fmt::format("<img class=\"shown\" alt=\"{0}\" src=\"data:image/png;base64,{1}\"><p class=\"kind\">{0}</p>\n",
                        html_escaped(o.result.picture_caption), base64(picture));
  if (!o.result.commands.empty()) {
    html += "<details><summary>By hand</summary><pre class=\"command\">";
    for (const std::string& command : o.result.commands) html += html_escaped(command) + "\n";
    html += "</pre></details>\n";
  }
  return html + "</section>\n";
}

std::string summary_table(const Verification& v) {
  std::string html =
      "<table class=\"figures\"><tr><th>case</th><th></th><th class=\"figure\">checks</th><th>largest share of a "
      "tolerance</th></tr>\n";
  std::string family;
  for (const CaseOutcome& o : v.outcomes) {
    if (o.of->family != family) {
      family = o.of->family;
      html += fmt::format("<tr><th colspan=\"4\">{}</th></tr>\n", html_escaped(family));
    }
    Real worst = 0;
    std::string of;
    for (const Check& c : o.result.checks) {
      const Real share = c.tolerance > 0 ? std::abs(c.error) / c.tolerance : c.passed ? 0 : 1e9;
      if (share >= worst) worst = share, of = c.quantity;
    }
    const auto failed = std::count_if(o.result.checks.begin(), o.result.checks.end(),
                                      [](const Check& c) { return !c.passed; });
    const std::string share = !o.failure.empty() ? "did not run to its end"
                              : worst >= 1e9 || o.result.checks.empty() ? html_escaped(of)
                                                                      : fmt::format("{:.0f} %: {}", 100 * worst, html_escaped(of));
    html += fmt::format("<tr><td><a href=\"#{}\">{}</a></td><td>{}</td><td class=\"figure\">{} of {}</td><td>{}</td></tr>\n",
                        o.of->name, html_escaped(o.of->title), verdict(o.passed()),
                        o.result.checks.size() - static_cast<std::size_t>(failed), o.result.checks.size(), share);
  }
  return html + "</table>\n";
}

std::string head(const Verification& v) {
  const auto failed = std::count_if(v.outcomes.begin(), v.outcomes.end(), [](const CaseOutcome& o) { return !o.passed(); });
  std::string html =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>Verification of Imbibe</title>\n<style>";
  html += report_style + own_style + "</style></head>\n<body><main>\n<h1>Verification of Imbibe " + html_escaped(v.version) +
          "</h1>\n";
  html += fmt::format("<p class=\"status {}\">{} of {} cases passed{}. {} form.</p>\n", failed ? "failed" : "done",
                      v.outcomes.size() - static_cast<std::size_t>(failed), v.outcomes.size(),
                      failed ? fmt::format("; {} failed", failed) : "", v.quick ? "Quick" : "Full");
  html +=
      "<p>Each case runs the solver through a scene file and compares it with a closed form or a published figure. "
      "Parameters come from the case's source or are the models' defaults; none is chosen for the result. "
      "A case outside its tolerance stays here with its error.</p>\n";
  return html + fmt::format("<pre class=\"command\">{}</pre>\n", html_escaped(v.command));
}

std::string picture_bytes(const fs::path& folder, const CaseOutcome& o) {
  const fs::path file = folder / "pictures" / (o.of->name + ".png");
  return o.result.picture.width > 0 && fs::exists(file) ? read_whole_file(file) : "";
}

std::string html_with_pictures(const Verification& v, const fs::path& folder) {
  std::string html = head(v) + summary_table(v), family;
  for (const CaseOutcome& o : v.outcomes) {
    if (o.of->family != family) html += "<h2>" + html_escaped(family = o.of->family) + "</h2>\n";
    html += case_section(o, folder.empty() ? "" : picture_bytes(folder, o));
  }
  return html + "</main></body></html>\n";
}

// Twelve digits: what is left of differences between machines' mathematics is below it.
Json number(Real value) {
  if (!std::isfinite(value)) return fmt::format("{}", value);
  return Json::parse(fmt::format("{:.9g}", value));
}

Json case_json(const CaseOutcome& o) {
  const Case& c = *o.of;
  Json j;
  j["name"] = c.name, j["family"] = c.family, j["title"] = c.title, j["passed"] = o.passed();
  if (!o.failure.empty()) j["failure"] = o.failure;
  j["computes"] = c.computes, j["formula"] = c.formula, j["source"] = c.source, j["assumptions"] = c.assumptions;
  j["models"] = c.models;
  j["parameters"] = Json::array();
  for (const ParameterRow& p : o.result.parameters) j["parameters"].push_back({{"name", p.name}, {"value", p.value}});
  j["checks"] = Json::array();
  for (const Check& k : o.result.checks)
    j["checks"].push_back({{"quantity", k.quantity}, {"measured", number(k.measured)}, {"reference", number(k.reference)},
                           {"unit", k.unit}, {"error", number(k.error)}, {"relative", k.relative},
                           {"tolerance", number(k.tolerance)}, {"reason", k.reason}, {"passed", k.passed}});
  j["convergence"] = Json::array();
  for (const Convergence& t : o.result.convergence) {
    Json rows = Json::array();
    for (const Convergence::Row& row : t.rows) rows.push_back({{"step", number(row.step)}, {"error", number(row.error)}});
    j["convergence"].push_back(
        {{"error_of", t.error_of}, {"step_name", t.step_name}, {"rows", rows}, {"order", number(t.order)}});
  }
  j["notes"] = o.result.notes;
  j["commands"] = o.result.commands;
  if (o.result.picture.width > 0) j["picture"] = "pictures/" + c.name + ".png", j["picture_caption"] = o.result.picture_caption;
  j["seconds"] = std::round(o.seconds * 100) / 100;
  return j;
}

}  // namespace

bool Verification::passed() const {
  return std::all_of(outcomes.begin(), outcomes.end(), [](const CaseOutcome& o) { return o.passed(); });
}

std::string figure_text(Real value) {
  if (!std::isfinite(value)) return fmt::format("{}", value);
  return fmt::format("{:.5g}", value);
}

std::string error_text(const Check& c) {
  if (!std::isfinite(c.error)) return fmt::format("{}", c.error);
  return c.relative ? fmt::format("{:+.3g} %", 100 * c.error) : fmt::format("{:+.3g}", c.error);
}

std::string tolerance_text(const Check& c) {
  if (c.tolerance == 0) return "bound";
  return c.relative ? fmt::format("{:.3g} %", 100 * c.tolerance) : fmt::format("{:.3g}", c.tolerance);
}

std::string json_of(const Verification& v) {
  Json j;
  j["version"] = v.version;
  j["form"] = v.quick ? "quick" : "full";
  j["passed"] = v.passed();
  j["cases"] = Json::array();
  for (const CaseOutcome& o : v.outcomes) j["cases"].push_back(case_json(o));
  return j.dump(1) + "\n";
}

std::string html_of(const Verification& v) { return html_with_pictures(v, {}); }

void write_report(const Verification& v, const fs::path& folder) {
  fs::create_directories(folder / "pictures");
  for (const CaseOutcome& o : v.outcomes) {
    if (o.result.picture.width > 0) write_png(folder / "pictures" / (o.of->name + ".png"), o.result.picture);
  }
  write_whole_file(folder / "verify.json", json_of(v));
  write_whole_file(folder / "verify.html", html_with_pictures(v, folder));
}

}  // namespace imbibe::verify
