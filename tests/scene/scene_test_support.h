// Help for the scene tests: a small valid scene as text, and the problems of a broken one.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "imbibe/scene/scene.h"

namespace imbibe::test {

// Line numbers matter: tests name them.
inline const char* const small_scene =
    "version: 1\n"                                                                     // 1
    "title: small\n"                                                                   // 2
    "duration: 1 s\n"                                                                  // 3
    "air: {temperature: 20 degC, humidity: 65 %}\n"                                    // 4
    "liquid:\n"                                                                        // 5
    "  kind: water\n"                                                                  // 6
    "  particle_mass: 0.205 mg\n"                                                      // 7
    "  drops:\n"                                                                       // 8
    "    - {centre: [0, 0, 5 mm], volume: 50 uL, velocity: [0, 0, -0.3 m/s]}\n"        // 9
    "textiles:\n"                                                                      // 10
    "  - name: swatch\n"                                                               // 11
    "    size: [12 mm, 12 mm]\n"                                                       // 12
    "    weave: plain\n"                                                               // 13
    "    warp: {fibre: cotton, diameter: 0.4 mm, density: 10 /cm}\n"                   // 14
    "    weft: {fibre: cotton, diameter: 0.4 mm, density: 10 /cm}\n"                   // 15
    "    sheet: fixed\n"                                                               // 16
    "    wetting: network\n";                                                          // 17

// small_scene with its line `line` replaced.
inline std::string with_line(int line, const std::string& replacement) {
  const std::string text = small_scene;
  std::string out;
  int at = 1;
  for (std::size_t begin = 0; begin < text.size(); ++at) {
    const std::size_t end = text.find('\n', begin) + 1;
    out += at == line ? replacement + "\n" : text.substr(begin, end - begin);
    begin = end;
  }
  return out;
}

inline std::vector<Problem> problems_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
  try {
    read_scene_text(text, "test.yaml", overrides);
  } catch (const InputError& error) {
    return error.problems();
  }
  return {};
}

// Exactly one problem, at this place, under this key, whose message holds `message`.
inline void expect_one(const std::vector<Problem>& problems, int line, int column, const std::string& key,
                       const std::string& message) {
  std::string all;
  for (const Problem& p : problems) all += p.text() + "\n";
  ASSERT_EQ(problems.size(), 1u) << all;
  const Problem& p = problems.front();
  EXPECT_EQ(p.line, line) << all;
  EXPECT_EQ(p.column, column) << all;
  EXPECT_EQ(p.key, key) << all;
  EXPECT_NE(p.message.find(message), std::string::npos) << "wanted '" << message << "' in: " << all;
}

// A folder that is removed with everything in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "imbibe_scene_XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    const auto file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
    return file;
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace imbibe::test
