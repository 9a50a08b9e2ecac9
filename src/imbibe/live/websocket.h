// The server's side of the WebSocket protocol (RFC 6455) as pure functions over bytes: handshake key, frames.
// No extensions; messages may come in fragments; every length is checked against the limit before anything is stored.
// Tested in tests/live/wire_test.cpp.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace imbibe::live {

// Sec-WebSocket-Accept for a client's Sec-WebSocket-Key.
std::string accept_key(std::string_view client_key);

std::array<std::uint8_t, 20> sha1(std::string_view data);
std::string base64(const std::uint8_t* data, std::size_t size);

enum class Opcode : std::uint8_t { continuation = 0, text = 1, binary = 2, close = 8, ping = 9, pong = 10 };

// Close codes.
inline constexpr int close_normal = 1000, close_protocol_error = 1002, close_too_big = 1009, close_going_away = 1001;

// Appends one whole server frame (not masked).
void append_frame(std::string& out, Opcode opcode, std::string_view payload);
void append_close(std::string& out, int code);

// Takes a client's bytes as they come and gives out whole messages.
class MessageReader {
 public:
  explicit MessageReader(std::size_t longest) : longest_(longest) {}

  struct Message {
    Opcode opcode = Opcode::text;  // text, binary, close, ping or pong
    std::string payload;
  };

  void feed(std::string_view bytes) { buffer_.append(bytes); }
  // True when a message is complete. After an error() none comes any more.
  bool next(Message& message);
  int error() const { return error_; }  // a close code, 0 = none

 private:
  bool fail(int code) {
    error_ = code;
    buffer_.clear(), parts_.clear();
    return false;
  }

  std::size_t longest_;
  std::string buffer_, parts_;
  Opcode parts_opcode_ = Opcode::continuation;  // continuation: no message is under way
  int error_ = 0;
};

}  // namespace imbibe::live
