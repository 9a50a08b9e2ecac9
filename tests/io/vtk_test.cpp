// Reads back with VTK's own readers, through Debian's python3-vtk9 (apt-packages-test.txt): what our writer calls a
// .vtp must be one to them. Values are written as text by Python and compared bit for bit here.
#include "imbibe/io/vtk.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>

#include "imbibe/core/error.h"
#include "imbibe/core/output_file.h"
#include "io/temporary_folder.h"

namespace imbibe {
namespace {

using testing::TemporaryFolder;

// Debian's python3, by its full path: another python may come first on the PATH, and it has no vtk.
constexpr const char* reader_script = R"(
import sys
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
reader = vtkXMLPolyDataReader()
reader.SetFileName(sys.argv[1])
reader.Update()
if reader.GetErrorCode() != 0: sys.exit(3)
data = reader.GetOutput()
out = open(sys.argv[2], 'w')
def line(name, values): out.write(name + ' ' + ' '.join(repr(float(v)) for v in values) + '\n')
n = data.GetNumberOfPoints()
line('points', [c for i in range(n) for c in data.GetPoint(i)])
for kind, cells in (('verts', data.GetVerts()), ('lines', data.GetLines())):
    ids, flat, lengths = __import__('vtkmodules.vtkCommonCore', fromlist=['vtkIdList']).vtkIdList(), [], []
    cells.InitTraversal()
    while cells.GetNextCell(ids):
        lengths.append(ids.GetNumberOfIds())
        flat += [ids.GetId(i) for i in range(ids.GetNumberOfIds())]
    line(kind, flat)
    line(kind + '_lengths', lengths)
pd = data.GetPointData()
for a in range(pd.GetNumberOfArrays()):
    array = pd.GetArray(a)
    m = array.GetNumberOfComponents()
    line('type_' + array.GetName(), [array.GetDataType()])
    line('array_' + array.GetName(),
         [array.GetComponent(i, c) for i in range(array.GetNumberOfTuples()) for c in range(m)])
line('time', [data.GetFieldData().GetArray('TimeValue').GetComponent(0, 0)])
)";

constexpr double vtk_int = 6, vtk_float = 10;  // type numbers of vtkType.h

std::map<std::string, std::vector<double>> read_by_vtk(const TemporaryFolder& folder, const std::string& file) {
  const auto script = folder / "read.py", answer = folder / "answer.txt";
  write_whole_file(script, reader_script);
  const std::string command = "/usr/bin/python3 " + script.string() + " " + (folder / file).string() + " " +
                              answer.string() + " 2>&1";
  const int status = std::system(command.c_str());
  EXPECT_EQ(status, 0) << "python3-vtk9 did not read " << file;
  std::map<std::string, std::vector<double>> values;
  std::ifstream in(answer);
  for (std::string text; std::getline(in, text);) {
    std::istringstream words(text);
    std::string name;
    words >> name;
    std::vector<double>& list = values[name];
    for (std::string word; words >> word;) list.push_back(std::strtod(word.c_str(), nullptr));
  }
  return values;
}

template <class T>
std::vector<double> widened(const std::vector<T>& values) {
  return {values.begin(), values.end()};
}

std::vector<double> widened(const std::vector<Vec3f>& points) {
  std::vector<double> all;
  for (const Vec3f& p : points) all.insert(all.end(), {p.x, p.y, p.z});
  return all;
}

TEST(Vtp, particles_are_read_back_by_vtk_bit_for_bit) {
  const TemporaryFolder folder;
  PolyData data;
  std::vector<float> velocity, mass;
  std::vector<std::int32_t> id;
  for (int i = 0; i < 1000; ++i) {
    const float f = static_cast<float>(i);
    data.points.push_back({1e-3f * f, -2.5e-4f * f, 1.0f / (1 + f)});
    velocity.insert(velocity.end(), {f, -f, 1e-38f * f});
    mass.push_back(2.05e-7f + 1e-12f * f);
    id.push_back(i * 1000003);
  }
  data.add("velocity", velocity, 3);
  data.add("mass", mass);
  data.add("id", id);
  write_vtp(folder / "liquid.vtp", data, {.time_s = 0.1, .step = 7});

  const auto read = read_by_vtk(folder, "liquid.vtp");
  EXPECT_EQ(read.at("points"), widened(data.points));
  EXPECT_EQ(read.at("array_velocity"), widened(velocity));
  EXPECT_EQ(read.at("array_mass"), widened(mass));
  EXPECT_EQ(read.at("array_id"), widened(id));
  EXPECT_EQ(read.at("type_mass"), std::vector<double>{vtk_float});
  EXPECT_EQ(read.at("type_id"), std::vector<double>{vtk_int});
  EXPECT_EQ(read.at("verts_lengths"), std::vector<double>(1000, 1.0));
  EXPECT_TRUE(read.at("lines").empty());
  EXPECT_EQ(read.at("time"), std::vector<double>{0.1});
}

TEST(Vtp, poly_lines_of_different_lengths_are_read_back_by_vtk) {
  const TemporaryFolder folder;
  PolyData data;
  for (int i = 0; i < 12; ++i) data.points.push_back({0.1f * static_cast<float>(i), 0, 0});
  data.line_start = {0, 3, 5, 12};
  data.add("saturation", std::vector<float>(12, 0.25f));
  write_vtp(folder / "lines.vtp", data, {});
  const auto read = read_by_vtk(folder, "lines.vtp");
  EXPECT_EQ(read.at("lines_lengths"), (std::vector<double>{3, 2, 7}));
  EXPECT_EQ(read.at("lines"), (std::vector<double>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}));
  EXPECT_TRUE(read.at("verts").empty());
}

