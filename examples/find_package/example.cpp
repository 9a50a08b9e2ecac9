// Reads a scene, simulates its first 2 ms, and prints where the liquid is: example SCENE
#include <cstdio>

#include "imbibe/scene/builder.h"
#include "imbibe/scene/library.h"
#include "imbibe/scene/scene.h"
#include "imbibe/sim/run.h"

int main(int count, char** words) {
  if (count != 2) return 2;
  const imbibe::Scene scene = imbibe::read_scene(words[1]);
  imbibe::World world = imbibe::build_world(scene, imbibe::read_library(imbibe::library_folders(words[1], {IMBIBE_DATA})));
  imbibe::run(world, {.until = 2e-3}, {});
  const imbibe::MassBalance balance = imbibe::mass_balance(world);
  std::printf("t = %g s: free %.4g mg, absorbed %.4g mg, balance error %.1e\n", world.time, 1e6 * balance.free,
              1e6 * (balance.yarn + balance.pore + balance.sorbed - balance.initial), balance.error());
  return balance.error() < 1e-10 ? 0 : 1;
}
