#include "imbibe/live/server.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>

namespace imbibe::live {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

namespace {
constexpr double longest_request_s = 10;        // for the whole request
constexpr std::size_t most_unread = 8u << 20;   // bytes that wait for a viewer before it is let go
constexpr std::size_t full_socket = 256u << 10; // bytes that wait before frames are left out

double seconds_since(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }
}  // namespace

struct Server::Connection {
  int fd = -1;
  std::uint64_t viewer = 0;  // 0: still HTTP
  bool closing = false;      // after what waits is written, or its time is up
  std::optional<Clock::time_point> closing_since;
  bool closed = false;
  std::string in, out;
  std::size_t sent = 0;      // of out
  std::size_t largest = 0;   // message that it was sent
  Clock::time_point opened = Clock::now(), frame_due{};
  MessageReader messages{longest_message};
  double tokens = 50;        // messages it may send now
  Clock::time_point tokens_at = Clock::now();
  double frame_interval = 1.0 / 30;
  std::vector<FrameEncoder> encoders;                        // per swatch
  std::vector<std::shared_ptr<const Geometry>> geometry;     // that it has
  std::vector<std::shared_ptr<const Snapshot>> snapshots;    // sent last

  bool may_send_message(double rate) {
    tokens = std::min(tokens + rate * seconds_since(tokens_at), std::max(rate, 1.0));
    tokens_at = Clock::now();
    return tokens >= 1;
  }
};

Server::Server(ServerOptions options, std::map<std::string, PageFile, std::less<>> files, Stage& stage)
    : options_(std::move(options)), stage_(stage) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(options_.port));
  if (inet_pton(AF_INET, options_.address.c_str(), &address.sin_addr) != 1)
    throw InputError("--listen " + options_.address + ": wants an IPv4 address such as 127.0.0.1 or 0.0.0.0");
  listener_ = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int on = 1;
  setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (listener_ < 0 || bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 ||
      listen(listener_, 64) != 0) {
    const int why = errno;
    if (listener_ >= 0) close(listener_);
    throw InputError(fmt::format("cannot listen on {} port {}: {}", options_.address, options_.port, std::strerror(why)));
  }
  socklen_t size = sizeof address;
  getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
  port_ = ntohs(address.sin_port);
  wake_fd_ = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  site_.files = std::move(files);
  site_.token = options_.token;
  site_.any_host = options_.address == "0.0.0.0";
  for (const std::string& name : {options_.address, std::string("localhost"), std::string("127.0.0.1")})
    site_.hosts.push_back(fmt::format("{}:{}", name, port_));
}

Server::~Server() {
  for (const auto& c : connections_)
    if (c->fd >= 0) close(c->fd);
  close(listener_), close(wake_fd_);
}

std::string Server::url() const {
  const std::string host = options_.address == "0.0.0.0" ? "127.0.0.1" : options_.address;
  return fmt::format("http://{}:{}/{}{}", host, port_, options_.token.empty() ? "" : "?token=", options_.token);
}

void Server::wake() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto ignored = ::write(wake_fd_, &one, sizeof one);
}

void Server::accept_all() {
  for (;;) {
    const int fd = accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (fd < 0) return;
    if (connections_.size() >= options_.most_connections) {
      ++counts_.refused;
      close(fd);
      continue;
    }
    const int on = 1;
    setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    connections_.push_back(std::make_unique<Connection>());
    connections_.back()->fd = fd;
  }
}

void Server::read_from(Connection& c) {
  char buffer[65536];
  const ssize_t n = recv(c.fd, buffer, sizeof buffer, 0);
  if (n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR)) c.closed = true;
  if (n <= 0 || c.closing) return;  // what a closing connection still sends is thrown away
  if (c.viewer == 0) c.in.append(buffer, static_cast<std::size_t>(n)), take_request(c);
  else c.messages.feed({buffer, static_cast<std::size_t>(n)});
}

void Server::take_request(Connection& c) {
  const std::size_t end = c.in.find("\r\n\r\n");
  if (end == std::string::npos ? c.in.size() > longest_request : end > longest_request) {
    ++counts_.refused;
    c.out += "HTTP/1.1 431 Request Header Fields Too Large\r\nContent-Length: 0\r\nConnection: close\r\n\r\n";
    c.closing = true;
    return;
  }
  if (end == std::string::npos) return;
  const HttpAnswer reply = answer(site_, std::string_view(c.in).substr(0, end + 4));
  c.out += reply.head_and_body;
  if (!reply.upgrade) {
    if (!reply.head_and_body.starts_with("HTTP/1.1 200")) ++counts_.refused;
    c.closing = true;
    return;
  }
  c.viewer = next_viewer_++;
  c.messages.feed(std::string_view(c.in).substr(end + 4));
  c.in.clear();
  ++counts_.viewers;
  welcome(c);
}

