#include "imbibe/verify/case.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "imbibe/view/frame_from_world.h"
#include "imbibe/view/picture.h"

namespace imbibe::verify {
namespace {

Check check_of(std::string quantity, Real measured, Real reference, std::string unit, Real tolerance,
               std::string reason) {
  Check c;
  c.quantity = std::move(quantity), c.measured = measured, c.reference = reference, c.unit = std::move(unit);
  c.tolerance = tolerance, c.reason = std::move(reason);
  return c;
}

}  // namespace

// Comparisons are written so that a NaN fails.
Check near(std::string quantity, Real measured, Real reference, std::string unit, Real tolerance, std::string reason) {
  Check c = check_of(std::move(quantity), measured, reference, std::move(unit), tolerance, std::move(reason));
  c.error = (measured - reference) / std::abs(reference);
  c.passed = std::abs(c.error) <= tolerance;
  return c;
}

Check within(std::string quantity, Real measured, Real reference, std::string unit, Real tolerance,
             std::string reason) {
  Check c = check_of(std::move(quantity), measured, reference, std::move(unit), tolerance, std::move(reason));
  c.relative = false;
  c.error = measured - reference;
  c.passed = std::abs(c.error) <= tolerance;
  return c;
}

Check at_most(std::string quantity, Real measured, Real bound, std::string unit, std::string reason) {
  Check c = check_of(std::move(quantity), measured, bound, std::move(unit), 0, std::move(reason));
  c.quantity += ", at most";
  c.relative = false;
  c.error = std::max(0.0, measured - bound);
  c.passed = measured <= bound;
  return c;
}

Check at_least(std::string quantity, Real measured, Real bound, std::string unit, std::string reason) {
  Check c = check_of(std::move(quantity), measured, bound, std::move(unit), 0, std::move(reason));
  c.quantity += ", at least";
  c.relative = false;
  c.error = std::max(0.0, bound - measured);
  c.passed = measured >= bound;
  return c;
}

Convergence convergence_of(std::string error_of, std::string step_name, std::vector<Convergence::Row> rows) {
  Convergence c{std::move(error_of), std::move(step_name), std::move(rows), 0};
  Real n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const Convergence::Row& row : c.rows) {
    if (!(std::abs(row.error) > 0)) continue;
    const Real x = std::log(row.step), y = std::log(std::abs(row.error));
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  if (n >= 2) c.order = (n * sxy - sx * sy) / (n * sxx - sx * sx);
  return c;
}

bool CaseResult::passed() const {
  return !checks.empty() && std::all_of(checks.begin(), checks.end(), [](const Check& c) { return c.passed; });
}

Scene CaseRunner::scene(const std::string& name, const std::vector<std::string>& overrides) const {
  return read_scene(scene_folder_ / (name + ".yaml"), overrides);
}

World CaseRunner::world(const std::string& name, const std::vector<std::string>& overrides) {
  std::string command =
      "imbibe run " + (std::filesystem::path("scenes/verify") / (name + ".yaml")).lexically_normal().string();
  for (const std::string& o : overrides) {
    command += " --set ";
    command += o.find_first_of(" [{(") == std::string::npos ? o : "'" + o + "'";
  }
  commands_.push_back(std::move(command));
  return build_world(scene(name, overrides), library_);
}

void CaseRunner::run(World& world, const Scene& scene, const Observer& observe, const Observer& after_step) const {
  const RunPlan plan = run_plan(scene);
  RunHooks hooks;
  hooks.at_output = observe;
  hooks.after_step = after_step;
  imbibe::run(world, plan, hooks);
}

World CaseRunner::run(const std::string& name, const std::vector<std::string>& overrides, const Observer& observe,
                      const Observer& after_step) {
  World w = world(name, overrides);
  run(w, scene(name, overrides), observe, after_step);
  return w;
}

void CaseRunner::picture(CaseResult& result, const World& world, const Scene& scene, const std::string& caption) const {
  if (!pictures_) return;
  PictureOptions options = scene.picture;
  options.width = 640, options.height = 400, options.film = false;
  result.picture = draw_picture(frame_from_world(world, scene.title), options);
  result.picture_caption = caption;
}

std::string set(const std::string& path, Real value, const std::string& unit) {
  return unit.empty() ? fmt::format("{}={:.12g}", path, value) : fmt::format("{}={:.12g} {}", path, value, unit);
}

Chart chart_of(std::string title, std::string x_name, std::string x_unit, std::string y_name, std::string y_unit,
               std::vector<Real> x, std::vector<Curve> curves) {
  Chart chart;
  chart.title = std::move(title);
  chart.x_name = std::move(x_name), chart.x_unit = {1, std::move(x_unit)};
  chart.y_name = std::move(y_name), chart.y_unit = {1, std::move(y_unit)};
  chart.x = std::move(x), chart.curves = std::move(curves);
  return chart;
}

}  // namespace imbibe::verify
