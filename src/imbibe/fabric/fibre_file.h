// Fibre data files, fibres/*.yaml: every value with its unit, source and confidence.
//
//   name: cotton
//   title: Cotton, scoured and bleached
//   values:
//     density: {value: 1550 kg/m3, source: "Morton & Hearle ...", confidence: high}
//   isotherm: {m0: 0.0339, c: 11.0, k: 0.857, source: "...", confidence: medium}
// Tested in tests/fabric/fibre_file_test.cpp.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "imbibe/fabric/fibre.h"

namespace imbibe {

// Where one number of a fibre comes from.
struct FibreValue {
  std::string key;         // e.g. density
  std::string shown;       // as written in the file, with its unit
  std::string source;
  std::string confidence;  // high, medium or low
};

struct FibreRecord {
  Fibre fibre;
  std::string title;
  Real staple_packing = 0.55;  // packing of a yarn of it when a scene gives none
  std::filesystem::path file;
  std::vector<FibreValue> values;
};

struct FibreLibrary {
  std::vector<FibreRecord> records;  // sorted by name
};

// Reads one file; throws InputError with all its problems.
FibreRecord read_fibre_file(const std::filesystem::path& file);

// Reads every *.yaml of the folders, in order; a later folder's fibre replaces an earlier one of the same name.
// Throws InputError with the problems of all files.
FibreLibrary read_fibre_library(const std::vector<std::filesystem::path>& folders);

// nullptr when there is none of that name.
const FibreRecord* find_fibre(const FibreLibrary& library, const std::string& name);
// Throws InputError naming the nearest fibre and listing all.
const FibreRecord& require_fibre(const FibreLibrary& library, const std::string& name);
// `there is no fibre "coton"; did you mean "cotton"? Known: ...`
std::string unknown_fibre_message(const FibreLibrary& library, const std::string& name);

}  // namespace imbibe
