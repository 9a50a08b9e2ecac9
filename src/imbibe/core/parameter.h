// One description of every parameter: name, unit, range, help, default. The scene reader, `--set`, `imbibe params`,
// the JSON Schema and the reference page are visitors of it; none of them lists a parameter by hand.
//
// A params struct `P` is described next to its definition by a free function template (found by ADL):
//
//   template <class V> void describe(V& v, SorptionParams& p) {
//     v.value("rate_factor", p.rate_factor, {.unit = "1", .min = 0, .max = 100, .help = "..."});
//     v.choice("model", p.model, {{"linear", SorptionModel::linear}, {"shells", SorptionModel::shells}}, "...");
//     v.group("isotherm", p.isotherm, "...");        // nested struct, described by its own describe()
//     v.list("drops", p.drops, "...");               // std::vector of described structs
//   }
//
// Types a visitor must take in value(): Real, int, std::uint64_t, bool, std::string, Vec3, std::array<Real, 2>,
// std::vector<std::string>, and std::optional of these. The default is the value in a default-constructed struct.
#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace imbibe {

inline constexpr double unlimited = std::numeric_limits<double>::infinity();

struct ParameterInfo {
  const char* unit = "1";      // SI unit of the stored value, UDUNITS spelling
  const char* shown = "";      // unit used on screen and in docs, e.g. "mm"; "" = same as unit
  double min = -unlimited;     // allowed range, in SI
  double max = unlimited;
  bool above_min = false;      // true: min itself is not allowed
  bool required = false;       // true: a file must give it
  const char* help = "";
};

// Describes in `body` what is read only where `read` holds (yarns, not of a cloth of cells). Readers, writers and tables know
// all keys all the same; a visitor that has a member `reads` learns of it there.
template <class V, class Body>
void read_when(V& v, bool read, Body&& body) {
  if constexpr (requires { v.reads; }) {
    const bool around = v.reads;
    v.reads = around && read;
    body();
    v.reads = around;
  } else {
    body();
  }
}

template <class Enum>
using Choices = std::vector<std::pair<const char*, Enum>>;

}  // namespace imbibe
