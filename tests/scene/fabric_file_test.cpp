#include "imbibe/scene/fabric_file.h"

#include "imbibe/scene/library.h"
#include "scene/scene_test_support.h"

namespace imbibe {
namespace {

namespace fs = std::filesystem;

TEST(FabricFile, EveryShippedFabricIsWoven) {
  const Library library = read_library({IMBIBE_SOURCE_DIR});
  int files = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(IMBIBE_SOURCE_DIR) / "fabrics")) {
    if (entry.path().extension() != ".yaml") continue;  // a draft alone may lack yarns and densities
    ++files;
    try {
      for (const NamedFabric& named : read_fabrics(entry.path())) {
        const Fabric fabric = build_named_fabric(named, library.fibres);
        EXPECT_GT(fabric.network.segments(), 0u) << entry.path();
      }
    } catch (const InputError& error) {
      ADD_FAILURE() << entry.path() << ": " << error.what();
    }
  }
  EXPECT_GE(files, 5);
}

TEST(FabricFile, ASceneGivesTheFabricsOfItsTextiles) {
  test::TemporaryFolder folder;
  const auto fabrics = read_fabrics(folder.write("scene.yaml", test::small_scene), {"textiles[0].size=[5 mm, 6 mm]"});
  ASSERT_EQ(fabrics.size(), 1u);
  EXPECT_EQ(fabrics[0].name, "swatch");
  EXPECT_EQ(fabrics[0].spec.size[1], 6e-3);
}

TEST(FabricFile, ADraftWithoutYarnsSaysWhatIsMissingAndTakesItFromOverrides) {
  const Library library = read_library({IMBIBE_SOURCE_DIR});
  const fs::path draft = fs::path(IMBIBE_SOURCE_DIR) / "fabrics" / "counterbalance_plain.wif";
  EXPECT_THROW(build_named_fabric(read_fabrics(draft)[0], library.fibres), InputError);
  const auto fabrics = read_fabrics(draft, {"size=[10 mm, 10 mm]", "warp={diameter: 0.4 mm, density: 10 /cm}",
                                            "weft={diameter: 0.4 mm, density: 10 /cm}"});
  EXPECT_EQ(build_named_fabric(fabrics[0], library.fibres).network.segments(), 200u);
}

TEST(FabricFile, AMisspeltKeyIsRefused) {
  test::TemporaryFolder folder;
  try {
    read_fabrics(folder.write("cloth.yaml", "weave: plain\nwrap: {fibre: wool}\n"));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.problems()[0].line, 2);
    EXPECT_EQ(error.problems()[0].key, "wrap");
  }
}

TEST(FabricFile, AnUnknownFibreIsReportedAtItsPlace) {
  test::TemporaryFolder folder;
  const auto fabrics = read_fabrics(folder.write(
      "cloth.yaml",
      "warp: {fibre: wol, diameter: 0.4 mm, density: 10 /cm}\nweft: {fibre: wool, diameter: 0.4 mm, density: 10 /cm}\n"));
  try {
    build_named_fabric(fabrics[0], read_library({IMBIBE_SOURCE_DIR}).fibres);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.problems()[0].line, 1) << error.what();
    EXPECT_EQ(error.problems()[0].key, "warp.fibre");
  }
}

}  // namespace
}  // namespace imbibe
