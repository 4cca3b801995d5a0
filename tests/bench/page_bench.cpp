#include <benchmark/benchmark.h>

#include "server/wire/page/texts/page_texts.hpp"
#include "server/wire/page/tiles/tile_store.hpp"
#include "tests/support/relations.hpp"
#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

constexpr int a_side = 100;

/// 10,000 patches of a furnished room, 4 m apart in a square: 8000 by 8000 cells.
MapCopy large_map() {
  MapCopy map;
  const Scan scan = testing::scan_from(testing::furnished_room(), {}, 0, 20, 360);
  for (int i = 0; i < a_side * a_side; ++i) {
    map.patches.push_back(make_patch(PatchId{i}, "R1", scan, testing::laser_of(), {}));
    const int row = i / a_side;
    map.poses.push_back({4.0 * (i % a_side), 4.0 * row, 0.1 * i});
    map.graph.add_patch(PatchId{i});
    for (const int before : {i - 1, i - a_side, i - a_side - 1})
      if (before >= 0) map.graph.add(testing::odometry_between(before, i));
  }
  return map;
}

const MapCopy& the_map() {
  static const MapCopy map = large_map();
  return map;
}

/// What a status costs the page's thread where nothing has moved.
void show_a_map(benchmark::State& state) {
  const auto map = std::make_shared<const MapCopy>(the_map());
  TileStore tiles(1);
  tiles.update(*map);
  const ShownMap before = shown_map({map, {}, 0, false}, nullptr, 1);
  for (auto _ : state) {
    const ShownMap shown = shown_map({map, {}, 0, false}, &before, 2);
    tiles.update(*map);
    benchmark::DoNotOptimize(islands_text(shown, tiles.islands()));
    benchmark::DoNotOptimize(closures_text(shown));
    benchmark::DoNotOptimize(status_text(shown));
  }
}
BENCHMARK(show_a_map)->Unit(benchmark::kMillisecond);

/// A tile of zoom 0 after one of its patches has moved.
void draw_a_tile(benchmark::State& state) {
  MapCopy map = the_map();
  TileStore tiles(1);
  tiles.update(map);
  for (auto _ : state) {
    state.PauseTiming();
    map.poses[5050].x = map.poses[5050].x > 200 ? 200 : 200.1;
    tiles.update(map);
    state.ResumeTiming();
    benchmark::DoNotOptimize(tiles.image(IslandId{0}, {0, 15, -16}));
  }
}
BENCHMARK(draw_a_tile)->Unit(benchmark::kMillisecond);

/// The coarsest zoom, for which all tiles are drawn that nobody has seen yet.
void draw_all_tiles(benchmark::State& state) {
  std::size_t bytes = 0;
  for (auto _ : state) {
    TileStore tiles(1);
    tiles.update(the_map());
    bytes = tiles.image(IslandId{0}, {coarsest_zoom, 0, -1})->png->size();
  }
  state.counters["bytes"] = static_cast<double>(bytes);
}
BENCHMARK(draw_all_tiles)->Unit(benchmark::kMillisecond)->Iterations(1);

void pack_patches(benchmark::State& state) {
  const ShownMap shown = shown_map({std::make_shared<const MapCopy>(the_map()), {}, 0, false}, nullptr, 1);
  for (auto _ : state) benchmark::DoNotOptimize(patch_arrays(shown, IslandId{0}));
  state.counters["bytes"] = static_cast<double>(patch_arrays(shown, IslandId{0}).size());
}
BENCHMARK(pack_patches)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isthmus
