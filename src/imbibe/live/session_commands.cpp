// What a session does with the commands of its viewers.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "imbibe/live/controls.h"
#include "imbibe/live/session.h"
#include "imbibe/scene/builder.h"

namespace imbibe::live {

using Json = nlohmann::json;

bool Session::handle(const Command& command) {
  const std::uint64_t viewer = command.viewer;
  const auto& body = command.message.body;
  if (const auto* set = std::get_if<SetMessage>(&body)) {
    if (!set->restart) return change({{viewer, set->assignments}});
    restart_with(viewer, set->assignments);
  } else if (const auto* drop_message = std::get_if<DropMessage>(&body)) {
    return drop(viewer, *drop_message);
  } else if (std::holds_alternative<RunMessage>(body)) {
    if (!ended_ && !failed_) running_ = true, rebase();
    told_ = false;
  } else if (std::holds_alternative<PauseMessage>(body)) {
    running_ = false, steps_left_ = 0, told_ = false;
  } else if (const auto* step = std::get_if<StepMessage>(&body)) {
    if (!ended_ && !failed_) running_ = false, steps_left_ += step->steps;
  } else if (std::holds_alternative<ResetMessage>(body)) {
    // As changed, but without the drops that were added by hand.
    Scene again = scene_;
    again.liquid.drops = start_scene_.liquid.drops;
    again.duration = start_scene_.duration;
    restart(viewer, std::move(again));
  } else if (const auto* speed = std::get_if<SpeedMessage>(&body)) {
    setup_.speed_limit = speed->limit;
    rebase();
    outlet.tell(all_viewers, Json{{"type", "speed"}, {"swatch", setup_.swatch}, {"limit", speed->limit}}.dump());
  } else if (const auto* look = std::get_if<InspectMessage>(&body)) {
    std::string text = inspect(world_, look->textile, look->node);
    if (text.empty()) text = error_event(setup_.swatch, "inspect", "there is no such yarn or pore");
    outlet.tell(viewer, text);
  } else if (const auto* opened = std::get_if<OpenMessage>(&body)) {
    open(viewer, *opened);
  } else if (const auto* record = std::get_if<RecordMessage>(&body)) {
    if (!recorder_) return outlet.tell(viewer, error_event(setup_.swatch, "record", "there is no run folder: reset first")), false;
    recorder_->record(record->on);
    told_ = false;
    outlet.tell(all_viewers, notice_event(setup_.swatch, record->on ? "recording to " + recorder_->folder().string()
                                                                   : "recording stopped"));
  } else if (std::holds_alternative<SaveMessage>(body)) {
    outlet.tell(viewer, Json{{"type", "scene_text"}, {"swatch", setup_.swatch}, {"text", write_scene(scene_)}}.dump(
                            -1, ' ', false, Json::error_handler_t::replace));
  } else if (std::holds_alternative<SeekMessage>(body)) {
    outlet.tell(viewer, error_event(setup_.swatch, "seek", "a running simulation goes only forwards"));
  }
  return false;
}

std::string Session::change_event(std::uint64_t viewer, const std::vector<std::string>& assignments) const {
  const Json json{{"type", "changed"},  {"swatch", setup_.swatch}, {"viewer", viewer},           {"set", assignments},
                  {"step", world_.step}, {"time", world_.time},     {"duration", scene_.duration}};
  std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  text.back() = ',';
  return text + "\"controls\":" + controls_json(scene_, world_, *setup_.library) + "}";
}

namespace {

std::string path_of(const std::string& assignment) { return assignment.substr(0, assignment.find('=')); }

bool same_viewer_and_live(const Command& a, const Command& b) {
  const auto live = [](const Command& c) {
    const auto* set = std::get_if<SetMessage>(&c.message.body);
    return set && !set->restart && std::all_of(set->assignments.begin(), set->assignments.end(), [](const std::string& s) {
      return effect_of(path_of(s)) == Effect::next_step;
    });
  };
  return a.viewer == b.viewer && live(a) && live(b);
}

// One after the other; of a value that is set twice only the last counts.
std::vector<std::string> joined(const std::vector<Session::Change>& changes) {
  std::vector<std::string> all;
  for (const Session::Change& change : changes)
    for (const std::string& assignment : change.assignments) {
      std::erase_if(all, [&](const std::string& earlier) { return path_of(earlier) == path_of(assignment); });
      all.push_back(assignment);
    }
  return all;
}

}  // namespace

// The commands at the head of the queue; changes that wait there together are one change of the world.
bool Session::handle_next(std::deque<Command>& todo) {
  std::size_t count = 1;
  while (count < todo.size() && same_viewer_and_live(todo.front(), todo[count])) ++count;
  bool changed = false;
  if (count == 1) {
    changed = handle(todo.front());
  } else {
    std::vector<Change> changes;
    for (std::size_t i = 0; i < count; ++i)
      changes.push_back({todo[i].viewer, std::get<SetMessage>(todo[i].message.body).assignments});
    changed = change(changes);
  }
  for (; count > 0; --count) {
    const Command& command = todo.front();
    if (command.message.ask != 0)
      outlet.tell(command.viewer, done_event(setup_.swatch, command.message.ask, command.arrived_at_step, world_.step, world_.time));
    todo.pop_front();
  }
  return changed;
}

bool Session::change(const std::vector<Change>& changes) {
  const std::uint64_t viewer = changes.front().viewer;
  if (failed_) return outlet.tell(viewer, error_event(setup_.swatch, "set", "the simulation has failed: reset it first")), false;
  const std::vector<std::string> assignments = joined(changes);
  try {
    Scene changed = changed_scene(scene_, assignments);
    refuse_new_files(changed, scene_);
    apply_change(scene_, world_, *setup_.library, std::move(changed));
  } catch (const InputError& error) {
    if (changes.size() > 1) {  // the good ones of them
      bool any = false;
      for (const Change& one : changes) any = change({one}) || any;
      return any;
    }
    outlet.tell(viewer, error_event(setup_.swatch, "set", error.problems()));
    // The page shows what it asked for: tell it what holds.
    outlet.tell(viewer, change_event(viewer, {}));
    return false;
  }
  recorder_->change(world_, assignments);
  {
    const std::scoped_lock hold(lock_);
    scene_text_ = write_scene(scene_);
  }
  if (world_.time < scene_.duration) ended_ = false;
  told_ = false;
  outlet.tell(all_viewers, change_event(viewer, assignments));
  return true;
}

bool Session::drop(std::uint64_t viewer, const DropMessage& message) {
  // Above the place, and above any liquid that stands there.
  const Real radius = std::cbrt(3 * message.volume / (4 * pi));
  const Real gap = world_.liquid.particle_mass > 0 ? world_.liquid.spacing() : 1e-4;
  const Vec3 down = norm(world_.gravity) > 0 ? normalized(world_.gravity) : Vec3{0, 0, -1};
  Real above = 0;
  for (const Float4& p : world_.liquid.particles.position) {
    const Vec3 d = Vec3{p.x, p.y, p.z} - message.at;
    const Real up = -dot(d, down);
    if (norm(d + up * down) < radius + gap) above = std::max(above, up);
  }
  const Vec3 centre = message.at - (above + radius + gap) * down, velocity = message.speed * down;
  const std::string assignment = fmt::format(
      "liquid.drops[{}]={{name: dropped by hand {}, centre: [{}, {}, {}], volume: {} m3, velocity: [{}, {}, {}], start: {}}}",
      scene_.liquid.drops.size(), scene_.liquid.drops.size() + 1, centre.x, centre.y, centre.z, message.volume,
      velocity.x, velocity.y, velocity.z, world_.time);
  return change({{viewer, {assignment}}});
}

void Session::restart(std::uint64_t viewer, Scene scene) {
  try {
    pin_output_interval(scene);
    World world = build_world(scene, *setup_.library);
    next_.emplace(std::move(scene), std::move(world));
    stop_ = true;
  } catch (const InputError& error) {
    outlet.tell(viewer, error_event(setup_.swatch, "restart", error.problems()));
  } catch (const std::exception& error) {
    outlet.tell(viewer, error_event(setup_.swatch, "restart", error.what()));
  }
}

void Session::restart_with(std::uint64_t viewer, const std::vector<std::string>& assignments) {
  try {
    Scene scene = read_scene_text(write_scene(scene_), "the scene", assignments);
    refuse_new_files(scene, scene_);
    scene.output = scene_.output, scene.limits = scene_.limits;  // guard rails and files are the server's own
    restart(viewer, std::move(scene));
  } catch (const InputError& error) {
    outlet.tell(viewer, error_event(setup_.swatch, "restart", error.problems()));
  }
}

void Session::open(std::uint64_t viewer, const OpenMessage& message) {
  try {
    Scene scene = message.gallery.empty() ? read_handed_in(*setup_.gallery, message.name, message.text, scene_)
                                          : open_gallery_scene(*setup_.gallery, message.gallery);
    if (message.gallery.empty()) scene.limits = scene_.limits;
    restart(viewer, std::move(scene));
  } catch (const InputError& error) {
    outlet.tell(viewer, error_event(setup_.swatch, "open", error.problems()));
  } catch (const std::exception& error) {
    outlet.tell(viewer, error_event(setup_.swatch, "open", error.what()));
  }
}

}  // namespace imbibe::live
