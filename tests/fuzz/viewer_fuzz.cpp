#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "server/wire/foxglove/broadcast.hpp"

/// Input: what a viewer says over its WebSocket. It is understood, complained of or overlooked; who leaves
/// then listens to nothing.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isthmus::foxglove;
  Broadcast broadcast("run");
  broadcast.open("/tf", Kind::frame_transforms, Broadcast::Keep::all);
  broadcast.open("/scene", Kind::scene_update, Broadcast::Keep::newest);
  broadcast.send("/scene", 1, "{}");
  Viewer& viewer = broadcast.join([] {});
  for (int again = 0; again < 2; ++again) broadcast.hear(viewer, {reinterpret_cast<const char*>(data), size});
  broadcast.send("/tf", 2, "{}");
  while (viewer.outbox().next()) continue;
  broadcast.leave(viewer);
  if (broadcast.is_heard("/tf") || broadcast.is_heard("/scene")) std::abort();
  return 0;
}
