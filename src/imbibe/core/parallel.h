// Parallel loops whose results do not depend on the number of threads: work is cut into fixed tiles, a tile writes
// only its own items, and sums are added tile by tile in order. Only parallel.cpp (and parallel_threads.cpp, for the thread sanitizer) knows the threading library.
#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>
#include <vector>

namespace imbibe {

inline constexpr std::size_t default_tile = 512;

// Limits the threads of all parallel loops while it lives; 0 = all cores.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Control;
  std::unique_ptr<Control> control_;
};

int available_threads();

namespace detail {
using TileCall = void (*)(void* body, std::size_t tile);
void run_tiles(std::size_t tiles, void* body, TileCall call);
}  // namespace detail

// Calls body(begin, end) for consecutive ranges of at most `tile` items of [0, count).
template <class Body>
void parallel_tiles(std::size_t count, Body&& body, std::size_t tile = default_tile) {
  if (count == 0) return;
  const std::size_t tiles = (count + tile - 1) / tile;
  auto call = [&](std::size_t t) { body(t * tile, t + 1 == tiles ? count : (t + 1) * tile); };
  if (tiles == 1) return call(0);
  using Call = decltype(call);
  detail::run_tiles(tiles, &call, [](void* c, std::size_t t) { (*static_cast<Call*>(c))(t); });
}

// Calls body(i) for every i in [0, count).
template <class Body>
void parallel_for(std::size_t count, Body&& body, std::size_t tile = default_tile) {
  parallel_tiles(count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  }, tile);
}

// The sum of part(begin, end) over the tiles, added in tile order: the same bits for any number of threads.
template <class Part>
auto parallel_sum(std::size_t count, Part&& part, std::size_t tile = default_tile) {
  using Value = std::decay_t<decltype(part(std::size_t{}, std::size_t{}))>;
  const std::size_t tiles = (count + tile - 1) / tile;
  std::vector<Value> parts(tiles);
  parallel_tiles(count, [&](std::size_t begin, std::size_t end) { parts[begin / tile] = part(begin, end); }, tile);
  Value total{};
  for (const Value& value : parts) total += value;
  return total;
}

// The greatest part(begin, end) over the tiles, and at least `lowest`.
template <class Part, class Value>
Value parallel_max(std::size_t count, Value lowest, Part&& part, std::size_t tile = default_tile) {
  const std::size_t tiles = (count + tile - 1) / tile;
  std::vector<Value> parts(tiles, lowest);
  parallel_tiles(count, [&](std::size_t begin, std::size_t end) { parts[begin / tile] = part(begin, end); }, tile);
  for (const Value& value : parts) lowest = lowest < value ? value : lowest;
  return lowest;
}

}  // namespace imbibe
