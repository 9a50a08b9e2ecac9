// What `imbibe live` shows: one simulation or replay, or two simulations side by side. A comparison is the scene of the
// first swatch with some keys changed, both begun anew, with the same drops; neither runs ahead of the other.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "imbibe/live/server.h"
#include "imbibe/live/session.h"

namespace imbibe::live {

class LiveStage final : public Stage {
 public:
  // `wake`: makes the server look again.
  LiveStage(SessionSetup setup, std::function<void()> wake);
  LiveStage(std::shared_ptr<Feed> replay, std::shared_ptr<const Gallery> gallery);

  std::vector<std::shared_ptr<Feed>> feeds() override { return feeds_; }
  std::string hello_json() override;
  bool take(std::uint64_t viewer, const Message& message, std::vector<Event>& events) override;
  void end() { feeds_.clear(), session_.reset(), second_.reset(); }  // threads are joined, run folders closed

 private:
  void compare(std::uint64_t viewer, const CompareMessage& message, std::vector<Event>& events);

  SessionSetup setup_;
  std::function<void()> wake_;
  std::shared_ptr<Session> session_, second_;
  std::vector<std::shared_ptr<Feed>> feeds_;
  std::shared_ptr<const Gallery> gallery_;
};

// The built page: index.html and what lies beside it and in assets/, from the first of the data folders that has it.
// Empty when none has.
std::map<std::string, PageFile, std::less<>> read_page(const std::vector<std::string>& data_folders);

}  // namespace imbibe::live
