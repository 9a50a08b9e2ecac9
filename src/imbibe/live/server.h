// The web server of `imbibe live`: one thread, one poll() over all connections, no waiting on anybody.
//
// A viewer whose socket takes no more gets no new frame until it does, and then the latest: its mailbox is the feed's
// latest snapshot. Frames are encoded against what that viewer has seen (protocol.h).
// Limits: connections, request size and time, message size, messages per second (a viewer that sends faster is read
// slower), bytes waiting to be sent. Malformed messages are answered and counted.
// Tested with the page, in viewer/test/live.test.mjs.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "imbibe/live/feed.h"
#include "imbibe/live/http.h"
#include "imbibe/live/websocket.h"

namespace imbibe::live {

struct ServerOptions {
  std::string address = "127.0.0.1";
  int port = 0;                    // 0: a free one
  std::string token;               // needed where the address is not of this machine only
  double frames_per_second = 30;
  std::size_t most_connections = 64;
  double messages_per_second = 200;  // of one viewer
};

// What the server shows: a feed per swatch. The list changes when a comparison begins or ends.
class Stage {
 public:
  virtual ~Stage() = default;
  virtual std::vector<std::shared_ptr<Feed>> feeds() = 0;  // one or two
  virtual std::string hello_json() = 0;                    // members of the hello message, without braces
  // A message that is for no single swatch (compare). True: taken.
  virtual bool take(std::uint64_t viewer, const Message& message, std::vector<Event>& events) = 0;
};

class Server {
 public:
  // Opens the socket: throws InputError when it cannot.
  Server(ServerOptions options, std::map<std::string, PageFile, std::less<>> files, Stage& stage);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  int port() const { return port_; }
  std::string url() const;
  void wake();  // any thread, and signal handlers: look again
  void run(const std::function<bool()>& stop);

  struct Counts {
    std::uint64_t frames = 0, frame_bytes = 0, malformed = 0, refused = 0;
    std::size_t viewers = 0;
  };
  const Counts& counts() const { return counts_; }  // of the thread in run(), or after it

 private:
  struct Connection;
  void accept_all();
  void read_from(Connection& c);
  void take_request(Connection& c);
  void take_messages(Connection& c);
  void take_message(Connection& c, const std::string& text);
  void welcome(Connection& c);
  void send_scenes(Connection& c);
  void send_frames(Connection& c);
  void send(Connection& c, Opcode opcode, std::string_view payload);
  void write_to(Connection& c);
  void broadcast_events();
  void tell_controls();
  void drop_closed();
  int wait_ms() const;

  ServerOptions options_;
  Site site_;
  Stage& stage_;
  int listener_ = -1, wake_fd_ = -1, port_ = 0;
  std::vector<std::unique_ptr<Connection>> connections_;
  std::vector<std::shared_ptr<Feed>> feeds_;
  std::uint64_t next_viewer_ = 1, holder_ = 0;  // who holds the controls; 0 = nobody
  Counts counts_;
};

}  // namespace imbibe::live
