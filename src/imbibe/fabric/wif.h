// Reads Weaving Information Files, WIF 1.1 (Nielsen, Keates, Sinkler et al., 1997): the draft as threading, tie-up and
// treadling or as a liftplan, with colours, spacing and thickness of the threads.
//
// How the format is read here:
//   - section and key names in any case; `;` starts a comment line, and a comment after a number or boolean
//   - [CONTENTS] is a hint: a section it promises may be missing, one it omits is read all the same
//   - rows are sparse: a thread without a row has the default of [WARP] or [WEFT]; shaft or treadle 0 = none
//   - booleans true, on, yes, 1 and false, off, no, 0
//   - Units: decipoints (1/720 inch), inches, centimeters
//   - [LIFTPLAN] wins where [TREADLING] is present too; both are legal
//   - a rising shed (the default) raises the shafts that a pick names, a sinking shed lowers them
//   - [COLOR TABLE] values run over `Range` of [COLOR PALETTE], by default 0,255; other sections are skipped
// Every problem of the file is reported with its line, all in one InputError. Tested in tests/fabric/wif_test.cpp.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "imbibe/core/types.h"
#include "imbibe/fabric/weave.h"

namespace imbibe {

// The warp or the weft of a file; per thread, in the file's order.
struct WifThreads {
  int threads = 0;
  std::vector<Real> spacing;    // m, room that a thread takes across the family; empty: not given
  std::vector<Real> thickness;  // m, diameter; empty: not given
  std::vector<Vec3> colour;     // linear RGB; empty: not given
  bool lengths_without_unit = false;  // spacing or thickness is written, but no Units: they are not used
};

struct WifFile {
  std::string title;
  int shafts = 0, treadles = 0;
  bool rising_shed = true;
  bool from_liftplan = false;   // the draft comes from [LIFTPLAN]
  WifThreads warp, weft;
  WeaveDraft draft;             // one row per pick, one column per end
};

inline constexpr int largest_wif_shafts = 4096;
inline constexpr std::size_t largest_wif_bytes = 64u << 20;

// Whether a file name ends in .wif, in any case.
bool is_wif_name(std::string_view name);

// Throws InputError with every problem of the text; `file` is the name put before the line numbers.
WifFile parse_wif(std::string_view text, const std::string& file);
WifFile read_wif(const std::filesystem::path& file);

// Linear value of an sRGB component, both 0..1 (IEC 61966-2-1).
Real linear_from_srgb(Real component);

}  // namespace imbibe
