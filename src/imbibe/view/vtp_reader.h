// Reads back the .vtp files that a run writes (io/vtk.h): PolyData with raw appended Float32 and Int32 arrays. Not a
// general VTK reader. Every count and offset is checked against the file's size before it is used.
#pragma once

#include <filesystem>

#include "imbibe/io/vtk.h"

namespace imbibe {

// InputError saying what is wrong when the file is missing, cut short or of another form.
PolyData read_vtp(const std::filesystem::path& path);

// The float array of that name with one value per point, or null.
const std::vector<float>* find_floats(const PolyData& data, const std::string& name);

}  // namespace imbibe
