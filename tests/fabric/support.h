// What several fabric tests need: the shipped fibres, two known cloths, and the problems that a call throws.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "imbibe/fabric/fabric.h"

namespace imbibe::test {

inline const FibreLibrary& shipped_fibres() {
  static const FibreLibrary library = read_fibre_library({IMBIBE_SOURCE_DIR "/fibres"});
  return library;
}

// Seed A's sheet: 60 x 60 yarns of radius 0.2 mm at a pitch of 1 mm.
inline FabricSpec paper_sheet() {
  FabricSpec spec;
  spec.size = {0.06, 0.06};
  for (YarnSpec* yarn : {&spec.warp, &spec.weft}) {
    yarn->fibre = "wool";
    yarn->diameter = 0.4e-3;
    yarn->density = 1000;
  }
  return spec;
}

// A cotton shirting, 30 x 28 per cm of 20 tex.
inline FabricSpec shirting(Real size = 0.01) {
  FabricSpec spec;
  spec.size = {size, size};
  spec.warp.linear_density = spec.weft.linear_density = 20e-6;
  spec.warp.density = 3000;
  spec.weft.density = 2800;
  return spec;
}

// All problems that `call` throws as text, or "" when it throws none.
template <class Call>
std::string problems_of(Call&& call) {
  try {
    call();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

template <class Call>
std::size_t problem_count(Call&& call) {
  try {
    call();
  } catch (const InputError& e) {
    return e.problems().size();
  }
  return 0;
}

inline bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace imbibe::test
