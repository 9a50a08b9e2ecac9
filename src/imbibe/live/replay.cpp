#include "imbibe/live/replay.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "imbibe/core/output_file.h"
#include "imbibe/io/run_folder.h"
#include "imbibe/live/capture.h"
#include "imbibe/live/recall.h"
#include "imbibe/scene/builder.h"
#include "imbibe/view/vtp_reader.h"

namespace imbibe::live {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

namespace {

// The rows of series.csv as the history of the scene message.
std::string history_of(const SeriesTable& series) {
  Json rows = Json::array();
  const auto& names = live_columns();
  const std::size_t stride = series.rows() / 2000 + 1;
  for (std::size_t i = 0; i < series.rows(); i += stride) {
    Json row = Json::array();
    for (const std::string& name : names) {
      const auto at = std::find(series.columns.begin(), series.columns.end(), name);
      row.push_back(at == series.columns.end() ? 0.0 : series.values[static_cast<std::size_t>(at - series.columns.begin())][i]);
    }
    rows.push_back(std::move(row));
  }
  return rows.dump();
}

}  // namespace

Replay::Replay(const std::filesystem::path& folder, std::shared_ptr<const Library> library, std::function<void()> wake)
    : Feed(std::move(wake)), scene_(read_scene(folder / "scene.yaml")), library_(std::move(library)) {
  scene_text_ = write_scene(scene_);
  world_ = build_world(scene_, *library_);
  frames_ = open_run_frames(folder, world_, scene_.title);
  const std::vector<std::string> stems = collection_stems(world_);
  for (std::size_t t = 0; t < world_.textiles.size(); ++t)
    pores_.push_back({world_.textiles[t].name, 0, world_.textiles[t].fabric->network.pores(),
                      read_pvd(folder / (stems[2 + 2 * t] + ".pvd"))});
  series_ = read_series(folder / "series.csv");
  outlet.publish(std::make_shared<const Geometry>(
      take_geometry(1, scene_, world_, *library_, {0, true, folder.string(), history_of(series_)})));
  show(0);
  thread_ = std::thread([this] { thread(); });
}

Replay::~Replay() {
  {
    const std::scoped_lock hold(lock_);
    quit_ = true;
  }
  woken_.notify_one();
  thread_.join();
}

void Replay::post(Command command) {
  {
    const std::scoped_lock hold(lock_);
    if (commands_.size() < 1000) commands_.push_back(std::move(command));
  }
  woken_.notify_one();
}

std::vector<double> Replay::values_at(Real time) const {
  const auto& times = series_.column("time_s");
  if (times.empty()) return std::vector<double>(live_columns().size(), 0);
  const auto at = std::lower_bound(times.begin(), times.end(), time * (1 - 1e-9));
  const std::size_t row = std::min(static_cast<std::size_t>(at - times.begin()), times.size() - 1);
  std::vector<double> values;
  for (const std::string& name : live_columns()) {
    const auto column = std::find(series_.columns.begin(), series_.columns.end(), name);
    const bool known = column != series_.columns.end();
    values.push_back(known ? series_.values[static_cast<std::size_t>(column - series_.columns.begin())][row]
                     : name == "converged" ? 1
                     : name == "speed" && playing_ ? speed_
                                                   : 0);
  }
  return values;
}

void Replay::show(std::size_t number) {
  const Frame frame = read_frame(frames_, number);
  auto s = std::make_shared<Snapshot>();
  s->generation = 1, s->number = ++number_;
  s->flags = static_cast<std::uint16_t>(flag_replay | (playing_ ? flag_running : 0) |
                                        (number + 1 == frames_.times.size() ? flag_ended : 0));
  s->values = values_at(frame.time);
  s->values.front() = frame.time;
  const std::size_t every = std::max<std::size_t>(1, (frame.particles.size() + most_shown_particles - 1) / most_shown_particles);
  QuantisedPoints particles = quantise(frame.particles.size() / every, [&](std::size_t i) { return frame.particles[i * every]; });
  particles.every = static_cast<std::uint16_t>(std::min<std::size_t>(every, 65535));
  s->particle_count = frame.particles.size();
  s->particles = std::make_shared<const QuantisedPoints>(std::move(particles));
  std::size_t first_point = 0;
  for (std::size_t t = 0; t < world_.textiles.size(); ++t) {
    const YarnNetwork& network = world_.textiles[t].fabric->network;
    auto bytes = std::make_shared<Saturations>(network.nodes());
    for (std::size_t y = 0; y + 1 < network.yarn_first_segment.size(); ++y)
      for (Index s_ = network.yarn_first_segment[y]; s_ < network.yarn_first_segment[y + 1]; ++s_) {
        const std::size_t point = first_point + network.yarn_first_point[y] +
                                  (s_ - network.yarn_first_segment[y]) * static_cast<std::size_t>(network.points_per_segment);
        (*bytes)[s_] = saturation_byte(frame.yarns.saturation[point]);
      }
    for (const PvdEntry& entry : pores_[t].entries) {
      if (entry.time_s != frame.time) continue;
      const PolyData data = read_vtp(frames_.folder / std::filesystem::path(entry.file).filename());
      const std::vector<float>* values = find_floats(data, "saturation");
      if (values && values->size() == network.pores())
        std::transform(values->begin(), values->end(), bytes->begin() + static_cast<std::ptrdiff_t>(network.segments()),
                       saturation_byte);
    }
    s->saturations.push_back(std::move(bytes));
    std::shared_ptr<const QuantisedPoints> moved;
    if (world_.textiles[t].cloth) {
      const auto begin = frame.yarns.points.begin() + static_cast<std::ptrdiff_t>(first_point);
      const std::vector<Vec3> points(begin, begin + static_cast<std::ptrdiff_t>(network.points.size()));
      moved = std::make_shared<const QuantisedPoints>(thinned_points(network, points));
    }
    s->yarns.push_back(std::move(moved));
    first_point += network.points.size();
  }
  for (const DrawnCloth& cloth : frame.cloths) {
    auto bytes = std::make_shared<Saturations>(cloth.saturation.size());
    std::transform(cloth.saturation.begin(), cloth.saturation.end(), bytes->begin(), saturation_byte);
    s->saturations.push_back(std::move(bytes));
    const auto& nodes = cloth.mesh.vertices;
    s->yarns.push_back(std::make_shared<const QuantisedPoints>(quantise(nodes.size(), [&](std::size_t i) { return nodes[i]; })));
  }
  frame_ = number;
  shown_at_ = Clock::now();
  last_ = std::move(s);
  outlet.publish(last_);
}

void Replay::tell_contents(std::uint64_t viewer, const InspectMessage& message) {
  if (recalled_ != frame_) recall(world_, frames_, pores_, frames_.times[frame_], places_);
  recalled_ = frame_;
  const bool woven = message.textile < places_.size() && message.node < places_[message.textile].size();
  const Vec3* place = woven ? &places_[message.textile][message.node] : nullptr;
  const std::string text = inspect(world_, message.textile, message.node, place);
  outlet.tell(viewer, text.empty() ? error_event(0, "inspect", "there is no such yarn or pore") : text);
}

bool Replay::handle(const Command& command) {
  const auto& body = command.message.body;
  const std::size_t last = frames_.times.size() - 1;
  if (std::holds_alternative<RunMessage>(body)) {
    playing_ = true;
    if (frame_ == last) frame_ = 0;
  } else if (std::holds_alternative<PauseMessage>(body)) {
    playing_ = false;
  } else if (const auto* step = std::get_if<StepMessage>(&body)) {
    playing_ = false;
    frame_ = std::min(frame_ + static_cast<std::size_t>(step->steps), last);
  } else if (std::holds_alternative<ResetMessage>(body)) {
    playing_ = false, frame_ = 0;
  } else if (const auto* seek = std::get_if<SeekMessage>(&body)) {
    const auto at = std::upper_bound(frames_.times.begin(), frames_.times.end(), seek->time * (1 + 1e-9));
    frame_ = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, at - frames_.times.begin() - 1));
  } else if (const auto* speed = std::get_if<SpeedMessage>(&body)) {
    speed_ = speed->limit;
    outlet.tell(all_viewers, Json{{"type", "speed"}, {"swatch", 0}, {"limit", speed->limit}}.dump());
    return false;
  } else if (const auto* look = std::get_if<InspectMessage>(&body)) {
    tell_contents(command.viewer, *look);
    return false;
  } else if (std::holds_alternative<SaveMessage>(body)) {
    outlet.tell(command.viewer, Json{{"type", "scene_text"}, {"swatch", 0}, {"text", scene_text_}}.dump());
    return false;
  } else {
    outlet.tell(command.viewer, error_event(0, "replay", "this is the replay of a finished run: nothing in it can be changed"));
    return false;
  }
  return true;
}

