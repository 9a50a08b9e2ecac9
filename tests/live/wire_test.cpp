// What a client can send: handshake, frames, requests, messages; and the frames that go back.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "imbibe/live/history.h"
#include "imbibe/live/http.h"
#include "imbibe/live/protocol.h"
#include "imbibe/live/websocket.h"

namespace imbibe::live {
namespace {

std::string client_frame(int first_byte, std::string payload, bool masked = true) {
  std::string out(1, static_cast<char>(first_byte));
  const std::size_t n = payload.size();
  const int flag = masked ? 0x80 : 0;
  if (n < 126) out.push_back(static_cast<char>(flag | static_cast<int>(n)));
  else out += {static_cast<char>(flag | 126), static_cast<char>(n >> 8), static_cast<char>(n & 255)};
  const std::string mask = "\x11\x22\x33\x44";
  if (masked) out += mask;
  for (std::size_t i = 0; i < n; ++i) out.push_back(masked ? static_cast<char>(payload[i] ^ mask[i % 4]) : payload[i]);
  return out;
}

TEST(WebSocket, AcceptKeyIsThatOfTheStandard) {  // RFC 6455 section 1.3
  EXPECT_EQ(accept_key("dGhlIHNhbXBsZSBub25jZQ=="), "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");
}

TEST(WebSocket, Base64PadsAsTheStandardSays) {  // RFC 4648 section 10
  const auto text = [](const char* s) { return base64(reinterpret_cast<const std::uint8_t*>(s), std::strlen(s)); };
  EXPECT_EQ(text(""), "");
  EXPECT_EQ(text("f"), "Zg==");
  EXPECT_EQ(text("fo"), "Zm8=");
  EXPECT_EQ(text("foobar"), "Zm9vYmFy");
}

TEST(WebSocket, MessageInFragmentsWithAPingBetweenIsWhole) {
  const std::string bytes = client_frame(0x01, "Hel") + client_frame(0x89, "p") + client_frame(0x80, std::string(300, 'o'));
  for (const std::size_t piece : {std::size_t{1}, std::size_t{7}, bytes.size()}) {
    MessageReader reader(1000);
    MessageReader::Message message;
    std::vector<MessageReader::Message> all;
    for (std::size_t i = 0; i < bytes.size(); i += piece) {
      reader.feed(std::string_view(bytes).substr(i, piece));
      while (reader.next(message)) all.push_back(message);
    }
    ASSERT_EQ(all.size(), 2u);
    EXPECT_EQ(all[0].opcode, Opcode::ping);
    EXPECT_EQ(all[1].payload, "Hel" + std::string(300, 'o'));
  }
}

TEST(WebSocket, TooLongFrameIsRefusedFromItsHeadAlone) {
  MessageReader reader(1000);
  MessageReader::Message message;
  reader.feed(std::string("\x81\xff\x7f\xff\xff\xff\xff\xff\xff\xff\x01\x02\x03\x04", 14));
  EXPECT_FALSE(reader.next(message));
  EXPECT_EQ(reader.error(), close_too_big);
}

TEST(WebSocket, FragmentsMayNotAddUpToMoreThanTheLimit) {
  MessageReader reader(1000);
  MessageReader::Message message;
  reader.feed(client_frame(0x01, std::string(600, 'a')) + client_frame(0x80, std::string(600, 'b')));
  EXPECT_FALSE(reader.next(message));
  EXPECT_EQ(reader.error(), close_too_big);
}

TEST(WebSocket, WhatTheStandardForbidsEndsTheConnection) {
  for (const std::string& bytes :
       {client_frame(0x81, "x", false), client_frame(0xC1, "x"), client_frame(0x83, "x"), client_frame(0x80, "x"),
        client_frame(0x09, "x"), client_frame(0x89, std::string(126, 'x')), client_frame(0x01, "a") + client_frame(0x01, "b")}) {
    MessageReader reader(1000);
    MessageReader::Message message;
    reader.feed(bytes);
    while (reader.next(message)) {}
    EXPECT_EQ(reader.error(), close_protocol_error);
  }
}

TEST(WebSocket, AnyBytesAreSurvived) {
  std::mt19937 random(7);
  for (int round = 0; round < 3000; ++round) {
    MessageReader reader(500);
    MessageReader::Message message;
    std::string bytes = client_frame(0x81, std::string(random() % 200, 'm'));
    for (unsigned k = random() % 6; k > 0; --k) bytes[random() % bytes.size()] = static_cast<char>(random());
    for (std::size_t i = 0; i < bytes.size(); i += 13) {
      reader.feed(std::string_view(bytes).substr(i, 13));
      while (reader.next(message)) EXPECT_LE(message.payload.size(), 500u);
    }
  }
}

Site small_site() {
  Site site;
  site.files["/index.html"] = {"text/html", "<p>page"};
  site.hosts = {"127.0.0.1:80"};
  return site;
}

std::string status(const Site& site, const std::string& request) { return answer(site, request).head_and_body.substr(9, 3); }

TEST(Http, OnlyFilesOfTheListAreServed) {
  const Site site = small_site();
  const auto get = [&](const std::string& path) { return status(site, "GET " + path + " HTTP/1.1\r\nHost: 127.0.0.1:80\r\n\r\n"); };
  EXPECT_EQ(get("/"), "200");
  EXPECT_EQ(get("/index.html?theme=dark"), "200");
  for (const char* path : {"/../index.html", "/etc/passwd", "//index.html", "/index.html/", "/index.html%00", "index.html"})
    EXPECT_EQ(get(path), "404") << path;
}

TEST(Http, ForeignNamesOriginsAndMethodsAreRefused) {
  const Site site = small_site();
  EXPECT_EQ(status(site, "GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n"), "403");
  EXPECT_EQ(status(site, "GET / HTTP/1.1\r\n\r\n"), "403");
  EXPECT_EQ(status(site, "GET / HTTP/1.1\r\nHost: 127.0.0.1:80\r\nHost: evil.example\r\n\r\n"), "403");
  EXPECT_EQ(status(site, "GET / HTTP/1.1\r\nHost: 127.0.0.1:80\r\nOrigin: http://evil.example\r\n\r\n"), "403");
  EXPECT_EQ(status(site, "GET / HTTP/1.1\r\nHost: 127.0.0.1:80\r\nOrigin: http://127.0.0.1:80\r\n\r\n"), "200");
  EXPECT_EQ(status(site, "PUT / HTTP/1.1\r\nHost: 127.0.0.1:80\r\n\r\n"), "405");
  for (const char* bad : {"", "\r\n\r\n", "GET /\r\n\r\n", "GET / HTTP/1.1\r\nno colon\r\n\r\n", "GET / HTTP/1.1\r\nHost: x"})
    EXPECT_EQ(status(site, bad), "400") << bad;
}

TEST(Http, TokenIsComparedAsAWhole) {
  EXPECT_TRUE(same_secret("abc", "abc"));
  for (const char* wrong : {"", "ab", "abcd", "abd", "abcabc"}) EXPECT_FALSE(same_secret(wrong, "abc")) << wrong;
}

TEST(Messages, GoodOnesAreRead) {
  const Message m = parse_message(R"({"type":"set","swatch":1,"assign":["air.humidity=30 %"]})");
  ASSERT_EQ(m.problem, "");
  EXPECT_EQ(m.swatch, 1);
  EXPECT_EQ(std::get<SetMessage>(m.body).assignments[0], "air.humidity=30 %");
  EXPECT_TRUE(m.needs_controls());
  EXPECT_FALSE(parse_message(R"({"type":"inspect","textile":0,"node":5})").needs_controls());
}

TEST(Messages, AnyMayAskToBeToldWhenItIsDone) {
  EXPECT_EQ(parse_message(R"({"type":"pause","ask":7})").ask, 7);
  EXPECT_EQ(parse_message(R"({"type":"pause"})").ask, 0);
  EXPECT_NE(parse_message(R"({"type":"pause","ask":-1})").problem, "");
}

TEST(Messages, BadOnesSayWhatIsWrong) {
  for (const char* text :
       {"", "{", "[]", "null", "{}", R"({"type":"fly"})", R"({"type":"set"})", R"({"type":"set","assign":[]})",
        R"({"type":"set","assign":[1]})", R"({"type":"drop","at":[0,0],"volume":1e-9})",
        R"({"type":"drop","at":[0,0,1e999],"volume":1e-9})", R"({"type":"drop","at":[0,0,0],"volume":-1})",
        R"({"type":"step","steps":1000000})", R"({"type":"run","swatch":7})", R"({"type":"speed","limit":"fast"})"})
    EXPECT_NE(parse_message(text).problem, "") << text;
  EXPECT_NE(parse_message(std::string(100000, '[')).problem, "");
}

TEST(Messages, AnyTextIsSurvived) {  // the fuzz test: mutations of good messages
  const std::vector<std::string> seeds{
      R"({"type":"set","assign":["textiles[0].contact_angle=60 deg"]})", R"({"type":"drop","at":[0,0.001,0],"volume":1e-9})",
      R"({"type":"open","name":"a.wif","text":"[WIF]"})", R"({"type":"inspect","textile":0,"node":12})",
      R"({"type":"compare","on":true,"assign":["seed=2"]})", R"({"type":"step","steps":3})"};
  std::mt19937 random(11);
  for (int round = 0; round < 5000; ++round) {
    std::string text = seeds[random() % seeds.size()];
    for (unsigned k = 1 + random() % 5; k > 0; --k) {
      const std::size_t at = random() % text.size();
      switch (random() % 4) {
        case 0: text[at] = static_cast<char>(random()); break;
        case 1: text.erase(at, 1 + random() % 5); break;
        case 2: text.insert(at, seeds[random() % seeds.size()].substr(0, random() % 30)); break;
        default: text[at] = "{}[]\",:0e9-"[random() % 11];
      }
      if (text.empty()) text = "{";
    }
    const Message m = parse_message(text);
    if (const auto* set = std::get_if<SetMessage>(&m.body); set && m.problem.empty()) {
      EXPECT_LE(set->assignments.size(), most_assignments);
    }
  }
}

TEST(Snapshots, QuantisedPointsAreWithinHalfAStep) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(-0.02f, 0.03f);
  std::vector<Vec3f> points(1000);
  for (Vec3f& p : points) p = {place(random), place(random), 0.5f * place(random)};
  const QuantisedPoints q = quantise(points.size(), [&](std::size_t i) { return points[i]; });
  for (std::size_t i = 0; i < points.size(); ++i) {
    // Half a step, and the rounding of float sums of this size.
    EXPECT_NEAR(q.origin.x + q.step.x * q.xyz[3 * i], points[i].x, 0.5f * q.step.x + 4e-9f);
    EXPECT_NEAR(q.origin.z + q.step.z * q.xyz[3 * i + 2], points[i].z, 0.5f * q.step.z + 4e-9f);
  }
}

TEST(Snapshots, WhateverTheBarShowsAsLiquidIsNotZero) {
  EXPECT_EQ(saturation_byte(0), 0);
  EXPECT_EQ(saturation_byte(4e-4), 0);
  EXPECT_EQ(saturation_byte(5e-4), 1);
  EXPECT_EQ(saturation_byte(1), saturation_scale);
  EXPECT_EQ(saturation_byte(9), 255);
  EXPECT_EQ(saturation_byte(std::nan("")), 0);
}

// Applies a frame's saturations as the page does.
void apply_frame(const std::string& frame, Saturations& s) {
  const auto u32 = [&](std::size_t at) { std::uint32_t v; std::memcpy(&v, frame.data() + at, 4); return v; };
  std::uint16_t sections = 0;
  std::memcpy(&sections, frame.data() + 18, 2);
  std::size_t at = 24 + 8 * u32(20);
  for (int i = 0; i < sections; ++i) {
    const auto kind = static_cast<std::uint8_t>(frame[at]);
    const std::uint32_t count = u32(at + 4), bytes = u32(at + 8);
    std::size_t from = at + 12;
    if (kind == 2) s.assign(frame.begin() + static_cast<std::ptrdiff_t>(from), frame.begin() + static_cast<std::ptrdiff_t>(from + count));
    std::size_t node = 0;
    for (std::uint32_t k = 0; kind == 3 && k < count; ++k) {
      std::size_t gap = 0;
      for (int shift = 0;; shift += 7) {
        const auto byte = static_cast<std::uint8_t>(frame[from++]);
        gap |= static_cast<std::size_t>(byte & 0x7F) << shift;
        if (byte < 0x80) break;
      }
      node += gap;
      s.at(node) = static_cast<std::uint8_t>(frame[from++]);
    }
    at += 12 + ((bytes + 3) & ~std::uint32_t{3});
  }
  EXPECT_EQ(at, frame.size());
}

TEST(Frames, ChangesAddUpToTheStateWhateverFramesAreLeftOut) {
  std::mt19937 random(5);
  FrameEncoder encoder(0);
  Saturations shown;
  auto state = std::make_shared<Saturations>(9000);
  std::size_t full = 0, largest_change = 0;
  for (std::uint32_t n = 1; n < 200; ++n) {
    auto next = std::make_shared<Saturations>(*state);
    const unsigned changed = n % 50 == 0 ? 9000 : random() % 200;
    for (unsigned k = 0; k < changed; ++k) (*next)[random() % 9000] = static_cast<std::uint8_t>(random());
    state = next;
    if (random() % 3 == 0) continue;  // this viewer was busy
    Snapshot s;
    s.generation = 1, s.number = n, s.saturations = {state};
    const std::string frame = encoder.encode(s);
    apply_frame(frame, shown);
    EXPECT_EQ(shown, *state);
    if (frame.size() > 9000) ++full;
    else largest_change = std::max(largest_change, frame.size());
  }
  EXPECT_GE(full, 1u);
  EXPECT_LT(largest_change, 24u + 12u + 3u * 600u + 3u) << "two or three bytes a change, of at most three steps";
}

TEST(Frames, LiquidThatDoesNotMoveIsSentOnce) {
  FrameEncoder encoder(0);
  Snapshot s;
  s.generation = 1;
  s.particles = std::make_shared<const QuantisedPoints>(quantise(1000, [](std::size_t i) { return Vec3(double(i), 0, 0); }));
  EXPECT_GT(encoder.encode(s).size(), 6000u);
  EXPECT_LT(encoder.encode(s).size(), 100u);
  s.generation = 2;  // a new world: everything again
  EXPECT_GT(encoder.encode(s).size(), 6000u);
}

TEST(HistoryOfRows, KeepsTheWholeTimeInABoundedNumberOfRows) {
  History history(100);
  for (int i = 0; i < 5000; ++i) history.add({double(i), 1});
  EXPECT_LT(history.size(), 100u);
  EXPECT_GT(history.size(), 30u);
  EXPECT_TRUE(history.json().starts_with("[[0,1],"));
}

}  // namespace
}  // namespace imbibe::live
