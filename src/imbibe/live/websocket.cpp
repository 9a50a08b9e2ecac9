#include "imbibe/live/websocket.h"

#include <bit>

namespace imbibe::live {

std::array<std::uint8_t, 20> sha1(std::string_view data) {  // FIPS 180-4; only for the handshake, which asks for it
  std::array<std::uint32_t, 5> h{0x67452301u, 0xEFCDAB89u, 0x98BADCFEu, 0x10325476u, 0xC3D2E1F0u};
  std::string text(data);
  text.push_back('\x80');
  while (text.size() % 64 != 56) text.push_back('\0');
  const std::uint64_t bits = 8 * static_cast<std::uint64_t>(data.size());
  for (int i = 7; i >= 0; --i) text.push_back(static_cast<char>(bits >> (8 * i) & 0xFF));
  for (std::size_t block = 0; block < text.size(); block += 64) {
    std::array<std::uint32_t, 80> w{};
    for (std::size_t i = 0; i < 64; ++i)
      w[i / 4] = w[i / 4] << 8 | static_cast<std::uint8_t>(text[block + i]);
    for (std::size_t i = 16; i < 80; ++i) w[i] = std::rotl(w[i - 3] ^ w[i - 8] ^ w[i - 14] ^ w[i - 16], 1);
    auto [a, b, c, d, e] = h;
    for (std::size_t i = 0; i < 80; ++i) {
      const std::uint32_t f = i < 20 ? (b & c) | (~b & d) : i < 40 || i >= 60 ? b ^ c ^ d : (b & c) | (b & d) | (c & d);
      const std::uint32_t k = i < 20 ? 0x5A827999u : i < 40 ? 0x6ED9EBA1u : i < 60 ? 0x8F1BBCDCu : 0xCA62C1D6u;
      const std::uint32_t t = std::rotl(a, 5) + f + e + k + w[i];
      e = d, d = c, c = std::rotl(b, 30), b = a, a = t;
    }
    h[0] += a, h[1] += b, h[2] += c, h[3] += d, h[4] += e;
  }
  std::array<std::uint8_t, 20> out{};
  for (std::size_t i = 0; i < 20; ++i) out[i] = static_cast<std::uint8_t>(h[i / 4] >> (24 - 8 * (i % 4)));
  return out;
}

std::string base64(const std::uint8_t* data, std::size_t size) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < size; i += 3) {
    const std::size_t n = std::min<std::size_t>(3, size - i);
    std::uint32_t v = 0;
    for (std::size_t k = 0; k < 3; ++k) v = v << 8 | (k < n ? data[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) out.push_back(k <= n ? digits[v >> (18 - 6 * k) & 63] : '=');
  }
  return out;
}

std::string accept_key(std::string_view client_key) {
  const auto digest = sha1(std::string(client_key) + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11");
  return base64(digest.data(), digest.size());
}

void append_frame(std::string& out, Opcode opcode, std::string_view payload) {
  out.push_back(static_cast<char>(0x80 | static_cast<int>(opcode)));
  const std::uint64_t n = payload.size();
  if (n < 126) {
    out.push_back(static_cast<char>(n));
  } else {
    const int bytes = n < 65536 ? 2 : 8;
    out.push_back(bytes == 2 ? 126 : 127);
    for (int i = bytes - 1; i >= 0; --i) out.push_back(static_cast<char>(n >> (8 * i) & 0xFF));
  }
  out.append(payload);
}

void append_close(std::string& out, int code) {
  const char payload[2]{static_cast<char>(code >> 8 & 0xFF), static_cast<char>(code & 0xFF)};
  append_frame(out, Opcode::close, {payload, 2});
}

bool MessageReader::next(Message& message) {
  for (;;) {
    if (error_ != 0 || buffer_.size() < 2) return false;
    const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(buffer_[i]); };
    const bool last = (byte(0) & 0x80) != 0, masked = (byte(1) & 0x80) != 0;
    const int opcode = byte(0) & 0x0F;
    const bool control = opcode >= 8;
    if ((byte(0) & 0x70) != 0 || !masked || opcode > 10 || (opcode > 2 && opcode < 8)) return fail(close_protocol_error);
    std::uint64_t size = byte(1) & 0x7F;
    const std::size_t extra = size == 126 ? 2 : size == 127 ? 8 : 0;
    if (control && (extra > 0 || !last)) return fail(close_protocol_error);
    if (buffer_.size() < 2 + extra + 4) return false;
    if (extra > 0) {
      size = 0;
      for (std::size_t i = 0; i < extra; ++i) size = size << 8 | byte(2 + i);
    }
    if (size > longest_ || (!control && parts_.size() + size > longest_)) return fail(close_too_big);
    const std::size_t head = 2 + extra + 4;
    if (buffer_.size() < head + size) return false;
    std::string payload = buffer_.substr(head, size);
    for (std::size_t i = 0; i < payload.size(); ++i)
      payload[i] = static_cast<char>(payload[i] ^ buffer_[2 + extra + i % 4]);
    buffer_.erase(0, head + size);
    if (control) {
      message = {static_cast<Opcode>(opcode), std::move(payload)};
      return true;
    }
    if ((opcode == 0) == (parts_opcode_ == Opcode::continuation)) return fail(close_protocol_error);
    if (opcode != 0) parts_opcode_ = static_cast<Opcode>(opcode);
    parts_ += payload;
    if (!last) continue;
    message = {parts_opcode_, std::move(parts_)};
    parts_.clear();
    parts_opcode_ = Opcode::continuation;
    return true;
  }
}

}  // namespace imbibe::live
