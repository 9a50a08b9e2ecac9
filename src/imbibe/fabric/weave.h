// The weave draft: which family of yarns lies on the face at each crossing of a repeat.
//
// Row = pick (weft yarn), column = end (warp yarn); 1 = warp on the face, 0 = weft on the face (the usual drafting
// convention: a filled square is a raised end). The first row is the pick at the smallest y, the first column the end
// at the smallest x. The draft repeats over the cloth.
//
// Parsed forms (words in any case, `2/1` or `2 1`):
//   plain | twill up/down [left|right] | satin n/step | sateen n/step | basket n | basket n/m | 1100 0110 0011 1001
// Tested in tests/fabric/weave_test.cpp.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "imbibe/core/types.h"

namespace imbibe {

struct WeaveDraft {
  int picks = 0, ends = 0;             // size of the repeat
  std::vector<std::uint8_t> warp_up;   // picks x ends, row-major

  // Whether the warp is on the face where `pick` crosses `end`; the draft repeats.
  bool warp_on_face(std::size_t pick, std::size_t end) const {
    return warp_up[(pick % static_cast<std::size_t>(picks)) * static_cast<std::size_t>(ends) +
                   end % static_cast<std::size_t>(ends)] != 0;
  }
  friend bool operator==(const WeaveDraft&, const WeaveDraft&) = default;
};

inline constexpr int largest_weave_repeat = 16384;       // picks or ends
inline constexpr std::size_t largest_weave = 1u << 26;   // crossings of a repeat

enum class TwillDirection { right, left };

WeaveDraft plain_weave();
WeaveDraft twill_weave(int up, int down, TwillDirection direction = TwillDirection::right);
// Warp-faced satin of `ends` ends whose single weft interlacing moves by `step`; step and ends must share no divisor
// and 1 < step < ends - 1. `sateen` turns it over: weft-faced.
WeaveDraft satin_weave(int ends, int step);
WeaveDraft sateen_weave(int ends, int step);
// Plain weave of groups of `ends` ends and `picks` picks.
WeaveDraft basket_weave(int ends, int picks);
// Rows of 0 and 1; first row = first pick.
WeaveDraft weave_from_rows(const std::vector<std::string>& rows);

// Any of the forms above; throws InputError that says what is wrong and lists the forms.
WeaveDraft parse_weave(std::string_view text);

// The draft as rows of 0 and 1.
std::vector<std::string> weave_rows(const WeaveDraft& draft);

// Structure of a draft, for checks and for printing.
struct WeaveFacts {
  Real warp_face_share = 0;          // share of crossings with the warp on the face
  Real warp_interlacing = 0;         // changes of side per crossing along a warp yarn, 1 = plain weave
  Real weft_interlacing = 0;
  int longest_warp_float = 0;        // crossings; 0 = the yarn never interlaces
  int longest_weft_float = 0;
  std::vector<int> loose_ends;       // ends of the repeat that never interlace: they fall out of the cloth
  std::vector<int> loose_picks;
};
WeaveFacts weave_facts(const WeaveDraft& draft);

}  // namespace imbibe
