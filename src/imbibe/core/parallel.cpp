// With oneTBB; parallel_threads.cpp has the same on plain threads.
#ifndef IMBIBE_PLAIN_THREADS

#include "imbibe/core/parallel.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

namespace imbibe {

struct ThreadLimit::Control {
  tbb::global_control control;
};

ThreadLimit::ThreadLimit(int threads)
    : control_(new Control{tbb::global_control(
          tbb::global_control::max_allowed_parallelism,
          static_cast<std::size_t>(threads > 0 ? threads : tbb::this_task_arena::max_concurrency()))}) {}
ThreadLimit::~ThreadLimit() = default;

int available_threads() {
  return static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

void detail::run_tiles(std::size_t tiles, void* body, TileCall call) {
  // The caller works too, so a core taken by another program does not stall the loop.
  tbb::parallel_for(std::size_t{0}, tiles, [=](std::size_t tile) { call(body, tile); }, tbb::auto_partitioner{});
}

}  // namespace imbibe

#endif