void Replay::thread() {
  for (;;) {
    std::deque<Command> todo;
    const std::size_t last = frames_.times.size() - 1;
    {
      std::unique_lock hold(lock_);
      Real wait_s = 3600;
      if (playing_ && frame_ < last) {
        const Real gap = frames_.times[frame_ + 1] - frames_.times[frame_];
        const Real due = std::max(speed_ > 0 ? gap / speed_ : 0, 1.0 / 60);
        wait_s = std::max<Real>(0, due - std::chrono::duration<Real>(Clock::now() - shown_at_).count());
      }
      woken_.wait_for(hold, std::chrono::duration<Real>(wait_s), [this] { return quit_ || !commands_.empty(); });
      if (quit_) return;
      todo.swap(commands_);
    }
    try {
      bool again = false;
      for (const Command& command : todo) {
        again = handle(command) || again;
        if (command.message.ask != 0)
          outlet.tell(command.viewer, done_event(0, command.message.ask, frame_, frame_, frames_.times[frame_]));
      }
      if (again) {
        show(frame_);
      } else if (todo.empty() && playing_ && frame_ < last) {
        if (frame_ + 1 == last) playing_ = false;
        show(frame_ + 1);
      }
    } catch (const std::exception& error) {
      playing_ = false;
      outlet.tell(all_viewers, error_event(0, "replay", error.what()));
    }
  }
}

}  // namespace imbibe::live
