#include "imbibe/io/series.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>

#include "imbibe/core/error.h"

namespace imbibe {

SeriesRow series_row(const World& world, const StepReport& last_step, const MeasureParams& params) {
  SeriesRow row;
  row.time_s = world.time;
  row.mass = mass_balance(world);
  row.particles = world.liquid.particles.size();
  row.step_s = last_step.step_s;
  row.steps = world.step;
  row.density_error = last_step.peak_density_error;
  row.density = world.density;
  Real yarn_volume = 0, weighted_saturation = 0;
  for (const Textile& textile : world.textiles) {
    const TextileMeasures m = measure(textile, world.air, params);
    row.wet_area_m2 += m.wet_area;
    row.wet_pore_area_m2 += m.wet_pore_area;
    row.wet_extent_warp_m = std::max(row.wet_extent_warp_m, m.extent_warp);
    row.wet_extent_weft_m = std::max(row.wet_extent_weft_m, m.extent_weft);
    row.wet_height_m = std::max(row.wet_height_m, m.wet_height);
    row.max_saturation = std::max(row.max_saturation, m.max_saturation);
    row.pore_saturation = std::max(row.pore_saturation, m.pore_saturation);
    row.max_regain = std::max(row.max_regain, m.max_regain);
    yarn_volume += m.yarn_volume;
    weighted_saturation += m.yarn_volume * m.mean_saturation;
    const ExchangeState& exchange = textile.exchange;
    row.contacts += exchange.contacts;
    row.absorbed_particles += exchange.absorbed_particles;
    row.released_particles += exchange.released_particles;
    row.bounces += exchange.bounces;
    for (const Real kg : exchange.waiting_kg) row.waiting_kg += kg;
  }
  if (any_soft_sheet(world)) row.lowest_cloth_m = unlimited;
  for (const Textile& textile : world.textiles) {
    if (!textile.cloth) continue;
    for (const Vec3& x : textile.cloth->soft.sheet.position) row.lowest_cloth_m = std::min(row.lowest_cloth_m, x.z);
  }
  for (const CellCloth& cloth : world.cell_cloths) {
    const CellClothMeasures m = measure(cloth, params);
    row.wet_area_m2 += m.wet_area;
    row.wet_extent_warp_m = std::max(row.wet_extent_warp_m, m.extent_warp);
    row.wet_extent_weft_m = std::max(row.wet_extent_weft_m, m.extent_weft);
    row.wet_height_m = std::max(row.wet_height_m, m.wet_height);
    row.max_saturation = std::max(row.max_saturation, m.max_saturation);
    row.contacts += cloth.crossings;
    row.absorbed_particles += cloth.absorbed_particles;
    row.released_particles += cloth.released_particles;
    row.bounces += cloth.bounces;
    row.waiting_kg += waiting_kg(cloth);
    row.lowest_cloth_m = std::min(row.lowest_cloth_m, m.lowest);
    // Cells hold liquid over their area as yarns over their volume: the mean is over both by what they can hold.
    yarn_volume += m.capacity_volume;
    weighted_saturation += m.capacity_volume * m.mean_saturation;
  }
  for (const Real kg : world.liquid.particles.owed_kg) row.owed_kg += kg;
  if (yarn_volume > 0) row.mean_saturation = weighted_saturation / yarn_volume;
  return row;
}

namespace {

// The table's columns in order: name and value of each. The one list of them.
template <class Row, class Column>
void visit_columns(const Row& r, Column&& column) {
  column("time_s", r.time_s);
  column("free_kg", r.mass.free);
  column("sorbed_kg", r.mass.sorbed);
  column("yarn_kg", r.mass.yarn);
  column("pore_kg", r.mass.pore);
  column("cell_kg", r.mass.cell);
  column("evaporated_kg", r.mass.evaporated);
  column("left_kg", r.mass.left);
  column("supplied_kg", r.mass.supplied);
  column("ledger_error", r.mass.error());
  column("particles", r.particles);
  column("wet_area_m2", r.wet_area_m2);
  column("wet_extent_warp_m", r.wet_extent_warp_m);
  column("wet_extent_weft_m", r.wet_extent_weft_m);
  column("mean_saturation", r.mean_saturation);
  column("max_saturation", r.max_saturation);
  column("step_s", r.step_s);
  column("steps", r.steps);
  column("initial_kg", r.mass.initial);
  column("waiting_kg", r.waiting_kg);
  column("owed_kg", r.owed_kg);
  column("wet_pore_area_m2", r.wet_pore_area_m2);
  column("pore_saturation", r.pore_saturation);
  column("max_regain", r.max_regain);
  column("peak_density_error", r.density_error);
  column("mean_density_error", r.density.mean());
  column("worst_density_error", r.density.worst_mean);
  column("worst_compression", r.density.worst_particle);
  column("mean_compression", r.density.mean_compression());
  column("worst_mean_compression", r.density.worst_mean_compression);
  column("contacts", r.contacts);
  column("absorbed_particles", r.absorbed_particles);
  column("released_particles", r.released_particles);
  column("bounces", r.bounces);
  column("lowest_cloth_m", r.lowest_cloth_m);
  column("wet_height_m", r.wet_height_m);
}

// One past the end of the last whole line at or after `from`.
std::size_t whole_lines(const std::string& text) {
  const std::size_t last = text.rfind('\n');
  return last == std::string::npos ? 0 : last + 1;
}

std::string header_line() {
  std::string line;
  for (const std::string& name : series_columns()) line += (line.empty() ? "" : ",") + name;
  return line;
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t comma = line.find(',');
    parts.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) return parts;
    line.remove_prefix(comma + 1);
  }
}

}  // namespace

