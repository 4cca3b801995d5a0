#include "patches/patch.hpp"

#include <utility>

namespace isthmus {

PatchPtr make_patch(PatchId id, std::string robot, Observation observation, const PatchOptions& options) {
  auto patch = std::make_shared<Patch>();
  static_cast<Observation&>(*patch) = std::move(observation);
  patch->id = id;
  patch->robot = std::move(robot);
  patch->utime = patch->scan.utime;
  patch->index = PointIndex(patch->points);
  patch->free_space = free_space_of(patch->scan, patch->laser, options.free_space);
  return patch;
}

PatchPtr make_patch(PatchId id, std::string robot, const Scan& scan, const Laser& laser,
                    const PatchOptions& options) {
  return make_patch(id, std::move(robot), observe(scan, laser, options), options);
}

}  // namespace isthmus
