#include "patches/patch.hpp"

#include <utility>

namespace isthmus {

PatchPtr make_patch(PatchId id, std::string robot, const Scan& scan, const Laser& laser,
                    const PatchOptions& options) {
  auto patch = std::make_shared<Patch>();
  patch->id = id;
  patch->robot = std::move(robot);
  patch->utime = scan.utime;
  patch->scan = scan;
  patch->laser = laser;
  patch->points = to_points(scan, laser, options.normals);
  patch->index = PointIndex(patch->points);
  patch->star = Star(scan, laser, options.free_space.max_range_m, options.free_space.no_return_range_m);
  patch->free_space = free_space_of(scan, laser, options.free_space);
  return patch;
}

}  // namespace isthmus