TEST(Vtp, without_any_point_is_read_by_vtk) {
  const TemporaryFolder folder;
  PolyData data;
  data.add("velocity", std::vector<float>{}, 3);
  write_vtp(folder / "empty.vtp", data, {});
  const auto read = read_by_vtk(folder, "empty.vtp");
  EXPECT_TRUE(read.at("points").empty());
}

TEST(Vtp, refuses_a_value_that_is_not_finite_and_names_the_array_and_the_point) {
  const TemporaryFolder folder;
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    PolyData data;
    data.points.assign(5, Vec3f{1, 2, 3});
    std::vector<float> velocity(15, 0.0f);
    velocity[11] = bad;  // a component of point 3
    data.add("velocity", velocity, 3);
    try {
      write_vtp(folder / "bad.vtp", data, {.time_s = 0.25, .step = 42});
      FAIL() << "written";
    } catch (const NumericalError& error) {
      EXPECT_NE(error.where.find("'velocity'"), std::string::npos) << error.where;
      EXPECT_NE(error.where.find("point 3"), std::string::npos) << error.where;
      EXPECT_EQ(error.step, 42u);
    }
    data.arrays.clear();
    data.points[2].y = bad;
    EXPECT_THROW(write_vtp(folder / "bad.vtp", data, {}), NumericalError);
  }
  EXPECT_EQ(testing::files_in(folder.path()), 0u);
}

TEST(Pvd, is_rewritten_whole_and_read_back) {
  const TemporaryFolder folder;
  const auto path = folder / "liquid.pvd";
  EXPECT_TRUE(read_pvd(path).empty());
  std::vector<PvdEntry> entries;
  for (int i = 0; i < 3; ++i) {
    entries.push_back({0.1 * i, "liquid_00000" + std::to_string(i) + ".vtp"});
    write_pvd(path, entries);
    const std::vector<PvdEntry> read = read_pvd(path);
    ASSERT_EQ(read.size(), entries.size());
    for (std::size_t k = 0; k < read.size(); ++k) {
      EXPECT_EQ(read[k].time_s, entries[k].time_s);
      EXPECT_EQ(read[k].file, entries[k].file);
    }
  }
  EXPECT_EQ(testing::files_in(folder.path()), 1u);
}

}  // namespace
}  // namespace imbibe