void Server::send(Connection& c, Opcode opcode, std::string_view payload) {
  if (c.closed || c.closing) return;
  if (c.out.size() - c.sent > most_unread) write_to(c);  // a large cloth's geometry alone is more: see whether it reads
  if (c.out.size() - c.sent > most_unread + c.largest) {
    c.closed = true;  // it reads nothing
    return;
  }
  c.largest = std::max(c.largest, payload.size());
  append_frame(c.out, opcode, payload);
}

void Server::welcome(Connection& c) {
  c.frame_interval = 1 / options_.frames_per_second;
  send(c, Opcode::text, fmt::format(R"({{"type":"hello","protocol":{},"viewer":{},{}}})", protocol_version, c.viewer,
                                    stage_.hello_json()));
  if (holder_ == 0) holder_ = c.viewer;
  tell_controls();
  send_scenes(c);
}

void Server::tell_controls() {
  const std::string json = Json{{"type", "controls"}, {"holder", holder_}, {"viewers", counts_.viewers}}.dump();
  for (const auto& c : connections_)
    if (c->viewer != 0) send(*c, Opcode::text, json);
}

// The scene message and geometry of every swatch whose world is new to this viewer.
void Server::send_scenes(Connection& c) {
  if (c.encoders.size() > feeds_.size()) {
    c.encoders.clear(), c.geometry.clear(), c.snapshots.clear();
  }
  for (std::size_t i = c.encoders.size(); i < feeds_.size(); ++i) c.encoders.emplace_back(static_cast<std::uint8_t>(i));
  c.geometry.resize(feeds_.size()), c.snapshots.resize(feeds_.size());
  for (std::size_t i = 0; i < feeds_.size(); ++i) {
    const auto geometry = feeds_[i]->outlet.geometry();
    if (!geometry || geometry == c.geometry[i]) continue;
    c.geometry[i] = geometry, c.snapshots[i] = nullptr;
    c.encoders[i] = FrameEncoder(static_cast<std::uint8_t>(i));
    send(c, Opcode::text, geometry->scene_json);
    send(c, Opcode::binary, encode_geometry(static_cast<std::uint8_t>(i), *geometry));
    if (const std::string rows = feeds_[i]->history_json(); rows != "[]")
      send(c, Opcode::text, fmt::format(R"({{"type":"history","swatch":{},"generation":{},"rows":{}}})", i, geometry->generation, rows));
  }
}

void Server::send_frames(Connection& c) {
  if (c.viewer == 0 || c.closing || c.closed) return;
  if (c.out.size() - c.sent > full_socket || Clock::now() < c.frame_due) return;
  send_scenes(c);
  bool sent = false;
  for (std::size_t i = 0; i < feeds_.size(); ++i) {
    const auto snapshot = feeds_[i]->outlet.snapshot();
    if (!snapshot || snapshot == c.snapshots[i] || !c.geometry[i] || snapshot->generation != c.geometry[i]->generation)
      continue;
    c.snapshots[i] = snapshot;
    const std::string frame = c.encoders[i].encode(*snapshot);
    send(c, Opcode::binary, frame);
    ++counts_.frames, counts_.frame_bytes += frame.size();
    sent = true;
  }
  if (!sent) return;
  const auto interval = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(c.frame_interval));
  c.frame_due = std::max(c.frame_due + interval, Clock::now() - interval);  // the rate is kept although frames come unevenly
}

void Server::take_messages(Connection& c) {
  MessageReader::Message message;
  while (!c.closing && !c.closed && c.may_send_message(options_.messages_per_second) && c.messages.next(message)) {
    c.tokens -= 1;
    if (message.opcode == Opcode::text) take_message(c, message.payload);
    else if (message.opcode == Opcode::ping) send(c, Opcode::pong, message.payload);
    else if (message.opcode == Opcode::close) append_close(c.out, close_normal), c.closing = true;
    else if (message.opcode == Opcode::binary) ++counts_.malformed, send(c, Opcode::text, error_event(0, "message", "binary messages are not understood"));
  }
  if (c.messages.error() != 0 && !c.closing) {
    ++counts_.malformed;
    append_close(c.out, c.messages.error());
    c.closing = true;
  }
}

void Server::take_message(Connection& c, const std::string& text) {
  Message message = parse_message(text);
  if (!message.problem.empty()) {
    ++counts_.malformed;
    return send(c, Opcode::text, error_event(message.swatch, "message", message.problem));
  }
  const auto done = [&] {
    if (message.ask != 0) send(c, Opcode::text, done_event(message.swatch, message.ask, 0, 0, 0));
  };
  if (const auto* rate = std::get_if<RateMessage>(&message.body)) {
    c.frame_interval = 1 / std::min(rate->frames_per_second, options_.frames_per_second);
    return done();
  }
  if (std::holds_alternative<TakeMessage>(message.body)) {
    holder_ = c.viewer;
    tell_controls();
    return done();
  }
  if (message.needs_controls() && c.viewer != holder_)
    return send(c, Opcode::text, error_event(message.swatch, "controls", "another viewer holds the controls; take them first"));
  std::vector<Event> events;
  if (stage_.take(c.viewer, message, events)) {
    feeds_ = stage_.feeds();
    for (const Event& event : events)
      for (const auto& other : connections_)
        if (other->viewer != 0 && (event.viewer == all_viewers || event.viewer == other->viewer))
          send(*other, Opcode::text, event.json);
    return done();
  }
  if (message.swatch != both_swatches && message.swatch >= feeds_.size())
    return send(c, Opcode::text, error_event(message.swatch, "message", "there is no second swatch"));
  for (std::size_t i = 0; i < feeds_.size(); ++i)
    if (message.swatch == both_swatches || message.swatch == i) feeds_[i]->post({c.viewer, message});
}

