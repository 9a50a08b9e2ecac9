#include "imbibe/io/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "imbibe/core/error.h"
#include "imbibe/core/output_file.h"
#include "imbibe/io/chart.h"
#include "imbibe/io/progress.h"
#include "imbibe/io/report_style.h"
#include "imbibe/io/series.h"

namespace imbibe {

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

struct RunRecord {
  fs::path folder;
  Json run;
  SeriesTable series;

  std::string text(const char* key) const {
    return run.contains(key) && run[key].is_string() ? run[key].get<std::string>() : "";
  }
  Real number(const char* key) const { return number_in(run, key); }
  static Real number_in(const Json& json, const char* key) {
    return json.contains(key) && json[key].is_number() ? json[key].get<Real>() : 0;
  }
  Real last(const char* column) const { return series.rows() ? series.column(column).back() : 0; }
  Real largest(const char* column) const {
    Real most = 0;
    for (const Real x : series.column(column)) most = std::max(most, x);
    return most;
  }
};

RunRecord read_run(const fs::path& folder) {
  RunRecord record{folder, Json::parse(read_whole_file(folder / "run.json"), nullptr, false),
                   read_series(folder / "series.csv")};
  if (!record.run.is_object()) throw InputError((folder / "run.json").string() + " is damaged: it is not JSON");
  for (const std::string& name : series_columns()) record.series.column(name);
  return record;
}

std::vector<std::string> pictures_of(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder / "pictures", none)) {
    if (entry.path().extension() == ".png") names.push_back("pictures/" + entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

// What the textiles hold beyond what their fibres had at the start.
Real taken_up(const RunRecord& r, std::size_t row) {
  const auto at = [&](const char* name) { return r.series.column(name)[row]; };
  return at("sorbed_kg") + at("yarn_kg") + at("pore_kg") + at("cell_kg") - at("initial_kg");
}

// The first time from which less than a thousandth of the supplied liquid is free; < 0 when it never came to that.
Real time_all_gone(const RunRecord& r) {
  const std::vector<Real>&free = r.series.column("free_kg"), &supplied = r.series.column("supplied_kg");
  std::size_t row = r.series.rows();
  while (row > 0 && free[row - 1] <= 1e-3 * supplied[row - 1] && supplied[row - 1] > 0) --row;
  return row < r.series.rows() ? r.series.column("time_s")[row] : -1;
}

std::string tile(const std::string& name, const std::string& value, const std::string& detail = "") {
  std::string html = fmt::format("<div class=\"tile\"><dt>{}</dt><dd>{}</dd>", html_escaped(name), html_escaped(value));
  if (!detail.empty()) html += "<p>" + html_escaped(detail) + "</p>";
  return html + "</div>\n";
}

std::string share_of(Real part, Real whole) {
  // Rounding of sums may leave -0.0: shown as zero.
  const double percent = whole > 0 && std::abs(part) > 1e-12 * whole ? 100 * part / whole : 0;
  return whole > 0 ? fmt::format("{:.1f} % of the liquid", percent) : "";
}

std::string key_figures(const RunRecord& r) {
  if (r.series.rows() == 0) return "<p>No output time was reached.</p>\n";
  const std::size_t end = r.series.rows() - 1;
  const Real supplied = r.last("supplied_kg"), taken = taken_up(r, end);
  const Real steps = r.number("steps"), wall = r.number("wall_s");
  std::string html = "<dl class=\"tiles\">\n";
  html += tile("Simulated time", scaled_text(r.last("time_s"), "s"),
               r.text("status") == "done" ? "" : "of " + scaled_text(r.number("until_s"), "s") + " asked for");
  html += tile("Liquid supplied", scaled_text(supplied, "kg"));
  html += tile("Taken up by the cloth", scaled_text(taken, "kg"), share_of(taken, supplied));
  html += tile("Still free", scaled_text(r.last("free_kg"), "kg"), share_of(r.last("free_kg"), supplied));
  html += tile("Evaporated", scaled_text(r.last("evaporated_kg"), "kg"));
  const Real gone = time_all_gone(r);
  html += tile("Liquid gone from the face", gone >= 0 ? "at " + scaled_text(gone, "s") : "not within the run",
               "less than 0.1 % left free");
  html += tile("Wetted area", scaled_text(r.last("wet_area_m2"), "m2"),
               fmt::format("yarns above {:.3g} % saturation", 100 * r.number("wet_saturation")));
  html += tile("Stain, warp × weft",
               fmt::format("{:.1f} × {:.1f} mm", 1e3 * r.last("wet_extent_warp_m"),
                           1e3 * r.last("wet_extent_weft_m")));
  html += tile("Saturation of the yarns", fmt::format("{:.1f} %", 100 * r.last("mean_saturation")),
               fmt::format("mean of the whole cloth; largest of a node {:.1f} %", 100 * r.last("max_saturation")));
  html += tile("Balance of the liquid", fmt::format("{:.1e}", r.largest("ledger_error")),
               "largest relative error of all rows; limit 1e-10");
  html += tile("Computing time", duration_text(wall),
               steps > 0 ? fmt::format("{:.0f} steps, {} each", steps, scaled_text(wall / steps, "s", 2)) : "");
  return html + "</dl>\n";
}

// A chart of columns of the series, all in one unit.
struct ColumnCurve {
  const char* column;
  const char* name;
};
Chart series_chart(const RunRecord& r, const std::string& title, const std::string& y_name, const std::string& si,
                   const std::vector<ColumnCurve>& columns) {
  Chart chart;
  chart.title = title;
  chart.y_name = y_name;
  chart.x = r.series.column("time_s");
  chart.x_unit = axis_unit(chart.x.empty() ? 0 : chart.x.back(), "s");
  Real most = 0;
  for (const ColumnCurve& c : columns) {
    Curve curve{c.name, r.series.column(c.column), ""};
    for (const Real value : curve.values) most = std::max(most, std::fabs(value));
    chart.curves.push_back(std::move(curve));
  }
  chart.y_unit = axis_unit(most, si);
  for (Curve& curve : chart.curves) {
    if (!curve.values.empty() && !si.empty()) curve.last_value = scaled_text(curve.values.back(), si);
  }
  return chart;
}

std::string charts(const RunRecord& r) {
  Chart masses = series_chart(r, "Where the liquid is", "mass", "kg",
                              {{"free_kg", "free"},
                               {"yarn_kg", "in yarns, between fibres"},
                               {"pore_kg", "in pores, between yarns"},
                               {"sorbed_kg", "in the fibres, beyond the start"},
                               {"evaporated_kg", "evaporated"},
                               {"left_kg", "left the domain"}});
  // The fibres' regain in air is there from the start and would bury everything else.
  Curve& sorbed = masses.curves[3];
  const std::vector<Real>& initial = r.series.column("initial_kg");
  Real most = 0;
  for (std::size_t i = 0; i < sorbed.values.size(); ++i) sorbed.values[i] -= initial[i];
  for (const Curve& curve : masses.curves) {
    for (const Real value : curve.values) most = std::max(most, std::fabs(value));
  }
  masses.y_unit = axis_unit(most, "kg");
  if (!sorbed.values.empty()) sorbed.last_value = scaled_text(sorbed.values.back(), "kg");

  const Chart area =
      series_chart(r, "Wetted area", "area", "m2", {{"wet_area_m2", "wet yarns"}, {"wet_pore_area_m2", "wet pores"}});
  const std::vector<ColumnCurve> directions{{"wet_extent_warp_m", "along the warp"},
                                            {"wet_extent_weft_m", "along the weft"}};
  const Chart extent = series_chart(r, "Extent of the stain", "extent", "m", directions);
  Chart root = series_chart(r, "Extent against √time: capillary wicking is straight", "extent", "m", directions);
  for (Real& t : root.x) t = std::sqrt(t);
  root.x_name = "√time";
  root.x_unit = {1, "√s"};
  Chart saturation = series_chart(r, "Saturation", "saturation", "",
                                  {{"mean_saturation", "yarns, mean"},
                                   {"pore_saturation", "pores, mean"},
                                   {"max_saturation", "largest of a node"}});
  saturation.y_unit = {0.01, "%"};
  for (Curve& curve : saturation.curves) {
    if (!curve.values.empty()) curve.last_value = fmt::format("{:.1f} %", 100 * curve.values.back());
  }
  Chart ledger =
      series_chart(r, "Balance of the liquid", "relative error", "", {{"ledger_error", "|parts − supplied|"}});
  ledger.logarithmic = true;
  ledger.limit = 1e-10;
  ledger.limit_name = "limit 1e-10";
  for (Curve& curve : ledger.curves) {
    // Exactly zero has no place on a logarithmic axis: shown at half a rounding of one addition.
    for (Real& value : curve.values) value = std::max(value, 1e-17);
  }
  std::string html = "<div class=\"charts\">\n";
  for (const Chart& chart : {masses, area, extent, root, saturation, ledger}) html += chart_html(chart);
  return html + "</div>\n";
}

std::string picture_section(const RunRecord& r) {
  const std::vector<std::string> all = pictures_of(r.folder);
  const bool film = fs::exists(r.folder / "film.mp4");
  if (all.empty() && !film) return "";
  std::string html = "<section><h2>Pictures</h2>\n";
  if (film) {
    html += fmt::format("<video controls preload=\"metadata\" src=\"film.mp4\"{}></video>\n",
                        all.empty() ? "" : " poster=\"" + html_escaped(all.back()) + "\"");
  } else {
    html +=
        fmt::format("<img class=\"hero\" src=\"{}\" alt=\"the last picture of the run\">\n", html_escaped(all.back()));
  }
  const std::size_t shown = std::min<std::size_t>(6, all.size());
  if (shown > 1) {
    html += "<div class=\"strip\">\n";
    for (std::size_t k = 0; k < shown; ++k) {
      const std::string name = html_escaped(all[k * (all.size() - 1) / (shown - 1)]);
      html += fmt::format("<a href=\"{0}\"><img loading=\"lazy\" src=\"{0}\" alt=\"{0}\"></a>\n", name);
    }
    html += "</div>\n";
  }
  return html + "</section>\n";
}

std::string fabric_section(const RunRecord& r) {
  std::string html;
  if (!r.run.contains("fabrics")) return html;
  for (const Json& fabric : r.run["fabrics"]) {
    html += fmt::format("<h3>{}</h3><pre>{}</pre>\n", html_escaped(fabric.value("name", "")),
                        html_escaped(fabric.value("numbers", "")));
  }
  return html.empty() ? "" : "<section><h2>The cloth, from its construction</h2>\n" + html + "</section>\n";
}

std::string notes_section(const RunRecord& r) {
  std::string html;
  if (r.run.contains("notes")) {
    for (const Json& note : r.run["notes"]) {
      if (note.is_string()) html += "<p>" + html_escaped(note.get<std::string>()) + "</p>\n";
    }
  }
  return html.empty() ? "" : "<section><h2>What happened, and why</h2>\n" + html + "</section>\n";
}

std::string row(const std::string& name, const std::string& value) {
  return fmt::format("<tr><th>{}</th><td>{}</td></tr>\n", html_escaped(name), html_escaped(value));
}

std::string balance_section(const RunRecord& r) {
  if (!r.run.contains("ledger")) return "";
  const Json& l = r.run["ledger"];
  const auto kg = [&](const char* key) { return scaled_text(RunRecord::number_in(l, key), "kg", 6); };
  std::string html = "<section><h2>Balance at the end</h2>\n<table>\n";
  html += row("in the fibres at the start", kg("initial_kg")) + row("+ supplied", kg("supplied_kg"));
  html += row("= free", kg("free_kg")) + row("+ in the fibres", kg("sorbed_kg"));
  html += row("+ in the yarns", kg("yarn_kg")) + row("+ in the pores", kg("pore_kg"));
  if (RunRecord::number_in(l, "cell_kg") != 0) html += row("+ in the cells", kg("cell_kg"));
  html += row("+ evaporated", kg("evaporated_kg")) + row("+ left the domain", kg("left_kg"));
  html += row("relative error", fmt::format("{:.2e}", RunRecord::number_in(l, "ledger_error")));
  return html + "</table></section>\n";
}

std::string repeat_section(const RunRecord& r) {
  std::string html = "<section><h2>To repeat it</h2>\n";
  html += fmt::format("<pre class=\"command\">{}</pre>\n", html_escaped(r.text("command")));
  html +=
      "<p>The scene with all defaults written out is <a href=\"scene.yaml\">scene.yaml</a>; the same version gives "
      "the same state number below, whatever the number of threads.</p>\n<table>\n";
  html += row("state", r.text("state_hash")) + row("version", r.text("version"));
  html +=
      row("seed", fmt::format("{:.0f}", r.number("seed"))) + row("threads", fmt::format("{:.0f}", r.number("threads")));
  html += row("started", r.text("started_at"));
  if (r.run.contains("machine") && r.run["machine"].is_object()) {
    const Json& m = r.run["machine"];
    html += row("machine", fmt::format("{}, {} cores, {:.1f} GB, {}", m.value("processor", ""), m.value("cores", 0),
                                       RunRecord::number_in(m, "memory_bytes") / 1e9, m.value("system", "")));
  }
  return html + "</table></section>\n";
}

std::string file_section(const RunRecord& r) {
  std::string html = "<section><h2>Files</h2>\n<table>\n";
  const auto link = [&](const std::string& file, const char* what) {
    if (!fs::exists(r.folder / file)) return;
    html += fmt::format("<tr><th><a href=\"{0}\">{0}</a></th><td>{1}</td></tr>\n", html_escaped(file), what);
  };
  link("series.csv", "every curve above as numbers, one row per output time");
  link("run.json", "this page's figures for programs");
  link("liquid.pvd", "the free liquid over time, for ParaView");
  std::vector<std::string> textiles;
  for (const auto& entry : fs::directory_iterator(r.folder)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("textile_") && name.ends_with(".pvd")) textiles.push_back(name);
  }
  std::sort(textiles.begin(), textiles.end());
  for (const std::string& name : textiles) {
    link(name, name.ends_with("_pores.pvd") ? "pores over time, for ParaView" : "yarns over time, for ParaView");
  }
  link("film.mp4", "all pictures as a film");
  link("log.txt", "what the program did and when");
  return html + "</table></section>\n";
}

std::string status_line(const RunRecord& r) {
  const std::string status = r.text("status"), reason = r.text("reason");
  std::string line = status == "done"          ? "Finished"
                     : status == "running"     ? "Still running, or stopped without a word"
                     : status == "interrupted" ? "Interrupted"
                                               : "Failed";
  if (!reason.empty()) line += ": " + reason;
  return fmt::format("<p class=\"status {}\">{}</p>\n", html_escaped(status), html_escaped(line));
}

}  // namespace

std::string report_html(const fs::path& folder) {
  const RunRecord r = read_run(folder);
  const std::string title = html_escaped(r.text("title").empty() ? folder.filename().string() : r.text("title"));
  std::string html =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  html += "<title>" + title + "</title>\n<style>" + report_style + "</style></head>\n<body><main>\n";
  html += "<header><p class=\"kind\">Imbibe, simulated</p><h1>" + title + "</h1>\n" + status_line(r) + "</header>\n";
  html += "<section>" + key_figures(r) + "</section>\n";
  html += notes_section(r) + picture_section(r);
  html += "<section><h2>Curves</h2>\n" + charts(r) + "</section>\n";
  html += fabric_section(r) + balance_section(r) + repeat_section(r) + file_section(r);
  return html + "</main></body></html>\n";
}

fs::path write_report(const fs::path& folder) {
  const fs::path path = folder / "report.html";
  write_whole_file(path, report_html(folder));
  return path;
}

}  // namespace imbibe
