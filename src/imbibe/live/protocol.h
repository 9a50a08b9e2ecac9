// What goes over the wire (docs/live_protocol.md).
//
// Server to page: JSON text for what happens seldom (hello, scene, changed, error, ...), one binary form for frames:
//
// An owner is a solid (props after the solids) in sections 6 and 7, else a textile, or a cloth of cells after them.
//
//   offset  type        meaning (little-endian)
//   0       u32         "IMBF"
//   4       u16 u8 u8   version, swatch (0 or 1), kind: 0 a frame, 1 the geometry of a scene message
//   8       u32 u32     generation, number
//   16      u16 u16     flags (below), number of sections
//   20      u32         number of values
//   24      f64[]       values, in the order of `columns` of the hello message
//   then sections, each beginning at a multiple of 4:
//   0       u8 u8 u16   section kind, textile or solid, how many each point stands for (0: as 1)
//   4       u32 u32     items, bytes of what follows (without padding)
//
//   kind  items       content
//   1     particles   f32[3] origin, f32[3] step, u16[3] each: position = origin + step * value (m);
//                     of more than most_shown_particles every second, third, ...
//   2     nodes       u8 each: saturation * saturation_scale, of all nodes
//   3     changes     of those that changed since the last frame to this viewer: LEB128 gap to the node before, then u8
//   4     points      yarns' centre-line points, or nodes of a cloth, as particles
//   5     points      pores, as particles
//   6     vertices    f32[3] each: mesh of a solid
//   7     triangles   u32[3] each
//   8     triangles   u32[3] each: of a cloth
//   9     nodes       f32[2] each: where they lie in the flat cloth, m along weft and warp
//   10    nodes       of the soft sheet that a textile's yarns ride on, as particles
//   11    triangles   u32[3] each: of that sheet
//   12    points      of its yarns, as in 4: u32 triangle, u16 second and third weight / 65535, f32 height: position =
//                     sum of weights x corners + height x the normal there, mixed alike of the nodes' normals
//
// A frame without section 1 leaves the particles as they are; with it and no items there are none.
//
// Page to server: JSON text, at most longest_message bytes, with a "type". parse_message() takes anything and throws
// nothing. Tested and fuzzed in tests/live/wire_test.cpp.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "imbibe/live/snapshot.h"

namespace imbibe::live {

inline constexpr int protocol_version = 1;
inline constexpr std::size_t longest_message = 2u << 20;
inline constexpr std::size_t most_assignments = 64;
inline constexpr std::size_t longest_assignment = 4096;

enum Flags : std::uint16_t {
  flag_running = 1,
  flag_ended = 2,     // the scene's duration, or the end of a replay, is reached
  flag_resting = 4,   // the liquid rests
  flag_replay = 8,
  flag_recording = 16,
  flag_failed = 32,   // stopped by a numerical failure
};

// Encodes frames for one viewer and one swatch: remembers what that viewer has seen.
class FrameEncoder {
 public:
  explicit FrameEncoder(std::uint8_t swatch) : swatch_(swatch) {}
  std::string encode(const Snapshot& snapshot);

 private:
  std::uint8_t swatch_;
  std::uint32_t generation_ = 0;
  std::shared_ptr<const QuantisedPoints> particles_;
  std::vector<std::shared_ptr<const Saturations>> saturations_;
  std::vector<std::shared_ptr<const QuantisedPoints>> yarns_, sheets_;
};

std::string encode_geometry(std::uint8_t swatch, const Geometry& geometry);

// ---- messages of the page

inline constexpr std::uint8_t both_swatches = 255;

struct SetMessage { std::vector<std::string> assignments; bool restart = false; };  // restart: a world built anew
struct RunMessage {};
struct PauseMessage {};
struct StepMessage { int steps = 1; };
struct ResetMessage {};
struct SpeedMessage { Real limit = 0; };                     // simulated per wall-clock second; 0 = none
struct DropMessage { Vec3 at{}; Real volume = 0; Real speed = 0; };  // m, m3, m/s; `at` on the cloth
struct InspectMessage { std::uint32_t textile = 0, node = 0; };
struct OpenMessage { std::string gallery; std::string name, text; };  // one of the gallery, or a file's text
struct CompareMessage { bool on = false; std::vector<std::string> assignments; };
struct RecordMessage { bool on = false; };
struct SaveMessage {};
struct SeekMessage { Real time = 0; };
struct TakeMessage {};
struct RateMessage { Real frames_per_second = 30; };

struct Message {
  std::uint8_t swatch = 0;  // 0, 1 or both_swatches
  std::variant<std::monostate, SetMessage, RunMessage, PauseMessage, StepMessage, ResetMessage, SpeedMessage, DropMessage,
               InspectMessage, OpenMessage, CompareMessage, RecordMessage, SaveMessage, SeekMessage, TakeMessage,
               RateMessage>
      body;
  std::string problem;  // what is wrong with it; "" = nothing
  double ask = 0;       // not 0: to be answered with this number once carried out
  // Whether only the viewer that holds the controls may send it.
  bool needs_controls() const;
};

Message parse_message(std::string_view text);

}  // namespace imbibe::live