void Server::broadcast_events() {
  for (const auto& feed : feeds_) {
    for (const Event& event : feed->outlet.take_events())
      for (const auto& c : connections_)
        if (c->viewer != 0 && (event.viewer == all_viewers || event.viewer == c->viewer)) {
          send_scenes(*c);  // an event of a new world comes after that world
          send(*c, Opcode::text, event.json);
        }
  }
}

void Server::write_to(Connection& c) {
  while (c.sent < c.out.size()) {
    const ssize_t n = ::send(c.fd, c.out.data() + c.sent, c.out.size() - c.sent, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      if (errno != EAGAIN) c.closed = true;
      break;
    }
    c.sent += static_cast<std::size_t>(n);
  }
  if (c.sent == c.out.size()) {
    c.out.clear(), c.sent = 0;
    if (c.closing) c.closed = true;
  } else if (c.sent > (1u << 20)) {
    c.out.erase(0, c.sent), c.sent = 0;
  }
}

void Server::drop_closed() {
  bool viewer_left = false;
  for (auto& c : connections_) {
    if (!c->closed && c->viewer == 0 && seconds_since(c->opened) > longest_request_s) c->closed = true;
    if (c->closing && !c->closing_since) c->closing_since = Clock::now();
    if (c->closing && seconds_since(*c->closing_since) > longest_request_s) c->closed = true;
    if (!c->closed) continue;
    if (c->fd >= 0) close(c->fd);
    if (c->viewer == 0) continue;
    viewer_left = true;
    --counts_.viewers;
    if (holder_ == c->viewer) holder_ = 0;
  }
  std::erase_if(connections_, [](const auto& c) { return c->closed; });
  if (!viewer_left) return;
  for (const auto& c : connections_)
    if (holder_ == 0 && c->viewer != 0) holder_ = c->viewer;
  tell_controls();
}

// Until a viewer's next frame is due, or a while when none is.
int Server::wait_ms() const {
  double wait = 0.5;
  for (const auto& c : connections_) {
    if (c->viewer == 0) continue;
    if (c->tokens < 1) wait = std::min(wait, 0.02);
    for (std::size_t i = 0; i < feeds_.size() && i < c->snapshots.size(); ++i)
      if (feeds_[i]->outlet.snapshot() != c->snapshots[i])
        wait = std::min(wait, std::max(0.0, -seconds_since(c->frame_due)));
  }
  return static_cast<int>(1000 * wait) + 1;
}

void Server::run(const std::function<bool()>& stop) {
  feeds_ = stage_.feeds();
  std::vector<pollfd> fds;
  while (!stop()) {
    fds.assign({{listener_, POLLIN, 0}, {wake_fd_, POLLIN, 0}});
    for (const auto& c : connections_) {
      const bool reads = c->viewer == 0 || c->may_send_message(options_.messages_per_second);
      fds.push_back({c->fd, static_cast<short>((reads ? POLLIN : 0) | (c->sent < c->out.size() ? POLLOUT : 0)), 0});
    }
    if (poll(fds.data(), fds.size(), wait_ms()) < 0 && errno != EINTR) break;
    std::uint64_t ignored = 0;
    while (read(wake_fd_, &ignored, sizeof ignored) > 0) {}
    const std::size_t known = connections_.size();
    for (std::size_t i = 0; i < known; ++i) {
      Connection& c = *connections_[i];
      if ((fds[i + 2].revents & POLLIN) != 0) read_from(c);
      else if ((fds[i + 2].revents & (POLLHUP | POLLERR)) != 0) c.closed = true;
      if (c.viewer != 0) take_messages(c);
    }
    if ((fds[0].revents & POLLIN) != 0) accept_all();
    feeds_ = stage_.feeds();
    for (const auto& feed : feeds_) feed->outlet.viewers.store(static_cast<int>(counts_.viewers));
    broadcast_events();
    for (const auto& c : connections_) {
      send_frames(*c);
      if (!c->closed) write_to(*c);
    }
    drop_closed();
  }
  for (const auto& c : connections_) {
    if (c->viewer != 0 && !c->closed) append_close(c->out, close_going_away), write_to(*c);
  }
}

}  // namespace imbibe::live
