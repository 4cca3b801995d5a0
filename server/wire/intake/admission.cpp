#include "server/wire/intake/admission.hpp"

namespace isthmus {
namespace {

template <class T>
bool admit_one(std::set<T>& known, const T& one, std::size_t max_known) {
  if (known.size() >= max_known) return known.contains(one);
  known.insert(one);
  return true;
}

}  // namespace

DropReason Admission::admit(const Event& event) {
  if (const auto* robot = std::get_if<RobotEvent>(&event.body))
    return admit_one(robots_, robot->robot, limits_.robots) ? DropReason::none : DropReason::too_many_robots;
  if (const auto* tag = std::get_if<TagEvent>(&event.body))
    return admit_one(tags_, tag->barcode, limits_.tags) ? DropReason::none : DropReason::too_many_tags;
  return DropReason::none;
}

void Admission::know(const MapCopy& map) {
  for (const HealthRecord& robot : map.health) robots_.insert(robot.robot);
  for (const TagRecord& tag : map.tags) tags_.insert(tag.barcode);
}

}  // namespace isthmus
