#include "imbibe/live/feed.h"

#include <nlohmann/json.hpp>

namespace imbibe::live {

using Json = nlohmann::json;

namespace {
// Texts may come from files and clients: what is not UTF-8 is replaced.
std::string dump(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

// A viewer that reads nothing must not fill the memory with what it is told.
constexpr std::size_t most_events = 10000;
}  // namespace

void Outlet::publish(std::shared_ptr<const Snapshot> snapshot) {
  {
    const std::scoped_lock hold(lock_);
    snapshot_ = std::move(snapshot);
  }
  wake_();
}

void Outlet::publish(std::shared_ptr<const Geometry> geometry) {
  {
    const std::scoped_lock hold(lock_);
    geometry_ = std::move(geometry);
    snapshot_ = nullptr;
  }
  wake_();
}

void Outlet::tell(std::uint64_t viewer, std::string json) {
  {
    const std::scoped_lock hold(lock_);
    if (events_.size() < most_events) events_.push_back({viewer, std::move(json)});
  }
  wake_();
}

std::shared_ptr<const Snapshot> Outlet::snapshot() const {
  const std::scoped_lock hold(lock_);
  return snapshot_;
}

std::shared_ptr<const Geometry> Outlet::geometry() const {
  const std::scoped_lock hold(lock_);
  return geometry_;
}

std::vector<Event> Outlet::take_events() {
  const std::scoped_lock hold(lock_);
  return std::move(events_);
}

std::string error_event(int swatch, const std::string& about, const std::vector<Problem>& problems) {
  Json list = Json::array();
  for (const Problem& p : problems)
    list.push_back({{"file", p.file}, {"line", p.line}, {"column", p.column}, {"key", p.key}, {"message", p.message}});
  return dump({{"type", "error"}, {"swatch", swatch}, {"about", about}, {"problems", list}});
}

std::string error_event(int swatch, const std::string& about, const std::string& message) {
  return error_event(swatch, about, std::vector<Problem>{{.message = message}});
}

std::string notice_event(int swatch, const std::string& message) {
  return dump({{"type", "notice"}, {"swatch", swatch}, {"message", message}});
}

std::string done_event(int swatch, double ask, std::uint64_t arrived, std::uint64_t step, Real time) {
  return dump({{"type", "done"}, {"swatch", swatch}, {"ask", ask}, {"arrived", arrived}, {"step", step}, {"time", time}});
}

}  // namespace imbibe::live