const std::vector<std::string>& series_columns() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    visit_columns(SeriesRow{}, [&](const char* name, const auto&) { all.emplace_back(name); });
    return all;
  }();
  return names;
}

std::vector<double> series_values(const SeriesRow& row) {
  std::vector<double> values;
  visit_columns(row, [&](const char*, const auto& value) { values.push_back(static_cast<double>(value)); });
  return values;
}

std::string series_line(const SeriesRow& row) {
  std::string line;
  // fmt's "{}" is the shortest text that reads back to the same bits.
  visit_columns(row, [&](const char*, const auto& value) {
    line += fmt::format("{}{}", line.empty() ? "" : ",", value);
  });
  return line;
}

SeriesFile::SeriesFile(const std::filesystem::path& path) {
  const bool is_new = !std::filesystem::exists(path) || std::filesystem::file_size(path) == 0;
  file_ = AppendFile(path);
  if (is_new) file_.append(header_line() + "\n");
}

void SeriesFile::write(const SeriesRow& row) { file_.append(series_line(row) + "\n"); }

void cut_series(const std::filesystem::path& path, Real time_s) {
  if (!std::filesystem::exists(path)) return;
  std::string text = read_whole_file(path);
  text.resize(whole_lines(text));
  std::size_t keep = text.find('\n');
  if (keep == std::string::npos) return;
  ++keep;
  while (keep < text.size() && std::strtod(text.c_str() + keep, nullptr) <= time_s) keep = text.find('\n', keep) + 1;
  text.resize(keep);
  write_whole_file(path, text);
}

const std::vector<Real>& SeriesTable::column(const std::string& name) const {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i] == name) return values[i];
  }
  throw InputError("series.csv has no column '" + name + "'");
}

SeriesTable read_series(const std::filesystem::path& path) {
  const std::string text = read_whole_file(path);
  std::string_view rest(text.data(), whole_lines(text));
  SeriesTable table;
  for (int number = 1; !rest.empty(); ++number) {
    const std::size_t end = rest.find('\n');
    const std::vector<std::string_view> parts = split(rest.substr(0, end));
    rest.remove_prefix(end + 1);
    if (table.columns.empty()) {
      for (const std::string_view part : parts) table.columns.emplace_back(part);
      table.values.resize(parts.size());
      continue;
    }
    if (parts.size() != table.columns.size()) {
      throw InputError({Problem{
          path.string(), number, 1, "",
          fmt::format("{} values where the header names {}", parts.size(), table.columns.size())}});
    }
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const std::string word(parts[i]);
      char* stop = nullptr;
      const Real value = std::strtod(word.c_str(), &stop);
      if (word.empty() || *stop != '\0') {
        throw InputError({Problem{path.string(), number, 1, table.columns[i], "'" + word + "' is not a number"}});
      }
      table.values[i].push_back(value);
    }
  }
  if (table.columns.empty()) throw InputError(path.string() + " has no header line");
  return table;
}

}  // namespace imbibe
