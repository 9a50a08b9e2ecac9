// One installed program for every x86-64 processor: `imbibe` is built for the oldest and starts the build for newer
// processors that lies beside it (`imbibe-x86-64-v3`, made with IMBIBE_DISPATCH=ON) where this processor can run it.
// Every build ends in the same bits (docs/decisions/0004-same-bits-on-every-machine.md), so nothing but time depends on
// the choice. IMBIBE_LEVEL=x86-64 in the environment stays with the oldest.
#pragma once

// Returns where no better build is there; otherwise the process goes on as that build, with the same words.
void go_on_as_best_build(char** words);
