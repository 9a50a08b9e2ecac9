#include "imbibe/live/gallery.h"

#include <gtest/gtest.h>

#include "imbibe/core/error.h"

namespace imbibe::live {
namespace {

Scene scene(const std::vector<std::string>& overrides = {}) {
  return read_scene(std::filesystem::path(IMBIBE_SOURCE_DIR) / "scenes/seed_b/round_cloth.yaml", overrides);
}

TEST(Gallery, EveryKindOfFileThatASceneNamesIsKnown) {
  const auto files = files_named_by(
      scene({"textiles[0].weave=/a/draft.wif", "liquid.pipes[0].file=/a/pipe.obj", "solids=[{shape: {kind: mesh, file: /a/solid.stl}}]"}));
  EXPECT_EQ(files.size(), 4u);
  for (const char* file : {"/a/draft.wif", "/a/pipe.obj", "/a/solid.stl"}) EXPECT_TRUE(files.contains(file)) << file;
}

TEST(Gallery, APageMayNotPointAnyKeyAtAnotherFile) {
  const Scene before = scene();
  EXPECT_NO_THROW(refuse_new_files(before, before));
  for (const char* change : {"textiles[0].weave=/etc/draft.WIF", "textiles[0].sheet.soft.mesh=/etc/passwd",
                             "liquid.pipes[0].file=/etc/passwd", "solids=[{shape: {kind: mesh, file: /etc/passwd}}]"}) {
    SCOPED_TRACE(change);
    const Scene after = read_scene_text(write_scene(before), "scene", {change});
    EXPECT_THROW(refuse_new_files(after, before), InputError);
  }
}

}  // namespace
}  // namespace imbibe::live
