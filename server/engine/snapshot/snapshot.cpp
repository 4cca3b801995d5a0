#include <algorithm>
#include <string>
#include <utility>

#include "server/engine/engine.hpp"
#include "server/engine/engine_state.hpp"
#include "server/engine/snapshot/snapshot_values.hpp"

namespace isthmus {
namespace {

/// What a scan makes of a patch is made again; one without, of a robot's way or a tag, is kept as it was.
bool is_of_a_scan(const Patch& patch) { return !patch.scan.ranges_m.empty(); }

}  // namespace

void save(SnapshotWriter& writer, const PatchPtr& patch) {
  std::vector<PatchPtr>& known = writer.context.patches;
  writer(patch->id);
  if (static_cast<std::size_t>(patch->id.value) < known.size()) return;
  known.push_back(patch);
  writer(patch->robot, patch->utime, patch->scan, patch->laser, patch->tag);
  if (!is_of_a_scan(*patch)) writer(patch->free_space.polygons());
}

void load(SnapshotReader& reader, PatchPtr& patch) {
  std::vector<PatchPtr>& known = reader.context.patches;
  Patch read;
  reader(read.id);
  const auto index = static_cast<std::size_t>(read.id.value);
  if (index < known.size()) {
    patch = known[index];
    return;
  }
  if (index != known.size()) throw std::runtime_error("it names a patch that it lacks");
  reader(read.robot, read.utime, read.scan, read.laser, read.tag);
  if (is_of_a_scan(read)) {
    patch = make_patch(read.id, read.robot, read.scan, read.laser, reader.context.options.patch);
  } else {
    std::vector<PolygonWithHoles> polygons;
    reader(polygons);
    read.free_space = Polysolid::of_sound(std::move(polygons));
    patch = std::make_shared<Patch>(std::move(read));
  }
  known.push_back(patch);
}

std::vector<std::uint8_t> Engine::save() const {
  if (is_frozen()) throw std::logic_error("a frozen engine was to be saved");
  SnapshotWriter writer;
  writer(state_->configuration.toml, static_cast<std::uint64_t>(state_->trajectory->size()), *state_);
  // A map without any is saved as it was before there were such things.
  const std::vector<RowCorrection> corrections = state_->trajectory->corrections();
  if (!state_->annotations.empty() || !corrections.empty()) writer(state_->annotations);
  if (!corrections.empty()) writer(corrections);
  return writer.take();
}

Engine Engine::restore(std::span<const std::uint8_t> saved, std::shared_ptr<TrajectoryStore> trajectory) {
  SnapshotReader reader(saved);
  std::string toml;
  std::uint64_t rows = 0;
  reader(toml, rows);
  auto configuration = parse_configuration(toml, "its configuration");
  if (const std::string* error = std::get_if<std::string>(&configuration)) throw std::runtime_error(*error);
  if (rows != trajectory->size())
    throw std::runtime_error("it is of " + std::to_string(rows) + " rows of trajectory, not " +
                             std::to_string(trajectory->size()));
  Engine engine(std::get<Configuration>(std::move(configuration)));
  reader.context.options = engine.state_->configuration.engine;
  reader(*engine.state_);
  if (reader.bytes_left() > 0) reader(engine.state_->annotations);
  std::vector<RowCorrection> corrections;
  if (reader.bytes_left() > 0) reader(corrections);
  if (reader.bytes_left() > 0) throw std::runtime_error("it does not end where it should");
  const auto is_known = [&](const RowCorrection& its) {
    return its.row < rows && index(its.patch) < engine.state_->map.manifold().size();
  };
  if (!std::ranges::all_of(corrections, is_known))
    throw std::runtime_error("it corrects a row that it lacks");
  for (const RowCorrection& correction : corrections) trajectory->correct(correction);
  engine.state_->trajectory = std::move(trajectory);
  return engine;
}

}  // namespace isthmus
