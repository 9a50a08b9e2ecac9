#include "imbibe/live/protocol.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

namespace imbibe::live {

static_assert(std::endian::native == std::endian::little, "frames are written as they lie in memory");

namespace {

template <class T>
void put(std::string& out, const T& value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class T>
void put_all(std::string& out, const std::vector<T>& values) {
  out.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

class FrameWriter {
 public:
  FrameWriter(std::uint8_t swatch, std::uint8_t kind, std::uint32_t generation, std::uint32_t number,
              std::uint16_t flags, const std::vector<double>& values) {
    out_ = "IMBF";
    put(out_, static_cast<std::uint16_t>(protocol_version));
    put(out_, swatch), put(out_, kind), put(out_, generation), put(out_, number), put(out_, flags);
    put(out_, std::uint16_t{0});  // sections, set in finish()
    put(out_, static_cast<std::uint32_t>(values.size()));
    put_all(out_, values);
  }
  template <class Fill>
  void section(int kind, std::size_t owner, std::size_t items, Fill&& fill, std::uint16_t every = 0) {
    put(out_, static_cast<std::uint8_t>(kind)), put(out_, static_cast<std::uint8_t>(owner)), put(out_, every);
    put(out_, static_cast<std::uint32_t>(items));
    const std::size_t size_at = out_.size();
    put(out_, std::uint32_t{0});
    fill(out_);
    const auto bytes = static_cast<std::uint32_t>(out_.size() - size_at - 4);
    std::memcpy(out_.data() + size_at, &bytes, 4);
    while (out_.size() % 4 != 0) out_.push_back('\0');
    ++sections_;
  }
  void points(int kind, std::size_t owner, const QuantisedPoints& points) {
    section(kind, owner, points.size(), [&](std::string& out) {
      put(out, points.origin), put(out, points.step);
      put_all(out, points.xyz);
    }, points.every);
  }
  std::string finish() {
    std::memcpy(out_.data() + 18, &sections_, 2);
    return std::move(out_);
  }

 private:
  std::string out_;
  std::uint16_t sections_ = 0;
};

void put_number(std::string& out, std::size_t n) {  // LEB128
  for (; n >= 0x80; n >>= 7) out.push_back(static_cast<char>((n & 0x7F) | 0x80));
  out.push_back(static_cast<char>(n));
}

// The changed nodes, or nothing when all of them would be shorter.
std::string changes(const Saturations& before, const Saturations& now, std::size_t& count) {
  std::string out;
  std::size_t last = 0;
  count = 0;
  for (std::size_t i = 0; i < now.size() && out.size() < now.size(); ++i) {
    if (now[i] == before[i]) continue;
    put_number(out, i - last);
    out.push_back(static_cast<char>(now[i]));
    last = i, ++count;
  }
  return out;
}

}  // namespace

std::uint8_t saturation_byte(Real saturation) {
  constexpr Real dry_below = 5e-4;  // view/colour_bar.h
  if (!(saturation >= dry_below)) return 0;
  return static_cast<std::uint8_t>(std::clamp(std::round(saturation * saturation_scale), 1.0, 255.0));
}

std::string FrameEncoder::encode(const Snapshot& s) {
  if (s.generation != generation_) {
    generation_ = s.generation;
    particles_ = nullptr;
    saturations_.assign(s.saturations.size(), nullptr);
    yarns_.assign(s.yarns.size(), nullptr);
    sheets_.assign(s.sheets.size(), nullptr);
  }
  FrameWriter frame(swatch_, 0, s.generation, s.number, s.flags, s.values);
  if (s.particles && s.particles != particles_) frame.points(1, 0, *s.particles), particles_ = s.particles;
  for (std::size_t t = 0; t < s.saturations.size(); ++t) {
    const auto& now = s.saturations[t];
    const auto& before = saturations_[t];
    if (now == before) continue;
    std::size_t count = 0;
    const bool comparable = before && before->size() == now->size();
    const std::string changed = comparable ? changes(*before, *now, count) : "";
    if (!comparable || changed.size() >= now->size())
      frame.section(2, t, now->size(), [&](std::string& out) { put_all(out, *now); });
    else if (count > 0)
      frame.section(3, t, count, [&](std::string& out) { out += changed; });
    saturations_[t] = now;
  }
  for (std::size_t t = 0; t < s.yarns.size(); ++t)
    if (s.yarns[t] && s.yarns[t] != yarns_[t]) frame.points(4, t, *s.yarns[t]), yarns_[t] = s.yarns[t];
  for (std::size_t t = 0; t < s.sheets.size(); ++t)
    if (s.sheets[t] && s.sheets[t] != sheets_[t]) frame.points(10, t, *s.sheets[t]), sheets_[t] = s.sheets[t];
  return frame.finish();
}

std::string encode_geometry(std::uint8_t swatch, const Geometry& g) {
  FrameWriter frame(swatch, 1, g.generation, 0, 0, {});
  for (std::size_t t = 0; t < g.yarns.size(); ++t) frame.points(4, t, g.yarns[t]);
  for (std::size_t t = 0; t < g.pores.size(); ++t) frame.points(5, t, g.pores[t]);
  for (std::size_t t = 0; t < g.carried.size(); ++t) {
    if (g.carried[t].empty()) continue;
    frame.section(11, t, g.sheet_triangles[t].size() / 3, [&](std::string& out) { put_all(out, g.sheet_triangles[t]); });
    frame.section(12, t, g.carried[t].size(), [&](std::string& out) { put_all(out, g.carried[t]); });
  }
  for (std::size_t c = 0; c < g.cloth_nodes.size(); ++c) {
    frame.points(4, g.yarns.size() + c, g.cloth_nodes[c]);
    frame.section(8, g.yarns.size() + c, g.cloth_triangles[c].size() / 3,
                  [&](std::string& out) { put_all(out, g.cloth_triangles[c]); });
    frame.section(9, g.yarns.size() + c, g.cloth_uv[c].size() / 2, [&](std::string& out) { put_all(out, g.cloth_uv[c]); });
  }
  for (std::size_t i = 0; i < g.mesh_vertices.size(); ++i) {
    if (g.mesh_vertices[i].empty()) continue;
    frame.section(6, i, g.mesh_vertices[i].size() / 3, [&](std::string& out) { put_all(out, g.mesh_vertices[i]); });
    frame.section(7, i, g.mesh_triangles[i].size() / 3, [&](std::string& out) { put_all(out, g.mesh_triangles[i]); });
  }
  return frame.finish();
}

namespace {

using Json = nlohmann::json;

// Reads the members of a message; the first thing that is wrong is kept.
class Members {
 public:
  Members(const Json& json, std::string& problem) : json_(json), problem_(problem) {}

  Real number(const char* name, Real low, Real high, Real fallback, bool required = true) {
    const Json* at = find(name, required);
    if (!at) return fallback;
    if (!at->is_number() || !std::isfinite(at->get<Real>()) || at->get<Real>() < low || at->get<Real>() > high)
      return fail(name, fmt::format("a number from {:g} to {:g}", low, high)), fallback;
    return at->get<Real>();
  }
  bool flag(const char* name, bool fallback) {
    const Json* at = find(name, false);
    if (!at) return fallback;
    if (!at->is_boolean()) return fail(name, "true or false"), fallback;
    return at->get<bool>();
  }
  std::string text(const char* name, std::size_t longest, bool required) {
    const Json* at = find(name, required);
    if (!at) return "";
    if (!at->is_string() || at->get_ref<const std::string&>().size() > longest)
      return fail(name, fmt::format("a text of at most {} bytes", longest)), "";
    return at->get<std::string>();
  }
  std::vector<std::string> texts(const char* name, bool required) {
    const Json* at = find(name, required);
    if (!at) return {};
    std::vector<std::string> out;
    const auto wrong = [&] {
      fail(name, fmt::format("at most {} texts path=value of at most {} bytes", most_assignments, longest_assignment));
      return std::vector<std::string>{};
    };
    if (!at->is_array() || at->size() > most_assignments || (required && at->empty())) return wrong();
    for (const Json& item : *at) {
      if (!item.is_string() || item.get_ref<const std::string&>().size() > longest_assignment) return wrong();
      out.push_back(item.get<std::string>());
    }
    return out;
  }
  Vec3 vector(const char* name, Real limit) {
    const Json* at = find(name, true);
    if (!at) return {};
    const auto good = [&](const Json& x) {
      return x.is_number() && std::isfinite(x.get<Real>()) && std::abs(x.get<Real>()) <= limit;
    };
    if (!at->is_array() || at->size() != 3 || !good((*at)[0]) || !good((*at)[1]) || !good((*at)[2]))
      return fail(name, "three numbers"), Vec3{};
    return {(*at)[0].get<Real>(), (*at)[1].get<Real>(), (*at)[2].get<Real>()};
  }

 private:
  const Json* find(const char* name, bool required) {
    const auto at = json_.find(name);
    if (at != json_.end()) return &*at;
    if (required) fail(name, "a value");
    return nullptr;
  }
  void fail(const char* name, const std::string& wanted) {
    if (problem_.empty()) problem_ = fmt::format("'{}' wants {}", name, wanted);
  }
  const Json& json_;
  std::string& problem_;
};

}  // namespace

bool Message::needs_controls() const {
  return !std::holds_alternative<InspectMessage>(body) && !std::holds_alternative<SaveMessage>(body) &&
         !std::holds_alternative<TakeMessage>(body) && !std::holds_alternative<RateMessage>(body);
}

Message parse_message(std::string_view text) {
  Message m;
  if (text.size() > longest_message) {
    m.problem = "the message is too long";
    return m;
  }
  // A depth that no message needs would only exhaust the stack of the parser's clean-up.
  int depth = 0;
  const auto shallow = [&](int, Json::parse_event_t event, Json&) {
    if (event == Json::parse_event_t::object_start || event == Json::parse_event_t::array_start) ++depth;
    if (event == Json::parse_event_t::object_end || event == Json::parse_event_t::array_end) --depth;
    if (depth > 8) m.problem = "the message is nested too deep";
    return depth <= 8;
  };
  const Json json = Json::parse(text, shallow, false);
  if (!m.problem.empty()) return m;
  if (!json.is_object()) {
    m.problem = "not a JSON object";
    return m;
  }
  Members get(json, m.problem);
  const std::string type = get.text("type", 32, true);
  const Real swatch = get.number("swatch", 0, both_swatches, 0, false);
  if (swatch != 0 && swatch != 1 && swatch != both_swatches) m.problem = "'swatch' wants 0, 1 or 255 (both)";
  m.swatch = static_cast<std::uint8_t>(swatch);
  m.ask = get.number("ask", 0, 9007199254740991.0, 0, false);
  if (!m.problem.empty()) return m;
  if (type == "set") m.body = SetMessage{get.texts("assign", true), get.flag("restart", false)};
  else if (type == "run") m.body = RunMessage{};
  else if (type == "pause") m.body = PauseMessage{};
  else if (type == "step") m.body = StepMessage{static_cast<int>(get.number("steps", 1, 1000, 1, false))};
  else if (type == "reset") m.body = ResetMessage{};
  else if (type == "speed") m.body = SpeedMessage{get.number("limit", 0, 1e6, 0)};
  else if (type == "drop")
    m.body = DropMessage{get.vector("at", 10), get.number("volume", 1e-15, 1e-3, 1e-8), get.number("speed", 0, 10, 0, false)};
  else if (type == "inspect")
    m.body = InspectMessage{static_cast<std::uint32_t>(get.number("textile", 0, 255, 0)),
                            static_cast<std::uint32_t>(get.number("node", 0, 4e9, 0))};
  else if (type == "open")
    m.body = OpenMessage{get.text("gallery", 200, false), get.text("name", 200, false), get.text("text", 1u << 20, false)};
  else if (type == "compare") m.body = CompareMessage{get.flag("on", true), get.texts("assign", false)};
  else if (type == "record") m.body = RecordMessage{get.flag("on", true)};
  else if (type == "save") m.body = SaveMessage{};
  else if (type == "seek") m.body = SeekMessage{get.number("time", 0, 1e9, 0)};
  else if (type == "take") m.body = TakeMessage{};
  else if (type == "rate") m.body = RateMessage{get.number("frames_per_second", 0.1, 60, 30)};
  else m.problem = fmt::format("there is no message '{}'", type);
  return m;
}

}  // namespace imbibe::live
