#include "imbibe/live/live_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "imbibe/core/output_file.h"
#include "imbibe/view/colour_bar.h"

namespace imbibe::live {

using Json = nlohmann::json;
namespace fs = std::filesystem;

LiveStage::LiveStage(SessionSetup setup, std::function<void()> wake)
    : setup_(std::move(setup)), wake_(std::move(wake)), gallery_(setup_.gallery) {
  session_ = std::make_shared<Session>(setup_, wake_);
  feeds_ = {session_};
}

LiveStage::LiveStage(std::shared_ptr<Feed> replay, std::shared_ptr<const Gallery> gallery)
    : feeds_{std::move(replay)}, gallery_(std::move(gallery)) {}

std::string LiveStage::hello_json() {
  Json bar = Json::array();
  for (int level = 0; level < colour_levels; ++level) {
    const BarColour c = colour_of_level(level);
    bar.push_back({c.colour.x, c.colour.y, c.colour.z, c.opacity});
  }
  Json json{{"version", IMBIBE_VERSION},
            {"columns", live_columns()},
            {"step_bounds", step_bounds()},
            {"saturation_scale", saturation_scale},
            {"bar", bar},
            {"replay", session_ == nullptr},
            {"speed_limit", setup_.speed_limit},
            {"swatches", feeds_.size()}};
  json["gallery"] = session_ && gallery_ ? Json::parse(gallery_json(*gallery_)) : Json::array();
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  return text.substr(1, text.size() - 2);
}

bool LiveStage::take(std::uint64_t viewer, const Message& message, std::vector<Event>& events) {
  if (const auto* wanted = std::get_if<CompareMessage>(&message.body)) {
    compare(viewer, *wanted, events);
    return true;
  }
  return false;
}

void LiveStage::compare(std::uint64_t viewer, const CompareMessage& message, std::vector<Event>& events) {
  if (!session_) {
    events.push_back({viewer, error_event(0, "compare", "a replay cannot be compared")});
    return;
  }
  std::shared_ptr<Session> second;
  if (message.on) {
    try {
      SessionSetup setup = setup_;
      setup.swatch = 1;
      const Scene first = read_scene_text(session_->scene_text(), "the scene");
      setup.scene = read_scene_text(session_->scene_text(), "the scene", message.assignments);
      refuse_new_files(setup.scene, first);
      setup.scene.output = first.output, setup.scene.limits = first.limits;
      setup.record.exactly = setup.record.overwrite = false;
      setup.wait_for_viewer = true;
      second = std::make_shared<Session>(std::move(setup), wake_);
    } catch (const std::exception& error) {
      const auto* input = dynamic_cast<const InputError*>(&error);
      events.push_back({viewer, input ? error_event(1, "compare", input->problems()) : error_event(1, "compare", error.what())});
      return;
    }
  }
  session_->keep_pace_with(nullptr);
  second_ = std::move(second);
  feeds_ = {session_};
  if (second_) {
    feeds_.push_back(second_);
    session_->keep_pace_with(second_->time_reached());
    second_->keep_pace_with(session_->time_reached());
    for (const auto& feed : feeds_) {
      feed->post({viewer, Message{0, ResetMessage{}, ""}});
      feed->post({viewer, Message{0, RunMessage{}, ""}});
    }
  }
  events.push_back({all_viewers, Json{{"type", "swatches"}, {"count", feeds_.size()}}.dump()});
}

std::map<std::string, PageFile, std::less<>> read_page(const std::vector<std::string>& data_folders) {
  std::map<std::string, PageFile, std::less<>> files;
  for (const std::string& folder : data_folders) {
    const fs::path page = fs::path(folder) / "viewer" / "dist";
    std::error_code none;
    if (!fs::exists(page / "index.html", none)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(page, none)) {
      const std::string type = media_type(entry.path().filename().string());
      if (type.empty() || !entry.is_regular_file(none)) continue;
      files["/" + fs::relative(entry.path(), page).generic_string()] = {type, read_whole_file(entry.path())};
    }
    return files;
  }
  return files;
}

}  // namespace imbibe::live
